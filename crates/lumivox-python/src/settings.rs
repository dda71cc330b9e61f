//! Settings by name, from the one table that all front ends read.

use glam::UVec2;
use lumivox_explorer::parameters::{
    PARAMETERS, PRESETS, Parameter, Value, find_parameter, find_preset,
};
use lumivox_explorer::suggest;
use lumivox_render::{PresetChoice, RenderError, RenderSettings, View};
use lumivox_scene::Scene;
use pyo3::prelude::*;

use crate::error::Fault;
use crate::scene::unknown;

/// Settings as the package passes them: names, and values as on the command line.
pub type Given = Vec<(String, String)>;

/// The table: each setting's name, group, unit, values, summary and default.
#[pyfunction]
pub fn table() -> Vec<[String; 6]> {
    let row = |row: &Parameter| {
        [
            row.name.to_owned(),
            row.group.name().to_owned(),
            row.unit.to_owned(),
            row.kind.in_words(),
            row.summary.to_owned(),
            row.default(PresetChoice::default()).to_string(),
        ]
    };
    PARAMETERS.iter().map(row).collect()
}

/// The settings of a preset for a scene, with given values.
///
/// # Errors
/// When there is no such setting or preset, a value is not allowed, or two contradict each other.
pub fn of(scene: &Scene, size: UVec2, given: &Given) -> Result<RenderSettings, Fault> {
    let mut preset = PresetChoice::default();
    let mut values: Vec<(&Parameter, Value)> = Vec::new();
    for (name, text) in given {
        if name == "preset" {
            preset = find_preset(text).ok_or_else(|| {
                let known: Vec<&str> = PRESETS.iter().map(|preset| preset.name()).collect();
                let like = suggest::like(text, known.iter().copied());
                let like = like.map(|like| format!("; did you mean \"{like}\"?"));
                let known = known.join(", ");
                Fault::input(format!(
                    "preset is \"{text}\", but must be {known}{}",
                    like.unwrap_or_default()
                ))
            })?;
            continue;
        }
        let Some(parameter) = find_parameter(name) else {
            let known: Vec<&str> = PARAMETERS.iter().flat_map(Parameter::names).collect();
            return Err(unknown("setting", name, &known, "lumivox.settings()"));
        };
        let value = parameter.parse(text).map_err(RenderError::from)?;
        values.push((parameter, value));
    }
    let take = |settings: &mut RenderSettings| -> Result<(), Fault> {
        for (parameter, value) in &values {
            parameter.set(settings, *value).map_err(RenderError::from)?;
        }
        Ok(())
    };
    // A look's cones and exposure depend on resolution and scene.
    let physical = RenderSettings { size, ..RenderSettings::default() };
    let mut settings = physical.clone();
    take(&mut settings)?;
    settings = RenderSettings { resolution: settings.resolution, ..physical };
    settings = settings.with_preset(preset, Some(scene));
    let look = settings.look_name();
    take(&mut settings)?;
    for (parameter, value) in &values {
        let name = parameter.name;
        if let Some(("look", needed)) = parameter.needs
            && needed != look
        {
            return Err(Fault::input(format!(
                "{name} is a setting of the look {needed}; add preset=\"{needed}\""
            )));
        }
        let now = parameter.get(&settings);
        if now != *value && !matches!(value, Value::Number(_)) {
            return Err(Fault::input(format!(
                "{name} is {value}, but another setting asks for {now}; leave one of the two out"
            )));
        }
    }
    Ok(settings)
}

/// All settings that have an effect, with their values.
pub fn texts(settings: &RenderSettings) -> Vec<(&'static str, String)> {
    let rows = PARAMETERS.iter().filter(|row| row.means_something(settings));
    rows.map(|row| (row.name, row.get(settings).to_string())).collect()
}

/// A layer of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// The mean of a view over the frames.
    View(View),
    /// The numbers of visible instances; -1 in the background.
    Instance,
    /// The numbers of their materials; -1 in the background.
    Material,
    /// The motion since the previous picture, in pixels.
    Motion,
}

/// The layers by name, with their channels.
pub const LAYERS: [(&str, Layer, usize); 12] = [
    ("direct", Layer::View(View::Direct), 3),
    ("indirect", Layer::View(View::Indirect), 3),
    ("irradiance", Layer::View(View::Diffuse), 3),
    ("specular", Layer::View(View::Specular), 3),
    ("occlusion", Layer::View(View::Occlusion), 1),
    ("shadow", Layer::View(View::Shadow), 1),
    ("albedo", Layer::View(View::Albedo), 3),
    ("normal", Layer::View(View::Normal), 3),
    ("depth", Layer::View(View::Depth), 1),
    ("instance", Layer::Instance, 1),
    ("material", Layer::Material, 1),
    ("motion", Layer::Motion, 2),
];

/// The layer of a name, and its channels.
///
/// # Errors
/// When there is none.
pub fn layer(name: &str) -> Result<(Layer, usize), Fault> {
    let found = LAYERS.iter().find(|(known, ..)| *known == name);
    found.map(|(_, layer, channels)| (*layer, *channels)).ok_or_else(|| {
        let known: Vec<&str> = LAYERS.iter().map(|(name, ..)| *name).collect();
        unknown("layer", name, &known, "lumivox.LAYERS")
    })
}
