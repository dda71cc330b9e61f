//! The table.

use lumivox::{
    Directionality, Duplication, MAX_RESOLUTION, Mipmapping, OctreeBuilder, OctreeOptions,
    TraceResolution, VolumeKind,
};

use super::names::{Named, octree};
use super::{Group, Kind, Parameter, Value, vxct};
use crate::classics::{
    INJECTIONS, VOXELIZERS, injection, injection_name, voxelizer, voxelizer_name,
};
use crate::{Exposure, ShadowMethod, ToneMap, View, Wireframe, Wires};

/// The word for a reach or a memory without end.
const UNLIMITED: &str = "unlimited";
/// The word for an exposure that is found from the picture.
const AUTO: &str = "auto";

/// A parameter.
macro_rules! parameter {
    ($name:literal, $group:ident, $unit:literal, $summary:literal, $kind:expr, $get:expr, $set:expr $(,)?) => {
        Parameter {
            name: $name,
            group: Group::$group,
            unit: $unit,
            summary: $summary,
            kind: $kind,
            get: $get,
            set: $set,
        }
    };
}

/// A setting that is on or off.
macro_rules! switch {
    ($name:literal, $group:ident, $summary:literal, $($field:ident).+) => {
        parameter!($name, $group, "", $summary, Kind::Switch, |s| Value::Switch(s.$($field).+), |s, v| {
            if let Value::Switch(on) = v {
                s.$($field).+ = on;
            }
        })
    };
}

/// A whole number.
macro_rules! whole {
    ($name:literal, $group:ident, $unit:literal, $summary:literal, $kind:expr, $($field:ident).+) => {
        parameter!($name, $group, $unit, $summary, $kind, |s| Value::Whole(s.$($field).+), |s, v| {
            if let Value::Whole(number) = v {
                s.$($field).+ = number;
            }
        })
    };
}

/// A number.
macro_rules! number {
    ($name:literal, $group:ident, $unit:literal, $summary:literal, $kind:expr, $($field:ident).+) => {
        parameter!($name, $group, $unit, $summary, $kind, |s| Value::Number(s.$($field).+), |s, v| {
            if let Value::Number(number) = v {
                s.$($field).+ = number;
            }
        })
    };
}

/// One of a few names.
macro_rules! choice {
    ($name:literal, $group:ident, $summary:literal, $names:expr, $kind:ty, $($field:ident).+) => {
        parameter!(
            $name, $group, "", $summary, Kind::Choice($names),
            |s| Value::Choice(<$kind as Named>::name(s.$($field).+)),
            |s, v| {
                if let Value::Choice(name) = v
                    && let Some(value) = <$kind as Named>::named(name)
                {
                    s.$($field).+ = value;
                }
            }
        )
    };
}

/// An option of the octree, which asks for one.
macro_rules! octree_option {
    ($name:literal, $summary:literal, $names:expr, $kind:ty, $field:ident) => {
        parameter!(
            $name,
            Volume,
            "",
            $summary,
            Kind::Choice($names),
            |s| Value::Choice(<$kind as Named>::name(octree(s).$field)),
            |s, v| {
                if let Value::Choice(name) = v
                    && let Some($field) = <$kind as Named>::named(name)
                {
                    s.volume = VolumeKind::Octree(OctreeOptions { $field, ..octree(s) });
                }
            }
        )
    };
}

/// All parameters, group by group.
pub static PARAMETERS: &[Parameter] = &{
    let mut all = [OWN[0]; OWN.len() + vxct::PARAMETERS.len()];
    let mut index = 0;
    while index < all.len() {
        all[index] =
            if index < OWN.len() { OWN[index] } else { vxct::PARAMETERS[index - OWN.len()] };
        index += 1;
    }
    all
};

/// All but those of VXCT's look.
const OWN: &[Parameter] = &[
    whole!("frames", Picture, "frames", "Frames that are averaged", Kind::whole(1, 65_536), frames),
    parameter!(
        "exposure",
        Picture,
        "stops",
        "Radiance in cd/m2 times 2 to this power is shown; auto makes the average a middle grey",
        Kind::Number { low: -64.0, high: 64.0, word: Some(AUTO), off: None },
        |s| match s.exposure {
            Exposure::Auto => Value::Word(AUTO),
            Exposure::Stops(stops) => Value::Number(stops),
        },
        |s, v| match v {
            Value::Number(stops) => s.exposure = Exposure::Stops(stops),
            _ => s.exposure = Exposure::Auto,
        },
    ),
    parameter!(
        "tone_map",
        Picture,
        "",
        "Curve from radiance to the screen's range",
        Kind::Choice(&TONE_MAPS),
        |s| Value::Choice(s.tone_map.name()),
        |s, v| s.tone_map = by_name(&ToneMap::ALL, ToneMap::name, v, s.tone_map),
    ),
    parameter!(
        "view",
        View,
        "",
        "What the picture shows",
        Kind::Choice(&VIEWS),
        |s| Value::Choice(s.view.name()),
        |s, v| s.view = by_name(&View::ALL, View::name, v, s.view),
    ),
    whole!(
        "level",
        View,
        "",
        "Level of the voxels that are shown; 0 is the finest",
        Kind::whole(0, MAX_RESOLUTION.ilog2()),
        voxel_level
    ),
    choice!(
        "wireframe",
        Overlay,
        "Edges of triangles over the picture: those that are visible, or all through surfaces",
        &["off", "over", "through"],
        Wireframe,
        overlay.wireframe
    ),
    choice!(
        "wire_voxels",
        Overlay,
        "Voxels as wire cubes over the picture: those that are visible, or all through surfaces",
        &["off", "over", "through"],
        Wires,
        overlay.wire_voxels
    ),
    switch!("show_grid", Overlay, "The box that the voxels lie in", overlay.grid_box),
    switch!(
        "hide_surfaces",
        Overlay,
        "A plain background instead of the picture under the overlay",
        overlay.hides_surfaces
    ),
    whole!(
        "resolution",
        Volume,
        "voxels",
        "Voxels along the longest axis",
        Kind::Whole { low: 16, high: MAX_RESOLUTION, multiple: 8 },
        resolution
    ),
    parameter!(
        "grid_offset",
        Volume,
        "voxels",
        "Shift of the grid against the scene",
        Kind::Vector { low: 0.0, below: 1.0 },
        |s| Value::Vector(s.grid_offset),
        |s, v| {
            if let Value::Vector(offset) = v {
                s.grid_offset = offset;
            }
        },
    ),
    choice!(
        "directionality",
        Volume,
        "A radiance for each of six directions, or one a voxel",
        &["six_lobes", "isotropic"],
        Directionality,
        directionality
    ),
    parameter!(
        "volume",
        Volume,
        "",
        "Where the voxels' light is stored",
        Kind::Choice(&["dense", "octree"]),
        |s| Value::Choice(if s.volume == VolumeKind::Dense { "dense" } else { "octree" }),
        |s, v| {
            s.volume = match v {
                Value::Choice("octree") => VolumeKind::Octree(octree(s)),
                _ => VolumeKind::Dense,
            }
        },
    ),
    octree_option!(
        "octree_builder",
        "How an octree's nodes come into being; asks for an octree",
        &["ranks", "locks"],
        OctreeBuilder,
        builder
    ),
    octree_option!(
        "octree_duplication",
        "How bricks find their neighbours' texels; asks for an octree",
        &["ranks", "pointers", "search"],
        Duplication,
        duplication
    ),
    octree_option!(
        "octree_mipmaps",
        "Over which cells coarser levels are filtered; asks for an octree",
        &["occupied", "every"],
        Mipmapping,
        mipmapping
    ),
    parameter!(
        "volume_memory",
        Volume,
        "MiB",
        "The most memory that the volume may take",
        Kind::Number { low: 1.0, high: 1_048_576.0, word: Some(UNLIMITED), off: None },
        |s| match s.volume_memory {
            None => Value::Word(UNLIMITED),
            Some(bytes) => Value::Number(bytes as f32 / MIB),
        },
        |s, v| match v {
            Value::Number(mib) => s.volume_memory = Some((mib * MIB) as u64),
            _ => s.volume_memory = None,
        },
    ),
    parameter!(
        "voxelizer",
        Volume,
        "",
        "How triangles become voxels",
        Kind::Choice(&VOXELIZERS),
        |s| Value::Choice(voxelizer_name(&s.voxelizer)),
        |s, v| {
            if let Value::Choice(name) = v {
                s.voxelizer = voxelizer(name);
            }
        },
    ),
    parameter!(
        "injection",
        Light,
        "",
        "How light comes into the voxels",
        Kind::Choice(&INJECTIONS),
        |s| Value::Choice(injection_name(&s.injection)),
        |s, v| {
            if let Value::Choice(name) = v {
                s.injection = injection(name);
            }
        },
    ),
    whole!(
        "bounces",
        Light,
        "",
        "Reflections of indirect light, the one at the visible surface included",
        Kind::whole(0, 16),
        bounces
    ),
    choice!("shadows", Light, "How shadows are found", &["map", "cone"], ShadowMethod, shadows),
    whole!(
        "shadow_resolution",
        Light,
        "texels",
        "Edge of a shadow map",
        Kind::whole(16, 16_384),
        shadow_resolution
    ),
    parameter!(
        "cones",
        Cones,
        "",
        "Diffuse cones a pixel and frame",
        Kind::Choice(&["6", "9", "12"]),
        |s| Value::Choice(match s.trace.diffuse_cones {
            12 => "12",
            9 => "9",
            _ => "6",
        }),
        |s, v| {
            if let Value::Choice(name) = v {
                s.trace.diffuse_cones = name.parse().unwrap_or(s.trace.diffuse_cones);
            }
        },
    ),
    choice!(
        "trace_resolution",
        Cones,
        "Cones from every pixel, or from one of each 2x2 block",
        &["full", "half"],
        TraceResolution,
        trace.resolution
    ),
    number!(
        "voxel_per_diameter",
        Cones,
        "share",
        "Sampled voxel's edge as a share of the cone's diameter",
        Kind::number(0.05, 1.0),
        trace.voxel_per_diameter
    ),
    number!(
        "clearance",
        Cones,
        "ratio",
        "Growth of the sampled voxels by metre and cosine, at most; 0 is off",
        Kind::Number { low: 0.1, high: 1.0, word: None, off: Some(0.0) },
        trace.clearance
    ),
    number!(
        "normal_offset",
        Cones,
        "voxels",
        "Start of the cones above the surface",
        Kind::number(0.0, 4.0),
        trace.normal_offset_voxels
    ),
    number!(
        "step",
        Cones,
        "share",
        "Distance between samples as a share of the sampled voxel's edge",
        Kind::number(0.25, 1.0),
        trace.step_per_voxel
    ),
    number!(
        "min_transmittance",
        Cones,
        "share",
        "Share of light below which a cone ends",
        Kind::number(0.0, 0.25),
        trace.min_transmittance
    ),
    switch!("specular", Cones, "Glossy reflections of indirect light", trace.specular),
    number!(
        "specular_share",
        Cones,
        "share",
        "Width of a glossy cone as a share of the lobe's solid angle",
        Kind::number(0.02, 1.0),
        trace.specular_share
    ),
    parameter!(
        "occlusion_distance",
        Cones,
        "m",
        "Reach of ambient occlusion; it never changes the light",
        Kind::Number { low: 0.0, high: 1e9, word: Some(UNLIMITED), off: None },
        |s| {
            let reach_m = s.trace.occlusion_distance_m;
            if reach_m.is_finite() { Value::Number(reach_m) } else { Value::Word(UNLIMITED) }
        },
        |s, v| match v {
            Value::Number(reach_m) => s.trace.occlusion_distance_m = reach_m,
            _ => s.trace.occlusion_distance_m = f32::INFINITY,
        },
    ),
    switch!(
        "jitter",
        Cones,
        "Draw the cones' directions at random, in each frame others",
        trace.jitter
    ),
    switch!(
        "clear_of_walls",
        Cones,
        "Start cones farther where a wall is felt at their start",
        trace.clear_of_walls
    ),
    number!(
        "width_attenuation",
        Cones,
        "",
        "What radiance loses for the cone's width; 0 is the physics",
        Kind::number(0.0, 64.0),
        trace.width_attenuation
    ),
    number!(
        "level_gain",
        Cones,
        "factor",
        "What radiance gains with each level; 1 is the physics",
        Kind::number(1.0, 8.0),
        trace.level_gain
    ),
];

const MIB: f32 = 1_048_576.0;

/// The names of all values of a type.
macro_rules! names {
    ($kind:ty) => {{
        let mut names = [""; <$kind>::ALL.len()];
        let mut index = 0;
        while index < names.len() {
            names[index] = <$kind>::ALL[index].name();
            index += 1;
        }
        names
    }};
}

const VIEWS: [&str; View::ALL.len()] = names!(View);
const TONE_MAPS: [&str; ToneMap::ALL.len()] = names!(ToneMap);

fn by_name<T: Copy>(all: &[T], name: fn(T) -> &'static str, value: Value, otherwise: T) -> T {
    let Value::Choice(wanted) = value else { return otherwise };
    all.iter().copied().find(|known| name(*known) == wanted).unwrap_or(otherwise)
}
