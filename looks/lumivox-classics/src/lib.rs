//! Renderers from the literature, built on Lumivox's public hooks ([`lumivox::hooks`]), for
//! comparison and as examples of the hooks. Lumivox does not depend on this crate.

pub mod locks;
pub mod photons;
pub mod raster;
pub mod report;

use lumivox::gpu::ShaderLibrary;

/// A copy of the library with more modules.
fn with_modules(shaders: &ShaderLibrary, modules: &[(&str, &'static str)]) -> ShaderLibrary {
    let mut shaders = shaders.clone();
    for (path, source) in modules {
        shaders.add(path, *source);
    }
    shaders
}
