//! Commands for cameras.

use glam::{Quat, Vec3};
use lumivox_scene::Camera;

use crate::arguments::{PLACE, angle, commas, degrees, direction, number, refused, spaces, vector};
use crate::command::Run::Now;
use crate::command::{Command, Edits, Group, PLAIN, Takes};
use crate::values::camera::{self, CameraChoice, FRAMING, INSIDE, OUTSIDE, resolve};
use crate::{Console, Failure, Reply, nothing_to_show, shown, suggest};

const CAMERA: Command =
    Command { group: Group::Camera, takes: &[Takes::Anything], edits: Edits::Nothing, ..PLAIN };

/// The range of turns, degrees.
const TURN: std::ops::RangeInclusive<f64> = -36_000.0..=36_000.0;
/// The steepest tilt of a camera: closer to the vertical its up direction is undetermined.
const MOST_TILT_RAD: f32 = 1.569;

pub const TABLE: &[Command] = &[
    Command {
        name: "camera",
        usage: "[NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]]",
        count: (0, 1),
        takes: &[Takes::Camera],
        summary: "Look from one of the scene's cameras, a stored one, or from a position to a target, or print the camera",
        details: "Numbers count from 0; `framing` is the view that shows the scene best. Positions are in metres, FOV is \
                  the vertical field of view in degrees, 1 to 170 (the present one where it is left out).",
        example: "camera 2,1.5,3,0,0.5,0,60",
        sets: Some(1),
        moves_camera: true,
        run: Now(camera),
        ..CAMERA
    },
    Command {
        name: "cameras",
        summary: "List the scene's cameras, and those that were stored under names",
        example: "cameras",
        run: Now(|console, _| {
            let scene = console.explorer.scene().ok_or_else(nothing_to_show)?;
            let lines = scene
                .cameras
                .iter()
                .enumerate()
                .map(|(number, camera)| format!("{number} \"{}\"", shown::line(&camera.name)));
            let lines: Vec<String> = lines
                .chain(
                    console
                        .explorer
                        .stored_cameras()
                        .map(|(name, _)| format!("  \"{}\", stored", shown::line(name))),
                )
                .chain([
                    format!("  \"{FRAMING}\", the view that shows the scene best"),
                    format!(
                        "  \"{OUTSIDE}\" and \"{INSIDE}\", the same from outside and from inside"
                    ),
                ])
                .collect();
            Ok(Reply::say(lines.join("\n")))
        }),
        ..CAMERA
    },
    Command {
        name: "camera_axes",
        usage: "PX PY PZ FX FY FZ UX UY UZ FOV [NEAR]",
        count: (10, 11),
        summary: "Place the camera by its position, viewing direction and up direction",
        details: "Position in metres; both directions of any length, not parallel; the vertical field of view in degrees, \
                  0.001 to 179; the near plane in metres. `script` prints this command, because it keeps every bit.",
        example: "camera_axes 0 1 3 0 0 -1 0 1 0 45",
        moves_camera: true,
        run: Now(axes),
        ..CAMERA
    },
    Command {
        name: "fov",
        usage: "[DEGREES]",
        count: (0, 1),
        summary: "Set the vertical field of view, or print it",
        details: "From 1 to 170 degrees.",
        example: "fov 60",
        moves_camera: true,
        run: Now(|console, arguments| {
            let mut camera = console.explorer.camera().clone();
            let Some(text) = arguments.first() else {
                return Ok(Reply::say(format!("fov {}", degrees(camera.vertical_fov_rad))));
            };
            camera.vertical_fov_rad = angle(text, "the field of view", 1.0..=170.0)?;
            console.explorer.set_camera(camera);
            Ok(Reply::default())
        }),
        ..CAMERA
    },
    Command {
        name: "move",
        usage: "RIGHT UP FORWARD",
        count: (1, 3),
        summary: "Move the camera along its own axes, in metres",
        example: "move 0 0 0.5",
        moves_camera: true,
        run: Now(|console, arguments| {
            let by = vector(arguments, "the distance in metres", PLACE)?;
            let mut camera = console.explorer.camera().clone();
            let axes = camera.world_from_camera();
            camera.position += axes.transform_vector3(by * Vec3::new(1.0, 1.0, -1.0));
            check_place(camera.position)?;
            console.explorer.set_camera(camera);
            Ok(Reply::default())
        }),
        ..CAMERA
    },
    Command {
        name: "orbit",
        usage: "RIGHT UP [X,Y,Z]",
        count: (2, 3),
        summary: "Orbit the camera about a point, by degrees to the right and upwards",
        details: "Without a point it orbits the centre of the scene. It keeps its distance and keeps looking at the point.",
        example: "orbit 30 10",
        moves_camera: true,
        run: Now(orbit),
        ..CAMERA
    },
    Command {
        name: "turn",
        usage: "RIGHT UP",
        count: (2, 2),
        summary: "Turn the camera in place, by degrees to the right and upwards",
        example: "turn -15 5",
        moves_camera: true,
        run: Now(|console, arguments| {
            let (yaw, pitch) = turns(arguments)?;
            let mut camera = console.explorer.camera().clone();
            let (turn, _) = turn(&camera, yaw, pitch);
            turn_axes(&mut camera, turn);
            console.explorer.set_camera(camera);
            Ok(Reply::default())
        }),
        ..CAMERA
    },
    Command {
        name: "pos1",
        summary: "Look from the first stored position",
        details: "The scene's second camera until another is stored.",
        example: "pos1",
        moves_camera: true,
        run: Now(|console, _| go(console, 0)),
        ..CAMERA
    },
    Command {
        name: "pos2",
        summary: "Look from the second stored position",
        details: "The scene's third camera until another is stored.",
        example: "pos2",
        moves_camera: true,
        run: Now(|console, _| go(console, 1)),
        ..CAMERA
    },
    Command {
        name: "store",
        usage: "1|2|NAME",
        count: (1, 1),
        takes: &[Takes::Stored],
        summary: "Store the present camera, to return to it by `pos1`, `pos2` or `camera NAME`",
        details: "Replaces what was stored there. Numbers and names of the scene's cameras are not allowed as names; `cameras` \
                  lists the stored cameras. They are kept until another scene is opened; `script` prints them, too.",
        example: "store 'window seat'",
        edits: Edits::Scene,
        run: Now(store),
        ..CAMERA
    },
];

fn camera(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some(text) = arguments.first() else {
        return Ok(Reply::say(told(console.explorer.camera())));
    };
    let scene = console.explorer.scene().ok_or_else(nothing_to_show)?;
    let is_own = scene.cameras.iter().any(|camera| camera.name == *text);
    let stored = console.explorer.stored_cameras().find(|(name, _)| name == text && !is_own);
    if let Some((_, stored)) = stored {
        let stored = stored.clone();
        console.explorer.set_camera(stored);
        return Ok(Reply::default());
    }
    let mut chosen = camera::camera(text).map_err(refused("camera", text))?;
    if let CameraChoice::LookAt { vertical_fov_rad, .. } = &mut chosen
        && text.split(',').count() == 6
    {
        *vertical_fov_rad = console.explorer.camera().vertical_fov_rad;
    }
    let size = console.explorer.settings().size;
    let found = resolve(Some(&chosen), scene, size.x as f32 / size.y as f32).map_err(|error| {
        let names = scene
            .cameras
            .iter()
            .map(|camera| camera.name.as_str())
            .chain(console.explorer.stored_cameras().map(|(name, _)| name))
            .chain([FRAMING, OUTSIDE, INSIDE]);
        let like = suggest::like(text, names).map(|like| format!("; did you mean \"{like}\"?"));
        Failure::input(format!("{error}{}", like.unwrap_or_default()))
    })?;
    console.explorer.set_camera(found);
    Ok(Reply::default())
}

fn store(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let text = arguments.first().copied().unwrap_or_default();
    if let Some(number) = ["1", "2"].iter().position(|number| *number == text) {
        console.explorer.store_position(number);
        return Ok(Reply::default());
    }
    console.explorer.scene().ok_or_else(nothing_to_show)?;
    // A name that `camera` reads differently could not be used.
    let is_name = matches!(camera::camera(text), Ok(CameraChoice::Name(name)) if name == text);
    if !text.trim().is_empty() && (!is_name || [FRAMING, OUTSIDE, INSIDE].contains(&text)) {
        return Err(Failure::input(format!(
            "no camera can be stored as \"{text}\": `camera {text}` means something else; the position is 1, 2 or a name"
        ))
        .into());
    }
    console.explorer.store_camera(text).map_err(|error| Failure::input(error.to_string()))?;
    Ok(Reply::default())
}

/// A description of a camera.
fn told(camera: &Camera) -> String {
    let target = camera.position + camera.forward;
    format!(
        "camera {},{},{} (\"{}\", at {}, looking along {})",
        commas(camera.position),
        commas(target),
        camera.vertical_fov_rad.to_degrees(),
        shown::line(&camera.name),
        commas(camera.position),
        commas(camera.forward)
    )
}

/// The arguments of `camera_axes` for a camera.
pub fn axes_words(camera: &Camera) -> String {
    let (p, f, u) = (spaces(camera.position), spaces(camera.forward), spaces(camera.up));
    format!("{p} {f} {u} {} {}", degrees(camera.vertical_fov_rad), camera.near_m)
}

fn axes(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let (vectors, rest) = arguments.as_chunks::<3>();
    let &[position, forward, up] = vectors else { return Err(axes_form(arguments).into()) };
    let (fov, near) = match rest {
        [fov] => (fov, None),
        [fov, near] => (fov, Some(near)),
        _ => return Err(axes_form(arguments).into()),
    };
    let mut camera = console.explorer.camera().clone();
    camera.position = vector(&position, "the position in metres", PLACE)?;
    camera.forward = direction(&forward, "the direction")?;
    camera.up = direction(&up, "the up direction")?;
    if camera.forward.cross(camera.up).length() < 1e-6 {
        return Err(Failure::input(
            "the viewing direction and the up direction must not be parallel",
        )
        .into());
    }
    camera.vertical_fov_rad = angle(fov, "the field of view", 0.001..=179.0)?;
    if let Some(near) = near {
        camera.near_m = number(near, "the near plane in metres", 1e-9..=1e6)?;
    }
    console.explorer.set_camera(camera);
    Ok(Reply::default())
}

fn axes_form(arguments: &[&str]) -> Failure {
    let count = arguments.len();
    Failure::input(format!(
        "camera_axes takes nine numbers, FOV and optionally NEAR; got {count} words"
    ))
}

fn turns(arguments: &[&str]) -> Result<(f32, f32), Failure> {
    let turn = |place: usize, what: &str| {
        angle(arguments.get(place).copied().unwrap_or_default(), what, TURN)
    };
    Ok((turn(0, "the turn to the right")?, turn(1, "the turn upwards")?))
}

/// The rotation for a turn about the vertical and a tilt about the camera's right, and the tilt
/// itself, which is limited so that the view stops short of the vertical.
fn turn(camera: &Camera, right_rad: f32, up_rad: f32) -> (Quat, f32) {
    let forward = camera.forward.normalize_or(Vec3::NEG_Z);
    let tilt = forward.y.clamp(-1.0, 1.0).asin();
    let up_rad = (tilt + up_rad).clamp(-MOST_TILT_RAD, MOST_TILT_RAD) - tilt;
    let right = camera.world_from_camera().x_axis.truncate();
    (Quat::from_rotation_y(-right_rad) * Quat::from_axis_angle(right, up_rad), up_rad)
}

fn turn_axes(camera: &mut Camera, turn: Quat) {
    camera.forward = (turn * camera.forward).normalize_or(Vec3::NEG_Z);
    camera.up = (turn * camera.up).normalize_or(Vec3::Y);
}

fn orbit(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let (yaw, pitch) = turns(arguments)?;
    let center = match arguments.get(2) {
        Some(text) => vector(&[text], "the point", PLACE)?,
        None => console
            .explorer
            .scene()
            .map(|_| console.explorer.bounds().center())
            .ok_or_else(nothing_to_show)?,
    };
    let mut camera = console.explorer.camera().clone();
    // An orbit to the right moves the eye right and turns the view left.
    let (turn, _) = turn(&camera, -yaw, -pitch);
    camera.position = center + turn * (camera.position - center);
    check_place(camera.position)?;
    turn_axes(&mut camera, turn);
    console.explorer.set_camera(camera);
    Ok(Reply::default())
}

fn check_place(position: Vec3) -> Result<(), Failure> {
    if position.to_array().iter().all(|x| PLACE.contains(x)) {
        return Ok(());
    }
    Err(Failure::input(
        "the camera would be farther away than 1e9 m; `camera framing` brings it back",
    ))
}

fn go(console: &mut Console, number: usize) -> anyhow::Result<Reply> {
    let camera = console.explorer.position(number).cloned().ok_or_else(|| {
        let number = number + 1;
        Failure::input(format!(
            "no position {number} is stored; `store {number}` stores the present camera"
        ))
    })?;
    console.explorer.set_camera(camera);
    Ok(Reply::default())
}
