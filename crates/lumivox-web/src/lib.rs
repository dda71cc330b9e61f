//! Lumivox in the browser: the same library and renderer, compiled to WebAssembly, on WebGPU.
//!
//! The API for JavaScript is in `renderer.rs`: a class that shows a scene on a canvas, in windows
//! and in workers. This project's page (`page/`) runs it in a worker, so that long work does not
//! block its panels.
//!
//! | file | content |
//! | --- | --- |
//! | `renderer.rs` | the functions that JavaScript calls; calls wait for each other |
//! | `session/` | the state behind it: an explorer, the canvas, the right side of a split |
//! | `opening.rs` | opening a scene |
//! | `edits.rs` | changing a scene, undo and redo |
//! | `looking.rs` | the surface and the light at a point of the picture, its histogram |
//! | `console.rs`, `browser.rs` | console lines, and the files that they read and write |
//! | `staged.rs` | light and objects added to a scene |
//! | `beside.rs` | another view or the path-traced reference on the right |
//! | `present.rs` | drawing pictures on the canvas |
//! | `load.rs`, `files.rs` | scenes and panoramas from addresses and files |
//! | `listener.rs` | progress callbacks and cancelling |
//! | `settings.rs`, `types/`, `js.rs` | values exchanged with JavaScript |
//! | `error.rs` | exceptions and their codes |

#![cfg_attr(test, allow(clippy::unwrap_used, reason = "in a test a panic is the message"))]

pub mod error;
pub mod files;
pub mod settings;
pub mod staged;
pub mod types;

#[cfg(target_arch = "wasm32")]
mod beside;
#[cfg(target_arch = "wasm32")]
mod browser;
#[cfg(target_arch = "wasm32")]
mod console;
#[cfg(target_arch = "wasm32")]
mod edits;
#[cfg(target_arch = "wasm32")]
mod js;
#[cfg(target_arch = "wasm32")]
mod listener;
#[cfg(target_arch = "wasm32")]
mod load;
#[cfg(target_arch = "wasm32")]
mod looking;
#[cfg(target_arch = "wasm32")]
mod opening;
#[cfg(target_arch = "wasm32")]
mod present;
#[cfg(target_arch = "wasm32")]
pub mod renderer;
#[cfg(target_arch = "wasm32")]
mod session;

#[cfg(test)]
mod tests {
    const PACKAGE: &str = include_str!("../npm/package.json");
    const README: &str = include_str!("../npm/README.md");
    const EXAMPLE: &str = include_str!("../npm/example.html");

    #[test]
    fn the_package_has_the_version_of_the_crate() {
        let package: serde_json::Value = serde_json::from_str(PACKAGE).unwrap();
        assert_eq!(package["version"], env!("CARGO_PKG_VERSION"));
    }

    /// The browser tests run the example, so this test only compares the texts.
    #[test]
    fn the_readme_shows_the_example_that_runs() {
        assert!(README.contains(EXAMPLE));
        let lines = EXAMPLE.lines().filter(|line| !line.trim().is_empty()).count();
        assert!(lines <= 25, "{lines} lines");
    }
}
