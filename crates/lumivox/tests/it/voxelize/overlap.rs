//! Which voxels are occupied, against separating axes in f64.

use glam::{Mat4, Vec3};
use lumivox::{Draw, Geometry, Grid, SurfaceMaterial};

use crate::voxelize::read::Lab;
use crate::voxelize::scenes::{Mesh, Random, unit_grid};
use crate::voxelize::twin::{self, in_grid};

/// Compares the occupied voxels with the twin's: voxels within `epsilon` of touching may differ.
fn compare(lab: &Lab, grid: &Grid, geometry: &Geometry, triangles: &[[Vec3; 3]], epsilon: f64) {
    let list = lab.voxelize(grid, geometry);
    let found = list.voxels();
    let triangles: Vec<_> = triangles.iter().map(|t| in_grid(grid, t)).collect();
    let nearest = twin::separations(grid, &triangles, epsilon);
    for voxel in &found {
        assert!(nearest.contains_key(voxel), "{voxel:?} is occupied, but nothing comes near it");
    }
    let mut close_calls = 0;
    for (voxel, apart) in &nearest {
        if *apart <= -epsilon {
            assert!(found.contains(voxel), "{voxel:?} is missing, though cut by {apart}");
        } else {
            close_calls += 1;
        }
    }
    assert!(!found.is_empty());
    println!("{} voxels, {close_calls} nearer to touching than {epsilon}", found.len());
}

fn compare_mesh(lab: &Lab, grid: &Grid, triangles: &[[Vec3; 3]], epsilon: f64) {
    let geometry =
        Mesh::from_triangles(triangles).geometry(&lab.device, SurfaceMaterial::default());
    compare(lab, grid, &geometry, triangles, epsilon);
}

/// Coordinates of up to 64 voxels are rounded by 64 * 2^-24 in f32, and by a few times that in the
/// transform; the tests are widened by 8 such roundings (walk.wgsl).
const EPSILON: f64 = 16.0 * 64.0 / 16_777_216.0;

#[test]
fn random_triangles() {
    let lab = Lab::new();
    let mut random = Random(1);
    let grid =
        Grid::fit(Vec3::new(-3.0, -1.0, 2.0), Vec3::new(4.0, 2.5, 6.0), 64, Vec3::splat(0.3))
            .unwrap();
    // Triangles from the size of a voxel to that of the grid, some partly or wholly outside.
    for size in [0.02_f32, 0.2, 1.0, 6.0] {
        let triangles: Vec<_> = (0..200)
            .map(|_| {
                let centre = random.vector(-3.0, 6.0);
                [(); 3].map(|()| centre + random.vector(-size, size))
            })
            .collect();
        compare_mesh(&lab, &grid, &triangles, EPSILON);
    }
}

#[test]
fn slivers() {
    let lab = Lab::new();
    let mut random = Random(2);
    let triangles: Vec<_> = (0..300)
        .map(|i| {
            let a = random.vector(1.0, 63.0);
            let b = random.vector(1.0, 63.0);
            // Slivers down to a width of a few roundings.
            let width = 10.0_f32.powf(-1.0 - 5.0 * (i as f32 / 300.0));
            [a, b, a + (b - a) * random.unit() + random.vector(-width, width)]
        })
        .collect();
    compare_mesh(&lab, &unit_grid(64), &triangles, EPSILON);
}

#[test]
fn huge_triangles() {
    let lab = Lab::new();
    let size = 5000.0;
    let triangles = [
        [Vec3::new(-size, 20.3, -size), Vec3::new(size, 20.3, -size), Vec3::new(0.0, 20.3, size)],
        [
            Vec3::new(-size, -3000.0, 10.0),
            Vec3::new(size, -3000.0, 40.0),
            Vec3::new(10.0, 4000.0, 20.0),
        ],
    ];
    // Rounding grows with the coordinates: 5000 * 2^-24, times the factors of EPSILON and of the
    // plane.
    compare_mesh(&lab, &unit_grid(64), &triangles, f64::from(size) * 32.0 / f64::from(1 << 24));
}

#[test]
fn tiny_triangles_in_one_voxel() {
    let lab = Lab::new();
    let mut random = Random(3);
    let triangles: Vec<_> = (0..100_000)
        .map(|_| {
            let centre = Vec3::new(17.0, 5.0, 9.0) + random.vector(0.01, 0.99);
            [(); 3].map(|()| centre + random.vector(-0.002, 0.002))
        })
        .collect();
    let list = lab.voxelize(
        &unit_grid(32),
        &Mesh::from_triangles(&triangles).geometry(&lab.device, SurfaceMaterial::default()),
    );
    assert_eq!(list.voxels().into_iter().collect::<Vec<_>>(), [[17, 5, 9]]);
    assert_eq!(list.stats.fragments, 100_000);
}

/// Voxels are closed boxes: surface in a boundary touches the voxels on both sides. All numbers are
/// exact here.
#[test]
fn surface_on_a_boundary_touches_both_voxels() {
    let lab = Lab::new();
    let grid = unit_grid(16);
    for axis in 0..3 {
        let turn = |p: Vec3| Vec3::from_array(std::array::from_fn(|i| p[(i + axis) % 3]));
        let triangles = [
            [Vec3::new(2.0, 3.0, 4.0), Vec3::new(6.0, 3.0, 4.0), Vec3::new(2.0, 8.0, 4.0)],
            [Vec3::new(6.0, 3.0, 4.0), Vec3::new(6.0, 8.0, 4.0), Vec3::new(2.0, 8.0, 4.0)],
        ]
        .map(|t| t.map(turn));
        compare_mesh(&lab, &grid, &triangles, EPSILON);
        let geometry =
            Mesh::from_triangles(&triangles).geometry(&lab.device, SurfaceMaterial::default());
        let list = lab.voxelize(&grid, &geometry);
        let low = turn(Vec3::new(1.0, 2.0, 3.0)).as_uvec3();
        let high = turn(Vec3::new(6.0, 8.0, 4.0)).as_uvec3();
        let size = (high - low + 1).element_product();
        assert_eq!(list.stats.voxels, size, "axis {axis}");
    }
}

#[test]
fn full_grid() {
    let lab = Lab::new();
    let grid = unit_grid(16);
    let mut mesh = Mesh::default();
    for layer in 0..16 {
        let y = layer as f32 + 0.5;
        let corner = |x: f32, z: f32| Vec3::new(x, y, z);
        mesh.quad([corner(0., 0.), corner(0., 16.), corner(16., 16.), corner(16., 0.)]);
    }
    let list = lab.voxelize(&grid, &mesh.geometry(&lab.device, SurfaceMaterial::default()));
    assert_eq!(list.stats.voxels, 16 * 16 * 16);
    assert_eq!(list.stats.faces, 16 * 16 * 16);
}

#[test]
fn skipped_and_outside_triangles_are_counted() {
    let lab = Lab::new();
    let good = [Vec3::splat(3.2), Vec3::new(5.0, 3.0, 4.0), Vec3::new(4.0, 6.0, 3.0)];
    let triangles = [
        good,
        [Vec3::new(f32::NAN, 1.0, 2.0), good[1], good[2]],
        [good[0], Vec3::new(1.0, f32::INFINITY, 2.0), good[2]],
        [Vec3::splat(1e30), -Vec3::splat(1e30), Vec3::new(1e30, -1e30, 0.0)],
        [good[0]; 3],
        [Vec3::splat(1.0), Vec3::splat(2.0), Vec3::splat(3.0)],
        good.map(|p| p + 20.0),
        good.map(|p| p - 20.0),
    ];
    let geometry =
        Mesh::from_triangles(&triangles).geometry(&lab.device, SurfaceMaterial::default());
    let list = lab.voxelize(&unit_grid(16), &geometry);
    assert_eq!(list.stats.triangles, 8);
    assert_eq!(list.stats.skipped, 5);
    assert_eq!(list.stats.outside, 2);
    let alone = Mesh::from_triangles(&[good]).geometry(&lab.device, SurfaceMaterial::default());
    assert_eq!(list.bits(), lab.voxelize(&unit_grid(16), &alone).bits());
}

#[test]
fn transformed_draws_of_all_batches_are_voxelized() {
    let lab = Lab::new();
    let mut cube = Mesh::default();
    cube.cuboid(Mat4::from_scale(Vec3::splat(4.0)));
    let sphere = Mesh::sphere(Vec3::ZERO, 3.0, 12);
    let transforms = [
        Mat4::from_translation(Vec3::new(3.3, 2.1, 5.7)),
        Mat4::from_translation(Vec3::new(20.0, 12.0, 9.0)) * Mat4::from_rotation_y(0.7),
        Mat4::from_translation(Vec3::new(12.0, 20.0, 20.0))
            * Mat4::from_rotation_x(2.0)
            * Mat4::from_scale(Vec3::new(-1.0, 0.3, 1.7)),
    ];
    let mut triangles = Vec::new();
    let mut batches = Vec::new();
    for mesh in [cube, sphere] {
        let mut batch = mesh.batch(&lab.device, 0);
        let whole = batch.draws[0];
        // The second transform draws only a part of the mesh, from the middle of the index buffer.
        batch.draws = transforms
            .iter()
            .enumerate()
            .map(|(index, &world_from_local)| Draw {
                first_index: 6 * index as u32,
                index_count: whole.index_count - 12,
                world_from_local,
                ..whole
            })
            .collect();
        for draw in &batch.draws {
            let first = draw.first_index as usize / 3;
            let end = first + draw.index_count as usize / 3;
            let part = mesh.triangles()[first..end].to_vec();
            triangles
                .extend(part.iter().map(|t| t.map(|p| draw.world_from_local.transform_point3(p))));
        }
        batches.push(batch);
    }
    let geometry = Geometry::new(batches, vec![SurfaceMaterial::default()]);
    compare(&lab, &unit_grid(32), &geometry, &triangles, EPSILON);
}
