//! Voxels and light that follow what moves, frame by frame, without waiting for the GPU in between.

use std::ops::ControlFlow;

use lumivox::gpu::Recorder;
use lumivox::{FrameVoxels, GiError};
use lumivox_scene::Scene;

use super::{RenderError, RenderProgress, Renderer};
use crate::scene::StreamedGeometry;
use crate::{Picture, RenderSettings};

/// Light that follows has all bounces. Settings that ask for fewer than this many want to see just these: they are
/// gathered from darkness at each change.
const MANY_BOUNCES: u32 = 8;

/// Vertices that are uploaded in a frame, where they come and go with the camera.
const UPLOADED_BYTES: u64 = 4 << 20;

/// Frames after a change until less than a hundredth of it is still to come, at one bounce a frame.
const SETTLING_FRAMES: u32 = 8;

/// Changes that the next frames have to follow.
#[allow(clippy::struct_excessive_bools, reason = "independent facts about one frame")]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Following {
    /// Surfaces have moved.
    pub(super) surfaces: bool,
    /// Whether the voxels had room for what has moved last may not be known yet.
    pub(super) is_pending: bool,
    /// Lights have moved, or what casts their shadows.
    pub(super) lights: bool,
    /// Frames until the light has settled, but for little.
    settling: u32,
    /// Whether the voxels' light has gone on from frame to frame since it was made from darkness.
    pub(super) goes_on: bool,
}

impl Following {
    /// Whether the light is on its way from a change.
    pub(super) fn is_settling(self) -> bool {
        self.settling > 0
    }
}

impl Renderer {
    /// Moves the instances of these numbers to their places in `scene`, takes its lights, and renders the first sample of a frame: all
    /// in one submission, as an engine does ([`Gi::voxelize_frame`](lumivox::Gi::voxelize_frame) and
    /// [`Gi::light_frame`](lumivox::Gi::light_frame), with all faces). The picture is this frame alone, or follows from those
    /// before it if [`TraceSettings::temporal`](lumivox::TraceSettings::temporal) says so.
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
        self.take_moved(scene, moved)?;
        self.follow_surfaces();
        let voxels = self.draw_frame(true).await?;
        voxels.ok_or(RenderError::Device {
            doing: "following what has moved",
            reason: "nothing was recorded".to_owned(),
        })
    }

    /// Renders so many frames more, whatever the settings ask for, and finishes the picture: frames of a film, of which each goes on
    /// from those before. `progress` is as in [`Self::render_until`].
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

    /// Shows the present scene as a new renderer would: the voxels and light of what has moved are made at once, and nothing of
    /// earlier frames is left. The mean starts again. `progress` is called with the stages `voxelize` and `light`.
    ///
    /// It is for cuts of a film, and for pictures that shall not depend on those before them: changes and a moving camera keep the
    /// light of earlier frames if [`TraceSettings::temporal`](lumivox::TraceSettings::temporal) is on. Otherwise it costs nothing.
    ///
    /// # Errors
    /// As [`Self::set_scene`].
    pub async fn cut(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        let Following { lights, goes_on, .. } = self.following;
        if self.gi.center_on(self.camera.position)? || self.are_voxels_late() {
            self.make_pose(progress).await?;
        } else if lights || goes_on {
            self.relight(progress).await?;
        }
        self.following = Following::default();
        self.targets.forget();
        self.scene.motion.settle(self.targets.gbuffer_textures.motion.is_some());
        (self.drawn, self.samples_drawn, self.former_camera) = (0, 0, None);
        Ok(())
    }

    /// How much of the scene is on the GPU; `None` without a budget ([`RenderSettings::geometry_budget`]): all.
    pub fn streamed(&self) -> Option<StreamedGeometry> {
        self.scene.streamed()
    }

    /// Lets the next frame follow surfaces, and their shadows.
    pub(super) fn follow_surfaces(&mut self) {
        self.following.surfaces = true;
        self.follow_lights();
    }

    /// Whether voxels are still to follow what has moved. Whether they had room for the last move is known once the GPU is done
    /// with it, which is waited for, but not in browsers.
    pub(super) fn are_voxels_late(&self) -> bool {
        let Following { surfaces, is_pending, .. } = self.following;
        if surfaces || !is_pending {
            return surfaces;
        }
        loop {
            let told = self.gi.frame_voxels();
            if !told.is_pending || cfg!(target_arch = "wasm32") {
                return told.is_late;
            }
            // A device that is lost tells elsewhere.
            if self.gpu.wait("following what has moved").is_err() {
                return false;
            }
            // Another thread that polls the device may be about to tell.
            std::thread::yield_now();
        }
    }

    /// Lets the next frame follow the lights.
    pub(super) fn follow_lights(&mut self) {
        self.following.lights = true;
        self.targets.accumulate.reset();
    }

    /// Lets cascades follow the camera, and vertices that come and go with it: over the next frames, or at once where nothing else
    /// follows frame by frame. Where there is no surface any more, voxels stay.
    pub(super) async fn follow_camera(&mut self) -> Result<(), RenderError> {
        let follows = self.settings.follows();
        let most_bytes = if follows { UPLOADED_BYTES } else { u64::MAX };
        let has_streamed = self.scene.stream(&self.gpu, self.camera.position, most_bytes);
        if !self.gi.center_on(self.camera.position)? && !has_streamed {
            return Ok(());
        }
        if follows {
            self.following.surfaces = true;
            // Geometry that comes or goes changes the shadow maps.
            self.following.lights |= has_streamed;
            return Ok(());
        }
        match self.gi.voxelize(&self.scene.geometry, self.settings.timing).await {
            Err(GiError::NothingToVoxelize { .. }) => return Ok(()),
            Err(error) => return Err(error.into()),
            Ok(voxelized) => self.store_voxels(voxelized),
        }
        self.relight(&mut |_| {}).await?;
        self.targets.accumulate.reset();
        Ok(())
    }

    /// Whether lights have shadow maps around cascades.
    fn has_fine_maps(&self) -> bool {
        self.lights.mapped.iter().flat_map(|light| &light.layers).any(|layer| layer.has_finer)
    }

    /// Records what the frame has to follow, before its passes.
    pub(super) fn follow(
        &mut self,
        recorder: &mut Recorder<'_>,
    ) -> Result<Option<FrameVoxels>, RenderError> {
        let mut voxels = None;
        if self.following.is_pending {
            let told = self.gi.frame_voxels();
            self.following.is_pending = told.is_pending;
            // The last move had no room, which is known only now.
            self.following.surfaces |= told.is_late;
        }
        if self.following.surfaces {
            let frame = self.gi.voxelize_frame(recorder, &self.scene.geometry)?;
            self.voxels_are_stale = frame.is_late;
            self.following.surfaces = frame.is_late;
            self.following.is_pending = frame.is_pending;
            voxels = Some(frame);
        }
        // Maps for the voxels of cascades move with them.
        self.following.lights |= self.has_fine_maps() && self.mapped_grid != *self.gi.grid();
        let has_changed = self.following.lights || voxels.is_some();
        if std::mem::take(&mut self.following.lights) {
            self.bind_lights(recorder);
            if let Some(look) = &mut self.look {
                look.relight();
            }
        }
        if (has_changed || self.settings.follows()) && self.settings.shown_look().is_none() {
            recorder.stage("light");
            self.gi.light_frame(recorder, &self.lights, None, &self.settings.trace)?;
            self.following.goes_on = true;
        }
        if self.settings.follows() {
            if self.following.settling > 0 {
                // Light that is still on its way does not belong into the mean.
                self.targets.accumulate.reset();
            }
            let left = self.following.settling.saturating_sub(1);
            self.following.settling = if has_changed { SETTLING_FRAMES } else { left };
        }
        Ok(voxels)
    }
}

impl RenderSettings {
    /// Whether voxels and light follow changes frame by frame, instead of being made anew at once.
    pub(crate) fn follows(&self) -> bool {
        self.trace.temporal && self.voxel_bounces() >= MANY_BOUNCES && self.shown_look().is_none()
    }
}
