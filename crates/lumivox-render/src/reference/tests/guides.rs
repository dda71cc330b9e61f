//! Tests that the path tracer's layers of visible surfaces equal the rasterizer's.

use glam::Vec2;
use lumivox_scene::{Filter, Shading, Wrap};

use super::*;
use crate::{Exposure, RenderSettings, Renderer, View};

fn renderer(scene: &Scene, size: UVec2, frames: u32) -> Renderer {
    let settings = RenderSettings {
        size,
        resolution: 32,
        bounces: 0,
        frames,
        view: View::Albedo,
        exposure: Exposure::Stops(0.0),
        shadow_resolution: 2048,
        ..RenderSettings::default()
    };
    let (gpu, mut hear) = (gpu(), |_| {});
    let made = Renderer::new(&gpu, scene, None, settings, &mut hear);
    pollster::block_on(made).expect("a renderer")
}

fn pixels(renderer: &mut Renderer, view: View) -> Vec<[f32; 4]> {
    renderer.set_view(view, 0).expect("a view");
    pollster::block_on(renderer.render(&mut |_| {})).expect("a picture").hdr
}

/// The difference of two layers at each pixel, averaged over channels; sorted.
fn differences(actual: &[[f32; 3]], expected: &[[f32; 4]]) -> Vec<f32> {
    let each = |(a, b): (&[f32; 3], &[f32; 4])| {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum::<f32>() / 3.0
    };
    let mut all: Vec<f32> = actual.iter().zip(expected).map(each).collect();
    all.sort_by(f32::total_cmp);
    all
}

fn mean_of(values: &[[f32; 3]]) -> f32 {
    values.iter().flatten().sum::<f32>() / (3 * values.len()) as f32
}

/// Asserts that half of the pixels, those without an edge, agree within `median`, and all pixels
/// within `mean` on average: at edges the two pictures sample different points.
#[track_caller]
fn assert_alike(what: &str, actual: &[[f32; 3]], expected: &[[f32; 4]], median: f32, mean: f32) {
    let sorted = differences(actual, expected);
    let middle = sorted[sorted.len() / 2];
    let whole = sorted.iter().sum::<f32>() / sorted.len() as f32;
    let means: [f32; 2] = [
        mean_of(actual),
        expected.iter().flat_map(|p| &p[..3]).sum::<f32>() / (3 * expected.len()) as f32,
    ];
    println!(
        "{what}: differs by {middle:.5} in the median, {whole:.5} in the mean; means {means:?}"
    );
    assert!(middle <= median && whole <= mean, "{what}: {middle} and {whole}");
}

#[test]
#[ignore = "slow: over three seconds"]
fn guide_layers_match_the_rasterizer() {
    let scene = zoo::scene();
    let size = UVec2::new(48, 27);
    let layers = traced(&scene, &ReferenceSettings { size, ..settings(1, 128) });
    let mut renderer = renderer(&scene, size, 32);
    // 1.5 times the differences on llvmpipe: 0.010 and 0.029 for the albedo, where leaves, panes
    // and edges alternate within a pixel. They fall with more samples and frames.
    let tolerances = |view| match view {
        View::Albedo => (0.015, 0.045),
        View::Normal => (0.001, 0.012),
        _ => (0.008, 0.06),
    };
    let depth: Vec<[f32; 3]> = layers.depth_m.iter().map(|depth| [*depth; 3]).collect();
    let coverage: Vec<[f32; 3]> = layers.coverage.iter().map(|share| [*share; 3]).collect();
    for (view, layer) in
        [(View::Albedo, &layers.albedo), (View::Normal, &layers.normal), (View::Depth, &depth)]
    {
        let shown = pixels(&mut renderer, view);
        let (median, mean) = tolerances(view);
        assert_alike(&format!("{view:?}"), layer, &shown, median, mean);
        let filled: Vec<[f32; 4]> = shown.iter().map(|[.., a]| [*a; 4]).collect();
        assert_alike("coverage", &coverage, &filled, 0.001, 0.004);
    }
    // Relative to the mean brightness.
    let shown = pixels(&mut renderer, View::Direct);
    let brightness = mean_of(&layers.direct);
    let scaled = |value: &f32| value / brightness;
    let direct: Vec<[f32; 3]> =
        layers.direct.iter().map(|p| std::array::from_fn(|i| scaled(&p[i]))).collect();
    let shown: Vec<[f32; 4]> =
        shown.iter().map(|p| std::array::from_fn(|i| scaled(&p[i]))).collect();
    assert_alike("direct light", &direct, &shown, 0.03, 0.11);
}

/// Texels of a third of a pixel and larger, inside and outside the texture, with all wrap modes and
/// filters.
#[test]
#[ignore = "slow: over three seconds"]
fn textures_are_read_as_the_rasterizer_reads_them() {
    let mut scene = stage();
    let wraps = [Wrap::Repeat, Wrap::ClampToEdge, Wrap::MirroredRepeat];
    for (row, filter) in [Filter::Nearest, Filter::Linear].into_iter().enumerate() {
        for (column, wrap) in wraps.into_iter().enumerate() {
            let texels = (0..5 * 3_u32).flat_map(|i| {
                [(i * 53 % 256) as u8, (i * 101 % 256) as u8, (i * 17 % 256) as u8, 255]
            });
            let reference = texture(&mut scene, UVec2::new(5, 3), filter, texels.collect());
            let sampler = &mut scene.textures[reference.texture].sampler;
            (sampler.wrap_u, sampler.wrap_v) = (wrap, wraps[(column + 1) % 3]);
            let mut material = Material::diffuse("textured", Vec3::ONE);
            if let Shading::MetallicRoughness(shading) = &mut material.shading {
                shading.base_color_texture = Some(reference);
            }
            let center = Vec3::new(0.4 * (column as f32 - 1.0), 0.5 * row as f32 - 0.25, 0.0);
            let mut mesh = quad(center, Vec3::X * 0.19, Vec3::Y * 0.22);
            for uv in &mut mesh.uvs {
                *uv = Vec2::new(2.6, 2.3) * *uv - Vec2::new(0.8, 0.7);
            }
            add(&mut scene, mesh, material);
        }
    }
    let size = UVec2::splat(96);
    let layers = traced(&scene, &ReferenceSettings { size, ..settings(1, 64) });
    let shown = pixels(&mut renderer(&scene, size, 32), View::Albedo);
    assert_alike("textures", &layers.albedo, &shown, 0.002, 0.007);
}
