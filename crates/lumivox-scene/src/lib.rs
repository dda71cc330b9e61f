//! Scenes: meshes, materials, textures, lights and cameras, in plain CPU memory.
//!
//! The world is right-handed with y up and lengths in metres (the convention of glTF 2.0, section
//! 3.4). Light is in photometric units: luminance in cd/m², illuminance in lux, intensity in
//! candela. This crate has no GPU code; renderers upload its scenes.
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
//!
//! # Features
//!
//! One feature for each family of formats, all on by default. If a format's feature is off, loading
//! its files returns an error that names the feature ([`SceneError::LeftOut`]).
//!
//! | feature | adds |
//! | --- | --- |
//! | `gltf` | [`Scene::load`] of `.gltf` and `.glb`, with Draco, meshopt and KTX2; animations |
//! | `obj` | `.obj` with `.mtl` and textures |
//! | `ply`, `stl` | `.ply`, `.stl` |
//! | `vxct` | `.scene`, `.vxct` and `.txt` of the program VXCT; brings `obj` for its models |
//! | `panoramas` | `EnvironmentMap::load` and `from_memory`: Radiance, OpenEXR, PNG, JPEG |
//! | `save` | `Scene::save_glb` and `to_glb` |
//!
//! Without any features there are scenes made in code, the computed sky, and cameras and light for
//! scenes that have none.

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::unwrap_used, clippy::float_cmp, reason = "in a test a panic is the message")
)]

mod atomic;
pub mod builtin;
mod environment;
mod error;
mod framing;
#[cfg_attr(
    not(feature = "default"),
    allow(dead_code, unused_imports, reason = "formats share what is in it")
)]
mod load;
mod model;
mod pick;
#[cfg_attr(
    not(feature = "gltf"),
    allow(dead_code, unused_imports, reason = "only glTF has animations")
)]
mod pose;
#[cfg(feature = "save")]
mod save;
mod validate;

pub use atomic::write_atomically;
pub use environment::{sky, studio};
pub use error::SceneError;
pub use framing::{
    DefaultLight, Fineness, Framing, Ground, Note, Shade, ShadowMapFineness, Sight, SightOptions,
    Staging,
};
pub use load::{
    EXTENSIONS, FileSource, LoadOptions, LoadProgress, MemoryBudget, UpAxis, check_regular,
    extensions_in_words, may_name, read_regular,
};
pub use model::{
    AlphaMode, Attenuation, Bounds, Camera, Clearcoat, Environment, EnvironmentMap, Filter,
    Instance, InstanceBounds, LIGHT_FIELDS, Light, LightField, LightForm, LightKind, LightValue,
    LoadNotes, Material, Mesh, MetallicRoughness, Phong, Sampler, Scene, Shading, Sheen, Strengths,
    Texture, TextureRef, Transmission, Unlit, Wrap, degrees,
};
pub use pick::{Pick, Picker};
pub use pose::{AnimationChoice, AnimationInfo, Moved, Places, Rig};

pub use validate::Outlier;

/// The key in a file's `extras` for everything that glTF cannot express.
#[cfg(any(feature = "gltf", feature = "save"))]
const EXTRAS: &str = "lumivox";
