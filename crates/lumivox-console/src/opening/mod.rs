//! Which scene is opened, and how it is read and lit.

mod light;
mod load;
mod source;

use std::cell::OnceCell;

use lumivox_explorer::Opened;
use lumivox_render::Progress;
use lumivox_scene::{Scene, SightOptions};

use crate::values::camera::{CameraChoice, resolve_with};

pub use light::SourceArgs;
pub use load::LoadArgs;
pub use source::{BUILTIN, SceneSource};

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

impl Opening {
    /// Makes a scene ready that was read, turned and lit as this says: finds its camera, and the light that it lacks.
    /// This may take seconds and needs no GPU.
    ///
    /// # Errors
    /// When there is no such camera, and as [`Opened::new`].
    pub fn ready(self, scene: Scene, tell: &mut dyn FnMut(Progress)) -> anyhow::Result<Ready> {
        let (choice, framing) = (self.camera.as_ref(), OnceCell::new());
        let camera = choice.map(|_| resolve_with(choice, &scene, self.aspect, &framing));
        let options = SightOptions {
            camera: camera.transpose()?,
            aspect: self.aspect,
            staging: self.light.staging(),
        };
        let opened = Opened::surveyed(scene, &options, &framing, tell)?;
        Ok(Ready { opening: self, opened })
    }
}

/// A scene that was read, and how.
#[derive(Debug)]
pub struct Ready {
    /// How.
    pub opening: Opening,
    /// The scene.
    pub opened: Opened,
}
