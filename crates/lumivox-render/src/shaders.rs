//! The shader modules of this crate, below `package::render`.

use lumivox::gpu::ShaderLibrary;

use crate::{passes, picture, reference, scene};

/// Adds this crate's modules to a library, as `package::render::...`.
///
/// `base` is the library of the present volume (`Gi::shaders`): direct light may march it for
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
