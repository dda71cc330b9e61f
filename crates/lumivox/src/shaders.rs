//! The shader modules of this crate.

use crate::gpu::ShaderLibrary;
use crate::{Directionality, VolumeKind};

/// The modules, resolved by `build.rs`.
#[allow(clippy::all, clippy::pedantic)]
mod built {
    include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
}

/// All shader modules of this crate except `package::volume`, which [`crate::Gi::shaders`] adds.
pub fn library() -> ShaderLibrary {
    let mut library = ShaderLibrary::default();
    library.add_built(built::MODULES);
    crate::voxelize::add_constants(&mut library);
    crate::volume::add_constants(&mut library);
    crate::cascades::add_constants(&mut library, None);
    crate::cones::mount(&mut library, false);
    library
        .constant_u32("LINEAR_WORKGROUP_SIZE", crate::gpu::LINEAR_WORKGROUP_SIZE)
        .constant_u32("SCAN_WORKGROUP_SIZE", crate::gpu::SCAN_WORKGROUP_SIZE)
        .constant_u32("SCAN_ITEMS", crate::gpu::SCAN_ITEMS)
        .constant_u32("MAX_WORKGROUPS", crate::gpu::MAX_WORKGROUPS)
        .constant_u32("COUNT_BLOCK_WORDS", crate::voxels::COUNT_BLOCK_WORDS)
        .constant_u32("RAY_CLASSES", crate::light::RAY_CLASSES)
        .constant_u32("RAREST_CASCADE", crate::light::RAREST_CASCADE)
        .constant_u32("SAMPLES_EMITTERS", 1)
        .constant_u32("TREE_PASS_LEVELS", crate::emitters::TREE_PASS_LEVELS)
        .constant_u32("LIGHT_DIRECTIONAL", crate::light::LIGHT_DIRECTIONAL)
        .constant_u32("LIGHT_POINT", crate::light::LIGHT_POINT)
        .constant_u32("LIGHT_SPOT", crate::light::LIGHT_SPOT)
        .constant_u32("LIGHT_ENVIRONMENT", crate::light::LIGHT_ENVIRONMENT)
        .constant_u32("SHADOW_NONE", crate::light::SHADOW_NONE)
        .constant_u32("SHADOW_MAP", crate::light::SHADOW_MAP)
        .constant_u32("SHADOW_CONE", crate::light::SHADOW_CONE);
    library
}

/// [`library`] plus a kind of volume as `package::volume`, for linking or checking shaders without
/// a device.
pub fn library_with_volume(kind: VolumeKind, directionality: Directionality) -> ShaderLibrary {
    let mut library = library();
    crate::volume::mount(&mut library, kind, directionality);
    library
}

/// The implementation of a slot in the file with that path (`build.rs` lists them).
pub(crate) fn implementation(path: &str) -> &'static lumivox_wgsl::Module {
    let found = built::IMPLEMENTATIONS.iter().find(|(name, _)| *name == path);
    &found.unwrap_or_else(|| panic!("build.rs lists no {path}")).1
}
