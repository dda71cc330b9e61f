//! Commands for objects: their transforms and visibility.

use glam::{EulerRot, Mat4, Quat, Vec3};
use lumivox_explorer::Placement;

use crate::arguments::{PLACE, choice, number, on_or_off, rounded, short, switch, vector, wrong};
use crate::command::Run::Now;
use crate::command::{Command, Group, PLAIN, Takes};
use crate::report::Table;
use crate::{Console, Failure, Reply, nothing_to_show};

const OBJECTS: Command =
    Command { group: Group::Objects, takes: &[Takes::Object, Takes::Anything], ..PLAIN };

/// An object, optionally followed by an axis.
const AXIS: [Takes; 3] = [Takes::Object, Takes::Word(&["x", "y", "z"]), Takes::Anything];

/// The range of turns, degrees: small enough for f32 to resolve them.
const TURN: std::ops::RangeInclusive<f32> = -36_000.0..=36_000.0;
/// The range of scale factors. An object without extent can be neither voxelized nor scaled back.
const SCALE: std::ops::RangeInclusive<f32> = -1e6..=1e6;

pub const TABLE: &[Command] = &[
    Command {
        name: "objects",
        usage: "[NAME]",
        count: (0, 1),
        summary: "List the objects: shown or hidden, static or dynamic, material, place",
        example: "objects",
        run: Now(list),
        ..OBJECTS
    },
    Command {
        name: "translate",
        usage: "NAME X Y Z|x VALUE|y VALUE|z VALUE",
        count: (3, 4),
        takes: &AXIS,
        summary: "Move an object along its own axes",
        details: "In metres of its own space, along one axis or all, in addition to earlier transforms.",
        example: "translate 'tall block' x 0.1",
        run: Now(|console, arguments| {
            transform(console, arguments, "the distance in metres", PLACE, |by| {
                Ok(Mat4::from_translation(by))
            })
        }),
        ..OBJECTS
    },
    Command {
        name: "rotate",
        usage: "NAME X Y Z|x VALUE|y VALUE|z VALUE",
        count: (3, 4),
        takes: &AXIS,
        summary: "Turn an object about its own axes",
        details: "In degrees about one axis, or about x, y and z (z first), in addition to earlier transforms.",
        example: "rotate 'tall block' y 30",
        run: Now(|console, arguments| {
            transform(console, arguments, "the angle in degrees", TURN, |degrees| {
                let [x, y, z] = degrees.map(f32::to_radians).to_array();
                Ok(Mat4::from_quat(Quat::from_euler(EulerRot::XYZ, x, y, z)))
            })
        }),
        ..OBJECTS
    },
    Command {
        name: "scale",
        usage: "NAME FACTOR|X Y Z",
        count: (2, 4),
        summary: "Multiply an object's size",
        details: "By one factor, or one for each of its own axes, from -1000000 to 1000000 but not 0, in addition to \
                  earlier transforms.",
        example: "scale 'tall block' 0.5",
        run: Now(|console, arguments| {
            let arguments = match arguments {
                [name, factor] => vec![*name, *factor, *factor, *factor],
                _ => arguments.to_vec(),
            };
            transform(console, &arguments, "the factor", SCALE, |by| {
                if by.min_element() == 0.0 || by.to_array().contains(&0.0) {
                    return Err(wrong("the factor", "a number other than 0", "0"));
                }
                Ok(Mat4::from_scale(by))
            })
        }),
        ..OBJECTS
    },
    Command {
        name: "place",
        usage: "NAME [PX PY PZ RX RY RZ S|SX SY SZ]",
        count: (1, 10),
        summary: "Place an object in the world, or print its place",
        details: "Position in metres, rotation in degrees about x, y and z (z first, in the world's axes), and scale as one \
                  factor or three.",
        example: "place 'tall block' 0 0.3 0 0 45 0 1",
        sets: Some(2),
        run: Now(place),
        ..OBJECTS
    },
    Command {
        name: "matrix",
        usage: "NAME [12 NUMBERS]",
        count: (1, 13),
        summary: "Set the matrix of all transforms of an object, or print it",
        details: "In its own space: the three axes, then the translation, three numbers each. It is applied before the place \
                  that the file or the animation gives the object; `script` prints this command, because it keeps every bit.",
        example: "matrix 'tall block' 1 0 0 0 1 0 0 0 1 0 0.2 0",
        run: Now(matrix),
        ..OBJECTS
    },
    Command {
        name: "toggle",
        usage: "NAME",
        count: (1, 1),
        summary: "Hide an object, or show it again",
        details: "A hidden object is neither drawn nor voxelized, and casts no shadow. Prints the new state.",
        example: "toggle FrontWall",
        run: Now(|console, arguments| {
            let name = arguments.first().copied().unwrap_or_default();
            let object = object(console, arguments)?;
            let is_hidden = console
                .explorer
                .scene()
                .and_then(|scene| scene.instances.get(object))
                .is_some_and(|i| i.is_hidden);
            console.explorer.set_hidden(object, !is_hidden);
            Ok(Reply::say(format!("{name} {}", if is_hidden { "shown" } else { "hidden" })))
        }),
        ..OBJECTS
    },
    Command {
        name: "hide",
        usage: "NAME|all",
        count: (1, 1),
        summary: "Hide an object, or all of them",
        example: "hide FrontWall",
        run: Now(|console, arguments| hide(console, arguments, true)),
        ..OBJECTS
    },
    Command {
        name: "show",
        usage: "NAME|all",
        count: (1, 1),
        summary: "Show an object again, or all of them",
        example: "show all",
        run: Now(|console, arguments| hide(console, arguments, false)),
        ..OBJECTS
    },
    Command {
        name: "static",
        usage: "NAME [on|off]",
        count: (1, 2),
        takes: &[Takes::Object, Takes::Switch],
        summary: "Set whether an object is static, that is, stays while others move, or print it",
        details: "A static object is voxelized once, and its voxels are kept. Moving it voxelizes the whole scene again.",
        example: "static 'tall block' off",
        sets: Some(2),
        run: Now(set_static),
        ..OBJECTS
    },
];

/// The number of the object that the first argument names.
fn object(console: &Console, arguments: &[&str]) -> Result<usize, Failure> {
    let name = arguments.first().copied().unwrap_or_default();
    console.explorer.object(name).map_err(|error| Failure::input(error.to_string()))
}

fn transform(
    console: &mut Console,
    arguments: &[&str],
    what: &str,
    range: std::ops::RangeInclusive<f32>,
    matrix: impl FnOnce(Vec3) -> Result<Mat4, Failure>,
) -> anyhow::Result<Reply> {
    let object = object(console, arguments)?;
    let local = matrix(match arguments.get(1..).unwrap_or_default() {
        // An axis and a number.
        [axis, value] if !axis.contains(',') => {
            let along = match choice(axis, "the axis", &["x", "y", "z"])? {
                "x" => Vec3::X,
                "y" => Vec3::Y,
                _ => Vec3::Z,
            };
            along * number(value, what, range)?
        }
        numbers => vector(numbers, what, range)?,
    })?;
    let edit = console.explorer.local_edit(object).unwrap_or(Mat4::IDENTITY);
    check_transform(console, object, edit * local)?;
    console.explorer.transform(object, local);
    Ok(Reply::default())
}

/// Refuses transforms that f32 cannot hold or invert, and those that `matrix` would not read back
/// from a script.
fn check_transform(console: &Console, object: usize, edit: Mat4) -> Result<(), Failure> {
    let world = console.explorer.posed(object).unwrap_or(Mat4::IDENTITY) * edit;
    let is_held = |matrix: Mat4| matrix.to_cols_array().iter().all(|number| PLACE.contains(number));
    if is_held(world) && is_held(edit) && edit.determinant().is_normal() {
        return Ok(());
    }
    Err(Failure::input(
        "the object would be too small or too large for its numbers; `matrix NAME 1 0 0 0 1 0 0 0 1 0 0 0` \
                        puts it back",
    ))
}

fn list(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let only = if arguments.is_empty() { None } else { Some(object(console, arguments)?) };
    let explorer = &console.explorer;
    let scene = explorer.scene().ok_or_else(nothing_to_show)?;
    let materials = explorer.material_names();
    let mut table = Table::left(&["object", "", "", "material", "position", "rotation", "scale"]);
    for (index, (name, instance)) in
        explorer.object_names().into_iter().zip(&scene.instances).enumerate()
    {
        if only.is_some_and(|only| only != index) {
            continue;
        }
        let at = Placement::of(instance.world_from_local);
        let shown = if instance.is_hidden { "hidden" } else { "shown" };
        let is_static = if instance.is_static { "static" } else { "dynamic" };
        let material = materials.get(instance.material).cloned().unwrap_or_default();
        table.row([
            name,
            shown.to_owned(),
            is_static.to_owned(),
            material,
            short(at.position),
            short(at.rotation_deg),
            short(at.scale),
        ]);
    }
    Ok(Reply::say(table.text().trim_end()))
}

fn place(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let number = object(console, arguments)?;
    let name = arguments.first().copied().unwrap_or_default();
    let placement = match arguments.get(1..).unwrap_or_default() {
        [] => {
            let at = console.explorer.placement(number).ok_or_else(nothing_to_show)?;
            let (p, r, s) = (rounded(at.position), rounded(at.rotation_deg), rounded(at.scale));
            return Ok(Reply::say(format!(
                "{name}: position {p} m, rotation {r} degrees, scale {s}"
            )));
        }
        [px, py, pz, rx, ry, rz, size @ ..] if size.len() == 1 || size.len() == 3 => {
            let size = if let [size] = size { vec![*size; 3] } else { size.to_vec() };
            let scale = vector(&size, "the scale", SCALE)?;
            if scale.to_array().contains(&0.0) {
                return Err(wrong("the scale", "a number other than 0", "0").into());
            }
            Placement {
                position: vector(&[px, py, pz], "the position in metres", PLACE)?,
                rotation_deg: vector(&[rx, ry, rz], "the rotation in degrees", TURN)?,
                scale,
            }
        }
        words => {
            return Err(Failure::input(format!(
                "place takes NAME, or NAME PX PY PZ RX RY RZ and one or three scale factors; got {} numbers",
                words.len()
            ))
            .into());
        }
    };
    let local = console.explorer.local_edit_for(number, placement).ok_or_else(nothing_to_show)?;
    if !local.is_finite() {
        return Err(Failure::input(format!(
            "at this moment of the animation \"{name}\" has no size, and so no place; `time SECONDS` shows another time"
        ))
        .into());
    }
    check_transform(console, number, local)?;
    console.explorer.set_local_edit(number, local);
    Ok(Reply::default())
}

fn matrix(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let number = object(console, arguments)?;
    let words = arguments.get(1..).unwrap_or_default();
    if words.is_empty() {
        let edit = console.explorer.local_edit(number).unwrap_or(Mat4::IDENTITY);
        return Ok(Reply::say(format!(
            "matrix {} {}",
            crate::line::quote(arguments[0]),
            matrix_words(edit)
        )));
    }
    let (columns, rest) = words.as_chunks::<3>();
    let (&[x, y, z, w], []) = (columns, rest) else {
        return Err(Failure::input(format!("matrix takes 12 numbers; got {}", words.len())).into());
    };
    let column = |words: [&str; 3]| vector(&words, "the matrix", PLACE);
    let matrix = Mat4::from_cols(
        column(x)?.extend(0.0),
        column(y)?.extend(0.0),
        column(z)?.extend(0.0),
        column(w)?.extend(1.0),
    );
    check_transform(console, number, matrix)?;
    console.explorer.set_local_edit(number, matrix);
    Ok(Reply::default())
}

/// The twelve numbers that `matrix` takes for a matrix.
pub fn matrix_words(matrix: Mat4) -> String {
    let columns = [matrix.x_axis, matrix.y_axis, matrix.z_axis, matrix.w_axis];
    columns.map(|column| crate::arguments::spaces(column.truncate())).join(" ")
}

fn hide(console: &mut Console, arguments: &[&str], is_hidden: bool) -> anyhow::Result<Reply> {
    let objects = match arguments {
        ["all", ..] if console.explorer.object("all").is_err() => {
            if console.explorer.scene().is_none() {
                return Err(nothing_to_show().into());
            }
            0..console.explorer.object_names().len()
        }
        _ => {
            let object = object(console, arguments)?;
            object..object + 1
        }
    };
    for object in objects {
        console.explorer.set_hidden(object, is_hidden);
    }
    Ok(Reply::default())
}

fn set_static(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let number = object(console, arguments)?;
    if let Some(text) = arguments.get(1) {
        let is_static = switch(text, "static")?;
        console.explorer.set_static(number, is_static);
        return Ok(Reply::default());
    }
    let instance = console.explorer.scene().and_then(|scene| scene.instances.get(number));
    let is_static = instance.is_some_and(|instance| instance.is_static);
    Ok(Reply::say(format!("static {} {}", arguments[0], on_or_off(is_static))))
}
