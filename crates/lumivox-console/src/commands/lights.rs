//! Commands for lights.

use glam::Vec3;
use lumivox_scene::{Attenuation, Light, LightKind};

use crate::arguments::{PLACE, angle, choice, degrees, direction, number, short, spaces, vector};
use crate::command::Run::Now;
use crate::command::{Command, Edits, Group, MANY, PLAIN, Takes};
use crate::properties::{self, Property, first, names};
use crate::report::Table;
use crate::{Console, Failure, Reply, nothing_to_show};

const LIGHT: Command = Command { group: Group::Light, takes: &[Takes::Light], ..PLAIN };

pub const TABLE: &[Command] = &[
    Command {
        name: "lights",
        summary: "List the lights: kind, strength, colour, position, direction",
        example: "lights",
        run: Now(list),
        ..LIGHT
    },
    Command {
        name: "light",
        usage: "NAME [PROPERTY VALUE...]...",
        count: (1, MANY),
        takes: &[Takes::Light, Takes::Word(&NAMES)],
        summary: "Change properties of a light, or print them",
        details: "strength (cd; lux of a sun), color R G B (linear), position X Y Z (m), direction X Y Z (in which light \
                  travels), radius (m, for soft shadows), range (m, or none), inner and outer (degrees, of a spot), \
                  angular_radius (degrees, of a sun), attenuation CONSTANT LINEAR QUADRATIC (of the look vxct, or none).",
        example: "light lamp strength 200 color 1 0.8 0.6",
        sets: Some(3),
        edits: Edits::Look,
        run: Now(light),
        ..LIGHT
    },
    Command {
        name: "add_light",
        usage: "point|spot|sun [NAME] [PROPERTY VALUE...]...",
        count: (1, MANY),
        takes: &[Takes::Word(&KINDS), Takes::Word(&NAMES)],
        summary: "Add a light",
        details: "Defaults of its properties (see `light`): at the camera, in its direction, 100 cd; a sun shines from \
                  above with 100000 lux. Prints the light's name.",
        example: "add_light point lamp position 0 1.5 0 strength 50",
        edits: Edits::Look,
        run: Now(add),
        ..LIGHT
    },
    Command {
        name: "remove_light",
        usage: "NAME|all",
        count: (1, 1),
        summary: "Remove a light, or all of them",
        example: "remove_light lamp",
        edits: Edits::Look,
        run: Now(remove),
        ..LIGHT
    },
];

const KINDS: [&str; 3] = ["point", "spot", "sun"];
/// The greatest strength, as on the command line.
const BRIGHTEST: f32 = 1e10;

type P = Property<Light>;

const NAMES: [&str; PROPERTIES.len()] = names(PROPERTIES);

fn range_of(light: &Light) -> Option<String> {
    match light.kind {
        LightKind::Point { range_m, .. } | LightKind::Spot { range_m, .. } => {
            Some(range_m.map_or("none".to_owned(), |range_m| range_m.to_string()))
        }
        LightKind::Directional { .. } => None,
    }
}

/// The properties of a light.
pub const PROPERTIES: &[P] = &[
    P {
        name: "strength",
        aliases: &["intensity", "illuminance"],
        count: 1,
        is: "a number from 0 to 1e10 (cd; lux of a sun)",
        get: |light| {
            Some(match light.kind {
                LightKind::Directional { illuminance_lux: x, .. }
                | LightKind::Point { intensity_cd: x, .. }
                | LightKind::Spot { intensity_cd: x, .. } => x.to_string(),
            })
        },
        set: |light, words| {
            let strength = number(first(words), "strength (cd; lux of a sun)", 0.0..=BRIGHTEST)?;
            match &mut light.kind {
                LightKind::Directional { illuminance_lux: x, .. }
                | LightKind::Point { intensity_cd: x, .. }
                | LightKind::Spot { intensity_cd: x, .. } => *x = strength,
            }
            Ok(())
        },
    },
    P {
        name: "color",
        aliases: &["colour"],
        count: 3,
        is: "three numbers R G B from 0 to 1000000",
        get: |light| Some(spaces(light.color)),
        set: |light, words| {
            light.color = vector(words, "color", 0.0..=1e6)?;
            Ok(())
        },
    },
    P {
        name: "position",
        aliases: &[],
        count: 3,
        is: "three numbers X Y Z in metres",
        get: |light| (!is_sun(light)).then(|| spaces(light.position)),
        set: |light, words| {
            light.position = vector(words, "position (m)", PLACE)?;
            Ok(())
        },
    },
    P {
        name: "direction",
        aliases: &[],
        count: 3,
        is: "three numbers X Y Z, not all 0",
        get: |light| {
            (!matches!(light.kind, LightKind::Point { .. })).then(|| spaces(light.direction))
        },
        set: |light, words| {
            light.direction = direction(words, "the direction")?;
            Ok(())
        },
    },
    P {
        name: "radius",
        aliases: &[],
        count: 1,
        is: "a number from 0 to 1e6 (m)",
        get: |light| (!is_sun(light)).then(|| light.radius_m.to_string()),
        set: |light, words| {
            light.radius_m = number(first(words), "radius (m)", 0.0..=1e6)?;
            Ok(())
        },
    },
    P {
        name: "range",
        aliases: &[],
        count: 1,
        is: "a number above 0 (m), or none",
        get: range_of,
        set: |light, words| {
            let reach_m = match first(words) {
                "none" => None,
                text => Some(number(text, "range (m, or none)", f32::MIN_POSITIVE..=1e9)?),
            };
            if let LightKind::Point { range_m, .. } | LightKind::Spot { range_m, .. } =
                &mut light.kind
            {
                *range_m = reach_m;
            }
            Ok(())
        },
    },
    P {
        name: "outer",
        aliases: &[],
        count: 1,
        is: "an angle above 0, at most 90 degrees",
        get: |light| match light.kind {
            LightKind::Spot { outer_angle_rad, .. } => Some(degrees(outer_angle_rad)),
            _ => None,
        },
        set: |light, words| {
            let outer = angle(first(words), "outer", 0.001..=90.000_001)?;
            if let LightKind::Spot { inner_angle_rad, outer_angle_rad, .. } = &mut light.kind {
                *outer_angle_rad = outer;
                *inner_angle_rad = inner_angle_rad.min(outer);
            }
            Ok(())
        },
    },
    P {
        name: "inner",
        aliases: &[],
        count: 1,
        is: "an angle from 0 to the outer one, in degrees",
        get: |light| match light.kind {
            LightKind::Spot { inner_angle_rad, .. } => Some(degrees(inner_angle_rad)),
            _ => None,
        },
        set: |light, words| {
            let inner = angle(first(words), "inner", 0.0..=90.000_001)?;
            if let LightKind::Spot { inner_angle_rad, outer_angle_rad, .. } = &mut light.kind {
                if inner > *outer_angle_rad {
                    let outer = degrees(*outer_angle_rad);
                    return Err(Failure::input(format!(
                        "inner is at most outer, {outer} degrees; got \"{}\"",
                        first(words)
                    )));
                }
                *inner_angle_rad = inner;
            }
            Ok(())
        },
    },
    P {
        name: "angular_radius",
        aliases: &[],
        count: 1,
        is: "an angle from 0 to 90 degrees",
        get: |light| match light.kind {
            LightKind::Directional { angular_radius_rad, .. } => Some(degrees(angular_radius_rad)),
            _ => None,
        },
        set: |light, words| {
            let radius = angle(first(words), "angular_radius", 0.0..=90.0)?;
            if let LightKind::Directional { angular_radius_rad, .. } = &mut light.kind {
                *angular_radius_rad = radius;
            }
            Ok(())
        },
    },
    P {
        name: "attenuation",
        aliases: &[],
        count: 3,
        is: "three numbers from 0, not all 0, or none",
        get: |light| {
            Some(match light.attenuation {
                Some(a) => format!("{} {} {}", a.constant, a.linear, a.quadratic),
                None => "none".to_owned(),
            })
        },
        set: |light, words| {
            light.attenuation = if first(words) == "none" {
                None
            } else {
                let v = vector(words, "attenuation", 0.0..=1e6)?;
                if v == Vec3::ZERO {
                    return Err(Failure::input("attenuation must not be 0 0 0"));
                }
                Some(Attenuation { constant: v.x, linear: v.y, quadratic: v.z })
            };
            Ok(())
        },
    },
];

fn is_sun(light: &Light) -> bool {
    matches!(light.kind, LightKind::Directional { .. })
}

/// The kind of a light as `add_light` names it.
pub fn kind_name(light: &Light) -> &'static str {
    match light.kind {
        LightKind::Directional { .. } => "sun",
        LightKind::Point { .. } => "point",
        LightKind::Spot { .. } => "spot",
    }
}

fn list(console: &mut Console, _: &[&str]) -> anyhow::Result<Reply> {
    let scene = console.explorer.scene().ok_or_else(nothing_to_show)?;
    if scene.lights.is_empty() {
        return Ok(Reply::say("the scene has no lights; `add_light` adds one"));
    }
    let mut table = Table::left(&["light", "kind", "strength", "colour", "position", "direction"]);
    for (name, light) in console.explorer.light_names().into_iter().zip(&scene.lights) {
        let strength = match light.kind {
            LightKind::Directional { illuminance_lux, .. } => format!("{illuminance_lux} lux"),
            LightKind::Point { intensity_cd, .. } | LightKind::Spot { intensity_cd, .. } => {
                format!("{intensity_cd} cd")
            }
        };
        let position = if is_sun(light) { "-".to_owned() } else { short(light.position) };
        let has_direction = !matches!(light.kind, LightKind::Point { .. });
        let direction = if has_direction { short(light.direction) } else { "-".to_owned() };
        table.row([
            name,
            kind_name(light).to_owned(),
            strength,
            short(light.color),
            position,
            direction,
        ]);
    }
    Ok(Reply::say(table.text().trim_end()))
}

fn light(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some((name, words)) = arguments.split_first() else { return Ok(Reply::default()) };
    let number = console.explorer.light(name).map_err(|error| Failure::input(error.to_string()))?;
    let light = console.explorer.scene().and_then(|scene| scene.lights.get(number));
    let light = light.ok_or_else(nothing_to_show)?;
    if words.is_empty() {
        let list = properties::list(PROPERTIES, light);
        return Ok(Reply::say(format!("{name}, {}:\n{list}", kind_name(light))));
    }
    let changed = properties::set(PROPERTIES, &format!("the light \"{name}\""), light, words)?;
    console.explorer.edit_lights(|scene| {
        if let Some(light) = scene.lights.get_mut(number) {
            *light = changed;
        }
    });
    Ok(Reply::default())
}

/// A new light of a kind, with the defaults of `add_light`.
pub fn new_light(kind: &str, camera: &lumivox_scene::Camera) -> Light {
    let light = Light { position: camera.position, direction: camera.forward, ..Light::default() };
    match kind {
        "sun" => Light {
            kind: LightKind::Directional {
                illuminance_lux: 100_000.0,
                angular_radius_rad: 0.004_65,
            },
            position: Vec3::ZERO,
            direction: Vec3::NEG_Y,
            ..light
        },
        "spot" => Light {
            kind: LightKind::Spot {
                intensity_cd: 100.0,
                range_m: None,
                inner_angle_rad: 20.0_f32.to_radians(),
                outer_angle_rad: 30.0_f32.to_radians(),
            },
            ..light
        },
        _ => Light {
            kind: LightKind::Point { intensity_cd: 100.0, range_m: None },
            direction: Vec3::NEG_Y,
            ..light
        },
    }
}

fn add(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some((kind, words)) = arguments.split_first() else { return Ok(Reply::default()) };
    let kind = choice(kind, "the kind", &KINDS)?;
    if console.explorer.scene().is_none() {
        return Err(nothing_to_show().into());
    }
    let is_property =
        |word: &str| PROPERTIES.iter().any(|p| p.name == word || p.aliases.contains(&word));
    let (name, words) = match words {
        [name, rest @ ..] if !is_property(name) => (*name, rest),
        _ => (kind, words),
    };
    let names = console.explorer.light_names();
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    let free = [name.to_owned()].into_iter().chain(numbered).find(|name| !names.contains(name));
    let name = free.unwrap_or_default();
    let light = new_light(kind, console.explorer.camera());
    let light = properties::set(PROPERTIES, &format!("the light \"{name}\""), &light, words)?;
    console.explorer.edit_lights(|scene| scene.lights.push(Light { name: name.clone(), ..light }));
    Ok(Reply::say(format!("added the light \"{name}\"")))
}

fn remove(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let name = first(arguments);
    if name == "all" && console.explorer.light(name).is_err() {
        console.explorer.edit_lights(|scene| scene.lights.clear());
        return Ok(Reply::default());
    }
    let number = console.explorer.light(name).map_err(|error| Failure::input(error.to_string()))?;
    console.explorer.edit_lights(|scene| {
        scene.lights.remove(number);
    });
    Ok(Reply::default())
}
