//! A scene with its camera and added light.

use std::cell::OnceCell;
use std::sync::Arc;

use lumivox_console::values::camera::{camera as parse, resolve_with};
use lumivox_scene::{Camera, Fineness, Scene, Sight, SightOptions, Staging};
use pyo3::FromPyObject;

use crate::error::Fault;
use crate::records::CameraRecord;
use crate::scene::unknown;

/// A caller's choice of a camera.
#[derive(FromPyObject)]
pub enum CameraArgument {
    /// A camera as on the command line: a name, a number, or positions.
    Named(String),
    /// A camera.
    Given(CameraRecord),
}

/// A scene ready for rendering.
#[derive(Clone)]
pub struct Staged {
    pub scene: Arc<Scene>,
    pub camera: Camera,
    /// Sentences on the chosen camera and light.
    pub notes: Vec<String>,
}

/// The camera that an argument names.
///
/// # Errors
/// When the scene has no such camera, or its numbers are not those of a camera.
pub fn camera(argument: CameraArgument, scene: &Scene, aspect: f32) -> Result<Camera, Fault> {
    match argument {
        CameraArgument::Given(record) => {
            let camera = Camera::from(record);
            let grid_bounds =
                Some(lumivox_scene::Bounds { min: glam::Vec3::ZERO, max: glam::Vec3::ONE });
            let name = scene.name.clone();
            let cameras = vec![camera.clone()];
            Scene { name, cameras, grid_bounds, ..Scene::default() }.validate()?;
            Ok(camera)
        }
        CameraArgument::Named(text) => {
            let choice = parse(&text)
                .map_err(|refused| Fault::input(format!("camera \"{text}\": {refused}")))?;
            Ok(resolve_with(Some(&choice), scene, aspect, &OnceCell::new())?)
        }
    }
}

/// Finds the camera, and adds the requested surroundings: `auto`, `studio`, `sky` or `none`.
///
/// # Errors
/// When there are no such surroundings or camera, and for a scene without triangles.
pub fn stage(
    scene: &Arc<Scene>,
    argument: Option<CameraArgument>,
    aspect: f32,
    surroundings: &str,
) -> Result<Staged, Fault> {
    let staging = Staging::ALL.into_iter().find(|known| known.name() == surroundings);
    let staging = staging.ok_or_else(|| {
        let known = Staging::ALL.map(Staging::name);
        unknown("surroundings", surroundings, &known, "help(lumivox.render)")
    })?;
    if scene.triangle_count() == 0 && scene.grid_bounds.is_none() {
        return Err(Fault::input(format!(
            "the scene \"{}\" has no triangles; add some with Scene.add",
            scene.name
        )));
    }
    let given = argument.map(|argument| camera(argument, scene, aspect)).transpose()?;
    if let (Some(camera), Staging::None) = (&given, staging) {
        return Ok(Staged { scene: scene.clone(), camera: camera.clone(), notes: Vec::new() });
    }
    let options = SightOptions { camera: given, aspect, staging, fineness: Fineness::default() };
    let sight = Sight::of(scene, &options, &OnceCell::new());
    let mut scene = scene.clone();
    if sight.light.is_some() {
        Arc::make_mut(&mut scene).light_up(&sight);
    }
    let notes = sight.notes.iter().map(|note| format!("{}: {note}", note.about)).collect();
    Ok(Staged { scene, camera: sight.camera, notes })
}
