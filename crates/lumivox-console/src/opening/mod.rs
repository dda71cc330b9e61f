//! Requests to open a scene.

mod light;
mod load;
mod source;

use std::cell::OnceCell;

use lumivox_explorer::PreparedScene;
use lumivox_render::{RenderProgress, RenderSettings};
use lumivox_scene::{Scene, SightOptions};

use crate::values::camera::{CameraChoice, resolve_with};

pub use light::SourceArgs;
pub use load::LoadArgs;
pub use source::{BUILTIN, SceneSource};

/// A request to open a scene: which one, and how it is read and lit.
#[derive(Clone, Debug)]
pub struct SceneRequest {
    /// The scene.
    pub source: SceneSource,
    /// How its file is read.
    pub load: LoadArgs,
    /// Added light.
    pub light: SourceArgs,
    /// The camera of the first picture; the scene's own if `None`.
    pub camera: Option<CameraChoice>,
    /// Width over height of the picture for which the camera is found.
    pub aspect: f32,
}

impl SceneRequest {
    /// Prepares a scene that was read, rotated and lit as requested: finds its camera, and adds
    /// light if it has too little. This may take seconds and needs no GPU.
    ///
    /// # Errors
    /// When there is no such camera, and as [`PreparedScene::new`].
    pub fn prepare(
        self,
        scene: Scene,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> anyhow::Result<OpenedScene> {
        let (choice, framing) = (self.camera.as_ref(), OnceCell::new());
        let camera = choice.map(|_| resolve_with(choice, &scene, self.aspect, &framing));
        let options = SightOptions {
            camera: camera.transpose()?,
            aspect: self.aspect,
            staging: self.light.staging(),
            fineness: RenderSettings::default().fineness(&scene),
        };
        let prepared = PreparedScene::surveyed(scene, &options, &framing, progress)?;
        Ok(OpenedScene { request: self, prepared })
    }
}

/// A scene that was read and prepared, with its request.
#[derive(Debug)]
pub struct OpenedScene {
    /// The request.
    pub request: SceneRequest,
    /// The scene, with its camera and light.
    pub prepared: PreparedScene,
}
