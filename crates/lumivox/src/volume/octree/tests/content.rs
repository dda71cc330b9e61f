//! Checks the content of bricks, and the light that cones find in them.

use glam::UVec3;

use super::read::{read_nodes, texel};
use super::*;
use crate::testing::{busy_room, read};
use crate::volume::{Level, read_levels};

const DIRECTIONALITIES: [Directionality; 2] = [Directionality::SixLobes, Directionality::Isotropic];

fn config(volume: VolumeKind, directionality: Directionality) -> GiConfig {
    GiConfig { directionality, volume, keeps_cells: true, ..GiConfig::new(odd_grid()) }
}

/// A part of a cell of the dense volume: zero outside of the grid.
fn dense_part(level: &Level, cell: UVec3, part: u32, directionality: Directionality) -> [f32; 4] {
    if cell.cmpge(level.dimensions).any() {
        return [0.0; 4];
    }
    let UVec3 { x, y, .. } = level.dimensions;
    let index = ((cell.z * y + cell.y) * x + cell.x) as usize;
    match (directionality, part % 3) {
        (Directionality::Isotropic, _) => level.lobes[0][index],
        (_, 0) => level.tilts[part as usize / 3][index],
        (_, side) => level.lobes[2 * (part as usize / 3) + side as usize - 1][index],
    }
}

/// Half floats have 11 bits, and a GPU may round up or down (NVIDIA's round down): each of four
/// levels has a relative error of at most 2^-10 in one of the two volumes.
fn is_near(a: [f32; 4], b: [f32; 4], absolute: f32) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() <= absolute + b.abs() * 2.0_f32.powi(-8))
}

#[test]
#[ignore = "slow: over three seconds"]
fn bricks_hold_the_cells_of_the_dense_volume_and_their_neighbours() {
    for directionality in DIRECTIONALITIES {
        let gpu = device();
        let geometry = turned_room(&gpu.0);
        let mut dense =
            voxelize(&gpu, config(VolumeKind::Dense, directionality), &geometry).expect("it fits");
        light(&gpu, &mut dense, 1);
        let volume = VolumeKind::Octree;
        let mut sparse =
            voxelize(&gpu, config(volume, directionality), &geometry).expect("it fits");
        light(&gpu, &mut sparse, 1);
        let levels = read_levels(&gpu.0, &gpu.1, &dense);
        let nodes = read_nodes(&gpu.0, &gpu.1, &sparse);
        let mut compared = 0;
        for ((level, at), node) in &nodes {
            for (part, brick) in &node.bricks {
                let cells = &levels[*level as usize - 1];
                for i in 0..27 {
                    let offset = UVec3::new(i % 3, (i / 3) % 3, i / 9);
                    let cell = 2 * UVec3::from_array(*at) + offset;
                    let expected = dense_part(cells, cell, *part, directionality);
                    let actual = texel(brick, offset);
                    // Tilts that are too small for a mask are not stored.
                    let absolute = if part % 3 == 0 { 1.0 / 127.0 } else { 1e-6 };
                    assert!(
                        is_near(actual, expected, absolute),
                        "level {level}, node {at:?}, part {part}, texel {offset}: {actual:?}, \
                         but dense has {expected:?}"
                    );
                    compared += usize::from(expected[3] > 0.0);
                }
            }
        }
        assert!(compared > 10_000, "only {compared} texels had something in them");
        let bricks: usize = nodes.values().map(|node| node.bricks.len()).sum();
        let stats = sparse.octree_stats().expect("an octree");
        assert_eq!(stats.bricks as usize, bricks, "each part of a node has one brick");
        // Nothing is missing: every cell with a lobe has a brick of it.
        let parts: &[u32] =
            if directionality == Directionality::Isotropic { &[0] } else { &[1, 2, 4, 5, 7, 8] };
        for (level, cells) in levels.iter().enumerate() {
            let UVec3 { x, y, z } = cells.dimensions;
            for index in 0..x * y * z {
                let cell = UVec3::new(index % x, (index / x) % y, index / (x * y));
                for part in parts {
                    if dense_part(cells, cell, *part, directionality)[3] > 0.0 {
                        let at = (level as u32 + 1, (cell / 2).to_array());
                        assert!(nodes[&at].bricks.contains_key(part), "{at:?} lacks part {part}");
                    }
                }
            }
        }
    }
}

#[test]
fn bounces_agree_with_the_dense_volume() {
    for directionality in DIRECTIONALITIES {
        let gpu = device();
        let geometry = turned_room(&gpu.0);
        let radiance = |volume| {
            let mut gi =
                voxelize(&gpu, config(volume, directionality), &geometry).expect("it fits");
            light(&gpu, &mut gi, 4);
            let faces = gi.voxels().expect("there are voxels").face_count as usize;
            read::<[f32; 4]>(&gpu.0, &gpu.1, gi.face_radiance().expect("it is lit"), faces)
        };
        let dense = radiance(VolumeKind::Dense);
        let sparse = radiance(VolumeKind::Octree);
        let luminance = |texel: &[f32; 4]| f64::from(texel[0] + texel[1] + texel[2]) / 3.0;
        let mean = dense.iter().map(luminance).sum::<f64>() / dense.len() as f64;
        let difference = |pair: (&[f32; 4], &[f32; 4])| luminance(pair.0) - luminance(pair.1);
        let pairs = || dense.iter().zip(&sparse).map(difference);
        let bias = pairs().sum::<f64>() / dense.len() as f64 / mean;
        let rms = (pairs().map(|d| d * d).sum::<f64>() / dense.len() as f64).sqrt() / mean;
        assert!(bias.abs() < 1e-3, "{directionality:?}: the mean differs by {bias}");
        assert!(rms < 4e-3, "{directionality:?}: faces differ by {rms}");
    }
}

#[test]
fn revoxelizing_leaves_nothing_of_the_former_octree() {
    let gpu = device();
    let geometry = turned_room(&gpu.0);
    let config = config(VolumeKind::Octree, Directionality::SixLobes);
    let mut reused = voxelize(&gpu, config.clone(), &busy_room().build(&gpu.0)).expect("it fits");
    light(&gpu, &mut reused, 2);
    pollster::block_on(reused.voxelize(&geometry, Timing::Off)).expect("it fits");
    // The places of bricks differ, which affects the last bits of cones' samples.
    light(&gpu, &mut reused, 1);
    let mut fresh = voxelize(&gpu, config, &geometry).expect("it fits");
    light(&gpu, &mut fresh, 1);
    assert!(
        read_nodes(&gpu.0, &gpu.1, &reused) == read_nodes(&gpu.0, &gpu.1, &fresh),
        "the octrees differ"
    );
}

#[test]
fn volumes_beyond_the_memory_budget_are_refused() {
    let gpu = device();
    let geometry = turned_room(&gpu.0);
    for volume in [VolumeKind::Dense, VolumeKind::Octree] {
        let config =
            GiConfig { memory_budget: Some(1 << 20), ..config(volume, Directionality::SixLobes) };
        let error = voxelize(&gpu, config, &geometry).expect_err("it needs more than a mebibyte");
        let GiError::Budget { needed, budget, remedy, .. } = &error else {
            panic!("{error}");
        };
        assert_eq!(*budget, 1 << 20);
        assert!(*needed > 1 << 20, "{error}");
        assert!(remedy.contains("set the resolution to about"), "{error}");
    }
}

#[test]
fn a_failed_revoxelization_keeps_the_earlier_voxels() {
    let gpu = device();
    let small = SceneBuilder::default()
        .quad(Vec3::splat(0.3), Vec3::X * 0.2, Vec3::Y * 0.2, lambert(0.5, 1.0))
        .build(&gpu.0);
    let config = GiConfig {
        memory_budget: Some(1 << 20),
        ..config(VolumeKind::Octree, Directionality::SixLobes)
    };
    let mut gi = voxelize(&gpu, config, &small).expect("a small thing fits");
    light(&gpu, &mut gi, 1);
    let before = read_nodes(&gpu.0, &gpu.1, &gi);
    let room = turned_room(&gpu.0);
    pollster::block_on(gi.voxelize(&room, Timing::Off)).expect_err("the room does not");
    light(&gpu, &mut gi, 1);
    assert!(before == read_nodes(&gpu.0, &gpu.1, &gi), "the small thing is no longer there");
}
