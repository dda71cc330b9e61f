//! The shader modules of this crate, below `package::render`.

use lumivox::gpu::ShaderLibrary;

use crate::settings::{ToneMap, View};
use crate::{overlay, reference, voxel_view, vxct};

/// Those that belong to no folder with a list of its own.
const MODULES: &[(&str, &str)] = &[
    ("accumulate", include_str!("accumulate.wgsl")),
    ("composite", include_str!("composite.wgsl")),
    ("direct", include_str!("direct.wgsl")),
    ("draws", include_str!("upload/draws.wgsl")),
    ("gbuffer_pass", include_str!("gbuffer_pass.wgsl")),
    ("layer_textures", include_str!("layer_textures.wgsl")),
    ("layers", include_str!("layers.wgsl")),
    ("material", include_str!("upload/material.wgsl")),
    ("normals", include_str!("normals.wgsl")),
    ("point", include_str!("point.wgsl")),
    ("reference::intersect", include_str!("reference/intersect.wgsl")),
    ("reference::panorama", include_str!("reference/panorama.wgsl")),
    ("reference::path", include_str!("reference/path.wgsl")),
    ("reference::random", include_str!("reference/random.wgsl")),
    ("reference::scatter", include_str!("reference/scatter.wgsl")),
    ("reference::sources", include_str!("reference/sources.wgsl")),
    ("reference::surface", include_str!("reference/surface.wgsl")),
    ("reference::texels", include_str!("reference/texels.wgsl")),
    ("reference::transmittance", include_str!("reference/transmittance.wgsl")),
    ("reference::world", include_str!("reference/world.wgsl")),
    ("screen_door", include_str!("screen_door.wgsl")),
    ("shadow_maps", include_str!("shadow_maps.wgsl")),
    ("tone_map", include_str!("tone_map.wgsl")),
];

/// Every module of this crate by its path below `render`.
pub(crate) fn own_modules() -> impl Iterator<Item = &'static (&'static str, &'static str)> {
    MODULES.iter().chain(voxel_view::MODULES).chain(overlay::MODULES).chain(vxct::MODULES)
}

/// A library's modules and this crate's beside them, as `package::render::...`.
///
/// `base` is the library of the volume in use (`Gi::shaders`): the direct light may march it for
/// shadows, and the voxel view shows it.
#[must_use]
pub fn library(base: &ShaderLibrary) -> ShaderLibrary {
    let mut library = base.clone();
    for (path, source) in own_modules() {
        library.add(&format!("render::{path}"), *source);
    }
    for view in View::ALL {
        library.constant_u32(view.constant(), view as u32);
    }
    for tone_map in ToneMap::ALL {
        library.constant_u32(tone_map.constant(), tone_map as u32);
    }
    for (name, value) in vxct::CONSTANTS {
        library.constant_u32(name, value);
    }
    library
        .constant_u32("ENCODE_COLOR", crate::tone_map::ENCODE_COLOR)
        .constant_u32("ENCODE_DATA", crate::tone_map::ENCODE_DATA)
        .constant_u32("ENCODE_HEAT", crate::tone_map::ENCODE_HEAT)
        .constant_u32("REFERENCE_BATCH", reference::BATCH)
        .constant_u32("TILE_CLAMP", reference::TILE_CLAMP)
        .constant_u32("TILE_MIRROR", reference::TILE_MIRROR)
        .constant_u32("TILE_NEAREST", reference::TILE_NEAREST)
        .constant_u32("TILE_COLOR", reference::TILE_COLOR)
        .constant_u32("TILE_PRESENT", reference::TILE_PRESENT);
    reference::Features::ALL.set(&mut library);
    library
}
