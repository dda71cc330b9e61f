//! Updates in an engine's frames, which never wait for the GPU.

use super::Gi;
use crate::cones::TraceSettings;
use crate::emitters::Emitters;
use crate::gpu::Recorder;
use crate::light::{Budget, Lights, Lit};
use crate::volume::changes::Changes;
use crate::volume::{OctreeVolume, ShownList};
use crate::voxelize::FrameVoxels;
use crate::{Geometry, GiError};

/// The inputs of [`Gi::frame`].
#[derive(Clone, Copy, Debug)]
pub struct Frame<'a> {
    /// The triangles; `None`: the voxels do not change.
    pub geometry: Option<&'a Geometry>,
    /// The lights; `None`: the voxels' light does not change.
    pub lights: Option<&'a Lights>,
    /// The settings of the cones.
    pub settings: &'a TraceSettings,
    /// The maximum number of faces that gather light in a frame; if there are more, they take
    /// turns, in the same order in every run. `None` (the default): all faces in every frame; with
    /// cascades, the faces of the finest in every frame, of the next one in every second, then in
    /// every fourth, and of all others in every eighth.
    pub faces_per_frame: Option<u32>,
}

impl<'a> Frame<'a> {
    /// All faces gather in every frame.
    pub fn new(geometry: &'a Geometry, lights: &'a Lights, settings: &'a TraceSettings) -> Self {
        let (geometry, lights) = (Some(geometry), Some(lights));
        Self { geometry, lights, settings, faces_per_frame: None }
    }
}

/// Whether voxels and light match their inputs, by the results that have been read back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct FrameStatus {
    /// `true` if the voxels are those of an earlier frame: a buffer overflowed, or static surface
    /// is still being rebuilt. Later calls of [`Gi::frame`] catch up.
    pub is_late: bool,
    /// `true` if it is not known yet whether the last frame that recorded voxels overflowed a
    /// buffer; `is_late` then describes an earlier one.
    pub is_pending: bool,
    /// `true` if the last geometry caused an error: the voxels are those of an earlier geometry.
    pub is_refused: bool,
    /// Frames until less than a hundredth of the light's last change is missing (with cascades, in
    /// the finest one); 0 before there is light.
    pub frames_left: u32,
    /// Occupied voxels.
    pub voxels: u32,
    /// Sides of voxels that have surface.
    pub faces: u32,
}

impl FrameStatus {
    /// `true` if voxels and light match their inputs.
    pub fn is_ready(&self) -> bool {
        !self.is_late && !self.is_pending && !self.is_refused && self.frames_left == 0
    }
}

impl Gi {
    /// Updates voxels and light in the caller's frame: for engines, in every frame, before
    /// [`Self::trace`]. It does not wait, and records nothing if nothing has changed and all light
    /// has converged.
    ///
    /// Triangles are voxelized if [`Geometry`] has changed, or cascades have moved. The voxels have
    /// the same bits as those of [`Self::voxelize_dynamic`]. If buffers are too small for them, the
    /// previous voxels stay; the needed size is known a few frames later, and then the buffers
    /// grow. New static draws take a few frames, too. An octree also has its own buffers: while
    /// they are too small, it shows its last voxels, with their light. [`FrameStatus::is_late`] is
    /// `true` meanwhile. Once all buffers are large enough, no buffer and no bind group is created.
    ///
    /// Light continues from the last call of this function or of [`Self::light`]: it computes
    /// direct light, if lights or surfaces have changed, and one gather. Light travels one bounce a
    /// frame, and converges to the result of [`Self::light`] with very many bounces, about 18
    /// gathers after the last change; 32 if faces take turns, with cascades, or with a
    /// [`ConeModel`](crate::hooks::ConeModel).
    ///
    /// The places of an octree's bricks, which affect the last bits of traced light, depend on the
    /// lists that it has shown. The same calls lead to the same places as long as no buffer
    /// overflows; which lists a late octree skips depends on the speed of the GPU.
    ///
    /// Transforms are set when this is called, vertices are read when the commands run: submit the
    /// encoders in the order in which they were recorded.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::{Mat4, Vec3};
    /// # use lumivox::gpu::{Recorder, upload};
    /// # use lumivox::{
    /// #     Draw, Frame, Geometry, GeometryBatch, Gi, GiConfig, Grid, SurfaceMaterial,
    /// #     TraceSettings,
    /// # };
    /// # let corners = [[0.1_f32, 0.1, 0.1], [0.1, 0.1, 0.9], [0.9, 0.1, 0.1]];
    /// # let positions = upload(&device, "positions", &corners);
    /// # let indices = upload(&device, "indices", &[0_u32, 1, 2]);
    /// # let materials = vec![SurfaceMaterial::default()];
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let mut gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// # let lights = gi.bind_lights(&[], Vec3::ONE, None);
    /// # let (positions, indices) = ((*positions).clone(), (*indices).clone());
    /// # let batch = GeometryBatch::new(positions, indices, vec![Draw::new(0, 3, 0)]);
    /// let mut geometry = Geometry::new(vec![batch], materials);
    /// let settings = TraceSettings::default();
    /// for frame in 0..64 {
    ///     if frame < 16 {
    ///         let place = Mat4::from_translation(0.02 * frame as f32 * Vec3::Y);
    ///         geometry.batches[0].draws[0].world_from_local = place;
    ///     }
    ///     let mut encoder = device.create_command_encoder(&Default::default());
    ///     let mut recorder = Recorder::on(&device, &queue, &mut encoder);
    ///     gi.frame(&mut recorder, Frame::new(&geometry, &lights, &settings))?;
    ///     // The G-buffer, `Gi::trace` and the engine's shading go here.
    ///     drop(recorder);
    ///     queue.submit([encoder.finish()]);
    /// #   let _ = device.poll(lumivox::wgpu::PollType::wait_indefinitely());
    /// }
    /// assert!(gi.status().is_ready() && gi.status().voxels > 0);
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::Setting`] when a setting is out of range, [`GiError::Geometry`] if draws and
    /// buffers contradict each other, [`GiError::Limit`] if the needed buffers do not fit the
    /// device, [`GiError::Budget`] if an octree exceeds the memory budget. After an error the
    /// voxels do not change; later calls light them, and voxelize again once geometry or cascades
    /// have changed. Submit the encoder all the same: buffers may have grown.
    pub fn frame(
        &mut self,
        recorder: &mut Recorder<'_>,
        frame: Frame<'_>,
    ) -> Result<FrameStatus, GiError> {
        frame.settings.validate()?;
        if let Some(geometry) = frame.geometry {
            let voxelized = self.update_voxels(recorder, geometry);
            self.is_refused |= voxelized.is_err();
            voxelized?;
        }
        if let Some(lights) = frame.lights {
            recorder.stage("light");
            self.bounces = u32::MAX;
            let budget = Budget::Faces(frame.faces_per_frame);
            self.light_step(recorder, lights, budget, frame.settings);
        }
        Ok(self.status())
    }

    /// Applies read-backs, and voxelizes if something has changed or is late.
    fn update_voxels(
        &mut self,
        recorder: &mut Recorder<'_>,
        geometry: &Geometry,
    ) -> Result<(), GiError> {
        let is_new = self.geometry.replace(geometry.version()) != Some(geometry.version());
        self.is_refused &= !is_new;
        self.voxelizer.read_back(recorder, &mut self.scene)?;
        let has_grown = self.grow_octree(recorder)?;
        let mut voxelized = Ok(());
        if is_new || (self.voxel_status().is_late && !self.is_refused) {
            voxelized = self.voxelize_frame(recorder, geometry);
        }
        if has_grown && (self.is_refused || voxelized.is_err()) {
            // The volume must show the last list in its new buffers.
            self.begin_changes(recorder);
            self.lighting.disturb();
            self.show_list(recorder)?;
        }
        voxelized
    }

    /// Grows an octree's buffers that overflowed, as far as read-backs have arrived. Returns `true`
    /// if they have grown; the list must be shown again first.
    pub(super) fn grow_octree(&mut self, recorder: &mut Recorder<'_>) -> Result<bool, GiError> {
        let has_moving = self.scene.has_moving();
        self.volume.octree_mut().map_or(Ok(false), |octree| octree.grow(recorder, has_moving))
    }

    /// The status after the last call of [`Self::frame`]. Records nothing and does not wait.
    pub fn status(&self) -> FrameStatus {
        let FrameVoxels { is_late, is_pending, voxels, faces } = self.voxel_status();
        let is_refused = self.is_refused;
        let is_late = is_late && !is_refused;
        let frames_left = self.lighting.frames_left();
        FrameStatus { is_late, is_pending, is_refused, frames_left, voxels, faces }
    }

    /// Records the voxelization of dynamic draws, and of static ones that have changed.
    pub(crate) fn voxelize_frame(
        &mut self,
        recorder: &mut Recorder<'_>,
        geometry: &Geometry,
    ) -> Result<(), GiError> {
        self.begin_changes(recorder);
        self.grow_octree(recorder)?;
        self.lighting.expect_emission(self.draws_emitters() && Emitters::are_in(geometry));
        self.voxelizer.record(recorder, &mut self.scene, geometry)?;
        let is_committed = self.commit_list(recorder);
        self.list_emitters(recorder, geometry)?;
        if is_committed {
            return self.show_list(recorder);
        }
        if self.volume.octree().is_some_and(OctreeVolume::is_late) {
            // The list has not changed, but the octree does not show it yet.
            self.lighting.disturb();
            self.show_list(recorder)?;
        }
        Ok(())
    }

    /// Commits the list that was collected, if any, and binds light, changes and volume to it.
    fn commit_list(&mut self, recorder: &mut Recorder<'_>) -> bool {
        let Self { device, voxelizer, scene, volume, changes, lighting, emitters, config, .. } =
            self;
        let Some(next) = scene.collected() else { return false };
        if config.grid != *next.grid {
            config.grid = *next.grid;
            lighting.move_to(device, next.grid);
            volume.move_to(device, next.grid, emitters.list());
        }
        let is_bound_anew = lighting.bind(recorder, next);
        if let Some(shown) = lighting.shown().filter(|_| is_bound_anew) {
            if let Some(changes) = changes {
                changes.bind(device, next.replaced, next.list, shown);
            }
            let changed = changes.as_ref().and_then(Changes::cells);
            volume.bind(device, (next.list, shown.now), changed);
            if let Some(surface) = volume.surface() {
                lighting.bind_far(device, next.list, surface);
            }
        }
        voxelizer.commit(recorder, scene);
        true
    }

    /// Shows the list of voxels to cones.
    fn show_list(&mut self, recorder: &mut Recorder<'_>) -> Result<(), GiError> {
        self.content += 1;
        self.lighting.copy_replaced(recorder);
        self.emitters.rest(recorder);
        let Self { scene, volume, changes, lighting, device, .. } = self;
        if let Some(octree) = volume.octree_mut() {
            octree.join_missed(recorder, scene.changed());
        }
        if let Some(changes) = changes {
            changes.wrong(recorder, volume.clears_cells());
        }
        let Some(voxels) = scene.list() else { return Ok(()) };
        lighting.set_list(device, voxels);
        let Some(shown) = lighting.shown() else { return Ok(()) };
        volume.show_surface(recorder);
        let Some([changed, wrong]) = changes.as_ref().and_then(Changes::cells) else {
            return Ok(());
        };
        let shown = ShownList { voxels, radiance: shown.now, changed, bits: scene.changed() };
        volume.show(recorder, shown, wrong)
    }

    /// Before a list is shown: forgets the cells that were stored.
    fn begin_changes(&mut self, recorder: &mut Recorder<'_>) {
        if let Some(changes) = &mut self.changes {
            changes.begin(recorder);
        }
    }

    /// Status of the voxels, from the results that have been read back.
    pub(crate) fn voxel_status(&self) -> FrameVoxels {
        // A lost device is reported elsewhere.
        let _ = self.device.poll(wgpu::PollType::Poll);
        let mut status = self.scene.status();
        if let Some(overflowed) = self.volume.octree().and_then(OctreeVolume::status) {
            status.is_late |= overflowed.is_late;
            status.is_pending |= overflowed.is_pending;
        }
        status
    }

    /// Records a step of the voxels' light.
    pub(crate) fn light_step(
        &mut self,
        recorder: &mut Recorder<'_>,
        lights: &Lights,
        budget: Budget,
        settings: &TraceSettings,
    ) {
        let Self { volume, changes, lighting, emitters, .. } = self;
        let (changes, cones) = (changes.as_mut(), (settings, self.cone_values));
        let lit = Lit { volume, changes, lights, emitters, cones };
        self.content += u64::from(lighting.step(recorder, lit, budget));
    }
}
