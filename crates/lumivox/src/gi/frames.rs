//! Per-frame calls, which never wait for the GPU.

use super::place::move_to;
use super::{Gi, follow};
use crate::cones::TraceSettings;
use crate::emitters::Emitters;
use crate::gpu::Recorder;
use crate::light::Lights;
use crate::voxelize::{FrameVoxels, Taken};
use crate::{Geometry, GiError};

impl Gi {
    /// Records the voxelization of dynamic draws into the caller's frame, without waiting for the
    /// GPU: for engines, in each frame in which something has moved. Use it with
    /// [`Self::light_frame`].
    ///
    /// The result has the same bits as that of [`Self::voxelize_dynamic`]. If buffers are too small
    /// for it, the previous voxels stay; the needed size is known a few frames later, and then the
    /// buffers grow. New static draws take a few frames, too. An octree has buffers of its own:
    /// while they are too small, it shows its last voxels, with their light.
    /// [`FrameVoxels::is_late`] is `true` in both cases, as far as results have been read back:
    /// those of an earlier call, not of this one. After the last change, poll
    /// [`Self::frame_voxels`] in each frame until it is not pending, and call this again while it
    /// is late, even if nothing moves any longer. Once all buffers are large enough, no buffer and
    /// no bind group is created.
    ///
    /// The places of an octree's bricks, which decide the last bits of what cones see, depend on
    /// the lists that it has shown. The same calls lead to the same places as long as no buffer
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
    /// #     Draw, Geometry, GeometryBatch, Gi, GiConfig, Grid, SurfaceMaterial, TraceSettings,
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
    /// let mut geometry = Geometry { batches: vec![batch], materials };
    /// let settings = TraceSettings::default();
    /// let mut late = 0;
    /// for frame in 0..16 {
    ///     let height = 0.02 * frame as f32;
    ///     geometry.batches[0].draws[0].world_from_local =
    ///         Mat4::from_translation(height * Vec3::Y);
    ///     let mut encoder = device.create_command_encoder(&Default::default());
    ///     let mut recorder = Recorder::on(&device, &queue, &mut encoder);
    ///     let voxels = gi.voxelize_frame(&mut recorder, &geometry)?;
    ///     gi.light_frame(&mut recorder, &lights, None, &settings)?;
    ///     // The G-buffer, `Gi::trace` and the engine's shading go here.
    ///     drop(recorder);
    ///     queue.submit([encoder.finish()]);
    /// #   let _ = device.poll(lumivox::wgpu::PollType::wait_indefinitely());
    ///     late += u32::from(voxels.is_late);
    /// }
    /// assert!(late < 8, "in the first frames there is no room yet");
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::Geometry`] if draws and buffers contradict each other, [`GiError::Limit`] if the
    /// needed buffers do not fit the device, [`GiError::Budget`] if an octree exceeds the memory
    /// budget. The shown voxels then do not change.
    pub fn voxelize_frame(
        &mut self,
        recorder: &mut Recorder<'_>,
        geometry: &Geometry,
    ) -> Result<FrameVoxels, GiError> {
        self.changes.begin(recorder);
        self.volume.hear(recorder, self.scene.has_moving())?;
        self.lighting.expect_emission(self.draws_emitters() && Emitters::are_in(geometry));
        let Self { device, voxelizer, scene, volume, changes, lighting, emitters, config, .. } =
            self;
        let mut is_taken = false;
        let follow = &mut |recorder: &mut Recorder<'_>, taken: Taken<'_>| {
            is_taken = true;
            move_to(device, &taken, config, (&mut *lighting, &mut *volume, emitters.list()));
            follow(device, recorder, taken, (&mut *lighting, &mut *changes, &mut *volume));
        };
        let mut frame = voxelizer.record(recorder, scene, geometry, follow)?;
        if !is_taken && self.volume.is_late() {
            // The list has not changed, but the volume does not show it yet.
            self.lighting.disturb();
            is_taken = true;
        }
        self.list_emitters(recorder, geometry)?;
        if is_taken {
            self.content += 1;
            self.follow_taken(recorder)?;
            self.volume.tell(recorder);
        }
        frame.is_late |= self.volume.is_late();
        frame.is_pending |= self.volume.told()[1];
        Ok(frame)
    }

    /// Status of the last call of [`Self::voxelize_frame`], from the results that have been read
    /// back. It records nothing and does not wait.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::{Mat4, Vec3};
    /// # use lumivox::gpu::{Recorder, upload};
    /// # use lumivox::{Draw, Geometry, GeometryBatch, Gi, GiConfig, Grid, SurfaceMaterial};
    /// # let corners = [[0.1_f32, 0.1, 0.1], [0.1, 0.1, 0.9], [0.9, 0.1, 0.1]];
    /// # let positions = upload(&device, "positions", &corners);
    /// # let indices = upload(&device, "indices", &[0_u32, 1, 2]);
    /// # let materials = vec![SurfaceMaterial::default()];
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let mut gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// # let (positions, indices) = ((*positions).clone(), (*indices).clone());
    /// # let batch = GeometryBatch::new(positions, indices, vec![Draw::new(0, 3, 0)]);
    /// # let geometry = Geometry { batches: vec![batch], materials };
    /// // Something has moved once, and nothing moves any more.
    /// let mut has_changed = true;
    /// for frame in 0..16 {
    ///     let told = gi.frame_voxels();
    ///     let mut recorder = Recorder::new(&device, &queue);
    ///     if has_changed || told.is_late {
    ///         gi.voxelize_frame(&mut recorder, &geometry)?;
    ///         has_changed = false;
    ///     }
    ///     recorder.submit();
    /// #   let _ = device.poll(lumivox::wgpu::PollType::wait_indefinitely());
    /// }
    /// let told = gi.frame_voxels();
    /// assert!(!told.is_pending && !told.is_late && told.voxels > 0);
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    pub fn frame_voxels(&self) -> FrameVoxels {
        // A lost device is reported elsewhere.
        let _ = self.device.poll(wgpu::PollType::Poll);
        let mut frame = self.scene.told();
        let [is_late, is_pending] = self.volume.told();
        frame.is_late |= is_late;
        frame.is_pending |= is_pending;
        frame
    }

    /// Lights the voxels in the caller's frame, continuing from the last call of this or of
    /// [`Self::light`]: direct light, if lights or surfaces have changed, and one gather. Light
    /// travels one bounce a frame, and converges to the result of [`Self::light`] with very many
    /// bounces. Some 32 gathers after the last change it has converged, and nothing is recorded any
    /// longer.
    ///
    /// `faces_per_frame` is the maximum number of faces that gather in a frame; if there are more,
    /// they take turns, in the same order in every run. `None`: all faces in every frame; with
    /// cascades, the faces of the finest in every frame, of the next one in every second, then in
    /// every fourth, and of all others in every eighth.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use lumivox::gpu::Timing;
    /// # use lumivox::GatherSettings;
    /// # use glam::Vec3;
    /// # use lumivox::gpu::{Recorder, upload};
    /// # use lumivox::{
    /// #     Draw, Geometry, GeometryBatch, Gi, GiConfig, Grid, SurfaceMaterial, TraceSettings,
    /// # };
    /// # let corners = [[0.1_f32, 0.1, 0.1], [0.1, 0.1, 0.9], [0.9, 0.1, 0.1]];
    /// # let positions = upload(&device, "positions", &corners);
    /// # let indices = upload(&device, "indices", &[0_u32, 1, 2]);
    /// # let materials = vec![SurfaceMaterial::default()];
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let mut gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// # let (positions, indices) = ((*positions).clone(), (*indices).clone());
    /// # let batch = GeometryBatch::new(positions, indices, vec![Draw::new(0, 3, 0)]);
    /// # let geometry = Geometry { batches: vec![batch], materials };
    /// gi.voxelize(&geometry, Timing::Off).await?;
    /// let mut lights = gi.bind_lights(&[], Vec3::ONE, None);
    /// let settings = TraceSettings::default();
    /// // The first frame lights a new floor as a whole. Then its sky turns brighter, and ten faces
    /// // a frame find that out.
    /// let mut seen = Vec::new();
    /// for frame in 0..12 {
    ///     lights.update(&queue, &[], Vec3::splat(if frame == 0 { 1.0 } else { 2.0 }), None);
    ///     let mut recorder = Recorder::new(&device, &queue);
    ///     gi.light_frame(&mut recorder, &lights, Some(10), &settings)?;
    ///     recorder.submit();
    ///     let (above, down) = ([Vec3::new(0.3, 0.2, 0.3)], [Vec3::NEG_Y]);
    ///     let lux = gi.gather(&above, &down, &lights, &GatherSettings::default()).await?;
    ///     seen.push(lux[0].total().y);
    /// }
    /// assert!(seen[1] < seen[4] && seen[4] < seen[11], "{seen:?}");
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::Setting`] when a setting is out of range.
    pub fn light_frame(
        &mut self,
        recorder: &mut Recorder<'_>,
        lights: &Lights,
        faces_per_frame: Option<u32>,
        settings: &TraceSettings,
    ) -> Result<(), GiError> {
        settings.validate()?;
        self.bounces = u32::MAX;
        let volume = (&mut self.volume, &mut self.changes);
        let cones = (settings, self.cone_values);
        let lights = (lights, &*self.emitters);
        if self.lighting.step(recorder, volume, lights, faces_per_frame, cones) {
            self.content += 1;
        }
        Ok(())
    }
}
