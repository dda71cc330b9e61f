//! The shader modules of this crate, below `package::render`.

use lumivox::gpu::ShaderLibrary;

use crate::{passes, picture, reference, scene};

/// A library's modules and this crate's beside them, as `package::render::...`.
///
/// `base` is the library of the volume in use (`Gi::shaders`): the direct light may march it for
/// shadows, and the voxel view shows it.
#[must_use]
pub fn library(base: &ShaderLibrary) -> ShaderLibrary {
    let mut library = base.clone();
    scene::add_shaders(&mut library);
    passes::add_shaders(&mut library);
    picture::add_shaders(&mut library);
    reference::add_shaders(&mut library);
    library
}
