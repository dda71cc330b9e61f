//! The work of `render` before the first picture.

use lumivox_render::{Gpu, RenderSettings};
use lumivox_scene::{Note, Scene};

use super::clock::Clock;
use crate::cli::RenderArgs;
use crate::host::Host;
use crate::progress::ProgressDisplay;
use crate::timeline::Schedule;

/// Everything that is needed before the first picture.
pub struct RenderJob<'a> {
    pub args: &'a RenderArgs,
    pub host: &'a Host,
    pub is_verbose: bool,
    pub settings: RenderSettings,
    pub gpu: Gpu,
    pub scene: Scene,
    /// Notes on what was chosen for the scene.
    pub notes: Vec<Note>,
    pub schedule: Schedule,
    pub progress: ProgressDisplay,
    pub clock: Clock,
}

impl RenderJob<'_> {
    /// `true` if a picture may stop before the settings' frames: `--frames` is not given, and each
    /// frame gathers its light again.
    pub fn may_stop(&self) -> bool {
        let settings = &self.settings;
        let is_given = self.args.given().iter().any(|(parameter, _)| parameter.name == "frames");
        !is_given
            && settings.view.is_light()
            && !settings.view.is_of_voxels()
            && settings.look.is_none()
            && !settings.trace.temporal
            && !settings.overlay.is_on()
            && settings.geometry_budget.is_none()
    }
}
