//! After any changes of geometry and lights, the volume has the bits of a new one. An octree keeps
//! the places of its bricks, which affect the last bits of cones' samples: it has the bits of an
//! octree that voxelized everything at each move.

use glam::{Mat4, Vec3};

use crate::gpu::{Pipelines, Recorder, Timing};
use crate::testing::{device, moved, read, room_with_a_box};
use crate::volume::{read_levels, read_nodes};
use crate::{
    Directionality, Geometry, Gi, GiConfig, Grid, Light, LightSource, Shadow, TraceSettings,
    VolumeKind,
};

struct Stage {
    device: Pipelines,
    queue: wgpu::Queue,
    config: GiConfig,
    geometry: Geometry,
}

impl Stage {
    fn new(volume: VolumeKind, directionality: Directionality) -> Self {
        let (device, queue) = device();
        let size = Vec3::new(1.0, 0.7, 0.9);
        let grid = Grid::fit(Vec3::ZERO, size, 32, Vec3::ZERO).expect("it fits");
        let geometry = room_with_a_box().build(&device);
        let config = GiConfig { directionality, volume, keeps_cells: true, ..GiConfig::new(grid) };
        Self { device, queue, config, geometry }
    }

    fn gi(&self) -> Gi {
        Gi::with_pipelines(&self.device, &self.queue, self.config.clone()).expect("a device")
    }

    fn voxelize(&self, gi: &mut Gi, place: Mat4) {
        let geometry = moved(&self.geometry, place);
        pollster::block_on(gi.voxelize_dynamic(&geometry, Timing::Off)).expect("there are voxels");
    }

    /// A lamp that reaches no farther than `range_m`, so that much of the room does not change.
    fn light(&self, gi: &mut Gi, bounces: u32, lamp: Vec3, shadow: Shadow) {
        let source = LightSource::Point {
            position: lamp,
            intensity: Vec3::new(1.0, 2.0, 3.0),
            radius_m: 0.02,
            range_m: Some(0.3),
        };
        let lights = gi.bind_lights(&[Light { source, shadow }], Vec3::ZERO, None);
        let mut recorder = Recorder::new(&self.device, &self.queue);
        gi.light(&mut recorder, &lights, bounces, &TraceSettings::default()).expect("valid");
        recorder.submit();
    }

    /// Compares with a new object for the same scene and light.
    fn assert_fresh(
        &self,
        gi: &Gi,
        place: Mat4,
        bounces: u32,
        lamp: Vec3,
        shadow: Shadow,
        what: &str,
    ) {
        let mut fresh = self.gi();
        let geometry = moved(&self.geometry, place);
        pollster::block_on(fresh.voxelize(&geometry, Timing::Off)).expect("there are voxels");
        self.light(&mut fresh, bounces, lamp, shadow);
        let is_octree = matches!(self.config.volume, VolumeKind::Octree);
        if is_octree && (bounces > 1 || shadow == Shadow::Cone) {
            let [own, fresh] = [gi, &fresh].map(|gi| self.radiance(gi));
            let largest = fresh.iter().flatten().fold(0.0_f32, |a, b| a.max(*b));
            let pairs = || own.iter().flatten().zip(fresh.iter().flatten());
            let off = pairs().filter(|(a, b)| (*a - *b).abs() > 1e-5 * largest).count();
            // A last bit may change whether a cone continues.
            assert!(off * 100 < pairs().count(), "{what}: {off} values differ");
            let sum = |light: &[[f32; 4]]| light.iter().flatten().copied().map(f64::from).sum();
            let [a, b]: [f64; 2] = [sum(&own), sum(&fresh)];
            assert!((a / b - 1.0).abs() < 1e-4, "{what}: the mean differs by {}", a / b - 1.0);
            return;
        }
        self.assert_same(gi, &fresh, what);
    }

    fn radiance(&self, gi: &Gi) -> Vec<[f32; 4]> {
        let count = gi.voxels().expect("there are voxels").face_count as usize;
        read(&self.device, &self.queue, gi.face_radiance().expect("there is light"), count)
    }

    /// Compares the buffers of two objects.
    fn assert_same(&self, gi: &Gi, other: &Gi, what: &str) {
        let radiance = |gi: &Gi| -> Vec<[u32; 4]> {
            self.radiance(gi).iter().map(|light| light.map(f32::to_bits)).collect()
        };
        assert!(radiance(gi) == radiance(other), "{what}: the faces' light differs");
        if matches!(self.config.volume, VolumeKind::Octree) {
            let nodes = |gi: &Gi| read_nodes(&self.device, &self.queue, gi);
            assert!(nodes(gi) == nodes(other), "{what}: nodes, masks or bricks differ");
            return;
        }
        let levels = read_levels(&self.device, &self.queue, gi);
        let expected = read_levels(&self.device, &self.queue, other);
        for (level, (a, b)) in levels.iter().zip(&expected).enumerate() {
            assert!(a.lobes == b.lobes, "{what}: lobes of level {level} differ");
            assert!(a.tilts == b.tilts, "{what}: tilts of level {level} differ");
        }
    }

    /// The number of cells of all levels that the last update wrote, and of occupied ones.
    fn changed(&self, gi: &Gi) -> (u32, u32) {
        let occupancy = &gi.voxels().expect("there are voxels").occupancy;
        let words = occupancy.size() as usize / 4;
        let count = |buffer: &wgpu::Buffer| {
            let bits: Vec<u32> = read(&self.device, &self.queue, buffer, words);
            bits.iter().map(|word| word.count_ones()).sum()
        };
        (count(gi.changed_cells().expect("there is a list")), count(occupancy))
    }
}

fn at(x: f32, y: f32, z: f32) -> Mat4 {
    Mat4::from_translation(Vec3::new(x, y, z))
}

const LAMP: Vec3 = Vec3::new(0.2, 0.4, 0.7);

/// Moves in the air, a little farther, into a wall, onto the plate, half outside, far outside
/// (gone), and back; lit directly, with bounces, directly again; with and without cone shadows.
fn check_moves(volume: VolumeKind, directionality: Directionality, shadow: Shadow) {
    let stage = Stage::new(volume, directionality);
    let [mut gi, mut whole] = [stage.gi(), stage.gi()];
    let places = [
        at(0.3, 0.4, 0.6),
        at(0.32, 0.41, 0.6),
        at(0.0, 0.4, 0.6),
        at(0.4, 0.3, 0.3),
        at(1.0, 0.7, 0.9),
        at(50.0, 0.0, 0.0),
        at(0.3, 0.4, 0.6),
    ];
    for (step, place) in places.into_iter().enumerate() {
        let bounces = [1, 1, 1, 2, 1, 1, 1][step];
        stage.voxelize(&mut gi, place);
        stage.light(&mut gi, bounces, LAMP, shadow);
        let what = format!("{volume:?}, {directionality:?}, {shadow:?}, step {step}");
        stage.assert_fresh(&gi, place, bounces, LAMP, shadow, &what);
        let geometry = moved(&stage.geometry, place);
        pollster::block_on(whole.voxelize(&geometry, Timing::Off)).expect("there are voxels");
        whole.forget_light();
        stage.light(&mut whole, bounces, LAMP, shadow);
        stage.assert_same(&gi, &whole, &format!("{what}, against everything"));
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_moved_dense_volume_equals_a_fresh_one() {
    check_moves(VolumeKind::Dense, Directionality::SixLobes, Shadow::Cone);
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_moved_isotropic_volume_equals_a_fresh_one() {
    check_moves(VolumeKind::Dense, Directionality::Isotropic, Shadow::None);
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_moved_octree_equals_a_fresh_one() {
    check_moves(VolumeKind::Octree, Directionality::SixLobes, Shadow::Cone);
    check_moves(VolumeKind::Octree, Directionality::Isotropic, Shadow::None);
}

/// Lists are replaced before they are lit, and light changes while the list does not.
#[test]
#[ignore = "slow: over three seconds"]
fn calls_in_any_order_equal_a_fresh_volume() {
    check_any_order(VolumeKind::Dense);
    check_any_order(VolumeKind::Octree);
}

fn check_any_order(volume: VolumeKind) {
    let stage = Stage::new(volume, Directionality::SixLobes);
    let mut gi = stage.gi();
    let (here, there, none) = (at(0.3, 0.4, 0.6), at(0.5, 0.2, 0.2), Shadow::None);
    stage.voxelize(&mut gi, here);
    stage.voxelize(&mut gi, there);
    stage.light(&mut gi, 1, LAMP, none);
    stage.assert_fresh(&gi, there, 1, LAMP, none, "two lists before the first light");
    stage.voxelize(&mut gi, here);
    stage.voxelize(&mut gi, at(0.7, 0.5, 0.4));
    stage.voxelize(&mut gi, there);
    stage.light(&mut gi, 1, LAMP, none);
    stage.assert_fresh(&gi, there, 1, LAMP, none, "there and back without light");
    let lamp = Vec3::new(0.8, 0.2, 0.3);
    stage.light(&mut gi, 1, lamp, none);
    stage.assert_fresh(&gi, there, 1, lamp, none, "another lamp");
    stage.light(&mut gi, 1, LAMP, none);
    stage.assert_fresh(&gi, there, 1, LAMP, none, "the first lamp again");
    stage.light(&mut gi, 3, lamp, none);
    stage.voxelize(&mut gi, here);
    stage.light(&mut gi, 0, lamp, Shadow::Cone);
    stage.assert_fresh(&gi, here, 0, lamp, Shadow::Cone, "after bounces");
    gi.forget_light();
    stage.light(&mut gi, 0, lamp, Shadow::Cone);
    let (changed, occupied) = stage.changed(&gi);
    assert_eq!(changed, occupied, "what is forgotten is stored");
    stage.assert_fresh(&gi, here, 0, lamp, Shadow::Cone, "forgotten");
}

#[test]
fn a_small_change_writes_few_cells() {
    let stage = Stage::new(VolumeKind::Dense, Directionality::SixLobes);
    let mut gi = stage.gi();
    stage.voxelize(&mut gi, at(0.3, 0.4, 0.6));
    stage.light(&mut gi, 1, LAMP, Shadow::None);
    let (changed, occupied) = stage.changed(&gi);
    assert_eq!(changed, occupied, "at first everything is new");
    stage.light(&mut gi, 1, LAMP, Shadow::None);
    assert_eq!(stage.changed(&gi).0, 0, "nothing has changed");
    stage.voxelize(&mut gi, at(0.32, 0.4, 0.6));
    stage.light(&mut gi, 1, LAMP, Shadow::None);
    let (changed, occupied) = stage.changed(&gi);
    assert!((10..occupied / 4).contains(&changed), "a small move changed {changed} of {occupied}");
    stage.light(&mut gi, 1, Vec3::new(0.8, 0.2, 0.3), Shadow::None);
    let (changed, occupied) = stage.changed(&gi);
    assert!((10..occupied).contains(&changed), "the lamp changed {changed} of {occupied}");
    stage.light(&mut gi, 2, LAMP, Shadow::None);
    let (changed, occupied) = stage.changed(&gi);
    assert!((10..=occupied).contains(&changed), "a bounce changed {changed} of {occupied}");
}
