//! The shader modules of this crate, below `package::render`.

use lumivox::gpu::ShaderLibrary;

use crate::{passes, picture, reference, scene};

/// The modules as resolved by `build.rs`.
#[allow(clippy::all, clippy::pedantic)]
mod built {
    include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
}

/// Adds this crate's modules to a library, as `package::render::...`.
///
/// `base` is the library of the current volume (`Gi::shaders`): direct light may march the volume
/// for shadows, and the voxel view shows it.
#[must_use]
pub fn library(base: &ShaderLibrary) -> ShaderLibrary {
    let mut library = base.clone();
    library.add_built(built::MODULES);
    scene::add_constants(&mut library);
    passes::add_constants(&mut library);
    picture::add_constants(&mut library);
    reference::add_constants(&mut library);
    library
}
