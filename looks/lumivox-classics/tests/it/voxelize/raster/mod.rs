//! The rasterizer's methods, each against its own definition in f64, and against each other.

mod sets;
mod surfaces;

use std::sync::Arc;

use glam::{DVec2, DVec3, Vec3};
use lumivox::gpu::Pipelines;
use lumivox::hooks::Voxelization;
use lumivox::{Gi, GiConfig, Grid, SurfaceMaterial};
use lumivox_classics::raster::Raster;

use crate::voxelize::panels::assert_are_apart;

use crate::voxelize::read::{Lab, ReadList};
use crate::voxelize::scenes::triangle_soup;
use crate::voxelize::scenes::unit_grid;
use crate::voxelize::scenes::{Mesh, Random};
use crate::voxelize::twin::{self, Triangle};

/// A method of voxelizing; `None` is the exact one.
type Method = Option<Raster>;

const EXACT: Method = None;
const RASTER: [Method; 3] =
    [Some(Raster::DominantAxis), Some(Raster::Conservative), Some(Raster::ThreePlane)];
const ALL: [Method; 4] = [EXACT, RASTER[0], RASTER[1], RASTER[2]];

fn lab(method: Method) -> Lab {
    Lab::by(method.map(|raster| Arc::new(raster) as Arc<dyn Voxelization>))
}

fn voxelize(method: Method, grid: &Grid, triangles: &[[Vec3; 3]]) -> ReadList {
    let lab = lab(method);
    let material = SurfaceMaterial::default();
    lab.voxelize(grid, &Mesh::from_triangles(triangles).geometry(&lab.device, material))
}

/// Rotates components so that `axis` becomes the third.
fn turn(v: DVec3, axis: usize) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|i| v[(axis + 1 + i) % 3]))
}

fn turn_back(v: DVec3, axis: usize) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|i| v[(i + 2 - axis) % 3]))
}

/// The distance of a point inside a triangle, seen along z (negative: outside).
fn depth_inside(t: &Triangle, p: DVec2) -> f64 {
    let area = (t[1] - t[0]).truncate().perp_dot((t[2] - t[0]).truncate());
    (0..3).fold(f64::MAX, |least, i| {
        let (start, edge) = (t[i].truncate(), (t[(i + 1) % 3] - t[i]).truncate());
        least.min(edge.perp_dot(p - start) * area.signum() / edge.length())
    })
}
fn axes_of(method: Method, t: &Triangle) -> Vec<usize> {
    match method {
        Some(Raster::ThreePlane) => vec![0, 1, 2],
        _ => vec![twin::lobe_of((t[1] - t[0]).cross(t[2] - t[0])) / 2],
    }
}
fn dominant(t: &Triangle) -> Vec<usize> {
    axes_of(Some(Raster::DominantAxis), t)
}
#[test]
#[ignore = "slow: over three seconds"]
fn triangle_order_does_not_change_the_bits() {
    let grid = unit_grid(32);
    let material = SurfaceMaterial { double_sided: true, ..Default::default() };
    for method in RASTER {
        let lab = lab(method);
        let mut triangles = triangle_soup();
        let geometry = |triangles: &[[Vec3; 3]]| {
            Mesh::from_triangles(triangles).geometry(&lab.device, material.clone())
        };
        let first = lab.voxelize(&grid, &geometry(&triangles));
        let mut random = Random(33);
        for i in (1..triangles.len()).rev() {
            triangles.swap(i, random.next() as usize % (i + 1));
        }
        let shuffled = lab.voxelize(&grid, &geometry(&triangles));
        assert!(first.bits() == shuffled.bits(), "{method:?}");
    }
}
#[test]
fn triangles_that_cannot_be_drawn_are_counted() {
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

#[test]
#[ignore = "slow: over three seconds"]
fn a_panel_hides_the_wall_behind_it() {
    for method in Raster::ALL {
        assert_are_apart(&lab(Some(method)), method.name());
    }
}

/// Render pipelines are compiled ahead and reused like all others.
#[test]
fn render_pipelines_are_compiled_ahead_and_counted() {
    let (device, queue) = crate::common::device();
    let pipelines = Pipelines::new(&device);
    let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO).expect("a grid");
    let voxelizer: Option<Arc<dyn Voxelization>> = Some(Arc::new(Raster::Conservative));
    let config = GiConfig { voxelizer, ..GiConfig::new(grid) };
    let gi = Gi::with_pipelines(&pipelines, &queue, config.clone()).expect("a device");
    let counts = pipelines.counts();
    assert_eq!(counts.made, 0, "{counts:?}");
    let mut told = Vec::new();
    pollster::block_on(pipelines.compile_all(&mut |done, total| told.push((done, total))));
    let total = counts.pipelines as u32;
    assert_eq!(told, (0..=total).map(|done| (done, total)).collect::<Vec<_>>());
    drop(gi);
    Gi::with_pipelines(&pipelines, &queue, config).expect("a device");
    let made = counts.pipelines;
    assert_eq!(pipelines.counts(), lumivox::gpu::pipelines::PipelineCounts { made, ..counts });
}
