//! Which scene is opened, and how it is read and lit.

mod light;
mod load;
mod source;

use lumivox_explorer::Opened;

use crate::values::camera::CameraChoice;

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
    /// The additions to its light.
    pub light: SourceArgs,
    /// Where it is seen from.
    pub camera: Option<CameraChoice>,
    /// Width by height of the picture that the camera is found for.
    pub aspect: f32,
}

/// A scene that was read, and how.
#[derive(Debug)]
pub struct Ready {
    /// How.
    pub opening: Opening,
    /// The scene.
    pub opened: Opened,
}
