use glam::{UVec3, Vec3};
use lumivox_scene::builtin;

use super::*;

fn grid() -> ProbeGrid {
    ProbeGrid { min: Vec3::ZERO, size: Vec3::new(2.0, 3.0, 4.0), cells: UVec3::new(2, 3, 4) }
}

/// Light whose values encode the probe and the direction.
fn numbered(probe: usize) -> [Vec3; 6] {
    std::array::from_fn(|side| std::f32::consts::PI * Vec3::new(probe as f32, side as f32, 7.0))
}

#[test]
fn probes_are_in_the_middles_of_cells() {
    let probes = grid().probes();
    assert_eq!(probes.len(), 24);
    assert_eq!(
        probes[..3],
        [Vec3::new(0.5, 0.5, 0.5), Vec3::new(1.5, 0.5, 0.5), Vec3::new(0.5, 1.5, 0.5)]
    );
    assert_eq!(probes[23], Vec3::new(1.5, 2.5, 3.5));
    assert_eq!(
        ProbeGrid::over(Vec3::ZERO, Vec3::new(2.0, 0.1, 4.9), 1.0).cells,
        UVec3::new(2, 1, 5)
    );
}

#[test]
fn probes_and_directions_follow_bevys_file_layout() {
    let irradiance: Vec<[Vec3; 6]> = (0..24).map(numbered).collect();
    let volume = IrradianceVolume::new(grid(), &irradiance, &[false; 24]);
    let (bytes, intensity) = volume.to_ktx2();
    assert!((intensity - 1.0).abs() < 1e-9);
    let file = ktx2::Reader::new(&bytes).unwrap();
    let header = file.header();
    assert_eq!((header.pixel_width, header.pixel_height, header.pixel_depth), (2, 6, 12));
    assert_eq!(header.format, Some(ktx2::Format::R16G16B16A16_SFLOAT));
    assert_eq!(file.writer().map(|name| name.trim_end_matches('\0')), Some("Lumivox"));
    let level = file.levels().next().unwrap();
    let texel = |x: u32, y: u32, z: u32| -> [f32; 4] {
        let at = 8 * ((z * 6 + y) * 2 + x) as usize;
        std::array::from_fn(|channel| {
            let bytes = &level.data[at + 2 * channel..at + 2 * channel + 2];
            half::f16::from_le_bytes(bytes.try_into().unwrap()).to_f32()
        })
    };
    // The last probe is (1, 2, 3); its six directions, by axis and sign.
    for (side, (y, z)) in [(2, 3), (5, 3), (2, 7), (5, 7), (2, 11), (5, 11)].into_iter().enumerate()
    {
        assert_eq!(texel(1, y, z), [23.0, side as f32, 7.0, 1.0], "{side}");
    }
}

#[test]
fn values_beyond_half_floats_are_scaled() {
    let sun = [Vec3::splat(1e6 * std::f32::consts::PI); 6];
    let volume = IrradianceVolume::new(grid(), &[sun; 24], &[false; 24]);
    let (bytes, intensity) = volume.to_ktx2();
    let level = ktx2::Reader::new(&bytes).unwrap().levels().next().unwrap().data.to_vec();
    let value = half::f16::from_le_bytes([level[0], level[1]]).to_f32() * intensity;
    assert!((value / 1e6 - 1.0).abs() < 1e-3, "{value}");
}

#[test]
fn buried_probes_copy_light_from_free_neighbours() {
    // Three probes in a corner of the first layer.
    let mut solid = [false; 24];
    (solid[0], solid[1], solid[2]) = (true, true, true);
    let light = |probe: usize| {
        if solid[probe] { [Vec3::ZERO; 6] } else { [Vec3::splat(std::f32::consts::PI); 6] }
    };
    let volume = IrradianceVolume::new(grid(), &(0..24).map(light).collect::<Vec<_>>(), &solid);
    assert!(volume.light().iter().flatten().all(|light| light.abs_diff_eq(Vec3::ONE, 1e-6)));
    let none = IrradianceVolume::new(grid(), &[[Vec3::ONE; 6]; 24], &[true; 24]);
    assert!(none.light().iter().flatten().all(|light| *light == Vec3::ZERO));
}

#[test]
fn points_inside_solid_objects_count_as_buried() {
    let scene = builtin::scene("cornell").unwrap();
    let (short, tall) = (Vec3::new(0.33, 0.3, 0.4), Vec3::new(-0.33, 0.6, -0.25));
    let (air, above, outside) =
        (Vec3::new(0.0, 1.8, 0.8), Vec3::new(0.33, 0.7, 0.4), Vec3::new(0.0, 1.0, 9.0));
    assert_eq!(
        buried(&scene, &[short, tall, air, above, outside]),
        [true, true, false, false, false]
    );
}
