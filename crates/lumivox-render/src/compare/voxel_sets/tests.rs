use glam::{UVec2, UVec3, Vec3};
use lumivox::Grid;
use lumivox_scene::Camera;

use super::*;

const RED: Vec3 = Vec3::new(0.8, 0.1, 0.1);

/// A grid of 16 voxels of 1 m with its corner at the world's origin.
fn grid() -> Grid {
    let (dimensions, levels) = (UVec3::splat(16), 3);
    Grid { origin_in_world: Vec3::ZERO, voxel_size_m: 1.0, dimensions, levels, cascades: None }
}

fn set(voxels: &[([u32; 3], Vec3, f32)]) -> VoxelSet {
    let voxels = voxels.iter().map(|&(cell, reflectance, area)| Voxel {
        morton: morton_encode(cell.into()),
        area,
        reflectance,
    });
    VoxelSet::new(grid(), voxels.collect())
}

#[test]
fn morton_codes_round_trip() {
    for cell in [[0, 0, 0], [1, 0, 0], [5, 9, 1023], [1023, 512, 7]].map(UVec3::from) {
        assert_eq!(morton_decode(morton_encode(cell)), cell);
    }
    assert_eq!(morton_encode(UVec3::new(1, 1, 1)), 7);
}

#[test]
fn a_set_does_not_differ_from_itself() {
    let all = set(&[([1, 2, 3], RED, 0.5), ([4, 5, 6], Vec3::ONE, 0.0)]);
    let same = all.difference(&all);
    assert_eq!((same.voxels, same.missing, same.extra), (2, 0, 0));
    assert_eq!((same.missing_area, same.area, same.color_rmse), (0.0, 1.0, 0.0));
}

#[test]
fn differences_are_counted() {
    let exact = set(&[
        ([1, 2, 3], RED, 0.5),
        ([4, 5, 6], RED, 1.0),
        ([7, 7, 7], RED, 0.5),
        ([8, 7, 7], Vec3::ZERO, 0.0),
        ([8, 8, 8], Vec3::ZERO, 0.0),
    ]);
    let found = set(&[
        ([1, 2, 3], RED + Vec3::new(0.0, 0.3, 0.0), 1.0),
        ([4, 5, 6], RED, 1.0),
        // In the exact set it has no surface, so colours are not compared.
        ([8, 7, 7], Vec3::ONE, 0.25),
        ([9, 9, 9], Vec3::ONE, 0.75),
    ]);
    let difference = found.difference(&exact);
    assert_eq!((difference.voxels, difference.missing, difference.extra), (4, 2, 1));
    assert_eq!(difference.missing_touched, 1);
    assert_eq!((difference.missing_area, difference.area), (0.25, 1.5));
    // One channel of six is off by 0.3.
    assert!((difference.color_rmse - 0.3 / 6.0_f64.sqrt()).abs() < 1e-6, "{difference:?}");
    let nothing = set(&[]).difference(&exact);
    assert_eq!((nothing.missing, nothing.missing_area, nothing.color_rmse), (5, 1.0, 0.0));
}

/// Four voxels in a row, seen from the front.
#[test]
fn missing_and_extra_voxels_have_different_colors() {
    let exact = set(&[([6, 8, 4], RED, 1.0), ([7, 8, 4], RED, 1.0), ([8, 8, 4], RED, 0.0)]);
    let found = set(&[([6, 8, 4], RED, 1.0), ([8, 8, 4], RED, 0.0), ([9, 8, 4], RED, 1.0)]);
    let camera = Camera {
        position: Vec3::new(8.0, 8.5, 14.0),
        vertical_fov_rad: 2.0 * (0.5_f32 / 9.0).atan(),
        ..Camera::default()
    };
    // The picture is six voxels wide at the distance of their front sides.
    let size = UVec2::new(6 * 20, 20);
    let picture = voxel_set_picture(&found, &exact, &camera, size);
    let at = |column: u32| picture[(10 * size.x + 20 * column + 10) as usize];
    let shown = |linear: Vec3| {
        linear
            .to_array()
            .map(|c| (crate::picture::srgb::srgb_encode(c * 0.86) * 255.0).round() as u8)
    };
    assert_eq!(at(1), shown(RED));
    assert_eq!(at(2), shown(MISSING_COLOR));
    assert_eq!(at(3), shown(Vec3::splat(0.1)));
    assert_eq!(at(4), shown(EXTRA_COLOR));
    assert_eq!(at(0), at(5));
    assert!(at(0).iter().all(|channel| *channel < 40), "{:?}", at(0));
}

/// Rays along each axis, from inside and outside the grid, meet the nearest cell.
#[test]
fn rays_meet_the_nearest_voxel() {
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let place = |along: f32| {
                let mut place = Vec3::new(5.5, 6.5, 7.5);
                place[axis] = along;
                place
            };
            let cells = [3.5, 9.5].map(|along| place(along).as_uvec3().to_array());
            let nearest = usize::from(sign < 0.0);
            let exact = set(&[(cells[nearest], RED, 1.0), (cells[1 - nearest], Vec3::ONE, 1.0)]);
            let mut forward = Vec3::ZERO;
            forward[axis] = sign;
            let up = if axis == 1 { Vec3::X } else { Vec3::Y };
            for start in [if sign > 0.0 { 0.5 } else { 15.5 }, 8.0 - sign * 50.0] {
                let camera = Camera { position: place(start), forward, up, ..Camera::default() };
                let picture = voxel_set_picture(&exact, &exact, &camera, UVec2::new(301, 301));
                let middle = picture[301 * 150 + 150];
                assert!(middle[0] > 2 * middle[1], "{middle:?} along {forward} from {start}");
            }
        }
    }
}
