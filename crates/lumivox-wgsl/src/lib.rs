//! WGSL in modules: imports are resolved when a crate is built, and shaders are joined as text.
//!
//! A module is a WGSL file that starts with imports:
//!
//! ```wgsl
//! import package::grid::{grid, grid_from_world};
//! ```
//!
//! [`parse`] splits a module into its declarations and gives each a name that is unique in every
//! program: `gather` of `package::cones::gather` becomes `cones_gather_gather`. Parsing needs no
//! other module. So a build script parses a crate's modules once ([`build_modules`]), and at run
//! time [`ShaderLibrary::link`] only collects the declarations that a shader's entry points reach,
//! and joins their text. Only modules added at run time are parsed then. Entry points keep their
//! names.
//!
//! Some modules are *slots*: their paths have several implementations, of which a library holds
//! one, under the slot's path. A slot's interface is the set of names that other modules import
//! from it. Constants from Rust are the module `package::constants`.

mod build;
mod library;
mod module;
mod tokens;

#[cfg(test)]
mod tests;

pub use build::{Slot, build_modules};
pub use library::{LinkedShader, ShaderError, ShaderLibrary};
pub use module::{Declaration, EntryPoint, Module, ParseError, Use, parse};
