//! The settings of a rendering: read from the command line, and reported under their names.

use glam::UVec2;
use lumivox_console::Failure;
use lumivox_explorer::parameters::{PARAMETERS, Parameter, Value};
use lumivox_render::{PresetChoice, RenderSettings};
use lumivox_scene::Scene;
use serde::{Serialize as _, Serializer};
use serde_json::{Map, json};

use crate::args::settings::{Given, SettingArgs, VolumeGroups};

/// The settings of a preset for a picture of this size, with the values of a command line.
///
/// # Errors
/// When two of them contradict each other.
pub fn of(preset: PresetChoice, size: UVec2, given: &[Given]) -> Result<RenderSettings, Failure> {
    let take = |settings: &mut RenderSettings| {
        for (parameter, value) in given {
            // Values of the command line were checked when they were read.
            let _ = parameter.set(settings, *value);
        }
    };
    let physical = RenderSettings { size, ..RenderSettings::default() };
    // Set the resolution first: a look's cones may depend on it.
    let mut settings = physical.clone();
    take(&mut settings);
    settings = RenderSettings { resolution: settings.resolution, ..physical };
    settings = settings.with_preset(preset, None);
    let look = settings.look_name();
    take(&mut settings);
    let option = |parameter: &Parameter| match parameter.needs {
        Some(("look", look)) => format!("--{look} {}", parameter.name),
        _ => format!("--{}", parameter.name.replace('_', "-")),
    };
    for (parameter, value) in given {
        if let Some(("look", needed)) = parameter.needs
            && needed != look
        {
            let option = option(parameter);
            return Err(Failure::input(format!(
                "{option}: it is a setting of the look {needed}; add --preset {needed}"
            )));
        }
        if parameter.get(&settings) != *value && !is_rounded(*value) {
            let now = parameter.get(&settings);
            let option = option(parameter);
            return Err(Failure::input(format!(
                "{option} {value}: another option asks for {} {now}; leave one of the two out",
                parameter.name
            )));
        }
    }
    Ok(settings)
}

/// The settings of the default preset with the voxel settings of a command line.
///
/// # Errors
/// When two of them contradict each other.
pub fn of_voxels(args: &SettingArgs<VolumeGroups>) -> Result<RenderSettings, Failure> {
    of(PresetChoice::default(), RenderSettings::default().size, args.given())
}

/// Whether storing a value may round it.
fn is_rounded(value: Value) -> bool {
    matches!(value, Value::Number(_))
}

/// Whether the command line gives this setting.
pub fn gives(given: &[Given], name: &str) -> bool {
    given.iter().any(|(parameter, _)| parameter.name == name)
}

/// Sets the exposure and curve that a look has for the scene, unless the command line gives them.
pub fn expose_for_look(settings: &mut RenderSettings, given: &[Given], scene: &Scene) {
    let Some((exposure, tone_map)) = settings.look.as_ref().map(|look| look.display(Some(scene)))
    else {
        return;
    };
    if !gives(given, "exposure") {
        settings.exposure = exposure;
    }
    if !gives(given, "tone_map") {
        settings.tone_map = tone_map;
    }
}

/// All settings that have an effect, under their names: numbers, booleans, and texts for choices
/// and words.
pub fn report(settings: &RenderSettings) -> Map<String, serde_json::Value> {
    let rows = PARAMETERS.iter().filter(|parameter| parameter.means_something(settings));
    rows.map(|row| (row.name.to_owned(), json_of(row.get(settings)))).collect()
}

/// Serializes the settings that have an effect, under their names.
///
/// # Errors
/// The errors of the writer `to`.
pub fn serialize<S: Serializer>(settings: &RenderSettings, to: S) -> Result<S::Ok, S::Error> {
    report(settings).serialize(to)
}

fn json_of(value: Value) -> serde_json::Value {
    match value {
        Value::Switch(on) => json!(on),
        Value::Whole(number) => json!(number),
        Value::Number(number) => json!(number),
        Value::Vector(vector) => json!(vector.to_array()),
        Value::Word(name) | Value::Choice(name) => json!(name),
    }
}
