//! Renderers from the literature, built on Lumivox's public hooks ([`lumivox::hooks`]): to be
//! compared with it, and as examples of what the hooks can do. Lumivox does not depend on this
//! crate.

pub mod locks;
pub mod photons;
pub mod raster;
pub mod report;

use lumivox::gpu::ShaderLibrary;

/// A library with more modules.
fn with_modules(shaders: &ShaderLibrary, modules: &[(&str, &'static str)]) -> ShaderLibrary {
    let mut shaders = shaders.clone();
    for (path, source) in modules {
        shaders.add(path, *source);
    }
    shaders
}
