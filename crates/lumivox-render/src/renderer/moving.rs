//! Frames in which something moves, without waiting for the GPU in between.

use lumivox::FrameVoxels;
use lumivox_scene::Scene;

use super::{RenderError, Renderer};

impl Renderer {
    /// Moves the instances of these numbers to their places in `scene`, takes its lights, and renders one frame: all in one
    /// submission, as an engine does ([`Gi::voxelize_frame`](lumivox::Gi::voxelize_frame) and
    /// [`Gi::light_frame`](lumivox::Gi::light_frame), with all faces). The picture is this frame alone.
    ///
    /// Light travels one bounce of [`RenderSettings::bounces`](crate::RenderSettings::bounces) a frame, whatever their
    /// number, and voxels may be a few frames late, which the result tells. Where [`Self::move_instances`] would upload the
    /// whole scene, this does, too.
    ///
    /// # Errors
    /// As [`Self::set_scene`], and what [`Gi::voxelize_frame`](lumivox::Gi::voxelize_frame) refuses.
    pub async fn render_moved(
        &mut self,
        scene: &Scene,
        moved: &[usize],
    ) -> Result<FrameVoxels, RenderError> {
        if self.scene.move_instances(&self.gpu, scene, moved) {
            self.take_places(scene)?;
        } else {
            self.take_pose(scene)?;
        }
        self.prepare_view().await?;
        self.targets.accumulate.reset();
        let mut recorder = self.recorder();
        let voxels = self.gi.voxelize_frame(&mut recorder, &self.scene.geometry)?;
        self.voxels_are_stale = voxels.is_late;
        self.bind_lights(&mut recorder);
        if let Some(look) = &mut self.look {
            look.relight();
        }
        if self.settings.shown_look().is_none() {
            recorder.stage("light");
            self.gi.light_frame(&mut recorder, &self.lights, None, &self.settings.trace)?;
        }
        self.record_frame(&mut recorder, true)?;
        self.times.add(recorder.finish().await?);
        self.gpu.check("rendering a moved frame")?;
        Ok(voxels)
    }
}
