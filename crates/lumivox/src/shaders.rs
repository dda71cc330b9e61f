//! The shader modules of this crate.

use crate::gpu::ShaderLibrary;
use crate::{Directionality, VolumeKind};

/// Modules that belong to no stage.
const MODULES: &[(&str, &str)] = &[
    ("cascades", include_str!("cascades/cascades.wgsl")),
    ("gpu::dispatch", include_str!("gpu/dispatch.wgsl")),
    ("gpu::indirect", include_str!("gpu/indirect.wgsl")),
    ("gpu::random", include_str!("gpu/random.wgsl")),
    ("gpu::scan", include_str!("gpu/scan.wgsl")),
    ("grid", include_str!("grid.wgsl")),
    ("voxels::cells", include_str!("voxels/cells.wgsl")),
    ("voxels::counts", include_str!("voxels/counts.wgsl")),
    ("voxels::inner_lobes", include_str!("voxels/inner_lobes.wgsl")),
    ("voxels::list", include_str!("voxels/list.wgsl")),
    ("voxels::lookup", include_str!("voxels/lookup.wgsl")),
    ("voxels::morton", include_str!("voxels/morton.wgsl")),
    ("voxels::pyramid", include_str!("voxels/pyramid.wgsl")),
    ("voxels::rank", include_str!("voxels/rank.wgsl")),
];

/// All shader modules of this crate but `package::volume`, which [`crate::Gi::shaders`] has as well.
pub fn library() -> ShaderLibrary {
    let mut library = ShaderLibrary::new(MODULES);
    let stages = [
        crate::cones::MODULES,
        crate::emitters::MODULES,
        crate::environment::MODULES,
        crate::light::MODULES,
        crate::points::MODULES,
        crate::temporal::MODULES,
        crate::trace::MODULES,
        crate::voxelize::MODULES,
    ];
    for (path, source) in stages.into_iter().flatten().chain(crate::volume::modules()) {
        library.add(path, *source);
    }
    crate::voxelize::add_constants(&mut library);
    crate::volume::add_constants(&mut library);
    crate::cascades::add_constants(&mut library, None);
    library
        .constant_u32("SCAN_WORKGROUP_SIZE", crate::gpu::SCAN_WORKGROUP_SIZE)
        .constant_u32("SCAN_ITEMS", crate::gpu::SCAN_ITEMS)
        .constant_u32("MAX_WORKGROUPS", crate::gpu::MAX_WORKGROUPS)
        .constant_u32("COUNT_BLOCK_WORDS", crate::voxels::COUNT_BLOCK_WORDS)
        .constant_u32("LIGHT_DIRECTIONAL", crate::light::LIGHT_DIRECTIONAL)
        .constant_u32("LIGHT_POINT", crate::light::LIGHT_POINT)
        .constant_u32("LIGHT_SPOT", crate::light::LIGHT_SPOT)
        .constant_u32("LIGHT_ENVIRONMENT", crate::light::LIGHT_ENVIRONMENT)
        .constant_u32("SHADOW_NONE", crate::light::SHADOW_NONE)
        .constant_u32("SHADOW_MAP", crate::light::SHADOW_MAP)
        .constant_u32("SHADOW_CONE", crate::light::SHADOW_CONE);
    library
}

/// As [`library`], with a kind of volume as `package::volume`: to link or check shaders without a device.
pub fn library_with_volume(kind: VolumeKind, directionality: Directionality) -> ShaderLibrary {
    let mut library = library();
    crate::volume::mount(&mut library, kind, directionality);
    library
}
