//! The parameters of VXCT's look, under the names of its console. Each but `look` asks for that look.

use super::names::vxct;
use super::{Group, Kind, Parameter, Value};
use crate::{Look, RenderSettings, VxctSettings};

/// Sets something of the look, and takes it.
fn set(settings: &mut RenderSettings, change: impl FnOnce(&mut VxctSettings)) {
    let mut look = vxct(settings);
    change(&mut look);
    settings.look = Look::Vxct(look);
}

const fn parameter(
    name: &'static str,
    unit: &'static str,
    summary: &'static str,
    kind: Kind,
    get: fn(&RenderSettings) -> Value,
    set: fn(&mut RenderSettings, Value),
) -> Parameter {
    Parameter { name, group: Group::Vxct, unit, summary, kind, get, set }
}

/// Something that is on or off.
macro_rules! switch {
    ($name:literal, $summary:literal, $($field:ident).+) => {
        parameter($name, "", $summary, Kind::Switch, |s| Value::Switch(vxct(s).$($field).+), |s, v| {
            if let Value::Switch(on) = v {
                set(s, |look| look.$($field).+ = on);
            }
        })
    };
}

/// A number.
macro_rules! number {
    ($name:literal, $unit:literal, $summary:literal, $low:literal, $high:literal, $($field:ident).+) => {
        parameter(
            $name, $unit, $summary, Kind::number($low, $high),
            |s| Value::Number(vxct(s).$($field).+),
            |s, v| {
                if let Value::Number(number) = v {
                    set(s, |look| look.$($field).+ = number);
                }
            }
        )
    };
}

/// The parameters.
pub(super) const PARAMETERS: [Parameter; 24] = [
    parameter(
        "look",
        "",
        "How the picture comes about; preset vxct takes what goes with that look besides",
        Kind::Choice(&["physical", "vxct"]),
        |s| Value::Choice(if s.look == Look::Physical { "physical" } else { "vxct" }),
        |s, v| match v {
            Value::Choice("vxct") => s.look = Look::Vxct(vxct(s)),
            _ => s.look = Look::Physical,
        },
    ),
    switch!(
        "indirect_light",
        "Cones; without them Phong's shader shows all of its terms, and no shadows",
        indirect_light
    ),
    switch!("phong", "Phong's terms", phong),
    switch!("phong_ambient", "Phong's ambient term", phong_ambient),
    switch!("phong_diffuse", "Phong's diffuse term", phong_diffuse),
    switch!("phong_specular", "Phong's highlights", phong_specular),
    switch!("vox_diffuse", "Light by diffuse cones", diffuse),
    switch!("vox_specular", "Reflections by specular cones", specular),
    switch!("vox_shadows", "Shadows by cones towards the lights", shadows),
    switch!("front_cone", "The diffuse cone along the normal", front_cone),
    switch!("side_cones", "Four diffuse cones along the surface", side_cones),
    switch!(
        "intermediate_cones",
        "Four diffuse cones half-way between normal and sides",
        intermediate_cones
    ),
    number!(
        "diffuse_aperture",
        "rad",
        "Angle of diffuse cones",
        0.001,
        2.0,
        diffuse_cone.aperture_rad
    ),
    number!(
        "occlusion_aperture",
        "rad",
        "Angle of shadow cones",
        0.001,
        2.0,
        occlusion_cone.aperture_rad
    ),
    number!(
        "specular_aperture",
        "rad",
        "Angle of specular cones",
        0.001,
        2.0,
        specular_cone.aperture_rad
    ),
    number!(
        "diffuse_offset",
        "half edges",
        "Start of diffuse cones",
        0.0,
        4.0,
        diffuse_cone.offset
    ),
    number!(
        "occlusion_offset",
        "half edges",
        "Start of shadow cones",
        0.0,
        4.0,
        occlusion_cone.offset
    ),
    number!(
        "specular_offset",
        "half edges",
        "Start of specular cones",
        0.0,
        4.0,
        specular_cone.offset
    ),
    number!(
        "diffuse_dist_factor",
        "diameters",
        "Step of diffuse cones",
        0.001,
        4.0,
        diffuse_cone.distance_factor
    ),
    number!(
        "occlusion_dist_factor",
        "diameters",
        "Step of shadow cones",
        0.001,
        4.0,
        occlusion_cone.distance_factor
    ),
    number!(
        "specular_dist_factor",
        "diameters",
        "Step of specular cones",
        0.001,
        4.0,
        specular_cone.distance_factor
    ),
    number!(
        "diffuse_origin_offset",
        "half edges",
        "Start of diffuse cones above the surface",
        0.0,
        1.0,
        diffuse_origin_offset
    ),
    number!(
        "shadow_str",
        "",
        "How fast what is in the way of light becomes a full shadow",
        0.0,
        16.0,
        shadow_strength
    ),
    number!(
        "shininess_falloff",
        "",
        "How fast reflections fade where a light stands off the mirrored direction",
        0.0,
        16.0,
        shininess_falloff
    ),
];
