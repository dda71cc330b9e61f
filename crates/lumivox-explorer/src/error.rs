//! Errors of an explorer.

use lumivox_render::RenderError;
use lumivox_scene::SceneError;

use crate::NotFound;

/// An error of an explorer: one of the errors below it, with its message.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExplorerError {
    /// The renderer refuses the request, or the device has failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The scene cannot be shown like this.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// No object, material, light or animation has this name.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// A camera cannot be stored under this name.
    #[error("no camera can be stored as \"{name}\": {problem}")]
    CameraName {
        /// The name.
        name: String,
        /// The reason.
        problem: &'static str,
    },
    /// There is no change to undo or redo.
    #[error("there is nothing to {what}")]
    Nothing {
        /// `undo` or `redo`.
        what: &'static str,
    },
}
