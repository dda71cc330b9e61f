//! The types of a scene.

mod bounds;
mod camera;
mod light;
mod light_fields;
mod material;
mod mesh;
mod scene;
mod texture;
mod unit;

pub use bounds::Bounds;
pub use camera::Camera;
pub use light::{Attenuation, Environment, EnvironmentMap, Light, LightKind};
pub use light_fields::{LIGHT_FIELDS, LightField, LightForm, LightValue, degrees};
pub use material::{
    AlphaMode, Clearcoat, Material, MetallicRoughness, Phong, Shading, Sheen, Strengths,
    Transmission, Unlit,
};
pub use mesh::{Instance, Mesh};
pub use scene::{InstanceBounds, LoadNotes, Scene};
pub use texture::{Filter, Sampler, Texture, TextureRef, Wrap};

pub(crate) use mesh::any_tangent;
pub(crate) use unit::to_unit;
