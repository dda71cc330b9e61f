//! The classics in the renderer: settings, pictures, and freed resources.

#[allow(dead_code, unused_imports)] // The renderer's own tests use the rest.
#[path = "../../../lumivox-render/tests/it/common/mod.rs"]
mod common;
mod hooks;
mod photons;
