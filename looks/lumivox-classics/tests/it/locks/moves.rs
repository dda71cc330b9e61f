//! Octrees built by locks and by ranks, through the same moves.
//!
//! Lumivox's own tests compare an octree built by ranks with a new one after each move. If the
//! octree built by locks equals it to the bit, that is enough.

use glam::{Mat4, Vec3};
use lumivox::gpu::{Pipelines, Recorder, Timing};
use lumivox::{
    Geometry, Gi, GiConfig, Grid, Light, LightSource, Shadow, TraceSettings, VolumeKind,
};

use super::read::read_bricks;
use super::{by_locks, by_ranks, radiance, voxels_of};
use crate::testing::{device, moved, room_with_a_box, wait_until_read};

/// Two octrees, by ranks and by locks.
struct Pair {
    gpu: (Pipelines, wgpu::Queue),
    gis: [Gi; 2],
}

impl Pair {
    fn new() -> Self {
        let gpu = device();
        let size = Vec3::new(1.0, 0.7, 0.9);
        let grid = Grid::fit(Vec3::ZERO, size, 32, Vec3::ZERO).expect("it fits");
        let gis = [by_ranks(grid), by_locks(grid)].map(|config| {
            let config = GiConfig { volume: VolumeKind::Octree, ..config };
            Gi::with_pipelines(&gpu.0, &gpu.1, config).expect("a device")
        });
        Self { gpu, gis }
    }

    /// Voxelizes, and waits for the list.
    fn voxelize(&mut self, geometry: &Geometry) {
        for gi in &mut self.gis {
            let work = gi.voxelize_dynamic(geometry, Timing::Off);
            pollster::block_on(work).expect("there are voxels");
        }
    }

    /// Records frames until the list fits, and its counts are known.
    fn record(&mut self, geometry: &Geometry) {
        let (device, queue) = &self.gpu;
        for gi in &mut self.gis {
            let mut in_time = 0;
            for _ in 0..16 {
                let mut recorder = Recorder::new(device, queue);
                gi.frame(&mut recorder, voxels_of(geometry, &TraceSettings::default()))
                    .expect("it fits");
                recorder.submit();
                wait_until_read(device, gi);
                in_time = if gi.status().is_late { 0 } else { in_time + 1 };
                // The second such frame has applied the counts of the first.
                if in_time == 2 {
                    break;
                }
            }
            assert_eq!(in_time, 2, "it never has room");
        }
    }

    /// Lights both octrees, and compares their whole content.
    fn assert_alike(&mut self, bounces: u32, shadow: Shadow, what: &str) {
        let (device, queue) = &self.gpu;
        let source = LightSource::Point {
            position: Vec3::new(0.2, 0.4, 0.7),
            intensity: Vec3::new(1.0, 2.0, 3.0),
            radius_m: 0.02,
            range_m: None,
        };
        for gi in &mut self.gis {
            let lights = gi.bind_lights(&[Light { source, shadow }], Vec3::ZERO, None);
            let mut recorder = Recorder::new(device, queue);
            gi.light(&mut recorder, &lights, bounces, &TraceSettings::default()).expect("valid");
            recorder.submit();
        }
        let [ranked, locked] = &self.gis;
        let light = radiance(&self.gpu, ranked);
        assert!(light.iter().any(|face| face[0] != 0), "{what}: there is no light");
        let other = radiance(&self.gpu, locked);
        assert_eq!(light.len(), other.len(), "{what}: the numbers of faces by ranks and by locks");
        let differing = light.iter().zip(&other).position(|(light, other)| light != other);
        assert_eq!(differing, None, "{what}: the first face whose light differs");
        let nodes = |gi: &Gi| read_bricks(&self.gpu, gi);
        assert!(nodes(ranked) == nodes(locked), "{what}: nodes, masks or bricks differ");
    }
}

fn at(x: f32, y: f32, z: f32) -> Mat4 {
    Mat4::from_translation(Vec3::new(x, y, z))
}

/// In the air, a little farther, into a wall, onto the plate, half outside, far outside (gone), and
/// back. Cones see the same, since bricks are in the same places.
#[test]
#[ignore = "slow: over three seconds"]
fn blocking_moves_give_equal_bits_with_both_builders() {
    let mut pair = Pair::new();
    let geometry = room_with_a_box().build(&pair.gpu.0);
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
        pair.voxelize(&moved(&geometry, place));
        let (bounces, shadow) = if step % 2 == 0 { (1, Shadow::None) } else { (2, Shadow::Cone) };
        pair.assert_alike(bounces, shadow, &format!("step {step}"));
    }
}

/// From nothing, through walls, out of the grid and back; without the moving box, without the
/// static room, with nothing at all. Without cones: a late octree may skip any list, so bricks may
/// be in other places.
#[test]
#[ignore = "slow: over three seconds"]
fn moves_within_frames_give_equal_bits_with_both_builders() {
    let mut pair = Pair::new();
    let geometry = room_with_a_box().build(&pair.gpu.0);
    let only = |is_static: bool| {
        let mut geometry = geometry.clone();
        geometry.batches[0].draws.retain(|draw| draw.is_static == is_static);
        moved(&geometry, at(0.5, 0.3, 0.4))
    };
    let mut nothing = geometry.clone();
    nothing.batches[0].draws.clear();
    for (what, geometry) in [
        ("in the air", moved(&geometry, at(0.3, 0.4, 0.6))),
        ("a little on", moved(&geometry, at(0.32, 0.41, 0.6))),
        ("in a wall", moved(&geometry, at(0.0, 0.4, 0.6))),
        ("outside", moved(&geometry, at(50.0, 0.0, 0.0))),
        ("not a number", moved(&geometry, Mat4::from_translation(Vec3::NAN))),
        ("back", moved(&geometry, at(0.3, 0.4, 0.6))),
        ("only the room", only(true)),
        ("only the box", only(false)),
        ("both", geometry.clone()),
        ("nothing", nothing),
        ("after nothing", moved(&geometry, at(0.5, 0.3, 0.4))),
    ] {
        pair.record(&geometry);
        if what == "nothing" {
            let voxels = pair.gis.each_ref().map(|gi| gi.voxels().expect("a list").voxel_count());
            assert_eq!(voxels, [0, 0]);
            continue;
        }
        pair.assert_alike(1, Shadow::None, what);
    }
}
