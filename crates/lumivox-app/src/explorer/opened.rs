//! Reading a scene, and what is remembered of it.

use std::collections::BTreeMap;

use glam::Mat4;
use lumivox_scene::{Bounds, Camera, Scene};

use super::names::names_of_objects;
use super::objects::Edit;
use super::original::Original;
use crate::args::camera::{CameraChoice, resolve};
use crate::args::scene::SceneSource;
use crate::cli::{ExploreArgs, LoadArgs, SourceArgs};
use crate::commands::light;
use crate::progress::Progress;

/// Which scene, and how it is read and lit.
#[derive(Clone, Debug)]
pub struct Opening {
    /// The scene.
    pub source: SceneSource,
    /// How its file is read.
    pub load: LoadArgs,
    /// What is added to its light.
    pub light: SourceArgs,
    /// Where it is seen from.
    pub camera: Option<CameraChoice>,
    /// Width by height of the picture that the camera is found for.
    pub aspect: f32,
}

/// A scene that was read, with the changes made to it since.
#[derive(Debug)]
pub struct Opened {
    pub(super) opening: Opening,
    /// As it is shown.
    pub(super) scene: Scene,
    pub(super) camera: Camera,
    /// What the grid is fitted to.
    pub(super) grid_bounds: Option<Bounds>,
    /// The objects' names, each once, in the order of the scene's instances.
    pub(super) names: Vec<String>,
    /// The objects' places without edits, in the same order.
    pub(super) posed: Vec<Mat4>,
    /// Changes of objects by their names.
    pub(super) edits: BTreeMap<String, Edit>,
    /// Lights and materials before they were changed.
    pub(super) original: Original,
}

/// Steps of an animation at which the room that it takes is measured.
const POSES: u32 = 32;

/// Reads and lights a scene, and finds its camera.
///
/// # Errors
/// When the scene or a panorama cannot be read, or there is no such camera.
pub fn load(opening: Opening, progress: &Progress) -> anyhow::Result<Opened> {
    opening.source.check()?;
    light::check(&opening.light)?;
    let mut scene = opening.source.load(&opening.load, progress)?;
    light::add(&mut scene, &opening.light, progress)?;
    if scene.cameras.is_empty() && opening.camera.is_none() {
        progress.set("looking for a camera", 0, 1);
    }
    let camera = resolve(opening.camera.as_ref(), &scene, opening.aspect)?;
    if !opening.light.no_default_light && !scene.shines() {
        light::add_default(&mut scene, &camera, progress);
    }
    let grid_bounds = bounds_of_all_poses(&mut scene, progress)?;
    let posed = scene.instances.iter().map(|instance| instance.world_from_local).collect();
    let (names, original) = (names_of_objects(&scene), Original::of(&scene));
    let edits = BTreeMap::new();
    Ok(Opened { opening, scene, camera, grid_bounds, names, posed, edits, original })
}

impl Opening {
    /// Of the scene that the command line names, if it names one.
    pub fn of_args(args: &ExploreArgs) -> Option<Self> {
        let source = args.scene.clone()?;
        Some(Self { camera: args.camera.clone(), ..Self::of(args, source) })
    }

    /// Of another scene, read and lit as the command line asks for.
    pub fn of(args: &ExploreArgs, source: SceneSource) -> Self {
        Self {
            source,
            load: args.load.clone(),
            light: args.light.sources.clone(),
            camera: None,
            aspect: args.size.x as f32 / args.size.y as f32,
        }
    }
}

impl Opened {
    /// The scene's second and third camera: those to come back to.
    pub(super) fn positions(&self) -> [Option<Camera>; 2] {
        [1, 2].map(|number| self.scene.cameras.get(number).cloned())
    }
}

/// The box around what moves, in all its poses; a grid that follows them would flicker.
fn bounds_of_all_poses(scene: &mut Scene, progress: &Progress) -> anyhow::Result<Option<Bounds>> {
    let animations = scene.animations();
    let Some(first) = animations.first() else { return Ok(None) };
    let rest = scene.clone();
    let mut bounds = scene.bounds();
    for step in 0..=POSES {
        progress.set("measuring the animation", step, POSES);
        let time_s = first.duration_s * step as f32 / POSES as f32;
        scene.pose(lumivox_scene::AnimationChoice::One(0), time_s)?;
        bounds = bounds.union(scene.bounds());
    }
    *scene = rest;
    Ok(Some(bounds))
}
