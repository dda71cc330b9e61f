//! Which voxels the rasterizer's methods find.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3, UVec3, Vec3};
use lumivox::Grid;

use lumivox_classics::raster::Raster;

use super::{EXACT, RASTER, axes_of, depth_inside, dominant, turn, turn_back, voxelize};
use crate::voxelize::scenes::Random;
use crate::voxelize::scenes::unit_grid;
use crate::voxelize::twin::{self, Separator, Triangle, in_grid};

/// Maximum shift of an edge by a rasterizer with 8 bits below the pixel, as in all desktop drivers.
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

/// The certain and the possible voxels at the pixel centres that a triangle covers along an axis.
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
            // On a steep plane, a small shift to the side changes the depth a lot.
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

/// The found voxels include all certain voxels, and only possible ones.
fn is_between(found: &Cells, certain: &Cells, possible: &Cells) {
    assert!(certain.len() > 5000, "only {} voxels are certain", certain.len());
    println!("{} voxels, {} certain, {} possible", found.len(), certain.len(), possible.len());
    let missing: Vec<_> = certain.difference(found).collect();
    assert!(missing.is_empty(), "missing: {missing:?}");
    let extra: Vec<_> = found.difference(possible).collect();
    assert!(extra.is_empty(), "found, but no centre of a pixel is there: {extra:?}");
}
#[test]
#[ignore = "slow: over three seconds"]
fn voxels_are_set_by_covered_pixel_centres() {
    let grid = unit_grid(64);
    let triangles = triangles_of_all_sizes();
    for method in [Some(Raster::DominantAxis), Some(Raster::ThreePlane)] {
        let (mut certain, mut possible) = (Cells::new(), Cells::new());
        for t in triangles.iter().map(|t| in_grid(&grid, t)) {
            for axis in axes_of(method, &t) {
                sampled(&grid, &t, axis, &mut certain, &mut possible);
            }
        }
        is_between(&voxelize(method, &grid, &triangles).voxels(), &certain, &possible);
    }
}

/// The dominant axis finds a subset of the exact set, and three planes find that subset and more.
#[test]
#[ignore = "slow: over three seconds"]
fn sampled_voxels_are_a_subset_of_the_exact_set() {
    let grid = unit_grid(64);
    let triangles = triangles_of_all_sizes();
    let [exact, dominant, three] = [EXACT, Some(Raster::DominantAxis), Some(Raster::ThreePlane)]
        .map(|method| voxelize(method, &grid, &triangles).voxels());
    let twins: Vec<_> = triangles.iter().map(|t| in_grid(&grid, t)).collect();
    // If a corner shifts by u and v, the plane's depth shifts by the slopes, at most 1, times that.
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

/// Each voxel whose column, plane and box the triangle meets, and no other. Rounding decides a
/// sliver's dominant axis: `axes` are the possible ones.
fn conservative_is_as_defined(
    grid: &Grid,
    triangles: &[[Vec3; 3]],
    epsilon: f64,
    axes: fn(&Triangle) -> Vec<usize>,
) -> (usize, usize) {
    let found = voxelize(Some(Raster::Conservative), grid, triangles).voxels();
    let exact = voxelize(EXACT, grid, triangles).voxels();
    let mut possible = Cells::new();
    for t in triangles.iter().map(|t| in_grid(grid, t)) {
        let columns = axes(&t).into_iter().map(|axis| Separator::in_column(&t, axis));
        let columns: Vec<_> = columns.collect();
        for voxel in twin::candidates(grid, &t, epsilon) {
            let apart = || columns.iter().map(|column| column.apart(voxel, epsilon));
            if apart().any(|apart| apart.is_some()) {
                possible.insert(voxel.to_array());
            }
            if apart().all(|apart| apart.is_some_and(|apart| apart < -epsilon)) {
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
#[test]
#[ignore = "slow: over three seconds"]
fn conservative_rasterization_misses_no_voxel() {
    let triangles = triangles_of_all_sizes();
    let (found, exact) = conservative_is_as_defined(&unit_grid(64), &triangles, EPSILON, dominant);
    assert!(found > exact && found < 2 * exact, "{found} of {exact}");
}

/// Slivers, whose shifted edges meet far away, or nowhere. Their planes may be off by a part
/// in 1024.
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
/// Grids that are longer along one axis, for every axis.
#[test]
fn the_raster_target_covers_the_longest_grid_axis() {
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
        let exact = voxelize(EXACT, &grid, &triangles).voxels();
        for method in RASTER {
            let found = voxelize(method, &grid, &triangles).voxels();
            let missing = exact.difference(&found).count();
            let most = if method == Some(Raster::Conservative) { 0 } else { exact.len() / 3 };
            assert!(missing <= most, "{method:?}, axis {axis}: {missing} of {}", exact.len());
            assert!(found.difference(&exact).count() * 100 <= exact.len(), "{method:?}");
        }
    }
}
