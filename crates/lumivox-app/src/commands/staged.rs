//! A scene prepared for a still picture: loaded, posed, lit, with its camera.

use std::cell::OnceCell;

use glam::UVec2;
use lumivox_console::values::camera::CameraChoice;
use lumivox_console::{Failure, LoadArgs, SceneSource, SourceArgs};
use lumivox_scene::{Camera, Fineness, Scene, Sight, SightOptions, Staging};

use crate::args::camera::resolve_with;
use crate::cli::ViewArgs;
use crate::light;
use crate::progress::ProgressDisplay;
use crate::timeline::choose;

/// Loads, poses and lights a scene, and finds its camera.
///
/// # Errors
/// When the scene or a panorama cannot be read, a time is given but nothing moves, or there is no
/// such camera.
pub fn stage(
    source: &SceneSource,
    load: &LoadArgs,
    sources: &SourceArgs,
    view: &ViewArgs,
    size: UVec2,
    progress: &ProgressDisplay,
) -> anyhow::Result<(Scene, Camera)> {
    let mut scene = crate::args::scene::load(source, load, progress)?;
    light::add(&mut scene, sources, progress)?;
    if view.time.is_some() || view.animation.is_some() {
        let Some(animation) = choose(view.animation.as_ref(), &scene)? else {
            return Err(Failure::input(format!(
                "nothing moves in the scene \"{}\": it has no animation; leave --time out",
                scene.name
            ))
            .into());
        };
        scene.pose(animation, view.time.unwrap_or(0.0))?;
    }
    if scene.cameras.is_empty() && view.camera.is_none() {
        progress.set("looking for a camera", 0, 1);
    }
    let camera = look_at(&mut scene, view.camera.as_ref(), size, sources.staging(), progress)?;
    Ok((scene, camera))
}

/// Finds the camera, adds the light that the scene needs, and logs both choices, for commands whose
/// reports do not name them.
///
/// # Errors
/// When there is no such camera.
pub fn look_at(
    scene: &mut Scene,
    choice: Option<&CameraChoice>,
    size: UVec2,
    staging: Staging,
    progress: &ProgressDisplay,
) -> anyhow::Result<Camera> {
    let (aspect, framing) = (size.x as f32 / size.y as f32, OnceCell::new());
    let camera = resolve_with(choice, scene, aspect, &framing)?;
    progress.set("looking at the scene", 0, 1);
    let options =
        SightOptions { camera: Some(camera), aspect, staging, fineness: Fineness::default() };
    let sight = Sight::of(scene, &options, &framing);
    scene.light_up(&sight);
    if sight.light.is_some() {
        light::tell(&sight.notes);
    }
    Ok(sight.camera)
}
