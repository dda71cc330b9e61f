//! Commands for the surroundings: skies, panoramas, uniform light.

use std::sync::Arc;

use glam::Vec3;
use lumivox_scene::sky::{Sky, SkySettings, sky as make_sky};
use lumivox_scene::{Environment, EnvironmentMap};

use crate::arguments::{angle, commas, degrees, number, refused, vector};
use crate::command::Run::{Now, Waits};
use crate::command::{Command, Edits, Group, PLAIN, Takes};
use crate::line::quote;
use crate::values::light::{self, Surroundings};
use crate::{Console, Reply, nothing_to_show, shown};

const LIGHT: Command = Command { group: Group::Light, takes: &[Takes::Anything], ..PLAIN };

pub const TABLE: &[Command] = &[
    Command {
        name: "sky",
        usage: "ELEVATION,AZIMUTH|X,Y,Z [TURBIDITY]",
        count: (1, 2),
        summary: "Put a clear sky and its sun around the scene",
        details: "The sun's position: degrees above the horizon and from -z towards +x, or a vector. The turbidity is from 1 \
                  (the clearest) to 10, by default 2. The sky is in cd/m2 and lux. Its sun takes the place of all \
                  directional lights.",
        example: "sky 30,120",
        sets: Some(1),
        edits: Edits::Look,
        run: Now(sky),
        ..LIGHT
    },
    Command {
        name: "environment",
        usage: "[R,G,B|FILE]",
        count: (0, 1),
        takes: &[Takes::File],
        summary: "Surround the scene with uniform light or a panorama, or print the surroundings",
        details: "R,G,B in cd/m2, from 0 to 1e10; a panorama is an .hdr or .exr file (or .png or .jpg).",
        example: "environment 2000,2600,3600",
        sets: Some(1),
        edits: Edits::Look,
        run: Waits(|console, arguments| Box::pin(environment(console, arguments))),
        ..LIGHT
    },
    Command {
        name: "environment_intensity",
        usage: "[FACTOR|R,G,B]",
        count: (0, 1),
        summary: "Set the factor of a panorama or a sky, or the radiance of uniform light, or print it",
        details: "One number, or three for R G B, from 0 to 1e10.",
        example: "environment_intensity 0.5",
        run: Now(intensity),
        ..LIGHT
    },
    Command {
        name: "environment_rotation",
        usage: "[DEGREES]",
        count: (0, 1),
        summary: "Set the panorama's rotation about the vertical, counter-clockwise seen from above, or print it",
        details: "From -360 to 360 degrees. The sun of a sky does not turn with it.",
        example: "environment_rotation 90",
        sets: Some(1),
        edits: Edits::Look,
        run: Now(rotation),
        ..LIGHT
    },
];

fn sky(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if console.explorer.scene().is_none() {
        return Err(nothing_to_show().into());
    }
    let text = arguments.first().copied().unwrap_or_default();
    let sun_direction = light::sky(text).map_err(refused("sky", text))?;
    let turbidity = arguments.get(1).map(|text| number(text, "the turbidity", 1.0..=10.0));
    let turbidity = turbidity.transpose()?.unwrap_or(SkySettings::default().turbidity);
    let settings = SkySettings { sun_direction, turbidity, ..SkySettings::default() };
    let made = make_sky(&settings)?;
    let mut replaced = Vec::new();
    console.explorer.edit_lights(|scene| {
        replaced = made.surround(&mut scene.environment, &mut scene.lights);
    });
    tell_replaced(&replaced);
    let map = console.explorer.scene().and_then(|scene| scene.environment.map.clone());
    if let Some(map) = map {
        console.remember_map(&map, format!("sky {} {turbidity}", commas(sun_direction)));
    }
    Ok(Reply::default())
}

/// Warns of the directional lights that a sky has replaced.
pub fn tell_replaced(names: &[String]) {
    for name in names {
        tracing::warn!(
            "the directional light '{}' is gone: the sky has a sun of its own",
            shown::line(name)
        );
    }
}

async fn environment(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let scene = console.explorer.scene().ok_or_else(nothing_to_show)?;
    let Some(text) = arguments.first() else {
        let Environment { radiance, map, rotation_rad } = &scene.environment;
        return Ok(Reply::say(match map {
            None => format!("environment {} cd/m2", commas(*radiance)),
            Some(map) => {
                let turn = degrees(*rotation_rad);
                format!(
                    "environment \"{}\", times {}, turned by {turn} degrees",
                    shown::line(&map.name),
                    commas(*radiance)
                )
            }
        }));
    };
    let environment = match light::environment(text).map_err(refused("environment", text))? {
        Surroundings::Uniform(radiance) => Environment { radiance, ..Environment::default() },
        Surroundings::File(file) => panorama(console, &file.to_string_lossy()).await?,
    };
    console.explorer.edit_lights(|scene| {
        scene.environment = environment;
        scene.lights.retain(|light| light.name != Sky::SUN);
    });
    Ok(Reply::default())
}

async fn panorama(console: &mut Console, file: &str) -> anyhow::Result<Environment> {
    let bytes = console.outside.read(file).await?;
    let mut map = EnvironmentMap::from_memory(file, &bytes)?;
    for warning in std::mem::take(&mut map.warnings) {
        tracing::warn!("{file}: {warning}");
    }
    let map = Arc::new(map);
    console.remember_map(&map, format!("environment {}", quote(file)));
    Ok(map.into())
}

fn intensity(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let scene = console.explorer.scene().ok_or_else(nothing_to_show)?;
    let Some(text) = arguments.first() else {
        let radiance = commas(scene.environment.radiance);
        return Ok(Reply::say(format!("environment_intensity {radiance}")));
    };
    let what = "the intensity";
    let radiance = if text.contains(',') {
        vector(&[text], what, 0.0..=1e10)?
    } else {
        Vec3::splat(number(text, what, 0.0..=1e10)?)
    };
    console.explorer.edit_lights(|scene| scene.environment.radiance = radiance);
    Ok(Reply::default())
}

fn rotation(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let scene = console.explorer.scene().ok_or_else(nothing_to_show)?;
    let Some(text) = arguments.first() else {
        let turn = degrees(scene.environment.rotation_rad);
        return Ok(Reply::say(format!("environment_rotation {turn}")));
    };
    let turn = angle(text, "the turn", -360.0..=360.0)?;
    console.explorer.edit_lights(|scene| scene.environment.rotation_rad = turn);
    Ok(Reply::default())
}
