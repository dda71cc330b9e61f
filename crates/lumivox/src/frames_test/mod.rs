//! Frames that never wait: their voxels equal those of a new object, perhaps late, and light
//! continues from frame to frame.

mod frame;
mod moved;
mod octree;

use glam::{Mat4, Vec3};

use crate::gpu::{Pipelines, Recorder, Timing};
use crate::light::Budget;
use crate::testing::{
    SceneBuilder, busy_room, device, lambert, moved, read, room_with_a_box, wait_until_read,
};
use crate::volume::{CellVolume, read_levels, read_nodes};
use crate::voxelize::FrameVoxels;
use crate::voxels::{FaceRecord, NodeRecord};
use crate::{
    FrameStatus, Geometry, Gi, GiConfig, Grid, Light, LightSource, Lights, Shadow, SurfaceMaterial,
    TraceSettings, VolumeKind,
};

/// A device with a scene in a grid.
struct Stage {
    device: Pipelines,
    queue: wgpu::Queue,
    grid: Grid,
    gi: Gi,
}

/// Faces with the radiance that they send out, in a fixed order: by cell and lobe.
type Lit = Vec<([u32; 2], [u32; 4])>;

impl Stage {
    fn new(max: Vec3, resolution: u32) -> Self {
        Self::with(VolumeKind::Dense, max, resolution)
    }

    fn with(volume: VolumeKind, max: Vec3, resolution: u32) -> Self {
        Self::made(volume, true, max, resolution)
    }

    /// An octree has cells all the same.
    fn without_cells(volume: VolumeKind, max: Vec3, resolution: u32) -> Self {
        Self::made(volume, false, max, resolution)
    }

    fn made(volume: VolumeKind, keeps_cells: bool, max: Vec3, resolution: u32) -> Self {
        let (device, queue) = device();
        let grid = Grid::fit(Vec3::ZERO, max, resolution, Vec3::ZERO).expect("it fits");
        let config = GiConfig { volume, keeps_cells, ..GiConfig::new(grid) };
        let gi = Gi::with_pipelines(&device, &queue, config).expect("a device");
        Self { device, queue, grid, gi }
    }

    fn lamp(&self, position: Vec3, intensity: Vec3) -> Lights {
        self.shadowed(position, intensity, Shadow::Cone)
    }

    fn shadowed(&self, position: Vec3, intensity: Vec3, shadow: Shadow) -> Lights {
        let source = LightSource::Point { position, intensity, radius_m: 0.02, range_m: None };
        self.gi.bind_lights(&[Light { source, shadow }], Vec3::ZERO, None)
    }

    /// `true` if the last list overflowed the octree.
    fn overflows(&self) -> bool {
        match self.gi.cells() {
            None | Some(CellVolume::Dense(_)) => false,
            Some(CellVolume::Octree(octree)) => octree.overflows_now(&self.device, &self.queue),
        }
    }

    fn is_octree(&self) -> bool {
        matches!(self.gi.config().volume, VolumeKind::Octree)
    }

    /// Records and submits a voxelization, and waits until its results are read back.
    fn voxelize(&mut self, geometry: &Geometry) -> FrameVoxels {
        let mut recorder = Recorder::new(&self.device, &self.queue);
        self.gi.voxelize_frame(&mut recorder, geometry).expect("it fits");
        let status = self.gi.voxel_status();
        self.submit(recorder);
        wait_until_read(&self.device, &self.gi);
        status
    }

    /// Records a voxelization without submitting it.
    fn record(&mut self, geometry: &Geometry) -> (FrameVoxels, wgpu::CommandEncoder) {
        let mut encoder =
            self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut recorder = Recorder::on(&self.device, &self.queue, &mut encoder);
        self.gi.voxelize_frame(&mut recorder, geometry).expect("it fits");
        drop(recorder);
        (self.gi.voxel_status(), encoder)
    }

    /// Voxelizes until the result is not late; returns the number of voxelizations.
    fn catch_up(&mut self, geometry: &Geometry) -> u32 {
        for frame in 1..16 {
            self.voxelize(geometry);
            // A call reports the results of the previous one.
            if !self.voxelize(geometry).is_late {
                return frame;
            }
        }
        panic!("it never has room");
    }

    fn submit(&self, recorder: Recorder<'_>) {
        recorder.submit();
        self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
    }

    /// Lights the voxels from darkness.
    fn light(&mut self, lights: &Lights, bounces: u32) {
        let mut recorder = Recorder::new(&self.device, &self.queue);
        let settings = TraceSettings::default();
        self.gi.light(&mut recorder, lights, bounces, &settings).expect("valid");
        self.submit(recorder);
    }

    /// Records a frame of light.
    fn step(&mut self, lights: &Lights, faces: Option<u32>) {
        let mut recorder = Recorder::new(&self.device, &self.queue);
        let settings = TraceSettings::default();
        self.gi.light_step(&mut recorder, lights, Budget::Faces(faces), &settings);
        self.submit(recorder);
    }

    fn faces(&self) -> (Vec<FaceRecord>, Vec<[f32; 4]>) {
        let list = self.gi.voxels().expect("there is a list");
        let read_nodes = |count| read::<NodeRecord>(&self.device, &self.queue, &list.nodes, count);
        let nodes = read_nodes(list.voxel_count() as usize);
        let places: Vec<u32> =
            read(&self.device, &self.queue, &list.first_faces, list.voxel_count() as usize);
        let count = list.face_count as usize;
        let faces: Vec<FaceRecord> = read(&self.device, &self.queue, &list.faces, count);
        let radiance = self.gi.face_radiance().expect("there is light");
        let radiance: Vec<[f32; 4]> = read(&self.device, &self.queue, radiance, count);
        nodes
            .iter()
            .zip(&places)
            .flat_map(|(node, &first)| first..first + node.faces())
            .map(|face| (faces[face as usize], radiance[face as usize]))
            .unzip()
    }

    fn lit(&self) -> Lit {
        let (faces, radiance) = self.faces();
        let lit = faces.iter().zip(radiance);
        lit.map(|(face, light)| ([face.cell, face.lobe], light.map(f32::to_bits))).collect()
    }

    /// Mean radiance of the faces, over the channels.
    fn mean(&self) -> f64 {
        let (_, radiance) = self.faces();
        let sum: f64 = radiance.iter().map(|[r, g, b, _]| f64::from(r + g + b) / 3.0).sum();
        sum / radiance.len() as f64
    }

    /// Compares voxels, light and the volume with those of a new object. Not cones' light for an
    /// octree: the places of bricks, which affect its last bits, depend on earlier lists.
    fn assert_fresh(&mut self, geometry: &Geometry, what: &str) {
        let is_octree = self.is_octree();
        let (shadow, bounces) = if is_octree { (Shadow::None, 1) } else { (Shadow::Cone, 2) };
        let lamp = |stage: &Self| {
            stage.shadowed(Vec3::new(0.2, 0.4, 0.7), Vec3::new(1.0, 2.0, 3.0), shadow)
        };
        let lights = lamp(self);
        self.light(&lights, bounces);
        let gi = Gi::with_pipelines(&self.device, &self.queue, self.gi.config().clone());
        let (device, queue) = (self.device.clone(), self.queue.clone());
        let mut fresh = Self { device, queue, grid: self.grid, gi: gi.expect("a device") };
        pollster::block_on(fresh.gi.voxelize(geometry, Timing::Off)).expect("there are voxels");
        let lights = lamp(&fresh);
        fresh.light(&lights, bounces);
        assert!(self.lit() == fresh.lit(), "{what}: the faces or their light differ");
        if is_octree {
            let nodes = |stage: &Self| read_nodes(&stage.device, &stage.queue, &stage.gi);
            assert!(nodes(self) == nodes(&fresh), "{what}: nodes, masks or bricks differ");
            return;
        }
        let levels = |stage: &Self| read_levels(&stage.device, &stage.queue, &stage.gi);
        for (level, (a, b)) in levels(self).iter().zip(levels(&fresh)).enumerate() {
            assert!(a.lobes == b.lobes, "{what}: lobes of level {level} differ");
            assert!(a.tilts == b.tilts, "{what}: tilts of level {level} differ");
        }
    }
}

fn at(x: f32, y: f32, z: f32) -> Mat4 {
    Mat4::from_translation(Vec3::new(x, y, z))
}

fn volumes() -> [VolumeKind; 2] {
    [VolumeKind::Dense, VolumeKind::Octree]
}

/// Starts empty, moves a box through walls, out of the grid and back; then removes the box, the
/// static room, and everything.
#[test]
#[ignore = "slow: over three seconds"]
fn frames_converge_to_the_bits_of_a_fresh_gi() {
    for volume in volumes() {
        check_frames(volume);
    }
}

fn check_frames(volume: VolumeKind) {
    let mut stage = Stage::with(volume, Vec3::new(1.0, 0.7, 0.9), 32);
    let geometry = room_with_a_box().build(&stage.device);
    let nan = Mat4::from_translation(Vec3::NAN);
    let places = [
        ("in the air", at(0.3, 0.4, 0.6)),
        ("a little on", at(0.32, 0.41, 0.6)),
        ("in a wall", at(0.0, 0.4, 0.6)),
        ("outside", at(50.0, 0.0, 0.0)),
        ("not a number", nan),
        ("back", at(0.3, 0.4, 0.6)),
    ];
    for (what, place) in places {
        let geometry = moved(&geometry, place);
        stage.catch_up(&geometry);
        stage.assert_fresh(&geometry, what);
    }
    let only = |is_static: bool| {
        let mut geometry = geometry.clone();
        geometry.batches[0].draws.retain(|draw| draw.is_static == is_static);
        moved(&geometry, at(0.5, 0.3, 0.4))
    };
    for (what, geometry) in
        [("only the room", only(true)), ("only the box", only(false)), ("both", geometry.clone())]
    {
        stage.catch_up(&geometry);
        stage.assert_fresh(&geometry, what);
    }
    let mut nothing = geometry.clone();
    nothing.batches[0].draws.clear();
    for _ in 0..10 {
        stage.voxelize(&nothing);
    }
    assert_eq!(stage.voxelize(&nothing).voxels, 0);
    let geometry = moved(&geometry, at(0.5, 0.3, 0.4));
    stage.catch_up(&geometry);
    stage.assert_fresh(&geometry, "after nothing");
}

/// A moving object suddenly grows a hundredfold and overflows the buffers: the previous voxels
/// stay, and a few frames later the buffers are large enough.
#[test]
#[ignore = "slow: over three seconds"]
fn an_overflowing_frame_keeps_the_former_voxels() {
    for volume in volumes() {
        check_late(volume);
    }
}

/// A room with a box of any size.
fn growing(volume: VolumeKind) -> (Stage, impl Fn(f32) -> Geometry) {
    let stage = Stage::with(volume, Vec3::new(1.0, 0.9, 1.0), 64);
    let half = Vec3::splat(0.5);
    let geometry = busy_room().fixed().room(-half, half, &lambert(0.6, 0.7)).build(&stage.device);
    let sized = move |size: f32| {
        let middle = Mat4::from_translation(Vec3::new(0.5, 0.45, 0.5));
        moved(&geometry, middle * Mat4::from_scale(Vec3::new(size, 0.85 * size, 0.9 * size)))
    };
    (stage, sized)
}

fn check_late(volume: VolumeKind) {
    let (mut stage, sized) = growing(volume);
    stage.catch_up(&sized(0.05));
    let lights = stage.lamp(Vec3::new(0.2, 0.4, 0.7), Vec3::ONE);
    stage.light(&lights, 1);
    let before = stage.lit();
    let grown = sized(0.95);
    stage.voxelize(&grown);
    stage.light(&lights, 1);
    assert!(stage.lit() == before, "what has no room changes nothing");
    assert!(stage.voxelize(&grown).is_late, "it is reported");
    let frames = stage.catch_up(&grown);
    // The octree reports its own needs only once the buffers of the voxels are large enough.
    assert!(frames <= if stage.is_octree() { 6 } else { 4 }, "it took {frames} frames");
    stage.assert_fresh(&grown, "grown");
    stage.catch_up(&sized(0.05));
    stage.assert_fresh(&sized(0.05), "small again");
}

/// A call returns the read-back results of earlier calls. An overflow is reported even if nothing
/// more is recorded, and a frame without a result is reported as pending.
#[test]
#[ignore = "slow: over three seconds"]
fn overflow_is_reported_even_if_nothing_is_recorded() {
    for volume in volumes() {
        check_status(volume);
    }
}

fn check_status(volume: VolumeKind) {
    let (mut stage, sized) = growing(volume);
    stage.catch_up(&sized(0.05));
    let status = |stage: &Stage| {
        let status = stage.gi.voxel_status();
        (status.is_late, status.is_pending)
    };
    assert_eq!(status(&stage), (false, false));
    // The second frame is recorded before the first has run, as with a late read-back.
    let grown = sized(0.95);
    let encoders = [0, 1].map(|_| {
        let (frame, encoder) = stage.record(&grown);
        assert_eq!((frame.is_late, frame.is_pending), (false, true));
        encoder
    });
    stage.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
    assert_eq!(status(&stage), (false, true), "nothing has run");
    stage.queue.submit(encoders.map(wgpu::CommandEncoder::finish));
    wait_until_read(&stage.device, &stage.gi);
    assert_eq!(status(&stage), (true, false), "there was no room");
    let mut frames = 0;
    while status(&stage).0 {
        stage.voxelize(&grown);
        frames += 1;
        assert!(frames <= 6, "it never has room");
    }
    let voxels = stage.gi.voxel_status().voxels;
    assert!(!stage.voxelize(&grown).is_late, "what was reported holds");
    assert_eq!(stage.gi.voxels().expect("a list").voxel_count(), voxels);
    // A recording that is not submitted is not shown.
    drop(stage.record(&sized(0.05)));
    assert_eq!(status(&stage), (true, false), "the encoder was dropped");
}

/// A moving object enters a static scene, for which no static share was kept: until that is
/// collected again, the voxels do not change.
#[test]
fn static_voxels_stay_until_static_surface_is_collected() {
    let mut stage = Stage::new(Vec3::new(1.0, 0.7, 0.9), 32);
    let both = moved(&room_with_a_box().build(&stage.device), at(0.3, 0.4, 0.6));
    let mut alone = both.clone();
    alone.batches[0].draws.retain(|draw| draw.is_static);
    pollster::block_on(stage.gi.voxelize(&alone, Timing::Off)).expect("there are voxels");
    let lights = stage.lamp(Vec3::new(0.2, 0.4, 0.7), Vec3::ONE);
    stage.light(&lights, 1);
    let before = stage.lit();
    assert!(stage.voxelize(&both).is_late);
    stage.light(&lights, 1);
    assert!(stage.lit() == before, "the room is there all the time");
    stage.catch_up(&both);
    stage.assert_fresh(&both, "with the box");
}

/// Several recordings before the first submission.
#[test]
fn unsubmitted_recordings_keep_their_own_inputs() {
    let mut stage = Stage::new(Vec3::new(1.0, 0.7, 0.9), 32);
    let geometry = room_with_a_box().build(&stage.device);
    stage.catch_up(&moved(&geometry, at(0.3, 0.4, 0.6)));
    let [first, second] = [at(0.5, 0.2, 0.2), at(0.4, 0.3, 0.3)].map(|at| moved(&geometry, at));
    let lights = stage.lamp(Vec3::new(0.2, 0.4, 0.7), Vec3::ONE);
    let settings = TraceSettings::default();
    let mut encoders = Vec::new();
    let mut between = None;
    for geometry in [&first, &second] {
        let mut encoder =
            stage.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut recorder = Recorder::on(&stage.device, &stage.queue, &mut encoder);
        stage.gi.voxelize_frame(&mut recorder, geometry).expect("it fits");
        stage.gi.light_step(&mut recorder, &lights, Budget::Faces(None), &settings);
        let light = stage.gi.face_radiance().expect("there is light").clone();
        let copy = between.get_or_insert_with(|| {
            crate::gpu::storage_buffer(&stage.device, "between", light.size())
        });
        if encoders.is_empty() {
            recorder.copy((&light, 0), (copy, 0), light.size());
        }
        drop(recorder);
        encoders.push(encoder);
    }
    for encoder in encoders {
        stage.queue.submit([encoder.finish()]);
    }
    let light = |buffer: &crate::gpu::Buffer| -> Vec<u32> {
        read(&stage.device, &stage.queue, buffer, buffer.size() as usize / 4)
    };
    let now = stage.gi.face_radiance().expect("there is light");
    assert!(between.is_some_and(|between| light(&between) != light(now)), "each has its place");
    stage.catch_up(&second);
    stage.assert_fresh(&second, "the second place");
}

/// The walls of a Cornell box (white, red, green), open in front.
fn cornell(device: &wgpu::Device) -> Geometry {
    let wall = |r, g, b| SurfaceMaterial {
        reflectance: Vec3::new(r, g, b).extend(1.0),
        ..SurfaceMaterial::default()
    };
    let white = || wall(0.725, 0.71, 0.68);
    let [x, y, z] = Vec3::AXES;
    SceneBuilder::default()
        .quad(Vec3::ZERO, z, x, white())
        .quad(y, x, z, white())
        .quad(Vec3::ZERO, x, y, white())
        .quad(Vec3::ZERO, y, z, wall(0.63, 0.065, 0.05))
        .quad(x, z, y, wall(0.14, 0.45, 0.091))
        .fixed()
        .build(device)
}

/// The share of a change of indirect light after each frame, 0 to 1; the final light, and that of a
/// solve with 24 bounces.
fn response(faces: impl Fn(u32) -> Option<u32>, frames: u32) -> (Vec<f64>, [f64; 2]) {
    let mut stage = Stage::new(Vec3::ONE, 32);
    let geometry = cornell(&stage.device);
    pollster::block_on(stage.gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let [dim, bright] = [0.1, 1.0].map(|i| stage.lamp(Vec3::new(0.5, 0.9, 0.5), Vec3::splat(i)));
    let count = stage.gi.voxels().expect("a list").face_count;
    let mut solved = |lights: &Lights, bounces: u32| {
        stage.light(lights, bounces);
        stage.mean()
    };
    let direct = [solved(&bright, 1), solved(&dim, 1)];
    let all = [solved(&bright, 25), solved(&dim, 25)];
    let [before, after] = [all[1] - direct[1], all[0] - direct[0]];
    let mut shares = Vec::new();
    for _ in 0..frames {
        stage.step(&bright, faces(count));
        shares.push((stage.mean() - direct[0] - before) / (after - before));
    }
    for _ in 0..400 {
        stage.step(&bright, faces(count));
    }
    (shares, [stage.mean(), all[0]])
}

/// The shares of light are those stated in docs/moving.md.
#[test]
#[ignore = "slow: over three seconds"]
fn light_follows_a_lamp_switch_within_frames() {
    let (whole, [settled, solved]) = response(|_| None, 10);
    println!("whole gathers: {whole:.3?}, settles to {settled} of {solved}");
    assert!(whole[0] >= 0.55 && whole[1] >= 0.86 && whole[3] >= 0.99, "{whole:?}");
    assert!((settled / solved - 1.0).abs() < 0.005, "{settled} is not {solved}");
    assert!(whole.iter().all(|share| *share <= 1.01), "it overshoots: {whole:?}");
    let (quarter, [settled, solved]) = response(|count| Some(count.div_ceil(4)), 14);
    println!("quarters: {quarter:.3?}, settles to {settled} of {solved}");
    assert!(quarter[11] >= 0.95, "{quarter:?}");
    assert!((settled / solved - 1.0).abs() < 0.005, "{settled} is not {solved}");
    assert!(quarter.iter().all(|share| *share <= 1.01), "it overshoots: {quarter:?}");
}

/// A lamp too bright for half floats lights near surfaces with the largest half float, and its
/// light vanishes when it is dimmed. (Mesa's software driver rounds towards zero, so that it never
/// made infinities; other devices do.)
#[test]
#[ignore = "slow: over three seconds"]
fn light_beyond_half_floats_is_clamped() {
    for volume in volumes() {
        let mut stage = Stage::with(volume, Vec3::ONE, 32);
        let geometry = cornell(&stage.device);
        stage.catch_up(&geometry);
        let [dim, glaring] =
            [0.1, 1e9].map(|i| stage.lamp(Vec3::new(0.5, 0.9, 0.5), Vec3::splat(i)));
        stage.light(&dim, 8);
        let before = stage.mean();
        for _ in 0..8 {
            stage.step(&glaring, None);
        }
        let lit = stage.mean();
        assert!(lit.is_finite() && lit > 1e3 * before, "{volume:?}: {lit}");
        for _ in 0..200 {
            stage.step(&dim, None);
        }
        let after = stage.mean();
        assert!((after / before - 1.0).abs() < 0.01, "{volume:?}: {after}, not {before}");
    }
}

/// If walls reflect 95 %, repeated bounces neither diverge nor drift; after the lamp is removed,
/// the light vanishes.
#[test]
#[ignore = "slow: over three seconds"]
fn reflected_light_neither_grows_nor_outlives_the_lamp() {
    let mut stage = Stage::new(Vec3::ONE, 16);
    let room = SceneBuilder::default().room(Vec3::ZERO, Vec3::ONE, &lambert(0.95, 0.0)).fixed();
    let geometry = room.build(&stage.device);
    pollster::block_on(stage.gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let lamp = stage.lamp(Vec3::new(0.3, 0.6, 0.4), Vec3::ONE);
    // Disturbs the light in each step, so that it never converges.
    let step = |stage: &mut Stage, lights: &Lights| {
        stage.gi.forget_light();
        stage.step(lights, None);
    };
    let mut means = Vec::new();
    for _ in 0..50 {
        for _ in 0..4 {
            step(&mut stage, &lamp);
        }
        means.push(stage.mean());
    }
    let settled = means[means.len() - 1];
    let highest = means.iter().copied().fold(0.0, f64::max);
    assert!(highest <= 1.01 * settled, "{highest} was above {settled}");
    let drift = (means[37] / settled - 1.0).abs();
    assert!(drift < 1e-3, "it drifts by {drift}");
    let dark = stage.lamp(Vec3::new(0.3, 0.6, 0.4), Vec3::ZERO);
    for _ in 0..150 {
        step(&mut stage, &dark);
    }
    let left = stage.mean() / settled;
    assert!(left < 1e-3, "{left} of the light is left");
}

/// After light has converged, no pass is recorded until something changes.
#[test]
#[ignore = "slow: over three seconds"]
fn settled_light_records_no_passes() {
    let mut stage = Stage::new(Vec3::new(1.0, 0.7, 0.9), 16);
    let geometry = moved(&room_with_a_box().build(&stage.device), at(0.3, 0.4, 0.6));
    pollster::block_on(stage.gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let lights = stage.lamp(Vec3::new(0.2, 0.4, 0.7), Vec3::ONE);
    let passes = |stage: &mut Stage, lights: &Lights| {
        let mut recorder =
            Recorder::with_timing(&stage.device, &stage.queue, Timing::SubmitAndWait);
        let settings = TraceSettings::default();
        stage.gi.light_step(&mut recorder, lights, Budget::Faces(None), &settings);
        pollster::block_on(recorder.finish()).expect("the device works").len()
    };
    assert!(passes(&mut stage, &lights) > 0);
    for _ in 0..100 {
        passes(&mut stage, &lights);
    }
    assert_eq!(passes(&mut stage, &lights), 0, "it has settled");
    let settled = stage.lit();
    let other = stage.lamp(Vec3::new(0.2, 0.5, 0.7), Vec3::ONE);
    assert!(passes(&mut stage, &other) > 0, "another lamp");
    assert!(stage.lit() != settled);
    for _ in 0..100 {
        passes(&mut stage, &other);
    }
    assert_eq!(passes(&mut stage, &other), 0, "it has settled again");
    stage.voxelize(&moved(&geometry, at(0.5, 0.4, 0.6)));
    assert!(passes(&mut stage, &other) > 0, "a move");
}

/// Repeated frames give the same bits in every run. The places of an octree's bricks depend on when
/// its buffers grew, so they are large enough from the start.
#[test]
#[ignore = "slow: over three seconds"]
fn frames_have_the_same_bits_in_every_run() {
    for volume in volumes() {
        check_runs(volume);
    }
}

fn check_runs(volume: VolumeKind) {
    let run = || {
        let mut stage = Stage::with(volume, Vec3::new(1.0, 0.7, 0.9), 32);
        let geometry = room_with_a_box().build(&stage.device);
        let start = moved(&geometry, at(0.3, 0.4, 0.6));
        pollster::block_on(stage.gi.voxelize(&start, Timing::Off)).expect("there are voxels");
        for frame in 0..8 {
            let time = frame as f32 * 0.03;
            stage.voxelize(&moved(&geometry, at(0.3 + time, 0.4, 0.6)));
            let lights = stage.lamp(Vec3::new(0.2 + time, 0.4, 0.7), Vec3::ONE);
            stage.step(&lights, Some(2000));
        }
        stage.voxelize(&moved(&geometry, at(0.5, 0.4, 0.6)));
        stage.lit()
    };
    assert!(run() == run());
}
