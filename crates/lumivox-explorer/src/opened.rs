//! A scene made ready to be looked at, and what is remembered of it.

use std::cell::OnceCell;
use std::collections::BTreeMap;

use glam::Mat4;
use lumivox_render::{RenderProgress, RenderSettings};
use lumivox_scene::{AnimationChoice, Bounds, Camera, Framing, Note, Scene, Sight, SightOptions};

use crate::ExplorerError;
use crate::names::names_of_objects;
use crate::objects::{Edit, Marks};
use crate::original::Original;

/// A scene that is ready for [`Explorer::open`](crate::Explorer::open), with the changes made to it since.
#[derive(Debug)]
pub struct PreparedScene {
    /// As it is shown.
    pub(crate) scene: Scene,
    pub(crate) camera: Camera,
    /// What the grid is fitted to.
    pub(crate) grid_bounds: Option<Bounds>,
    /// The objects' names, each once, in the order of the scene's instances.
    pub(crate) names: Vec<String>,
    /// The objects' places without edits, in the same order.
    pub(crate) posed: Vec<Mat4>,
    /// What the file says of them, in the same order.
    pub(crate) marks: Vec<Marks>,
    /// Changes of objects by their names.
    pub(crate) edits: BTreeMap<String, Edit>,
    /// Lights and materials before they were changed.
    pub(crate) original: Original,
    notes: Vec<Note>,
}

/// Steps of an animation at which the room that it takes is measured.
const POSES: u32 = 32;

impl PreparedScene {
    /// Decides how a scene is seen, lights it where it needs light, and measures the room that its animation takes. This
    /// may take seconds and needs no GPU; `progress` is called at each step.
    ///
    /// # Errors
    /// When nothing of the scene is left at some time of its animation.
    pub fn new(
        scene: Scene,
        options: &SightOptions,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<Self, ExplorerError> {
        Self::surveyed(scene, options, &OnceCell::new(), progress)
    }

    /// The same for a scene that was surveyed before, if its triangles are still the same.
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

    /// The scene, lit.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Where it is seen from.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// What was chosen for the scene, its camera and its light; users want to hear of it.
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// The scene's second and third camera: those to come back to.
    pub(crate) fn positions(&self) -> [Option<Camera>; 2] {
        [1, 2].map(|number| self.scene.cameras.get(number).cloned())
    }
}

/// The box around what moves, in all its poses; a grid that follows them would flicker.
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

/// A first picture has at most so many voxels along the longest axis.
const FIRST_RESOLUTION: u32 = 32;

/// Settings for a scene's first picture, which is there while what is asked for takes its time: at most 32 voxels along
/// the longest axis, and one bounce. Those asked for where the view shows voxels instead of light. The size is the
/// caller's.
pub fn first_look(asked: &RenderSettings) -> RenderSettings {
    if !asked.view.is_light() {
        return asked.clone();
    }
    RenderSettings {
        resolution: asked.resolution.min(FIRST_RESOLUTION),
        bounces: asked.bounces.min(1),
        ..asked.clone()
    }
}
