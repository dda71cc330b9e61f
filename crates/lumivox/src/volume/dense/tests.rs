//! Compares storing and filtering with plain loops.

use glam::{UVec3, Vec3};
use half::f16;

use super::Directionality;
use crate::gpu::{Pipelines, Recorder, Timing};
use crate::testing::{busy_room, device, read, read_level};
use crate::volume::CellVolume;
use crate::voxels::FaceRecord;
use crate::{Gi, GiConfig, Grid, TraceSettings};

/// A level of the pyramid, read back: lobes (rgb premultiplied, opacity) and tilts.
pub(crate) struct Level {
    pub(crate) dimensions: UVec3,
    pub(crate) lobes: Vec<Vec<[f32; 4]>>,
    pub(crate) tilts: Vec<Vec<[f32; 4]>>,
}

impl Level {
    fn index(&self, cell: UVec3) -> usize {
        ((cell.z * self.dimensions.y + cell.y) * self.dimensions.x + cell.x) as usize
    }

    fn cells(&self) -> impl Iterator<Item = UVec3> + use<> {
        let UVec3 { x, y, z } = self.dimensions;
        (0..z).flat_map(move |z| (0..y).flat_map(move |y| (0..x).map(move |x| UVec3::new(x, y, z))))
    }
}

fn lit_room(resolution: u32, directionality: Directionality) -> (Pipelines, wgpu::Queue, Gi) {
    let (device, queue) = device();
    let grid =
        Grid::fit(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), resolution, Vec3::ZERO).expect("fits");
    let mut gi = Gi::with_pipelines(
        &device,
        &queue,
        GiConfig { directionality, keeps_cells: true, ..GiConfig::new(grid) },
    )
    .expect("a device");
    let geometry = busy_room().build(&device);
    pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let lights = gi.bind_lights(&[], Vec3::ZERO, None);
    let mut recorder = Recorder::new(&device, &queue);
    gi.light(&mut recorder, &lights, 2, &TraceSettings::default()).expect("valid settings");
    recorder.submit();
    (device, queue, gi)
}

pub(crate) fn read_levels(device: &wgpu::Device, queue: &wgpu::Queue, gi: &Gi) -> Vec<Level> {
    (0..gi.grid().levels).map(|level| read_parts(device, queue, gi, level)).collect()
}

/// Reads the parts of all cells of a level from the atlas.
fn read_parts(device: &wgpu::Device, queue: &wgpu::Queue, gi: &Gi, level: u32) -> Level {
    let Some(CellVolume::Dense(dense)) = gi.cells() else { panic!("it is dense") };
    let texels: Vec<[f32; 4]> = read_level::<[u16; 4]>(device, queue, dense.texture(), level)
        .iter()
        .map(|texel| texel.map(|bits| f16::from_bits(bits).to_f32()))
        .collect();
    let dimensions = gi.grid().level_dimensions(level);
    let UVec3 { x: width, y: height, z: depth } = dimensions;
    let rows = texels.len() as u32 / (width * depth);
    let part = |y_slab: u32, z_slab: u32| -> Vec<[f32; 4]> {
        (0..depth)
            .flat_map(|z| (0..height).flat_map(move |y| (0..width).map(move |x| (x, y, z))))
            .map(|(x, y, z)| {
                let (y, z) = (y + y_slab * height, z + z_slab * depth);
                // An isotropic texture has one slab; one with six lobes three along y.
                let rows = if rows == height { height } else { 3 * height };
                texels[((z * rows + y) * width + x) as usize]
            })
            .collect()
    };
    if rows == height {
        return Level { dimensions, lobes: vec![part(0, 0)], tilts: Vec::new() };
    }
    Level {
        dimensions,
        lobes: (0..6).map(|lobe| part(1 + lobe % 2, lobe / 2)).collect(),
        tilts: (0..3).map(|axis| part(0, axis)).collect(),
    }
}

/// Half floats have 11 bits; sums may differ in their last bits before rounding.
fn assert_near(actual: [f32; 4], expected: [f32; 4], absolute: f32, what: &str) {
    for (a, e) in actual.iter().zip(expected) {
        let tolerance = absolute + e.abs() * 2.0_f32.powi(-10);
        assert!((a - e).abs() <= tolerance, "{what}: {actual:?}, but expected {expected:?}");
    }
}

#[test]
fn finest_level_holds_the_faces_and_nothing_else() {
    let (device, queue, gi) = lit_room(32, Directionality::SixLobes);
    let voxels = gi.voxels().expect("there are voxels");
    let level = &read_levels(&device, &queue, &gi)[0];
    let faces: Vec<FaceRecord> = read(&device, &queue, &voxels.faces, voxels.face_count as usize);
    let radiance: Vec<[f32; 4]> = read(
        &device,
        &queue,
        gi.face_radiance().expect("there is light"),
        voxels.face_count as usize,
    );
    let mut expected = vec![vec![[0.0_f32; 4]; level.lobes[0].len()]; 6];
    let mut tilts = vec![vec![[0.0_f32; 4]; level.lobes[0].len()]; 3];
    for (face, radiance) in faces.iter().zip(&radiance) {
        let (lobe, axis) = (face.lobe as usize, face.lobe as usize / 2);
        let cell = crate::testing::morton_decode(face.cell);
        let opacity = face.vector_area[axis].abs();
        let [r, g, b, _] = radiance.map(|value| value * opacity);
        expected[lobe][level.index(cell)] = [r, g, b, opacity];
        let tilt = &mut tilts[axis][level.index(cell)];
        let side = 2 * (lobe % 2);
        tilt[side] = face.vector_area[(axis + 1) % 3];
        tilt[side + 1] = face.vector_area[(axis + 2) % 3];
    }
    for cell in level.cells() {
        let index = level.index(cell);
        for (lobe, expected) in expected.iter().enumerate() {
            assert_near(level.lobes[lobe][index], expected[index], 1e-6, "lobe");
        }
        for (axis, expected) in tilts.iter().enumerate() {
            assert_near(level.tilts[axis][index], expected[index], 1e-6, "tilt");
        }
    }
}

/// The rule of `filter.wgsl`, with the same loops.
fn filter_twin(finer: &Level, cell: UVec3, lobe: usize) -> ([f32; 4], [f32; 2]) {
    let axis = lobe / 2;
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let side = 2 * (lobe % 2);
    let (mut sum, mut tilt) = ([0.0; 4], [0.0; 2]);
    for column in 0..4_u32 {
        let mut low = 2 * cell;
        low[u] += column & 1;
        low[v] += column >> 1;
        let mut high = low;
        high[axis] += 1;
        let (near, far) = if lobe.is_multiple_of(2) { (high, low) } else { (low, high) };
        let (near, far) = (finer.index(near), finer.index(far));
        let (n, f) = (finer.lobes[lobe][near], finer.lobes[lobe][far]);
        let share = if f[3] > 0.0 { f[3].min(1.0 - n[3]) / f[3] } else { 0.0 };
        for i in 0..4 {
            sum[i] += 0.25 * (n[i] + share * f[i]);
        }
        for (i, tilt) in tilt.iter_mut().enumerate() {
            let parts = &finer.tilts[axis];
            *tilt += 0.25 * (parts[near][side + i] + share * parts[far][side + i]);
        }
    }
    (sum, tilt)
}

#[test]
fn mip_levels_match_the_cpu_twin() {
    let (device, queue, gi) = lit_room(32, Directionality::SixLobes);
    let levels = read_levels(&device, &queue, &gi);
    let mut filled = 0;
    for pair in levels.windows(2) {
        let (finer, coarser) = (&pair[0], &pair[1]);
        for cell in coarser.cells() {
            let index = coarser.index(cell);
            for lobe in 0..6 {
                let (expected, tilt) = filter_twin(finer, cell, lobe);
                assert_near(coarser.lobes[lobe][index], expected, 1e-6, "filtered lobe");
                filled += usize::from(expected[3] > 0.0);
                let actual = coarser.tilts[lobe / 2][index];
                let side = 2 * (lobe % 2);
                let actual = [actual[side], actual[side + 1], 0.0, 0.0];
                assert_near(actual, [tilt[0], tilt[1], 0.0, 0.0], 1e-6, "filtered tilt");
            }
        }
    }
    assert!(filled > 100, "only {filled} filtered lobes were compared");
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_new_voxel_list_clears_the_old_content() {
    let (device, queue, mut gi) = lit_room(32, Directionality::SixLobes);
    // Moves the room by some voxels: its first place must be empty.
    let shift = glam::Mat4::from_scale_rotation_translation(
        Vec3::splat(0.5),
        glam::Quat::IDENTITY,
        Vec3::new(0.13, 0.11, 0.17),
    );
    let geometry = busy_room().transformed(shift).build(&device);
    pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let lights = gi.bind_lights(&[], Vec3::ZERO, None);
    let mut recorder = Recorder::new(&device, &queue);
    gi.light(&mut recorder, &lights, 2, &TraceSettings::default()).expect("valid settings");
    recorder.submit();

    let config = GiConfig { keeps_cells: true, ..GiConfig::new(*gi.grid()) };
    let mut fresh = Gi::new(&device, &queue, config).expect("a device");
    pollster::block_on(fresh.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let mut recorder = Recorder::new(&device, &queue);
    fresh.light(&mut recorder, &lights, 2, &TraceSettings::default()).expect("valid settings");
    recorder.submit();

    let reused = read_levels(&device, &queue, &gi);
    for (level, (a, b)) in reused.iter().zip(read_levels(&device, &queue, &fresh)).enumerate() {
        assert!(a.lobes == b.lobes, "lobes of level {level} differ from a fresh volume's");
        assert!(a.tilts == b.tilts, "tilts of level {level} differ from a fresh volume's");
    }
}

/// Cells of the finest level contain the voxel's area of surface, one at most, and the mean of its
/// light; each coarser cell is the mean of eight.
#[test]
fn isotropic_levels_are_means() {
    let (device, queue, gi) = lit_room(32, Directionality::Isotropic);
    let levels = read_levels(&device, &queue, &gi);
    let voxels = gi.voxels().expect("there are voxels");
    let count = voxels.face_count as usize;
    let faces: Vec<FaceRecord> = read(&device, &queue, &voxels.faces, count);
    let buffer = gi.face_radiance().expect("there is light");
    let radiance: Vec<[f32; 4]> = read(&device, &queue, buffer, count);
    let mut sums = vec![[0.0_f32; 4]; levels[0].lobes[0].len()];
    for (face, [r, g, b, _]) in faces.iter().zip(&radiance) {
        let cell = crate::testing::morton_decode(face.cell);
        let area = Vec3::from(face.vector_area).length();
        let sum = &mut sums[levels[0].index(cell)];
        *sum = std::array::from_fn(|i| sum[i] + area * [r, g, b, &1.0][i]);
    }
    let crowded = sums.iter().filter(|sum| sum[3] > 1.2).count();
    assert!(crowded > 10, "only {crowded} voxels have more than one side of surface");
    for (texel, sum) in levels[0].lobes[0].iter().zip(&sums) {
        assert_near(*texel, sum.map(|value| value / sum[3].max(1.0)), 1e-6, "finest");
    }
    for pair in levels.windows(2) {
        for cell in pair[1].cells() {
            let mut mean = [0.0; 4];
            for child in 0..8 {
                let corner = UVec3::new(child & 1, (child >> 1) & 1, child >> 2);
                let texel = pair[0].lobes[0][pair[0].index(2 * cell + corner)];
                for i in 0..4 {
                    mean[i] += 0.125 * texel[i];
                }
            }
            assert_near(pair[1].lobes[0][pair[1].index(cell)], mean, 1e-6, "mean");
        }
    }
}
