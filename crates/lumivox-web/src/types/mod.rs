//! The values that a page passes and receives: plain objects. TypeScript's declarations are made
//! from these types.

mod camera;
mod environment;
mod light;
mod material;
mod parameter;
mod photometry;

use glam::Vec3;
use lumivox_render::MemoryUse;
use lumivox_scene::{Bounds, Scene, Staging};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use tsify::Tsify;

pub use camera::Camera;
pub use environment::{EnvironmentChange, EnvironmentInfo};
pub use light::{Light, LightKindInfo, declarations as light_declarations};
pub use material::{Material, MaterialChange, Shading};
pub use parameter::ParameterInfo;
pub use photometry::{HistogramInfo, LightHere};

/// The progress of long work.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct Progress {
    /// `fetching`, `reading`, `textures`, `compile`, `upload`, `voxelize` or `light`.
    pub stage: String,
    /// The amount that is done, from 0 to `total`.
    pub done: f64,
    /// Bytes of files, or steps; 0 if the total is unknown.
    pub total: f64,
}

/// A box along the axes, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Tsify)]
pub struct Box3 {
    /// The corner with the least coordinates.
    #[tsify(type = "[number, number, number]")]
    pub min: Vec3,
    /// The corner with the greatest coordinates.
    #[tsify(type = "[number, number, number]")]
    pub max: Vec3,
}

impl From<Bounds> for Box3 {
    fn from(bounds: Bounds) -> Self {
        Self { min: bounds.min, max: bounds.max }
    }
}

/// An object of a scene: a mesh at a place.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct ObjectInfo {
    /// The name; no two objects have the same.
    pub name: String,
    /// Whether it is hidden.
    pub hidden: bool,
}

/// An animation of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct AnimationInfo {
    /// The name in its file.
    pub name: String,
    /// Its length in seconds, after which it starts again.
    pub duration_s: f32,
}

/// The properties of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
#[tsify(hashmap_as_object)]
pub struct SceneInfo {
    /// The file's name without its extension.
    pub name: String,
    /// The number of triangles of all objects.
    pub triangles: usize,
    /// The number of occupied voxels at the present resolution.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voxels: Option<u32>,
    /// The box around the scene.
    pub bounds: Box3,
    /// The cameras of the file.
    pub cameras: Vec<Camera>,
    /// The camera of the first picture: the file's first, or the view that was found.
    pub camera: Camera,
    /// The objects.
    pub objects: Vec<ObjectInfo>,
    /// Names of materials.
    pub materials: Vec<String>,
    /// All lights, including those that were added to a scene with too little light.
    #[tsify(type = "Light[]")]
    pub lights: Vec<Light>,
    /// The surroundings.
    pub environment: EnvironmentInfo,
    /// The animations that can be played.
    pub animations: Vec<AnimationInfo>,
    /// Sentences on approximations and omissions of the loader.
    pub notes: Vec<String>,
}

impl SceneInfo {
    /// The properties of an open scene.
    pub fn new(
        scene: &Scene,
        camera: &lumivox_scene::Camera,
        objects: &[String],
        voxels: Option<u32>,
        notes: Vec<String>,
    ) -> Self {
        let objects = objects.iter().zip(&scene.instances);
        Self {
            name: scene.name.clone(),
            triangles: scene.triangle_count(),
            voxels,
            bounds: scene.bounds().into(),
            cameras: scene.cameras.iter().map(Camera::from).collect(),
            camera: camera.into(),
            objects: objects
                .map(|(name, instance)| ObjectInfo {
                    name: name.clone(),
                    hidden: instance.is_hidden,
                })
                .collect(),
            materials: scene.materials.iter().map(|material| material.name.clone()).collect(),
            lights: scene.lights.iter().map(Light::from).collect(),
            environment: (&scene.environment).into(),
            animations: scene
                .animations()
                .into_iter()
                .map(|animation| AnimationInfo {
                    name: animation.name,
                    duration_s: animation.duration_s,
                })
                .collect(),
            notes,
        }
    }
}

/// The time of a stage in a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct StageMs {
    /// The stage: `G-buffer`, `direct light`, `trace`, ...
    pub name: String,
    /// Milliseconds on the GPU.
    pub ms: f64,
}

/// The result of a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct FrameReport {
    /// The number of frames in the picture so far.
    pub frame: u32,
    /// The number of frames of the complete picture.
    pub frames: u32,
    /// Whether nothing is left to do until something changes.
    pub complete: bool,
    /// The time of the last frame, from the call until the GPU was done, in milliseconds.
    pub frame_ms: f64,
    /// The time that a frame may take while something moves, in milliseconds; 0 if pictures are never coarser.
    pub budget_ms: f32,
    /// The picture's width and height as a share of the canvas's: below 1 while something moves and frames are slow.
    pub scale: f32,
    /// Cone samples per pixel in the last frame; undefined without cones, or if stages are not
    /// timed.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub samples_per_pixel: Option<f32>,
    /// The average number of frames in the mean light of a surface; undefined without `temporal`,
    /// or if stages are not timed.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub history_frames: Option<f32>,
    /// The camera, if it is one of the scene's: an animation may have moved it.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<Camera>,
    /// The time of the animation in seconds; undefined if nothing moves.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f32>,
    /// The times of stages; empty if the browser cannot measure them.
    pub stages: Vec<StageMs>,
    /// Why a camera would not expose the picture like this: too dark, too bright, or black.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
    /// Whether the scene's own emission is its only light.
    pub emission_alone: bool,
    /// Description of the change that `undo` would undo.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undo: Option<String>,
    /// Description of the change that `redo` would redo.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub redo: Option<String>,
    /// Samples of each pixel in the reference, if one is shown.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_samples: Option<u32>,
}

/// A split: the right part of the picture shows something else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// The name of a view, or `reference` for the path tracer.
    pub right: String,
    /// Its left edge, from 0 (left) to 1. Default: the middle.
    #[serde(default = "middle")]
    #[tsify(optional)]
    pub at: f32,
    /// Samples of each pixel of the reference, at least 1. Default: 256.
    #[serde(default = "usual_samples")]
    #[tsify(optional)]
    pub samples: u32,
}

fn middle() -> f32 {
    0.5
}

fn usual_samples() -> u32 {
    256
}

/// How a loaded scene is seen.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Tsify)]
#[serde(deny_unknown_fields, default)]
pub struct SceneOptions {
    /// Its surroundings. Default: `auto`.
    #[tsify(optional)]
    pub surroundings: Surroundings,
    /// The side that it is seen from, instead of its own camera or the view that shows it best.
    #[tsify(optional)]
    pub from: Option<Standpoint>,
    /// The camera of the first picture. The surroundings are still chosen for the scene's own view.
    /// Default: that view.
    #[tsify(optional)]
    pub camera: Option<Camera>,
    /// A panorama around the scene: an address or a `File`, as for `loadPanorama`.
    #[tsify(optional, type = "string | URL | File")]
    pub panorama: IgnoredAny,
    /// Cancels loading; the present scene stays.
    #[tsify(optional, type = "AbortSignal")]
    pub signal: IgnoredAny,
}

/// Options of loading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Tsify)]
#[serde(deny_unknown_fields, default)]
pub struct LoadingOptions {
    /// Cancels loading; the present scene stays.
    #[tsify(optional, type = "AbortSignal")]
    pub signal: IgnoredAny,
}

/// The surface at a place of the picture.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct Picked {
    /// The number of the object in `scene().objects`.
    pub object: usize,
    /// The number of its material in `materials()`.
    pub material: usize,
    /// The point on the surface, in metres.
    #[tsify(type = "[number, number, number]")]
    pub position: Vec3,
    /// The unit normal of the surface there, towards the eye.
    #[tsify(type = "[number, number, number]")]
    pub normal: Vec3,
    /// The distance from the eye, in metres.
    pub distance_m: f32,
    /// The box around the whole object.
    pub bounds: Box3,
}

/// The light around a scene. With `auto`, if the scene's own light is not enough, lamps light a
/// closed room, sun and sky an open place, and a studio everything else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Tsify)]
#[serde(rename_all = "lowercase")]
pub enum Surroundings {
    /// Light that suits the scene.
    #[default]
    Auto,
    /// A studio: soft boxes, a grey wall, a ground.
    Studio,
    /// Sun and sky of a clear day.
    Sky,
    /// No added light, even if the scene is dark.
    None,
}

impl From<Surroundings> for Staging {
    fn from(surroundings: Surroundings) -> Self {
        match surroundings {
            Surroundings::Auto => Self::Auto,
            Surroundings::Studio => Self::Studio,
            Surroundings::Sky => Self::Sky,
            Surroundings::None => Self::None,
        }
    }
}

/// The side that a scene is seen from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Tsify)]
#[serde(rename_all = "lowercase")]
pub enum Standpoint {
    /// From outside, all of it.
    Outside,
    /// From inside.
    Inside,
}

impl Standpoint {
    /// The name of the view.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Outside => "outside",
            Self::Inside => "inside",
        }
    }
}

/// An item of GPU memory.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct MemoryInfo {
    /// Its use.
    pub name: String,
    /// Its size in bytes.
    pub bytes: f64,
}

impl From<&MemoryUse> for MemoryInfo {
    fn from(used: &MemoryUse) -> Self {
        Self { name: used.name.clone(), bytes: used.bytes as f64 }
    }
}

/// A choice: its name, and texts for people.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct Named {
    /// The name that functions take.
    pub name: String,
    /// The title for people.
    pub title: String,
    /// A sentence on it without a full stop; empty if the title is enough.
    pub summary: String,
}
