//! Irradiance at arbitrary points.

use glam::Vec3;

use super::Gi;
use crate::GiError;
use crate::gpu::{Recorder, read_buffer};
use crate::light::Lights;
use crate::points::{GatherPoints, GatherSettings, GatheredPoint, Irradiance, PointGatherer};

/// Maximum number of points per dispatch.
const POINTS_AT_ONCE: usize = 1 << 18;

impl Gi {
    /// The irradiance at points, m, with normals of any nonzero length: what a lux meter reads
    /// there, and a light map or a probe stores. Call [`Self::light`] first; after *n* bounces in
    /// it, the points get *n* bounces. The result of a point does not depend on the others.
    ///
    /// Points may be on surfaces or in the air. Cones start
    /// [`crate::TraceSettings::normal_offset_voxels`] above them. The future waits for the GPU,
    /// without blocking in browsers; [`Self::record_gather`] does not.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::Vec3;
    /// # use lumivox::{GatherSettings, Gi, GiConfig, Grid};
    /// let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// let gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// // An empty world below a sky of radiance 1: pi above, pi below.
    /// let lights = gi.bind_lights(&[], Vec3::ONE, None);
    /// let points = [Vec3::splat(0.5); 2];
    /// let settings = GatherSettings::default();
    /// let lux = gi.gather(&points, &[Vec3::Y, Vec3::NEG_Y], &lights, &settings).await?;
    /// assert!(lux.iter().all(|lux| (lux.total().y - std::f32::consts::PI).abs() < 1e-3));
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::Geometry`] if the numbers of normals and positions differ, or if one is not
    /// finite or a normal is zero; [`GiError::Setting`] if a setting is out of range;
    /// [`GiError::Device`] if the device is lost.
    pub async fn gather(
        &self,
        positions: &[Vec3],
        normals: &[Vec3],
        lights: &Lights,
        settings: &GatherSettings,
    ) -> Result<Vec<Irradiance>, GiError> {
        check_points(positions, normals)?;
        let mut irradiance = Vec::with_capacity(positions.len());
        for (positions, normals) in
            positions.chunks(POINTS_AT_ONCE).zip(normals.chunks(POINTS_AT_ONCE))
        {
            let points = GatherPoints::upload(&self.device, positions, normals);
            let mut recorder = Recorder::new(&self.device, &self.queue);
            self.record_gather(&mut recorder, &points, lights, settings)?;
            recorder.submit();
            let bytes = (positions.len() * size_of::<GatheredPoint>()) as u64;
            let read = read_buffer(&self.device, &self.queue, points.gathered(), 0..bytes);
            let gathered: Vec<GatheredPoint> = read.await?;
            irradiance.extend(gathered.into_iter().map(Irradiance::from));
        }
        Ok(irradiance)
    }

    /// Records [`Self::gather`] for points and results on the GPU. Its samples are added to the
    /// earlier ones, so a few per frame give a mean that improves over time
    /// ([`GatherPoints::restart`]).
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::Vec3;
    /// # use lumivox::gpu::{Recorder, read_buffer, upload};
    /// # use lumivox::{GatherPoints, GatherSettings, GatheredPoint, Gi, GiConfig, Grid};
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// # let lights = gi.bind_lights(&[], Vec3::ONE, None);
    /// let positions = upload(&device, "probes", &[[0.5_f32, 0.5, 0.5, 0.0]]);
    /// let normals = upload(&device, "directions", &[[0.0_f32, 1.0, 0.0, 0.0]]);
    /// let points = GatherPoints::new(&device, &positions, &normals, 1);
    /// let mut settings = GatherSettings::default();
    /// settings.frames = 2;
    /// for _frame in 0..3 {
    ///     let mut encoder = device.create_command_encoder(&Default::default());
    ///     let mut recorder = Recorder::on(&device, &queue, &mut encoder);
    ///     gi.record_gather(&mut recorder, &points, &lights, &settings)?;
    ///     drop(recorder);
    ///     queue.submit([encoder.finish()]);
    /// }
    /// let read: Vec<GatheredPoint> =
    ///     read_buffer(&device, &queue, points.gathered(), 0..32).await?;
    /// assert_eq!(read[0].frames, 6);
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::Setting`] when a setting is out of range.
    pub fn record_gather(
        &self,
        recorder: &mut Recorder,
        points: &GatherPoints,
        lights: &Lights,
        settings: &GatherSettings,
    ) -> Result<(), GiError> {
        settings.cones.validate()?;
        if !(1..=65_536).contains(&settings.frames) {
            return Err(GiError::Setting {
                name: "frames",
                value: settings.frames.to_string(),
                expected: "from 1 to 65536".to_owned(),
            });
        }
        let gatherer = self.point_gatherer()?;
        let cones = settings.cones.cones(self.config.grid.voxel_size_m, self.cone_values);
        let bound = [self.volume.globals(), &lights.group];
        let bound = (bound, self.emitters.has_any());
        gatherer.run(recorder, bound, points, settings, cones);
        Ok(())
    }

    /// Queues the kernel of [`Self::record_gather`] for
    /// [`Pipelines::compile`](crate::gpu::Pipelines::compile), which compiles it in the background;
    /// otherwise it is compiled on first use.
    ///
    /// # Errors
    /// [`GiError::Shader`] if the kernel does not link because the caller's own module is wrong.
    pub fn prepare_gather(&self) -> Result<(), GiError> {
        let gatherer = self.point_gatherer()?;
        gatherer.expect(&self.device, self.emitters.has_any());
        Ok(())
    }

    /// The kernel, created on first use.
    fn point_gatherer(&self) -> Result<&PointGatherer, GiError> {
        if let Some(gatherer) = self.points.get() {
            return Ok(gatherer);
        }
        let layouts = [self.volume.globals_layout(), &self.lights_layout];
        let gatherer = PointGatherer::new(&self.device, &self.shaders, layouts)?;
        Ok(self.points.get_or_init(|| gatherer))
    }
}

fn check_points(positions: &[Vec3], normals: &[Vec3]) -> Result<(), GiError> {
    let fail = |place: String, problem: String| Err(GiError::Geometry { place, problem });
    if positions.len() != normals.len() {
        let problem = format!(
            "there are {} positions, but {} normals; give one for each",
            positions.len(),
            normals.len()
        );
        return fail("the points to gather at".to_owned(), problem);
    }
    for (index, (position, normal)) in positions.iter().zip(normals).enumerate() {
        if !position.is_finite() {
            return fail(
                format!("point {index}"),
                format!("its position {position} is not finite"),
            );
        }
        if normal.try_normalize().is_none() {
            return fail(format!("point {index}"), format!("its normal {normal} has no direction"));
        }
    }
    Ok(())
}
