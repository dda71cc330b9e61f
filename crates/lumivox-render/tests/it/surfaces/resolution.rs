//! Tests of cones at half resolution, with light of neighbours for the other pixels.

use std::sync::Arc;

use glam::Vec3;
use lumivox::hooks::ConeModel;
use lumivox::{TraceResolution, TraceSettings};
use lumivox_render::{RenderSettings, View};
use lumivox_scene::{Material, Scene};

use crate::common::StillCones;
use crate::surfaces::stage::*;

/// Half the edge of the box.
const HALF: f32 = 1.2;

/// A deep black box under an open sky, open towards the camera.
fn black_box() -> Scene {
    let mut scene = scene();
    let (half, depth) = (HALF, 3.0);
    let black = Material::diffuse("black", Vec3::ZERO);
    let (x, y, z) = (Vec3::X * half, Vec3::Y * half, Vec3::Z * 0.5 * depth);
    add(&mut scene, quad(-2.0 * z, x, y), black.clone());
    // The walls face inwards.
    for (middle, u, v) in [(-x, y, z), (x, z, y), (-y, z, x), (y, x, z)] {
        add(&mut scene, quad(middle - z, u, v), black.clone());
    }
    scene.environment.radiance = Vec3::ONE;
    scene
}

/// A pane under an open sky in front of the bottom of a deep black box; both face the camera.
/// Neighbours across the edge have the same normal but are in another plane, so their light is not
/// used.
#[test]
fn half_resolution_does_not_blend_across_surfaces() {
    let mut scene = black_box();
    let (x, y) = (Vec3::X * HALF, Vec3::Y * HALF);
    let white = Material::diffuse("white", Vec3::ONE);
    add(&mut scene, quad(-0.5 * x, 0.5 * x, y), white);
    for resolution in [TraceResolution::Full, TraceResolution::Half] {
        let trace = TraceSettings { resolution, ..TraceSettings::default() };
        let settings = RenderSettings { bounces: 1, frames: 4, trace, ..settings(View::Diffuse) };
        let picture = render(&scene, settings);
        let column = |x: u32| mean_of(&picture, (x, 8).into(), (x + 1, 24).into()).x;
        // The pane ends in the middle of the picture, between columns 15 and 16.
        println!(
            "{resolution:?}: {} and {}, {}, {}",
            column(14),
            column(15),
            column(16),
            column(17)
        );
        for x in 8..16 {
            assert!(column(x) > 0.97, "{resolution:?}: column {x} has {}", column(x));
        }
        assert!(column(17) < 0.4, "{resolution:?}: the box is dark, not {}", column(17));
    }
}

/// A post as thin as a pixel in front of the bottom of such a box: the traced pixels beside it do
/// not match, so the post is traced itself, even in a single frame.
#[test]
#[ignore = "slow: over three seconds"]
fn half_resolution_traces_pixels_without_matching_neighbours() {
    let mut scene = black_box();
    let pixel = 8.0 * 0.15_f32.tan() / 32.0;
    let middle = Vec3::new(-0.5 * pixel, 0.0, 0.0);
    let white = Material::diffuse("white", Vec3::ONE);
    add(&mut scene, quad(middle, 0.5 * pixel * Vec3::X, Vec3::Y * HALF), white);
    let [full, half] = [TraceResolution::Full, TraceResolution::Half].map(|resolution| {
        let trace = TraceSettings { resolution, ..TraceSettings::default() };
        let cone_model: Option<Arc<dyn ConeModel>> = Some(Arc::new(StillCones { share: 1.0 }));
        let (bounces, frames) = (1, 1);
        let settings =
            RenderSettings { bounces, frames, trace, cone_model, ..settings(View::Diffuse) };
        let picture = render(&scene, settings);
        [14, 15, 16].map(|x: u32| mean_of(&picture, (x, 8).into(), (x + 1, 24).into()).x)
    });
    println!("full {full:?}, half {half:?}");
    // The first frame traces even columns; the post is in an odd one.
    assert!(full[1] > 0.9 && full[0] < 0.5, "or else nothing is tested: {full:?}");
    assert!((half[1] - full[1]).abs() < 1e-3, "{half:?} are not {full:?}");
}
