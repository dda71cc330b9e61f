//! This crate's shader modules, resolved by `build.rs`.

pub(crate) use built::MODULES;

#[allow(clippy::all, clippy::pedantic)]
mod built {
    include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
}

/// The module in the file at `path` that implements a slot (`build.rs` lists them).
pub(crate) fn implementation(path: &str) -> &'static lumivox_wgsl::Module {
    let found = built::IMPLEMENTATIONS.iter().find(|(name, _)| *name == path);
    &found.unwrap_or_else(|| panic!("build.rs lists no {path}")).1
}
