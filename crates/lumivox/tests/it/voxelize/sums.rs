//! The contents of faces, against clipping in f64.

use glam::{DVec3, Mat4, Vec3, Vec4};
use lumivox::voxels::FaceRecord;
use lumivox::{Draw, Geometry, Grid, SurfaceMaterial};

use crate::voxelize::read::{Lab, ReadList, along, morton_decode};
use crate::voxelize::scenes::unit_grid;
use crate::voxelize::scenes::{Mesh, Random};
use crate::voxelize::twin::{self, in_grid};

/// Positions are rounded by up to 64 * 2^-24 voxels, and a piece's boundary, a few voxels long,
/// moves with them; the sums' own rounding is far below.
const TOLERANCE: f64 = 5e-5;

fn grey() -> SurfaceMaterial {
    SurfaceMaterial { reflectance: Vec4::new(0.2, 0.4, 0.6, 1.0), ..Default::default() }
}

/// Compares every face with the twin's.
fn compare(
    grid: &Grid,
    list: &ReadList,
    triangles: &[[Vec3; 3]],
    double_sided: bool,
    reflectance: Vec3,
) {
    let triangles: Vec<_> = triangles.iter().map(|t| in_grid(grid, t)).collect();
    let mut expected = twin::faces(grid, &triangles, double_sided);
    let mut in_voxel = std::collections::BTreeMap::new();
    let mut found = std::collections::BTreeMap::<_, Vec<&FaceRecord>>::new();
    for face in &list.faces {
        let voxel = morton_decode(face.cell).to_array();
        *in_voxel.entry(voxel).or_insert(0) += 1;
        found.entry((voxel, face.lobe as usize)).or_default().push(face);
    }
    let faces = list.faces.len();
    for (key, faces) in found {
        let own = expected.remove(&key).unwrap_or_default();
        let tolerance = TOLERANCE * f64::from(own.pieces.max(1));
        // Each plane of the lobe has its own face with its own limit.
        let area: DVec3 = faces.iter().map(|face| Vec3::from(face.vector_area).as_dvec3()).sum();
        if own.weight < 1.0 {
            let error = (area - own.area).abs().max_element();
            assert!(error <= tolerance, "{key:?}: {area}, not {}, {own:?}", own.area);
        } else {
            assert!(area.length() <= own.area.length() + tolerance, "{key:?}: {area}, {own:?}");
        }
        // A face's position is the mean over surface that no other face hides; if other surface
        // parts it, over the larger side.
        let is_seen = (double_sided
            && faces.iter().all(|face| face.flags & FaceRecord::PARTED == 0))
            || in_voxel[&key.0] == 1;
        if own.weight > 0.01 && own.weight < 1.0 && is_seen {
            let moment = |face: &&FaceRecord| {
                let position = grid.grid_from_world(Vec3::from(face.position_in_world));
                position.as_dvec3() * f64::from(along(face))
            };
            let weight: f64 = faces.iter().map(|face| f64::from(along(face))).sum();
            let position = faces.iter().map(moment).sum::<DVec3>() / weight;
            let mean = own.moment / own.weight;
            // The position's error is the area's error over the area.
            let allowed = 2.0 * tolerance / own.weight + 1e-4;
            let error = (position - mean).abs().max_element();
            assert!(error <= allowed, "{key:?}: at {position}, not {mean}, {own:?}");
        }
        for face in faces.iter().filter(|face| along(face) > 0.01) {
            let error = (Vec3::from(face.reflectance) - reflectance).abs().max_element();
            assert!(error <= 1e-5, "{key:?}: {:?}, {own:?}", face.reflectance);
        }
    }
    for (key, own) in expected {
        assert!(own.weight <= TOLERANCE, "{key:?} is missing: {own:?}");
    }
    println!("{faces} faces");
}

fn compare_mesh(lab: &Lab, grid: &Grid, triangles: &[[Vec3; 3]], double_sided: bool) -> ReadList {
    let material = SurfaceMaterial { double_sided, ..grey() };
    let list = lab.voxelize(grid, &Mesh::from_triangles(triangles).geometry(&lab.device, material));
    compare(grid, &list, triangles, double_sided, Vec3::new(0.2, 0.4, 0.6));
    list
}

#[test]
fn random_triangles() {
    let lab = Lab::new();
    let mut random = Random(11);
    let grid =
        Grid::fit(Vec3::new(-3.0, -1.0, 2.0), Vec3::new(4.0, 2.5, 6.0), 64, Vec3::splat(0.3))
            .unwrap();
    for (size, double_sided) in [(0.02_f32, false), (0.2, true), (1.0, false), (5.0, true)] {
        let triangles: Vec<_> = (0..150)
            .map(|_| {
                let centre = random.vector(-3.0, 6.0);
                [(); 3].map(|()| centre + random.vector(-size, size))
            })
            .collect();
        compare_mesh(&lab, &grid, &triangles, double_sided);
    }
}

#[test]
fn slivers() {
    let lab = Lab::new();
    let mut random = Random(12);
    let triangles: Vec<_> = (0..200)
        .map(|i| {
            let a = random.vector(1.0, 63.0);
            let b = random.vector(1.0, 63.0);
            let width = 10.0_f32.powf(-1.0 - 3.0 * (i as f32 / 200.0));
            [a, b, a + (b - a) * random.unit() + random.vector(-width, width)]
        })
        .collect();
    compare_mesh(&lab, &unit_grid(64), &triangles, false);
}

/// A plane of any orientation: its pieces add up to its own area vector, and its position is on it.
#[test]
fn planes_keep_their_area() {
    let lab = Lab::new();
    let grid = unit_grid(32);
    let mut random = Random(13);
    for _ in 0..20 {
        let t = [random.vector(1.0, 31.0), random.vector(1.0, 31.0), random.vector(1.0, 31.0)];
        let list = lab.voxelize(&grid, &Mesh::from_triangles(&[t]).geometry(&lab.device, grey()));
        let [a, b, c] = t.map(DVec3::from);
        let area = 0.5 * (b - a).cross(c - a);
        // About the rounding of a sum of hundreds of f32 faces.
        let error = (list.total_area() - area).length();
        assert!(error <= 2e-5 * area.length(), "{t:?}: {}, not {area}", list.total_area());
        let normal = area.normalize();
        for face in list.faces.iter().filter(|face| along(face) > 0.05) {
            let apart = normal.dot(Vec3::from(face.position_in_world).as_dvec3() - a);
            assert!(apart.abs() < 1e-4, "{face:?} is off its plane by {apart}");
        }
    }
}

/// Pieces in the plane between two voxels are counted once, in the voxel above, for large triangles
/// and for small ones within a side.
#[test]
fn boundary_planes_count_once() {
    let lab = Lab::new();
    let grid = unit_grid(16);
    for axis in 0..3 {
        let turn = |p: Vec3| Vec3::from_array(std::array::from_fn(|i| p[(i + axis) % 3]));
        let triangles = [
            [Vec3::new(2.0, 3.0, 4.0), Vec3::new(6.0, 3.0, 4.0), Vec3::new(2.0, 8.0, 4.0)],
            [Vec3::new(6.0, 3.0, 4.0), Vec3::new(6.0, 8.0, 4.0), Vec3::new(2.0, 8.0, 4.0)],
        ]
        .map(|t| t.map(turn));
        let list = compare_mesh(&lab, &grid, &triangles, false);
        assert_eq!(list.stats.faces, 20);
        let plane = turn(Vec3::new(0.0, 0.0, 4.0));
        for face in &list.faces {
            let voxel = glam::UVec3::from(morton_decode(face.cell).to_array()).as_vec3();
            assert!((voxel - plane).dot(plane) == 0.0, "{face:?}");
            assert!((along(face) - 1.0).abs() < 1e-6, "{face:?}");
        }
        let small = [Vec3::new(2.2, 3.3, 4.0), Vec3::new(2.8, 3.4, 4.0), Vec3::new(2.4, 3.9, 4.0)];
        let list = compare_mesh(&lab, &grid, &[small.map(turn)], false);
        assert_eq!(list.stats.faces, 1);
        assert!((Vec3::from(list.faces[0].position_in_world) - plane).dot(plane) == 0.0);
    }
}

#[test]
fn vector_areas_of_closed_surfaces_sum_to_zero() {
    let lab = Lab::new();
    let grid = Grid::fit(Vec3::NEG_ONE, Vec3::ONE, 64, Vec3::ZERO).unwrap();
    // A million triangles, a dozen in a voxel's width.
    let list =
        lab.voxelize(&grid, &Mesh::sphere(Vec3::ZERO, 1.0, 708).geometry(&lab.device, grey()));
    let radius = 1.0 / f64::from(grid.voxel_size_m);
    // Along the lobes the unit sphere has the area of the projections, by symmetry six times one
    // sixth.
    let sum = list.total_area();
    assert!(sum.length() < 1e-4 * radius * radius, "{sum}");
    // The lobe +y is the part with n.y above |n.x| and |n.z|; its area along y is
    // the integral of n.y: 3 sqrt(2) atan(1 / sqrt(2)) * 2 / 3 * r^2 (of the square of directions).
    let expected = 6.0 * projected_face_area() * radius * radius;
    let along = list.total_along();
    assert!((along / expected - 1.0).abs() < 1e-3, "{along}, not {expected}");
}

/// The integral of n.y over the directions whose dominant axis is +y: over the square [-1, 1]^2 of
/// directions (u, 1, v), of 1 / (1 + u^2 + v^2)^2.
fn projected_face_area() -> f64 {
    let steps = 2000;
    let place = |i: i32| (f64::from(i) + 0.5) / f64::from(steps) * 2.0 - 1.0;
    let cell = (2.0 / f64::from(steps)).powi(2);
    let mut sum = 0.0;
    for i in 0..steps {
        for j in 0..steps {
            sum += cell / (1.0 + place(i).powi(2) + place(j).powi(2)).powi(2);
        }
    }
    sum
}

/// A million pieces, each far below the unit of a plain fixed-point sum.
#[test]
fn many_tiny_pieces_add_up() {
    let lab = Lab::new();
    let mut random = Random(14);
    let mut area = DVec3::ZERO;
    let triangles: Vec<_> = (0..300_000)
        .map(|_| {
            let centre = Vec3::new(4.5, 3.5, 6.5) + random.vector(-0.4, 0.4);
            let t =
                [(); 3].map(|()| centre + random.vector(-1e-3, 1e-3) * Vec3::new(1.0, 1.0, 0.2));
            // Turned so that all face the same way.
            let turned =
                if (t[1] - t[0]).cross(t[2] - t[0]).z < 0.0 { [t[0], t[2], t[1]] } else { t };
            let [a, b, c] = turned.map(DVec3::from);
            area += 0.5 * (b - a).cross(c - a);
            turned
        })
        .collect();
    let list = lab
        .voxelize(&unit_grid(16), &Mesh::from_triangles(&triangles).geometry(&lab.device, grey()));
    let error = (list.total_area() - area).length() / area.length();
    // The sum is 0.2; each piece is rounded at random by at most 2^-17 of it.
    assert!(error < 1e-3, "{}, not {area}", list.total_area());
}

/// More surface in a voxel than a fixed-point sum can hold is limited, not wrapped around.
#[test]
fn full_voxels_do_not_overflow() {
    let lab = Lab::new();
    let quad = |z: f32| {
        let corner = |x: f32, y: f32| Vec3::new(x, y, z);
        [
            [corner(3.0, 3.0), corner(4.0, 3.0), corner(4.0, 4.0)],
            [corner(3.0, 3.0), corner(4.0, 4.0), corner(3.0, 4.0)],
        ]
    };
    let triangles: Vec<_> = (0..5000).flat_map(|i| quad(3.0 + (i as f32 + 0.5) / 5000.0)).collect();
    let list = lab
        .voxelize(&unit_grid(16), &Mesh::from_triangles(&triangles).geometry(&lab.device, grey()));
    let face = list.faces.iter().find(|face| along(face) > 0.5).expect("the full voxel");
    assert!((along(face) - 1.0).abs() < 1e-6, "{face:?}");
    let reflectance = Vec3::from(face.reflectance);
    assert!((reflectance - Vec3::new(0.2, 0.4, 0.6)).abs().max_element() < 1e-4, "{face:?}");
    // Each of the 5000 layers belongs to one of four planes, whose positions are means.
    let count = list.faces.iter().filter(|other| other.cell == face.cell).count();
    assert!((1..=4).contains(&count), "{count} faces");
    let position = Vec3::from(face.position_in_world);
    assert!((position - 3.5).abs().max_element() <= 0.5, "{face:?}");
}

#[test]
fn mirrored_draws_turn_their_front() {
    let lab = Lab::new();
    let t = [Vec3::new(2.2, 3.3, 4.4), Vec3::new(8.0, 3.0, 5.0), Vec3::new(3.0, 9.0, 6.0)];
    let mirror = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let mut batch = Mesh::from_triangles(&[t]).batch(&lab.device, 0);
    batch.draws = vec![Draw {
        world_from_local: Mat4::from_translation(Vec3::new(12.0, 0.0, 0.0)) * mirror,
        ..batch.draws[0]
    }];
    let geometry = Geometry::new(vec![batch], vec![grey()]);
    let grid = unit_grid(16);
    let list = lab.voxelize(&grid, &geometry);
    let mirrored = t.map(|p| Vec3::new(12.0 - p.x, p.y, p.z));
    compare(&grid, &list, &[mirrored], false, Vec3::new(0.2, 0.4, 0.6));
}
