//! Scenes: meshes, materials, textures, lights and cameras, in plain CPU memory.
//!
//! The world is right-handed with y up and lengths in metres (the convention of glTF 2.0, section
//! 3.4). Light is in photometric units: luminance in cd/m², illuminance in lux, intensity in
//! candela. This crate does not know GPUs; renderers upload its scenes.
//!
//! A [`Scene`] comes from [`Scene::load`] (a glTF, OBJ, PLY, STL or VXCT file), from
//! [`builtin::scene`] (made in code, see [`builtin::names`]), or from hand-filled fields followed
//! by [`Scene::validate`]. In each case the same promises hold afterwards:
//!
//! - every index points at something, every number is finite, no triangle has zero area;
//! - triangles wind counter-clockwise seen from their front *after* the instance's transform, also
//!   where that transform mirrors;
//! - the scene has at least one triangle that is not hidden and a size above zero, or has a box for
//!   its voxels ([`Scene::grid_bounds`]).
//!
//! ```
//! let scene = lumivox_scene::builtin::scene("cornell")?;
//! assert!(scene.triangle_count() > 0);
//! # Ok::<(), lumivox_scene::SceneError>(())
//! ```

#![cfg_attr(
    test,
    allow(clippy::unwrap_used, clippy::float_cmp, reason = "in a test a panic is the message")
)]

pub mod builtin;
mod environment;
mod error;
mod framing;
mod load;
mod model;
mod pick;
mod pose;
mod save;
mod validate;

pub use environment::{sky, studio};
pub use error::SceneError;
pub use framing::{DefaultLight, Framing, Ground, Note, Sight, SightOptions, Staging};
pub use load::{
    EXTENSIONS, FileSource, LoadOptions, LoadProgress, MemoryBudget, UpAxis, check_regular,
    extensions_in_words, may_name, read_regular,
};
pub use model::{
    AlphaMode, Attenuation, Bounds, Camera, Clearcoat, Environment, EnvironmentMap, Filter,
    Instance, InstanceBounds, Light, LightKind, LoadNotes, Material, Mesh, MetallicRoughness,
    Phong, Sampler, Scene, Shading, Sheen, Strengths, Texture, TextureRef, Transmission, Unlit,
    Wrap,
};
pub use pick::{Pick, Picker};
pub use pose::{AnimationChoice, AnimationInfo, Moved, Places, Rig};

/// The key in a file's `extras` for everything that glTF cannot express.
const EXTRAS: &str = "lumivox";
pub use save::write_atomically;
pub use validate::Outlier;
