//! This crate's shader modules, resolved by `build.rs`.

pub(crate) use built::MODULES;

#[allow(clippy::all, clippy::pedantic)]
mod built {
    include!(concat!(env!("OUT_DIR"), "/shaders.rs"));
}

/// The implementation of a slot in the file with that path (`build.rs` lists them).
pub(crate) fn implementation(path: &str) -> &'static lumivox_wgsl::Module {
    let found = built::IMPLEMENTATIONS.iter().find(|(name, _)| *name == path);
    &found.unwrap_or_else(|| panic!("build.rs lists no {path}")).1
}
