//! A scene prepared for viewing: its camera, its light, the bounds of its motion.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use glam::Mat4;
use lumivox_render::{RenderProgress, RenderSettings, View};
use lumivox_scene::{AnimationChoice, Bounds, Camera, Framing, Note, Scene, Sight, SightOptions};

use crate::ExplorerError;
use crate::names::names_of_objects;
use crate::objects::{Edit, Marks};
use crate::original::Original;

/// A scene that is ready for [`Explorer::open`](crate::Explorer::open), with the changes made to it
/// since.
#[derive(Debug)]
pub struct PreparedScene {
    /// The displayed scene.
    pub(crate) scene: Scene,
    pub(crate) camera: Camera,
    /// The box to which the grid is fitted.
    pub(crate) grid_bounds: Option<Bounds>,
    /// The objects' names, each once, in the order of the scene's instances.
    pub(crate) names: Vec<String>,
    /// The objects' transforms without edits, in the same order.
    pub(crate) posed: Vec<Mat4>,
    /// The file's marks of the objects, in the same order.
    pub(crate) marks: Vec<Marks>,
    /// The objects' edits by name.
    pub(crate) edits: BTreeMap<String, Edit>,
    original: Original,
    notes: Vec<Note>,
}

/// The number of poses from which an animation's bounds are measured.
const POSES: u32 = 32;

impl PreparedScene {
    /// Finds a camera, adds light if the scene has too little, and measures the bounds of its
    /// animation. This may take seconds and needs no GPU; `progress` is called at each step.
    ///
    /// # Errors
    /// When the scene has no triangles left at some time of its animation.
    pub fn new(
        scene: Scene,
        options: &SightOptions,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<Self, ExplorerError> {
        Self::surveyed(scene, options, &OnceCell::new(), progress)
    }

    /// As [`PreparedScene::new`], for a scene that was surveyed before and whose triangles have not
    /// changed since.
    ///
    /// # Errors
    /// As [`PreparedScene::new`].
    pub fn surveyed(
        mut scene: Scene,
        options: &SightOptions,
        framing: &OnceCell<Framing>,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<Self, ExplorerError> {
        progress(RenderProgress { stage: "looking at the scene", done: 0, total: 1 });
        let sight = Sight::of(&scene, options, framing);
        scene.light_up(&sight);
        let Sight { camera, notes, .. } = sight;
        let grid_bounds = bounds_of_all_poses(&mut scene, progress)?;
        let posed = scene.instances.iter().map(|instance| instance.world_from_local).collect();
        let marks = scene.instances.iter().map(Marks::of).collect();
        let (names, original) = (names_of_objects(&scene), Original::of(&scene));
        let edits = BTreeMap::new();
        Ok(Self { scene, camera, grid_bounds, names, posed, marks, edits, original, notes })
    }

    /// The scene, with its light.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The camera of the first picture.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Notes for the user on the chosen camera and light.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Lights and materials before any change.
    pub fn original(&self) -> &Original {
        &self.original
    }

    /// The scene's second and third camera: the stored positions at first.
    pub fn positions(&self) -> [Option<Camera>; 2] {
        [1, 2].map(|number| self.scene.cameras.get(number).cloned())
    }
}

/// The box around all poses; a grid fitted to each pose would flicker.
fn bounds_of_all_poses(
    scene: &mut Scene,
    progress: &mut dyn FnMut(RenderProgress),
) -> Result<Option<Bounds>, ExplorerError> {
    let animations = scene.animations();
    let Some(first) = animations.first() else { return Ok(None) };
    let rest = scene.clone();
    let mut bounds = scene.bounds();
    for step in 0..=POSES {
        progress(RenderProgress { stage: "measuring the animation", done: step, total: POSES });
        let time_s = first.duration_s * step as f32 / POSES as f32;
        scene.pose(AnimationChoice::One(0), time_s)?;
        bounds = bounds.union(scene.bounds());
    }
    *scene = rest;
    Ok(Some(bounds))
}

/// The most voxels along the longest axis in a first picture.
const FIRST_RESOLUTION: u32 = 32;

/// Settings for a scene's first picture, shown until the requested one is ready: at most 32 voxels
/// along the longest axis, and only direct light, or one bounce if the scene has no lamps. If the
/// view shows voxels instead of light, the requested settings are returned. The size is left as
/// requested.
pub fn first_look(asked: &RenderSettings, scene: Option<&Scene>) -> RenderSettings {
    if !asked.view.is_light() {
        return asked.clone();
    }
    // Kernels of bounces take as long to compile as all others together.
    let has_lamps = scene.is_some_and(|scene| !scene.lights.is_empty());
    let bounces = u32::from(!(asked.view == View::Final && has_lamps));
    RenderSettings {
        resolution: asked.resolution.min(FIRST_RESOLUTION),
        bounces: asked.bounces.min(bounces),
        ..asked.clone()
    }
}
