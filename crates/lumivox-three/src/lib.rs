//! Global illumination for three.js: the library on the device of a `WebGPURenderer`, without
//! scenes and files.
//!
//! The Rust code does not depend on three.js: JavaScript (`js/`) walks the scene and passes
//! buffers, textures and numbers; the results are textures.
//!
//! | file | is |
//! | --- | --- |
//! | `device.rs` | the page's `GPUDevice` as a device of wgpu |
//! | `shared.rs` | the class that `js/` calls |
//! | `input.rs` | materials, draws, lights and the camera from rows of numbers |
//! | `options.rs` | options by name |
//! | `probes.rs` | irradiance in the air, for transparent materials |
//! | `foreign.rs` | the page's textures as textures of wgpu |
//! | `gbuffer.rs`, `gbuffer.wgsl` | the shader module with which cones read the G-buffer |
//! | `error.rs` | exceptions and their codes |
//! | `js/` | the part that knows three.js: `lumivox/three` of the npm package |

#![cfg_attr(test, allow(clippy::unwrap_used, reason = "in a test a panic is the message"))]

pub mod error;
pub mod gbuffer;
pub mod input;
pub mod options;
pub mod probes;

#[cfg(target_arch = "wasm32")]
mod device;
#[cfg(target_arch = "wasm32")]
mod foreign;
#[cfg(target_arch = "wasm32")]
pub mod shared;
