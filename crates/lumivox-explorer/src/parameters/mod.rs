//! The one table of settings and the presets, with those of looks.
//!
//! The renderer knows its own settings and presets; each look has more in a crate of its own. Here
//! they become one table for all front ends. The feature `classics` adds the looks of earlier work.

use std::sync::LazyLock;

use lumivox_render::PresetChoice;
use lumivox_render::parameters::PARAMETERS as OF_RENDERER;
pub use lumivox_render::parameters::{
    Choice, Choices, Group, Kind, Parameter, Redoes, Setting, SettingError, Value,
};

/// The table, group by group.
pub static PARAMETERS: LazyLock<Vec<Parameter>> =
    LazyLock::new(|| OF_RENDERER.iter().cloned().chain(of_looks()).collect());

/// The groups of the table, in its order.
pub const GROUPS: &[Group] = &[
    Group::Picture,
    Group::View,
    Group::Overlay,
    Group::Volume,
    Group::Light,
    Group::Cones,
    #[cfg(feature = "classics")]
    lumivox_vxct::GROUP,
];

/// All presets, from the cheapest to the most expensive, then those that are not physical.
pub const PRESETS: &[PresetChoice] = &[
    PresetChoice::PHYSICAL[0],
    PresetChoice::PHYSICAL[1],
    PresetChoice::PHYSICAL[2],
    PresetChoice::PHYSICAL[3],
    #[cfg(feature = "classics")]
    lumivox_vxct::PRESET,
];

/// The setting of a name or an alias.
pub fn find_parameter(name: &str) -> Option<&'static Parameter> {
    PARAMETERS.iter().find(|parameter| parameter.names().any(|known| known == name))
}

/// The preset of a name.
pub fn find_preset(name: &str) -> Option<PresetChoice> {
    PRESETS.iter().copied().find(|preset| preset.name() == name)
}

/// The setting that chooses the look, and the settings of each look.
#[cfg(feature = "classics")]
fn of_looks() -> impl Iterator<Item = Parameter> {
    use std::sync::Arc;

    use lumivox_render::{PHYSICAL, RenderSettings};
    use lumivox_vxct::{CHOICE, GROUP};

    const LOOK: Setting<RenderSettings> = Setting {
        name: "look",
        summary: "How the picture is made; preset vxct also sets what this look needs",
        kind: Kind::Choice(&[
            Choice::new(PHYSICAL, "direct light with shadow maps, and cones that gather radiance"),
            CHOICE,
        ]),
        redoes: Redoes::Frames,
        get: |s| Value::Choice(s.look_name()),
        set: |s, v| {
            s.look = match v {
                Value::Choice(lumivox_vxct::NAME) => Some(Arc::new(lumivox_vxct::settings_of(s))),
                _ => None,
            }
        },
        ..Setting::ROW
    };
    std::iter::once(Parameter::own(GROUP, LOOK)).chain(lumivox_vxct::parameters())
}

#[cfg(not(feature = "classics"))]
fn of_looks() -> impl Iterator<Item = Parameter> {
    std::iter::empty()
}

#[cfg(test)]
mod tests;
