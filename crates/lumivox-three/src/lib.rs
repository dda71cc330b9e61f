//! Global illumination for three.js: the library on the device of a `WebGPURenderer`, without scenes and files.
//!
//! This crate knows nothing of three.js: JavaScript (`js/`) walks its scene and hands over buffers, textures and
//! numbers; what comes back are two textures.
//!
//! | file | is |
//! | --- | --- |
//! | `device.rs` | the page's `GPUDevice` as one of wgpu |
//! | `shared.rs` | the class that `js/` calls |
//! | `input.rs` | materials, draws, lights and the camera from rows of numbers |
//! | `options.rs` | options by name |
//! | `foreign.rs` | the page's textures as those of wgpu |
//! | `gbuffer.rs`, `gbuffer.wgsl` | how cones read what three.js has drawn |
//! | `error.rs` | exceptions and their codes |
//! | `js/` | the part that knows three.js: `lumivox/three` of the npm package |

#![cfg_attr(test, allow(clippy::unwrap_used, reason = "in a test a panic is the message"))]

pub mod error;
pub mod gbuffer;
pub mod input;
pub mod options;

#[cfg(target_arch = "wasm32")]
mod device;
#[cfg(target_arch = "wasm32")]
mod foreign;
#[cfg(target_arch = "wasm32")]
pub mod shared;
