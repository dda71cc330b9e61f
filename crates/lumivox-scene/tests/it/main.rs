//! Tests of the public API, with a module per topic. All are one program, which links the crate
//! only once.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::needless_pass_by_value,
    reason = "in a test a panic is the message, and exact numbers are meant"
)]

mod common;
mod corpus;
mod gltf_animation;
mod gltf_animation_hostile;
mod gltf_attributes;
mod gltf_compression;
mod gltf_dangling;
mod gltf_deformed;
mod gltf_forgiven;
mod gltf_hostile;
mod gltf_materials;
mod gltf_meshopt;
mod gltf_odd;
mod gltf_scenes;
mod gltf_textures;
mod gltf_valid;
mod in_memory;
#[cfg(unix)]
mod links;
mod mtl;
mod obj;
mod origin;
mod ply;
mod round_trip;
mod stl;
mod vxct;
