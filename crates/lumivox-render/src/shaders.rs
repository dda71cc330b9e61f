//! The shader modules of this crate, below `package::render`.

use lumivox::gpu::ShaderLibrary;

use crate::settings::{ToneMap, View};

/// Every module by its path below `render`.
const MODULES: &[(&str, &str)] = &[
    ("accumulate", include_str!("accumulate.wgsl")),
    ("composite", include_str!("composite.wgsl")),
    ("direct", include_str!("direct.wgsl")),
    ("draws", include_str!("upload/draws.wgsl")),
    ("gbuffer_pass", include_str!("gbuffer_pass.wgsl")),
    ("layers", include_str!("layers.wgsl")),
    ("material", include_str!("upload/material.wgsl")),
    ("point", include_str!("point.wgsl")),
    ("screen_door", include_str!("screen_door.wgsl")),
    ("shadow_maps", include_str!("shadow_maps.wgsl")),
    ("tone_map", include_str!("tone_map.wgsl")),
    ("voxel_view", include_str!("voxel_view.wgsl")),
];

/// A library's modules and this crate's beside them, as `package::render::...`.
///
/// `base` is the library of the volume in use (`Gi::shaders`): the direct light may march it for
/// shadows, and the voxel view shows it.
#[must_use]
pub fn library(base: &ShaderLibrary) -> ShaderLibrary {
    let mut library = base.clone();
    for (path, source) in MODULES {
        library.add(&format!("render::{path}"), *source);
    }
    for view in View::ALL {
        library.constant_u32(view.constant(), view as u32);
    }
    for tone_map in ToneMap::ALL {
        library.constant_u32(tone_map.constant(), tone_map as u32);
    }
    library
        .constant_u32("ENCODE_COLOR", crate::tone_map::ENCODE_COLOR)
        .constant_u32("ENCODE_DATA", crate::tone_map::ENCODE_DATA)
        .constant_u32("ENCODE_HEAT", crate::tone_map::ENCODE_HEAT);
    library
}
