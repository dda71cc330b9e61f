//! Updates of voxels and light for moving objects, frame by frame, without waiting for the GPU.

use std::ops::ControlFlow;

use lumivox::gpu::Recorder;
use lumivox::{Frame, FrameStatus, GiError};
use lumivox_scene::Scene;

use super::{RenderError, RenderProgress, Renderer};
use crate::scene::StreamedGeometry;
use crate::{Picture, RenderSettings};

/// The least number of bounces with incremental light, which accumulates any number. With fewer,
/// the user wants exactly that many, so each change gathers light from darkness.
const MANY_BOUNCES: u32 = 8;

/// The most bytes of vertices uploaded in a frame while streaming with the camera.
const UPLOADED_BYTES: u64 = 4 << 20;

/// Changes that the next frames have to process.
#[allow(clippy::struct_excessive_bools, reason = "independent facts about one frame")]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Updates {
    /// Whether surfaces have moved whose voxels are late or not recorded yet.
    pub(super) surfaces: bool,
    /// Whether it is still unknown if the voxels of the last move fitted into their buffers.
    pub(super) is_pending: bool,
    /// Whether lights or their shadow casters have moved.
    pub(super) lights: bool,
    /// Whether the light of the last frame was still changing.
    pub(super) is_settling: bool,
    /// Whether the voxels' light has been updated incrementally since it was computed from
    /// darkness.
    pub(super) goes_on: bool,
}

impl Renderer {
    /// Moves the instances with the indices `moved` to their transforms in `scene`, applies its
    /// lights, and renders the first sample of a frame: all in one submission, like an engine
    /// ([`Gi::frame`](lumivox::Gi::frame), with all faces). The picture is only this frame, or
    /// blended with earlier ones if [`TraceSettings::temporal`](lumivox::TraceSettings::temporal)
    /// is on.
    ///
    /// Light travels one bounce a frame, whatever the number of
    /// [`RenderSettings::bounces`](crate::RenderSettings::bounces). Voxels may be a few frames
    /// late; the result says so. If [`Self::move_instances`] would upload the whole scene, this
    /// method does as well.
    ///
    /// # Errors
    /// As [`Self::set_scene`] and [`Gi::frame`](lumivox::Gi::frame).
    pub async fn render_moved(
        &mut self,
        scene: &Scene,
        moved: &[usize],
    ) -> Result<FrameStatus, RenderError> {
        self.take_moved(scene, moved)?;
        self.changed(true);
        self.draw_frame(true).await
    }

    /// Renders `frames` more frames, whatever the settings ask for, and finishes the picture: for
    /// films, in which each frame continues from the one before. `progress` works as in
    /// [`Self::render_until`].
    ///
    /// # Errors
    /// When the device fails.
    pub async fn render_more(
        &mut self,
        frames: u32,
        progress: &mut dyn FnMut(RenderProgress) -> ControlFlow<()>,
    ) -> Result<Option<Picture>, RenderError> {
        for done in 0..frames {
            if progress(RenderProgress { stage: "render", done, total: frames }).is_break() {
                return Ok(None);
            }
            self.render_frame().await?;
            self.gpu.wait("rendering a frame")?;
        }
        self.complete_overlay().await?;
        self.finish().await.map(Some)
    }

    /// Shows the current scene like a new renderer: voxels and light of moved objects are computed
    /// at once, and nothing of earlier frames remains. The mean starts again. `progress` is called
    /// with the stages `voxelize` and `light`.
    ///
    /// Use it for cuts in a film, and for pictures that must not depend on those before: with
    /// [`TraceSettings::temporal`](lumivox::TraceSettings::temporal), changes and a moving camera
    /// keep the light of earlier frames. It costs nothing if no frame was updated incrementally.
    ///
    /// # Errors
    /// As [`Self::set_scene`].
    pub async fn cut(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        self.updates.surfaces |= self.gi.center_on(self.camera.position)?;
        let Updates { lights, goes_on, .. } = self.updates;
        if lights || goes_on || self.are_voxels_late() {
            self.complete_updates(progress).await?;
        }
        self.updates = Updates::default();
        self.targets.forget();
        self.scene.motion.settle(self.targets.gbuffer_textures.motion.is_some());
        self.start_like_new();
        Ok(())
    }

    /// How much of the scene is on the GPU; `None` if there is no budget
    /// ([`RenderSettings::geometry_budget`]), so all of it.
    pub fn streamed(&self) -> Option<StreamedGeometry> {
        self.scene.streamed()
    }

    /// Marks lights as changed, and surfaces if `surfaces`. The mean starts again.
    pub(super) fn changed(&mut self, surfaces: bool) {
        self.updates.surfaces |= surfaces;
        self.updates.lights = true;
        self.targets.accumulate.reset();
    }

    /// Updates lights that have changed, and surfaces if `surfaces`: in the next frames, or at once
    /// if the settings do not update frame by frame.
    pub(super) async fn update(
        &mut self,
        surfaces: bool,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        self.changed(surfaces);
        if self.settings.updates_by_frame() {
            return Ok(());
        }
        self.complete_updates(progress).await
    }

    /// Completes all updates at once, with light from darkness.
    pub(super) async fn complete_updates(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        if self.are_voxels_late() {
            self.voxelize(progress).await?;
        }
        self.relight(progress).await
    }

    /// Whether voxels still lag behind moved objects. Waits for the GPU, except in browsers: only
    /// then is it known if the last move fitted into the buffers.
    pub(super) fn are_voxels_late(&self) -> bool {
        let Updates { surfaces, is_pending, .. } = self.updates;
        if surfaces || !is_pending {
            return surfaces;
        }
        loop {
            let status = self.gi.status();
            if !status.is_pending || cfg!(target_arch = "wasm32") {
                return status.is_late;
            }
            // Another call reports the lost device.
            if self.gpu.wait("updating what has moved").is_err() {
                return false;
            }
            // Another thread that polls the device may be about to deliver the result.
            std::thread::yield_now();
        }
    }

    /// Moves cascades with the camera, and streams vertices: over the next frames, or at once if
    /// the settings do not update frame by frame. If no surface is left in the grid, the old voxels
    /// are kept.
    pub(super) async fn move_with_camera(&mut self) -> Result<(), RenderError> {
        let follows = self.settings.updates_by_frame();
        let most_bytes = if follows { UPLOADED_BYTES } else { u64::MAX };
        let has_streamed = self.scene.stream(&self.gpu, self.camera.position, most_bytes);
        if !self.gi.center_on(self.camera.position)? && !has_streamed {
            return Ok(());
        }
        self.updates.surfaces = true;
        if follows {
            // Geometry that is loaded or unloaded changes the shadow maps.
            self.updates.lights |= has_streamed;
            return Ok(());
        }
        match self.complete_updates(&mut |_| {}).await {
            Err(RenderError::Gi(GiError::NothingToVoxelize { .. })) => {
                self.updates.surfaces = false;
                Ok(())
            }
            completed => {
                self.targets.accumulate.reset();
                completed
            }
        }
    }

    /// Whether lights have shadow maps around cascades.
    fn has_fine_maps(&self) -> bool {
        self.lights.mapped.iter().flat_map(|light| &light.layers).any(|layer| layer.has_finer)
    }

    /// Records the pending updates before the passes of the frame.
    pub(super) fn record_updates(
        &mut self,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), RenderError> {
        self.updates.is_settling &= self.settings.updates_by_frame();
        // Shadow maps around cascades move with them.
        self.updates.lights |= self.has_fine_maps() && self.mapped_grid != *self.gi.grid();
        let Updates { is_pending, lights, is_settling, .. } = self.updates;
        let surfaces = self.updates.surfaces || is_pending;
        if lights {
            self.bind_lights(recorder);
            if let Some(look) = &mut self.look {
                look.relight();
            }
        }
        let follows = self.settings.updates_by_frame();
        if is_settling {
            // Light that is still changing must not enter the mean.
            self.targets.accumulate.reset();
        }
        if surfaces || lights || follows {
            // After a move whose voxels fitted, light has been updated.
            let is_changing = self.updates.surfaces || lights || self.gi.status().is_late;
            let is_lit = (is_changing || follows) && self.settings.shown_look().is_none();
            let frame = Frame {
                geometry: surfaces.then_some(&self.scene.geometry),
                lights: is_lit.then_some(&self.lights),
                ..Frame::new(&self.scene.geometry, &self.lights, &self.settings.trace)
            };
            let status = self.gi.frame(recorder, frame)?;
            self.updates = Updates {
                surfaces: surfaces && status.is_late,
                is_pending: surfaces && status.is_pending,
                lights: false,
                is_settling: follows && (status.is_late || status.frames_left > 0),
                goes_on: self.updates.goes_on || is_lit,
            };
            if surfaces {
                self.voxels_are_stale = status.is_late || status.is_refused;
            }
        }
        Ok(())
    }
}

impl RenderSettings {
    /// Whether voxels and light are updated frame by frame, instead of at once.
    pub(crate) fn updates_by_frame(&self) -> bool {
        self.trace.temporal && self.voxel_bounces() >= MANY_BOUNCES && self.shown_look().is_none()
    }
}
