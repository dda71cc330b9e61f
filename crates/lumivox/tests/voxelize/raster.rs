//! The rasterizer's methods, each against its own definition in f64, and against each other.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3, UVec3, Vec3, Vec4};
use lumivox::{Draw, Geometry, Grid, SurfaceMaterial, VoxelizeMethod};

use crate::overlap::unit_grid;
use crate::promises::triangle_soup;
use crate::read::{Lab, ReadList, along};
use crate::scenes::{Mesh, Random};
use crate::twin::{self, Triangle, in_grid};

const RASTER: [VoxelizeMethod; 3] =
    [VoxelizeMethod::DominantAxis, VoxelizeMethod::Conservative, VoxelizeMethod::ThreePlane];

/// By how much a rasterizer with 8 bits below the pixel, which all desktop drivers have, may put an edge off.
const SUBPIXEL: f64 = 1.0 / 256.0;

/// Rounding of coordinates of up to 64 voxels, as in overlap.rs.
const EPSILON: f64 = 16.0 * 64.0 / 16_777_216.0;

/// Triangles from within a voxel to across the grid, some of them partly outside.
fn triangles_of_all_sizes() -> Vec<[Vec3; 3]> {
    let mut random = Random(31);
    (0..600)
        .map(|i| {
            let size = [0.3, 1.5, 8.0, 60.0][i % 4];
            let centre = random.vector(-2.0, 66.0);
            [(); 3].map(|()| centre + random.vector(-size, size))
        })
        .collect()
}

fn voxelize(method: VoxelizeMethod, grid: &Grid, triangles: &[[Vec3; 3]]) -> ReadList {
    let lab = Lab::with_method(method);
    let material = SurfaceMaterial::default();
    lab.voxelize(grid, &Mesh::from_triangles(triangles).geometry(&lab.device, material))
}

/// A cyclic turn that makes `axis` the third.
fn turn(v: DVec3, axis: usize) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|i| v[(axis + 1 + i) % 3]))
}

fn turn_back(v: DVec3, axis: usize) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|i| v[(i + 2 - axis) % 3]))
}

/// How far inside a triangle, seen along z, a point is (negative: outside).
fn depth_inside(t: &Triangle, p: DVec2) -> f64 {
    let area = (t[1] - t[0]).truncate().perp_dot((t[2] - t[0]).truncate());
    (0..3).fold(f64::MAX, |least, i| {
        let (start, edge) = (t[i].truncate(), (t[(i + 1) % 3] - t[i]).truncate());
        least.min(edge.perp_dot(p - start) * area.signum() / edge.length())
    })
}

/// The voxels that a triangle's pixels' centres along an axis stand for: with certainty, and perhaps.
fn sampled(grid: &Grid, t: &Triangle, axis: usize, certain: &mut Cells, possible: &mut Cells) {
    let turned = t.map(|p| turn(p, axis));
    let normal = (turned[1] - turned[0]).cross(turned[2] - turned[0]);
    let low = turned[0].min(turned[1]).min(turned[2]);
    let high = turned[0].max(turned[1]).max(turned[2]);
    let size = grid.dimensions.as_dvec3();
    let inside_grid = |p: DVec3| p.cmpge(DVec3::ZERO).all() && p.cmplt(size).all();
    let range = |i: usize| low[i].floor().max(0.0) as u32..=high[i].ceil().clamp(0.0, 63.0) as u32;
    for u in range(0) {
        for v in range(1) {
            let centre = DVec2::new(f64::from(u), f64::from(v)) + 0.5;
            let inside = depth_inside(&turned, centre);
            if inside < -2.0 * SUBPIXEL {
                continue;
            }
            let offset = centre - turned[0].truncate();
            let plane = turned[0].z - normal.truncate().dot(offset) / normal.z;
            let depth = plane.clamp(low.z, high.z);
            // Where the plane is steep, a little to the side is a lot of depth.
            let slope = normal.truncate().abs().element_sum() / normal.z.abs();
            let error = (1.0 + slope) * 32.0 * EPSILON;
            let cells = [-error, error]
                .map(|error| turn_back(centre.extend((depth + error).clamp(low.z, high.z)), axis));
            for cell in cells.into_iter().filter(|cell| inside_grid(*cell)) {
                possible.insert(cell.as_uvec3().to_array());
            }
            let is_one = cells[0].as_ivec3() == cells[1].as_ivec3();
            if is_one && inside > 2.0 * SUBPIXEL && inside_grid(cells[0]) {
                certain.insert(cells[0].as_uvec3().to_array());
            }
        }
    }
}

type Cells = BTreeSet<[u32; 3]>;

/// What is found has all that must be there and nothing that cannot be.
fn is_between(found: &Cells, certain: &Cells, possible: &Cells) {
    assert!(certain.len() > 5000, "only {} voxels are certain", certain.len());
    println!("{} voxels, {} certain, {} possible", found.len(), certain.len(), possible.len());
    let missing: Vec<_> = certain.difference(found).collect();
    assert!(missing.is_empty(), "missing: {missing:?}");
    let extra: Vec<_> = found.difference(possible).collect();
    assert!(extra.is_empty(), "found, but no centre of a pixel is there: {extra:?}");
}

fn axes_of(method: VoxelizeMethod, t: &Triangle) -> Vec<usize> {
    match method {
        VoxelizeMethod::ThreePlane => vec![0, 1, 2],
        _ => vec![twin::lobe_of((t[1] - t[0]).cross(t[2] - t[0])) / 2],
    }
}

#[test]
fn centres_of_pixels_decide() {
    let grid = unit_grid(64);
    let triangles = triangles_of_all_sizes();
    for method in [VoxelizeMethod::DominantAxis, VoxelizeMethod::ThreePlane] {
        let (mut certain, mut possible) = (Cells::new(), Cells::new());
        for t in triangles.iter().map(|t| in_grid(&grid, t)) {
            for axis in axes_of(method, &t) {
                sampled(&grid, &t, axis, &mut certain, &mut possible);
            }
        }
        is_between(&voxelize(method, &grid, &triangles).voxels(), &certain, &possible);
    }
}

/// The dominant axis finds a part of the exact set, and three planes find that part and more.
#[test]
fn centres_are_a_part_of_the_exact_set() {
    let grid = unit_grid(64);
    let triangles = triangles_of_all_sizes();
    let [exact, dominant, three] =
        [VoxelizeMethod::Exact, VoxelizeMethod::DominantAxis, VoxelizeMethod::ThreePlane]
            .map(|method| voxelize(method, &grid, &triangles).voxels());
    let twins: Vec<_> = triangles.iter().map(|t| in_grid(&grid, t)).collect();
    // A corner that moves by u and v takes the plane along, by the slopes, which are at most 1.
    let near = twin::separations(&grid, &twins, 2.0 * SUBPIXEL);
    for voxel in &dominant {
        assert!(near.contains_key(voxel), "{voxel:?} is found, but nothing comes near it");
    }
    let extra = dominant.difference(&exact).count();
    assert!(extra * 1000 < dominant.len(), "{extra} of {} are not exact", dominant.len());
    assert!(dominant.len() < three.len() && three.len() < exact.len());
    for voxel in &dominant {
        assert!(three.contains(voxel), "{voxel:?} is in one plane, but not in three");
    }
}

/// As [`twin::separation`], without the edges seen along the two other axes: what a conservative rasterizer
/// and the plane's range of depth over the pixel can tell.
fn separation_in_column(t: &Triangle, voxel: UVec3, axis: usize) -> f64 {
    let edges = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let mut seen_along = [0.0; 3];
    seen_along[axis] = 1.0;
    let seen_along = DVec3::from(seen_along);
    let mut apart = f64::MIN;
    let normal = edges[0].cross(edges[1]);
    let across = edges.map(|edge| edge.cross(seen_along));
    for direction in [DVec3::X, DVec3::Y, DVec3::Z, normal].into_iter().chain(across) {
        let Some(direction) = direction.try_normalize() else { continue };
        let places = t.map(|p| direction.dot(p - voxel.as_dvec3() - 0.5));
        let low = places.into_iter().fold(f64::MAX, f64::min);
        let high = places.into_iter().fold(f64::MIN, f64::max);
        let reach = 0.5 * direction.abs().element_sum();
        apart = apart.max((low - reach).max(-reach - high));
    }
    apart
}

/// Each voxel whose column, plane and box the triangle meets, and no other. The dominant axis of a sliver is a
/// matter of rounding: `axes` are those that it may be.
fn conservative_is_as_defined(
    grid: &Grid,
    triangles: &[[Vec3; 3]],
    epsilon: f64,
    axes: fn(&Triangle) -> Vec<usize>,
) -> (usize, usize) {
    let found = voxelize(VoxelizeMethod::Conservative, grid, triangles).voxels();
    let exact = voxelize(VoxelizeMethod::Exact, grid, triangles).voxels();
    let mut possible = Cells::new();
    for t in triangles.iter().map(|t| in_grid(grid, t)) {
        let axes = axes(&t);
        for voxel in twin::candidates(grid, &t, epsilon) {
            let apart = || axes.iter().map(|axis| separation_in_column(&t, voxel, *axis));
            if apart().any(|apart| apart <= epsilon) {
                possible.insert(voxel.to_array());
            }
            if apart().all(|apart| apart < -epsilon) {
                assert!(found.contains(&voxel.to_array()), "{voxel} is missing");
            }
        }
    }
    println!("{} voxels, {} exact, {} possible", found.len(), exact.len(), possible.len());
    let extra: Vec<_> = found.difference(&possible).collect();
    assert!(extra.is_empty(), "found, but nothing comes near: {extra:?}");
    let twins: Vec<_> = triangles.iter().map(|t| in_grid(grid, t)).collect();
    for (voxel, apart) in twin::separations(grid, &twins, epsilon) {
        assert!(apart > -epsilon || found.contains(&voxel), "{voxel:?} is missing: {apart}");
    }
    (found.len(), exact.len())
}

fn dominant(t: &Triangle) -> Vec<usize> {
    axes_of(VoxelizeMethod::DominantAxis, t)
}

#[test]
fn conservative_misses_nothing() {
    let triangles = triangles_of_all_sizes();
    let (found, exact) = conservative_is_as_defined(&unit_grid(64), &triangles, EPSILON, dominant);
    assert!(found > exact && found < 2 * exact, "{found} of {exact}");
}

/// Slivers, whose shifted edges meet far away, or nowhere. Their planes may be off by a part in 1024.
#[test]
fn conservative_finds_slivers() {
    let mut random = Random(32);
    let triangles: Vec<_> = (0..300)
        .map(|i| {
            let a = random.vector(1.0, 63.0);
            let b = random.vector(1.0, 63.0);
            let width = 10.0_f32.powf(-1.0 - 5.0 * (i as f32 / 300.0));
            [a, b, a + (b - a) * random.unit() + random.vector(-width, width)]
        })
        .collect();
    let (found, exact) =
        conservative_is_as_defined(&unit_grid(64), &triangles, 2e-3, |_| vec![0, 1, 2]);
    assert!(found < 2 * exact, "{found} of {exact}");
}

#[test]
fn conservative_finds_huge_triangles() {
    let p = Vec3::new;
    let triangles = [
        [p(-5000.0, 20.3, -5000.0), p(5000.0, 20.3, -5000.0), p(0.0, 20.3, 5000.0)],
        [p(-5000.0, -3000.0, 10.0), p(5000.0, -3000.0, 40.0), p(10.0, 4000.0, 20.0)],
    ];
    conservative_is_as_defined(
        &unit_grid(64),
        &triangles,
        5000.0 * 32.0 / f64::from(1 << 24),
        dominant,
    );
}

fn colored(reflectance: Vec3) -> SurfaceMaterial {
    SurfaceMaterial { reflectance: reflectance.extend(1.0), ..Default::default() }
}

const RED: Vec3 = Vec3::new(0.9, 0.1, 0.05);
const BLUE: Vec3 = Vec3::new(0.15, 0.3, 0.8);

/// A tilted plane, one half red and one half blue: each voxel has the colour of its side, both have the same
/// area, and the area is that of the plane.
#[test]
fn a_plane_of_two_colours() {
    let p = Vec3::new;
    let at = |u: f32, v: f32| p(8.0, 9.0, 20.0) + u * p(44.0, 5.0, 18.0) + v * p(-4.0, 42.0, 11.0);
    let mut mesh = Mesh::default();
    for i in 0..20 {
        for j in 0..20 {
            let corner = |di: i32, dj: i32| at((i + di) as f32 / 20.0, (j + dj) as f32 / 20.0);
            mesh.quad([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
        }
    }
    let area = p(44.0, 5.0, 18.0).cross(p(-4.0, 42.0, 11.0)).as_dvec3();
    for (method, allowed) in VoxelizeMethod::ALL.into_iter().zip([1e-4, 0.01, 1e-4, 0.01]) {
        let lab = Lab::with_method(method);
        let mut batch = mesh.batch(&lab.device, 0);
        let whole = batch.draws[0];
        let half = whole.index_count / 2;
        batch.draws = vec![
            Draw { index_count: half, ..whole },
            Draw { first_index: half, index_count: half, material: 1, ..whole },
        ];
        let geometry =
            Geometry { batches: vec![batch], materials: vec![colored(RED), colored(BLUE)] };
        let list = lab.voxelize(&unit_grid(64), &geometry);

        let (mut sum, mut weight, mut pure) = (Vec3::ZERO, 0.0, 0);
        for face in list.faces.iter().filter(|face| along(face) > 1e-3) {
            // Along the middle between the halves, in the direction across, in units of half the plane.
            let position = Vec3::from(face.position_in_world);
            let normal = area.as_vec3().normalize();
            let across = p(-4.0, 42.0, 11.0).cross(normal).normalize();
            let side = (position - at(0.5, 0.0)).dot(across);
            let reflectance = Vec3::from(face.reflectance);
            // Beyond the reach of a voxel.
            if side.abs() > 1.8 {
                let own =
                    if side * (at(0.0, 0.0) - at(0.5, 0.0)).dot(across) > 0.0 { RED } else { BLUE };
                assert!((reflectance - own).abs().max_element() < 1e-5, "{method:?}: {face:?}");
                pure += 1;
            }
            let apart = (position - at(0.5, 0.5)).dot(normal);
            // A conservative pixel that an edge crosses is an estimate.
            let most = if method == VoxelizeMethod::Conservative { 0.3 } else { 1e-3 };
            assert!(apart.abs() < most, "{method:?}: {face:?} is off its plane by {apart}");
            sum += along(face) * reflectance;
            weight += along(face);
        }
        assert!(pure > 1000, "{method:?}: {pure}");
        let mean = sum / weight;
        let error = (mean - 0.5 * (RED + BLUE)).abs().max_element();
        let kept = list.total_area().length() / area.length();
        println!("{method:?}: mean off by {error:.5}, area {kept:.4}");
        assert!(error < 0.01, "{method:?}: {mean}");
        assert!((kept - 1.0).abs() < allowed, "{method:?}: {kept} of the area");
        let direction = list.total_area().normalize().dot(area.normalize());
        assert!(direction > 0.99999, "{method:?}: {direction}");
    }
}

/// Where a pixel is covered as a whole, the shares of its voxels are their areas, and lie where those do.
#[test]
fn conservative_shares_are_exact_within_a_plane() {
    let p = Vec3::new;
    let grid = unit_grid(64);
    for t in [
        [p(3.0, 4.0, 20.3), p(61.0, 7.0, 38.0), p(9.0, 60.0, 47.0)],
        [p(30.2, 4.0, 3.0), p(31.0, 6.0, 61.0), p(52.0, 60.0, 9.0)],
        [p(3.0, 30.4, 4.0), p(5.0, 30.4, 61.0), p(60.0, 30.4, 6.0)],
    ] {
        let turned = in_grid(&grid, &t);
        let axis = dominant(&turned)[0];
        let turned = turned.map(|p| turn(p, axis));
        let exact = voxelize(VoxelizeMethod::Exact, &grid, &[t]);
        let own = voxelize(VoxelizeMethod::Conservative, &grid, &[t]);
        let mut compared = 0;
        for face in &exact.faces {
            let voxel = UVec3::from(exact.voxel(face.voxel)).as_dvec3() + 0.5;
            if depth_inside(&turned, turn(voxel, axis).truncate()) < 1.0 {
                continue;
            }
            let other =
                own.faces.iter().find(|other| own.voxel(other.voxel) == exact.voxel(face.voxel));
            let area = other.map_or(0.0, along);
            assert!((area - along(face)).abs() < 1e-3, "{face:?}: {area}");
            if let Some(other) = other.filter(|_| along(face) > 0.05) {
                let [a, b] = [face, other].map(|face| Vec3::from(face.position_in_world));
                assert!((a - b).abs().max_element() < 0.2, "{face:?}: {other:?}");
                let normal = (t[1] - t[0]).cross(t[2] - t[0]).normalize();
                assert!((b - t[0]).dot(normal).abs() < 1e-3, "{face:?}: {other:?}");
            }
            compared += 1;
        }
        assert!(compared > 1000, "{compared}");
    }
}

/// Triangles smaller than voxels, most of which cover no centre at all: those that do stand for the others.
#[test]
fn small_triangles_keep_their_area_in_the_mean() {
    let grid = Grid::fit(Vec3::NEG_ONE, Vec3::ONE, 64, Vec3::ZERO).unwrap();
    let along_of = |method| {
        let lab = Lab::with_method(method);
        let sphere = Mesh::sphere(Vec3::ZERO, 1.0, 300);
        let list = lab.voxelize(&grid, &sphere.geometry(&lab.device, SurfaceMaterial::default()));
        let closed = list.total_area().length() / list.total_along();
        assert!(closed < 0.01, "{method:?}: a closed surface has a sum of {closed}");
        list.total_along()
    };
    let exact = along_of(VoxelizeMethod::Exact);
    for (method, allowed) in RASTER.into_iter().zip([0.02, 1e-3, 0.02]) {
        let share = along_of(method) / exact;
        println!("{method:?}: {share:.4} of the area");
        assert!((share - 1.0).abs() < allowed, "{method:?}: {share} of the area");
    }
}

/// A hundred thousand fragments in one voxel: a third of them red, and not one is lost.
#[test]
fn crowded_voxels_average() {
    const COUNT: u32 = 100_000;
    let triangles: Vec<_> = (0..COUNT)
        .map(|i| {
            let z = 6.0 + (f32::from(u16::try_from(i % 50_000).unwrap()) + 0.5) / 50_000.0;
            // The centre of the voxel's column, and of no other.
            [Vec3::new(5.1, 3.1, z), Vec3::new(5.9, 3.3, z), Vec3::new(5.4, 3.9, z)]
        })
        .collect();
    for method in RASTER {
        let lab = Lab::with_method(method);
        let mut batch = Mesh::from_triangles(&triangles).batch(&lab.device, 0);
        let whole = batch.draws[0];
        batch.draws = (0..COUNT / 1000)
            .map(|i| Draw {
                first_index: 3000 * i,
                index_count: 3000,
                material: u32::from(i % 4 != 0),
                ..whole
            })
            .collect();
        let materials = vec![colored(RED), colored(BLUE)];
        let list = lab.voxelize(&unit_grid(16), &Geometry { batches: vec![batch], materials });
        assert_eq!(list.voxels().into_iter().collect::<Vec<_>>(), [[5, 3, 6]], "{method:?}");
        assert_eq!(list.stats.fragments, u64::from(COUNT), "{method:?}");
        let [face] = list.faces[..] else { panic!("{method:?}: {} faces", list.faces.len()) };
        let expected = 0.25 * RED + 0.75 * BLUE;
        let error = (Vec3::from(face.reflectance) - expected).abs().max_element();
        assert!(error < 1e-5, "{method:?}: {face:?}, off by {error}");
        assert!((face.position_in_world[2] - 6.5).abs() < 1e-4, "{method:?}: {face:?}");
        assert!((along(&face) - 1.0).abs() < 1e-6, "{method:?}: {face:?}");
    }
}

#[test]
fn runs_and_orders_give_the_same_bits() {
    let grid = unit_grid(32);
    let material = SurfaceMaterial { double_sided: true, ..Default::default() };
    for method in RASTER {
        let lab = Lab::with_method(method);
        let mut triangles = triangle_soup();
        let geometry = |triangles: &[[Vec3; 3]]| {
            Mesh::from_triangles(triangles).geometry(&lab.device, material.clone())
        };
        let first = lab.voxelize(&grid, &geometry(&triangles));
        for _ in 0..2 {
            let again = lab.voxelize(&grid, &geometry(&triangles));
            assert!(first.bits() == again.bits(), "{method:?}");
        }
        let mut random = Random(33);
        for i in (1..triangles.len()).rev() {
            triangles.swap(i, random.next() as usize % (i + 1));
        }
        let shuffled = lab.voxelize(&grid, &geometry(&triangles));
        assert!(first.bits() == shuffled.bits(), "{method:?}");
    }
}

/// A grid that is longer along one axis than along the others, and every axis once.
#[test]
fn the_picture_holds_every_axis() {
    for axis in 0..3 {
        let turned = |p: [f32; 3]| Vec3::from_array(std::array::from_fn(|i| p[(i + axis) % 3]));
        let mut dimensions = UVec3::splat(16);
        dimensions[(3 - axis) % 3] = 48;
        let grid = Grid { dimensions, ..unit_grid(32) };
        let triangles = [
            [[1.0, 8.5, 1.0], [47.0, 8.5, 1.0], [1.0, 8.5, 15.0]],
            [[40.5, 1.0, 1.0], [40.5, 15.0, 2.0], [40.5, 2.0, 15.0]],
            [[1.0, 2.0, 12.5], [46.0, 2.0, 12.5], [47.0, 15.0, 12.5]],
        ]
        .map(|t| t.map(turned));
        let exact = voxelize(VoxelizeMethod::Exact, &grid, &triangles).voxels();
        for method in RASTER {
            let found = voxelize(method, &grid, &triangles).voxels();
            let missing = exact.difference(&found).count();
            let most = if method == VoxelizeMethod::Conservative { 0 } else { exact.len() / 3 };
            assert!(missing <= most, "{method:?}, axis {axis}: {missing} of {}", exact.len());
            assert!(found.difference(&exact).count() * 100 <= exact.len(), "{method:?}");
        }
    }
}

#[test]
fn what_cannot_be_drawn_is_counted() {
    let good = [Vec3::splat(3.2), Vec3::new(8.0, 3.0, 4.0), Vec3::new(4.0, 9.0, 3.0)];
    let triangles = [
        good,
        [Vec3::new(f32::NAN, 1.0, 2.0), good[1], good[2]],
        [Vec3::splat(1e30), -Vec3::splat(1e30), Vec3::new(1e30, -1e30, 0.0)],
        [good[0]; 3],
        [Vec3::splat(1.0), Vec3::splat(2.0), Vec3::splat(3.0)],
        good.map(|p| p + 20.0),
        good.map(|p| p - 20.0),
    ];
    for method in RASTER {
        let list = voxelize(method, &unit_grid(16), &triangles);
        let stats = &list.stats;
        assert_eq!((stats.triangles, stats.skipped, stats.outside), (7, 4, 2), "{method:?}");
        assert_eq!(list.bits(), voxelize(method, &unit_grid(16), &[good]).bits(), "{method:?}");
    }
}

/// Textures, holes and colours on a wall whose pixels are whole voxels: as of the exact method.
#[test]
fn surfaces_are_those_of_the_exact_method() {
    use crate::materials::{columns, texture, textured, wall};
    for method in RASTER {
        let lab = Lab::with_method(method);
        let exact = Lab::new();
        let material = |lab: &Lab, alpha_is_coverage, transmission| {
            let shade = |x: u32, y: u32| [(x * 30) as u8, 200, 30, (255 - y * 30) as u8];
            SurfaceMaterial {
                reflectance: Vec4::new(1.0, 0.8, 0.5, 1.0),
                reflectance_texture: Some(textured(lab, texture(lab, 8, shade))),
                emission: Vec3::new(7.0, 3.0, 1.0),
                alpha_is_coverage,
                transmission,
                ..Default::default()
            }
        };
        for (holes, transmission) in [(false, 0.0), (true, 0.0), (false, 0.7)] {
            let of = |lab: &Lab| {
                columns(lab, &wall().geometry(&lab.device, material(lab, holes, transmission)))
            };
            let (own, right) = (of(&lab), of(&exact));
            // The border's texels wrap around; on the diagonal two triangles meet.
            let inner = |[x, y]: [u32; 2]| (5..11).contains(&x) && (5..11).contains(&y) && x != y;
            let mut compared = 0;
            for (column, face) in own.iter().filter(|(column, _)| inner(*column)) {
                let (_, right) = right.iter().find(|(other, _)| other == column).expect("a face");
                let (a, b) = (Vec3::from(face.reflectance), Vec3::from(right.reflectance));
                assert!((a - b).abs().max_element() < 2e-3, "{method:?} {column:?}: {a}, not {b}");
                assert!((along(face) - along(right)).abs() < 2e-3, "{method:?} {column:?}");
                let (a, b) = (Vec3::from(face.emission), Vec3::from(right.emission));
                assert!((a - b).abs().max_element() < 1e-3, "{method:?} {column:?}: {a}, not {b}");
                compared += 1;
            }
            assert_eq!(compared, 30, "{method:?}");
        }
    }
}
