//! Times, printed: `cargo test -p lumivox --test it -- --ignored --nocapture speed`.

use std::time::Instant;

use glam::Vec3;
use lumivox::gpu::{Pipelines, Timing};
use lumivox::{Geometry, Grid, SurfaceMaterial, Voxelizer};

use crate::common;
use crate::voxelize::scenes::{Mesh, cornell_box};

/// Runs of which the best and the mean time are printed.
const RUNS: u32 = 10;

/// Processor time of this process so far: what a software driver takes, whatever else the machine
/// does.
fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Fields 14 and 15, in hundredths of a second; the name, in brackets, may hold blanks.
    let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
    fields.filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Voxelizes a few times; prints the best time, and the passes of one timed run.
fn report(name: &str, grid: &Grid, geometry: &Geometry, device: &Pipelines, queue: &wgpu::Queue) {
    let voxelizer = Voxelizer::new(device, &lumivox::shaders::library()).expect("it works");
    let run = |timing| {
        let mut scene = voxelizer.scene(device, queue, grid);
        pollster::block_on(voxelizer.voxelize(device, queue, &mut scene, geometry, timing))
            .expect("it works")
    };
    let mut best = f64::MAX;
    let before = cpu_seconds();
    for _ in 0..RUNS {
        let start = Instant::now();
        run(Timing::Off);
        device.poll(wgpu::PollType::wait_indefinitely()).expect("it works");
        best = best.min(start.elapsed().as_secs_f64());
    }
    let work = (cpu_seconds() - before) / f64::from(RUNS);
    let (stats, times) = run(Timing::SubmitAndWait);
    println!(
        "{name} at {}: {:.1} ms at best, {:.1} ms of all cores on average; {} triangles, {} items, {} pieces, {} voxels, {} faces",
        grid.dimensions.max_element(),
        best * 1e3,
        work * 1e3,
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
#[ignore = "by hand: prints times"]
fn speed_by_hand() {
    let (device, queue) = common::device();
    let cornell = cornell_box().geometry(&device, SurfaceMaterial::default());
    for resolution in [64, 128, 256] {
        let grid =
            Grid::fit(Vec3::ZERO, Vec3::splat(2.0), resolution, Vec3::ZERO).expect("it works");
        report("cornell", &grid, &cornell, &device, &queue);
    }
    let segments = std::env::var("SEGMENTS").map_or(708, |s| s.parse().expect("a number"));
    let sphere =
        Mesh::sphere(Vec3::ZERO, 1.0, segments).geometry(&device, SurfaceMaterial::default());
    let grid = Grid::fit(Vec3::NEG_ONE, Vec3::ONE, 64, Vec3::ZERO).expect("it works");
    report("sphere", &grid, &sphere, &device, &queue);
    let wall = Mesh::from_triangles(&[[
        Vec3::new(-1.0, -1.0, -0.9),
        Vec3::new(1.0, -1.0, 0.3),
        Vec3::new(-0.9, 1.0, 0.8),
    ]]);
    let grid = Grid::fit(Vec3::NEG_ONE, Vec3::ONE, 256, Vec3::ZERO).expect("it works");
    report("wall", &grid, &wall.geometry(&device, SurfaceMaterial::default()), &device, &queue);
}
