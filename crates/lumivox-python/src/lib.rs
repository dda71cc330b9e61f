//! The Python extension `lumivox._lumivox`: scenes, renderings and light as numbers, for the
//! package in `python/lumivox`.
//!
//! The package checks arrays and has all types and documentation; this crate does the work. Arrays
//! are passed in as bytes of 32-bit numbers and returned as `bytearray`s, which numpy views without
//! a copy. Records (a camera, a light) are dictionaries.
//!
//! Work runs without Python's global lock, under the lock of its object. The object's lock is only
//! taken while the global lock is released, so the two cannot deadlock.
//!
//! | file | is |
//! | --- | --- |
//! | `error.rs` | errors as the package's exceptions |
//! | `work.rs` | progress, Ctrl-C, and the bytes of arrays |
//! | `gpu.rs` | the process's device |
//! | `records.rs` | cameras, lights, materials and instances as dictionaries |
//! | `scene.rs` | scenes and their edits |
//! | `settings.rs` | settings by name |
//! | `stage.rs` | a scene with its camera and the light that is added to it |
//! | `render.rs` | a scene on the device: pictures, layers, irradiance |
//! | `motion.rs` | the motion of visible points since the previous picture |
//! | `measure.rs` | light at points and along rays by the path tracer; workplanes |
//! | `picture.rs` | pictures for screens and files |
//! | `reference.rs` | the path tracer, and comparison |
//! | `command.rs` | the program `lumivox` |

#![allow(clippy::needless_pass_by_value, reason = "arguments from Python are values")]

mod command;
mod error;
mod gpu;
mod measure;
mod motion;
mod picture;
mod records;
mod reference;
mod render;
mod scene;
mod settings;
mod stage;
mod work;

#[pyo3::pymodule]
mod _lumivox {
    #[pymodule_export]
    use crate::{
        command::main,
        gpu::{adapters, description},
        measure::{false_color, measure, summary, workplane_points},
        picture::{develop, encode_exr},
        reference::{Reference, figures},
        render::Renderer,
        scene::{Scene, builtin_names},
        settings::table,
    };
}
