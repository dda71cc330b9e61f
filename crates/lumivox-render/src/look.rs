//! Looks: the hook with which a caller replaces the physical passes to draw the picture.
//!
//! Write one for non-photorealistic rendering, to compare with another engine's shading, or for a
//! study that leaves terms out. A [`Look`] is a cheap description, set in
//! [`RenderSettings::look`](crate::RenderSettings::look); it creates [`LookPasses`] for a scene on
//! a device. The renderer still uploads the scene, counts and averages frames, draws overlays and
//! develops the picture. `lumivox-vxct` is an example.

use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

use lumivox::gpu::{Recorder, ShaderLibrary, TextureView};
use lumivox::{Gi, GiView, Lights};
use lumivox_scene::{Bounds, Material, Scene};

pub use crate::passes::composite::PICTURE_FORMAT;
pub use crate::passes::gbuffer::NORMALS_FORMAT;
pub use crate::passes::raster::DEPTH_FORMAT;
pub use crate::scene::{Attributes, GpuMaterial, SceneDraw, VertexBuffers};
use crate::scene::{GpuScene, Lighting};
use crate::{Exposure, Gpu, MemoryUse, RenderError, ToneMap, View};

/// The type of [`RenderSettings::look`](crate::RenderSettings::look); `None` is the physical look.
pub type LookChoice = Option<Arc<dyn Look>>;

/// A way of drawing a scene, with its settings.
pub trait Look: Any + Debug + Send + Sync {
    /// The name, in lower case.
    fn name(&self) -> &'static str;

    /// Whether `other`, a look with the same name, has the same settings.
    fn is_same(&self, other: &dyn Look) -> bool;

    /// Checks the settings against their ranges.
    ///
    /// # Errors
    /// [`RenderError::Setting`] for the first one that is out of range.
    fn validate(&self) -> Result<(), RenderError>;

    /// Whether the look draws `view`. Lumivox draws the other views.
    fn shows(&self, view: View) -> bool;

    /// The coarsest level in the look's views of voxels.
    fn last_level(&self) -> u32 {
        0
    }

    /// The look's exposure and curve; `scene` is `None` if not known yet.
    fn display(&self, scene: Option<&Scene>) -> (Exposure, ToneMap);

    /// Creates the passes that draw a scene. `grid` is the box that the grid is fitted to. GPU
    /// resources may be created later, in [`LookPasses::prepare`].
    fn passes(&self, scene: &LookScene, grid: Bounds) -> Box<dyn LookPasses>;
}

/// Looks are equal if their names and their settings are.
impl PartialEq for dyn Look {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name() && self.is_same(other)
    }
}

/// The parts of a scene that a look receives in addition to those on the GPU.
#[derive(Clone, Debug)]
pub struct LookScene {
    /// The materials; [`GpuScene`] has their textures.
    pub materials: Vec<Material>,
    /// Lights and surroundings.
    pub lighting: Lighting,
    /// [`Scene::has_display_values`].
    pub has_display_values: bool,
    /// [`Scene::voxel_bounds`] at the last change of the lights.
    pub bounds: Bounds,
}

impl LookScene {
    /// Collects the parts of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self {
            materials: scene.materials.clone(),
            lighting: Lighting::of(scene),
            has_display_values: scene.has_display_values(),
            bounds: scene.voxel_bounds(),
        }
    }
}

/// The passes of a look for one scene, created by [`Look::passes`]. They are recreated when
/// materials or the grid change, and dropped when another look is chosen.
pub trait LookPasses: Debug + wgpu::WasmNotSendSync {
    /// Updates lights and transforms, not materials.
    fn set_scene(&mut self, scene: &LookScene);

    /// Invalidates everything that depends on transforms and light, for the next frame.
    fn relight(&mut self);

    /// Links shaders and creates missing resources for the next frame. Called before each frame.
    ///
    /// # Errors
    /// When something does not fit the device, or a shader does not link.
    fn prepare(&mut self, parts: &LookParts<'_>) -> Result<(), RenderError>;

    /// Records a frame. Buffer writes take effect at the next submission, so record one frame per
    /// recorder.
    fn record(&mut self, gpu: &Gpu, recorder: &mut Recorder, frame: &LookFrame<'_>);

    /// GPU memory by its use.
    fn memory(&self) -> Vec<MemoryUse>;
}

/// The input of [`LookPasses::prepare`].
#[derive(Clone, Copy, Debug)]
pub struct LookParts<'a> {
    /// The device, with its pipelines.
    pub gpu: &'a Gpu,
    /// All shader modules of Lumivox and of this crate, for the current volume; add your own to a
    /// clone.
    pub shaders: &'a ShaderLibrary,
    /// The volume, for its layouts.
    pub gi: &'a Gi,
    /// The scene on the GPU.
    pub scene: &'a GpuScene,
    /// Voxels along the longest axis.
    pub resolution: u32,
}

/// The input and the targets of a look's frame.
#[derive(Clone, Copy, Debug)]
pub struct LookFrame<'a> {
    /// The look, with its settings.
    pub look: &'a dyn Look,
    /// The scene on the GPU.
    pub scene: &'a GpuScene,
    /// Lights, surroundings and shadow maps.
    pub lights: &'a Lights,
    /// The camera, with the G-buffer's bindings.
    pub camera: &'a GiView,
    /// The view to draw: one that [`Look::shows`].
    pub shown: View,
    /// The level of voxels to draw.
    pub level: u32,
    /// The target of the picture, with format [`PICTURE_FORMAT`], for a storage binding: radiance
    /// in multiples of [`GpuScene::radiance_unit`], and the share that surfaces cover as alpha.
    pub picture: &'a TextureView,
    /// The target of the surfaces' depths, with format [`DEPTH_FORMAT`], for a render pass; nearer
    /// is greater. Overlays read it.
    pub depth: &'a TextureView,
    /// The target of the surfaces' normals, with format [`NORMALS_FORMAT`], for a render pass.
    /// Overlays read it.
    pub normals: &'a TextureView,
}
