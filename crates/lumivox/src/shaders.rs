//! The shader modules of this crate.

use crate::gpu::{MODULES, ShaderLibrary};
use crate::{Directionality, VolumeKind};

/// All shader modules of this crate except `package::volume`, which [`crate::Gi::shaders`] adds.
pub fn library() -> ShaderLibrary {
    let mut library = ShaderLibrary::default();
    library.add_built(MODULES);
    crate::gpu::add_constants(&mut library);
    crate::voxelize::add_constants(&mut library);
    crate::voxels::add_constants(&mut library);
    crate::emitters::add_constants(&mut library);
    crate::light::add_constants(&mut library);
    crate::cascades::add_constants(&mut library, None);
    crate::volume::add_constants(&mut library);
    crate::cones::add_constants(&mut library);
    crate::trace::add_constants(&mut library);
    crate::points::add_constants(&mut library);
    crate::temporal::add_constants(&mut library);
    crate::cones::mount(&mut library, false);
    library
}

/// [`library`] plus a kind of volume as `package::volume`, for linking or checking shaders without
/// a device.
pub fn library_with_volume(kind: VolumeKind, directionality: Directionality) -> ShaderLibrary {
    let mut library = library();
    crate::volume::mount(&mut library, kind, directionality);
    library
}
