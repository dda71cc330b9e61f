//! What can go wrong while a scene is looked at and changed.

use lumivox_render::RenderError;
use lumivox_scene::SceneError;

use crate::NotFound;

/// An error of an explorer: one of those below it, with its message.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExplorerError {
    /// The renderer refuses, or the device has failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The scene cannot be shown so.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// There is nothing of a name.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// A camera cannot be stored under a name.
    #[error("no camera can be stored as \"{name}\": {problem}")]
    CameraName {
        /// The name.
        name: String,
        /// Why not.
        problem: &'static str,
    },
    /// No change is there to be taken back, or none to be done again.
    #[error("there is nothing to {what}")]
    Nothing {
        /// `undo` or `redo`.
        what: &'static str,
    },
}
