//! Times, printed: `cargo test -p lumivox --test voxelize -- --ignored --nocapture speed`.

use std::time::Instant;

use glam::Vec3;
use lumivox::gpu::Timing;
use lumivox::{Geometry, Grid, SurfaceMaterial, Voxelizer};

use crate::common;
use crate::scenes::{Mesh, cornell_box};

/// Voxelizes a few times; prints the best time, and the passes of one timed run.
fn report(name: &str, grid: &Grid, geometry: &Geometry, device: &wgpu::Device, queue: &wgpu::Queue) {
    let voxelizer = Voxelizer::new(device, &lumivox::shaders::library()).unwrap();
    let run = |timing| {
        pollster::block_on(voxelizer.voxelize(device, queue, grid, geometry, timing)).unwrap()
    };
    let mut best = f64::MAX;
    for _ in 0..5 {
        let start = Instant::now();
        run(Timing::Off);
        device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
        best = best.min(start.elapsed().as_secs_f64());
    }
    let (_, stats, times) = run(Timing::SubmitAndWait);
    println!(
        "{name} at {}: {:.1} ms; {} triangles, {} items, {} pieces, {} voxels, {} faces",
        grid.dimensions.max_element(),
        best * 1e3,
        stats.triangles,
        stats.work_items,
        stats.fragments,
        stats.voxels,
        stats.faces,
    );
    for time in times {
        println!("    {:30} {:8.3} ms", time.pass, time.duration.as_secs_f64() * 1e3);
    }
}

#[test]
#[ignore = "prints times; says nothing about right or wrong"]
fn speed() {
    let (device, queue) = common::device();
    let cornell = cornell_box().geometry(&device, SurfaceMaterial::default());
    for resolution in [64, 128, 256] {
        let grid = Grid::fit(Vec3::ZERO, Vec3::splat(2.0), resolution, Vec3::ZERO).unwrap();
        report("cornell", &grid, &cornell, &device, &queue);
    }
    let segments = std::env::var("SEGMENTS").map_or(708, |s| s.parse().unwrap());
    let sphere = Mesh::sphere(Vec3::ZERO, 1.0, segments).geometry(&device, SurfaceMaterial::default());
    let grid = Grid::fit(Vec3::NEG_ONE, Vec3::ONE, 64, Vec3::ZERO).unwrap();
    report("sphere", &grid, &sphere, &device, &queue);
    let wall = Mesh::from_triangles(&[[
        Vec3::new(-1.0, -1.0, -0.9),
        Vec3::new(1.0, -1.0, 0.3),
        Vec3::new(-0.9, 1.0, 0.8),
    ]]);
    let grid = Grid::fit(Vec3::NEG_ONE, Vec3::ONE, 256, Vec3::ZERO).unwrap();
    report("wall", &grid, &wall.geometry(&device, SurfaceMaterial::default()), &device, &queue);
}
