//! The values that a page hands over and gets back: plain objects, with declarations for TypeScript
//! made from these types.

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
pub use environment::{EnvironmentChange, EnvironmentInfo, of_panorama};
pub use light::{Light, LightKind};
pub use material::{Material, MaterialChange, Shading};
pub use parameter::ParameterInfo;
pub use photometry::{HistogramInfo, LightHere};

/// How far something is that takes time.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct Progress {
    /// `fetching`, `reading`, `textures`, `compile`, `upload`, `voxelize` or `light`.
    pub stage: String,
    /// From 0 to `total`.
    pub done: f64,
    /// Bytes of files, or steps; 0 where the total is unknown.
    pub total: f64,
}

/// A box along the axes, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Tsify)]
pub struct Box3 {
    /// Its least corner.
    #[tsify(type = "[number, number, number]")]
    pub min: Vec3,
    /// Its greatest.
    #[tsify(type = "[number, number, number]")]
    pub max: Vec3,
}

impl From<Bounds> for Box3 {
    fn from(bounds: Bounds) -> Self {
        Self { min: bounds.min, max: bounds.max }
    }
}

/// An object of a scene: a mesh at some place.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct ObjectInfo {
    /// Each is there once.
    pub name: String,
    /// Whether it is left out.
    pub hidden: bool,
}

/// An animation of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct AnimationInfo {
    /// As its file calls it.
    pub name: String,
    /// When it starts again, in seconds.
    pub duration_s: f32,
}

/// The properties of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct SceneInfo {
    /// The file's name without its extension.
    pub name: String,
    /// Triangles of all objects.
    pub triangles: usize,
    /// Voxels that it touches, at the present resolution.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voxels: Option<u32>,
    /// Around all that is there.
    pub bounds: Box3,
    /// The cameras of the file.
    pub cameras: Vec<Camera>,
    /// The one that it is seen from at first: its file's first, or the view that was found for it.
    pub camera: Camera,
    /// Meshes at their places.
    pub objects: Vec<ObjectInfo>,
    /// Names of materials.
    pub materials: Vec<String>,
    /// All lights, with those that were added because nothing shone.
    pub lights: Vec<Light>,
    /// Its surroundings.
    pub environment: EnvironmentInfo,
    /// The animations that can be played.
    pub animations: Vec<AnimationInfo>,
    /// The approximations and omissions while loading, in sentences.
    pub notes: Vec<String>,
}

impl SceneInfo {
    /// The properties of a scene as it is seen.
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

/// The time of a stage of a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct StageMs {
    /// `G-buffer`, `direct light`, `trace`, ...
    pub name: String,
    /// Milliseconds on the GPU.
    pub ms: f64,
}

/// The result of a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct FrameReport {
    /// Frames in the picture so far.
    pub frame: u32,
    /// Frames that it will have.
    pub frames: u32,
    /// Whether nothing is left to do until something changes.
    pub complete: bool,
    /// The time of the last frame, from the call until the GPU was done, in milliseconds.
    pub frame_ms: f64,
    /// The moment of the animation that is shown, in seconds; none where nothing moves.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f32>,
    /// The times of stages, where the browser has them; else empty.
    pub stages: Vec<StageMs>,
    /// The reason why the picture is not as a camera would make it: too dark, too bright, or black.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warning: Option<String>,
    /// Whether its own emission is all the light that the scene has.
    pub emission_alone: bool,
    /// The change that `undo` would undo, in words.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub undo: Option<String>,
    /// The change that `redo` would redo, in words.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub redo: Option<String>,
    /// Samples of each pixel in the reference, where one is shown.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_samples: Option<u32>,
}

/// The right part of the picture shows something else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// The name of a view, or `reference` for the path tracer.
    pub right: String,
    /// Where it begins, from 0 (at the left edge) to 1. Default: the middle.
    #[serde(default = "middle")]
    #[tsify(optional)]
    pub at: f32,
    /// Samples of each pixel that the reference takes, at least 1. Default: 256.
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

/// How a scene is seen that is loaded.
#[derive(Clone, Debug, Default, PartialEq, Deserialize, Tsify)]
#[serde(deny_unknown_fields, default)]
pub struct SceneOptions {
    /// The surroundings that it gets. Default: `auto`.
    #[tsify(optional)]
    pub surroundings: Surroundings,
    /// Where from, instead of the scene's own camera or the view that shows it best.
    #[tsify(optional)]
    pub from: Option<Standpoint>,
    /// The camera of the first picture; the surroundings are chosen for its own view. Default: that
    /// view.
    #[tsify(optional)]
    pub camera: Option<Camera>,
    /// A panorama around it: an address or a `File`, as `loadPanorama` takes it.
    #[tsify(optional, type = "string | URL | File")]
    pub panorama: IgnoredAny,
    /// Cancels loading; the present scene stays.
    #[tsify(optional, type = "AbortSignal")]
    pub signal: IgnoredAny,
}

/// How something is loaded.
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
    /// Where it was met, in metres.
    #[tsify(type = "[number, number, number]")]
    pub position: Vec3,
    /// The unit normal of its surface there, towards the eye.
    #[tsify(type = "[number, number, number]")]
    pub normal: Vec3,
    /// From the eye, in metres.
    pub distance_m: f32,
    /// Around the whole object.
    pub bounds: Box3,
}

/// The light around a scene: a studio, or the sun and the sky of a clear day, or nothing. With
/// `auto`, where a scene's own light is not enough, lamps light closed rooms, sun and sky open
/// places, and a studio everything else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Tsify)]
#[serde(rename_all = "lowercase")]
pub enum Surroundings {
    /// The light that suits the scene.
    #[default]
    Auto,
    /// Soft boxes, a grey wall, a ground.
    Studio,
    /// A clear day.
    Sky,
    /// Nothing, even if it is dark.
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

/// Where a scene is seen from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Tsify)]
#[serde(rename_all = "lowercase")]
pub enum Standpoint {
    /// The whole of it.
    Outside,
    /// From within.
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

/// One use of GPU memory.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct MemoryInfo {
    /// The use.
    pub name: String,
    /// How much.
    pub bytes: f64,
}

impl From<&MemoryUse> for MemoryInfo {
    fn from(used: &MemoryUse) -> Self {
        Self { name: used.name.clone(), bytes: used.bytes as f64 }
    }
}

/// A name to choose by, and a title.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct Named {
    /// The name that functions take.
    pub name: String,
    /// The title for people.
    pub title: String,
    /// A sentence on it without a full stop; empty where the title says it.
    pub summary: String,
}
