//! Tests that light of earlier frames causes no artifacts: lag of direct light, boiling, patterns
//! of sampling, blurred contact shadows.

use lumivox::Preset;
use lumivox_render::{Picture, RenderSettings, Renderer, View};
use lumivox_scene::Scene;

use super::{frame, many_frames, orbit, rmse, settings, still, stills};
use crate::common::{builtin, gpu, renderer};

fn luminances(picture: &Picture) -> impl Iterator<Item = f64> + '_ {
    picture.hdr.iter().map(|pixel| pixel[..3].iter().map(|value| f64::from(*value)).sum())
}

/// Cornell with its lamp moved sideways, m.
fn lamp_at(scene: &Scene, x: f32) -> Scene {
    let mut moved = scene.clone();
    moved.lights[0].position.x += x;
    moved
}

/// Shadows of a moving lamp do not lag: the error is smaller than that of one frame with one sample
/// a pixel and without history, 0.31.
#[test]
#[ignore = "slow: over three seconds"]
fn direct_light_does_not_lag() {
    let scene = builtin("cornell");
    let own = |preset| RenderSettings { view: View::Direct, ..settings(preset) };
    let at = |step: u32| lamp_at(&scene, 0.05 * step as f32);
    let mut moving = renderer(&gpu(), &scene, own(Preset::Realtime));
    let follow = |renderer: &mut Renderer, step| {
        pollster::block_on(renderer.set_lights(&at(step), &mut |_| {})).expect("the same scene");
        frame(renderer)
    };
    let picture = (0..=8).map(|step| follow(&mut moving, step)).last().expect("at least one");
    let mut stood = renderer(&gpu(), &at(8), own(Preset::Balanced));
    let truth = (0..16).map(|_| frame(&mut stood)).last().expect("at least one");
    // Clamped, because light on the ceiling near the lamp is unbounded.
    let [picture, truth] = [picture, truth].map(|mut picture| {
        picture.hdr.iter_mut().flatten().for_each(|value| *value = value.min(4.0));
        picture
    });
    let error = rmse(&picture, &truth);
    assert!(error < 0.2, "{error}");
}

/// A still picture settles: changes from frame to frame are small and decrease.
#[test]
#[ignore = "slow: over three seconds"]
fn still_pictures_settle_from_frame_to_frame() {
    let scene = builtin("cornell");
    let mut renderer = renderer(&gpu(), &scene, settings(Preset::Realtime));
    let mut before = frame(&mut renderer);
    let changes: Vec<f64> = (0..48)
        .map(|_| {
            let after = frame(&mut renderer);
            let change = rmse(&before, &after);
            before = after;
            change
        })
        .collect();
    assert!(changes[15] < 0.02 && changes[47] < 0.005, "{changes:?}");
}

/// Changing light leaves no rings around edges: where the truth is smooth, pixels do not alternate.
#[test]
#[ignore = "slow: over three seconds"]
fn moving_light_leaves_no_rings_around_edges() {
    let scene = builtin("cornell");
    let own = |preset| RenderSettings { view: View::Final, ..settings(preset) };
    let at = |step: u32| lamp_at(&scene, 0.03 * step as f32);
    let mut moving = renderer(&gpu(), &scene, own(Preset::Realtime));
    let pictures = (0..=16).map(|step| {
        pollster::block_on(moving.set_lights(&at(step), &mut |_| {})).expect("the same scene");
        frame(&mut moving)
    });
    let picture = pictures.last().expect("at least one");
    let mut stood = renderer(&gpu(), &at(16), own(Preset::Balanced));
    let truth = (0..48).map(|_| frame(&mut stood)).last().expect("at least one");
    let [ours, light] = [&picture, &truth].map(|picture| luminances(picture).collect::<Vec<_>>());
    let places = smooth_places(&truth);
    let width = truth.size.x as usize;
    let bends = |values: &[f64]| -> f64 {
        let bend = |place: usize, step: usize| {
            let sides = 0.5 * (values[place - step] + values[place + step]);
            ((values[place] - sides) / light[place]).powi(2)
        };
        places.iter().map(|place| bend(*place, 1) + bend(*place, width)).sum()
    };
    let ratio = (bends(&ours) / bends(&light)).sqrt();
    // Measured: 1.83, from noise; 2.13 if the mean of frames is scaled by box-filtered means of 3x3
    // pixels.
    assert!(ratio < 2.0, "{ratio}");
}

/// The pixels whose neighbours differ by at most a fifth.
fn smooth_places(picture: &Picture) -> Vec<usize> {
    let light: Vec<f64> = luminances(picture).collect();
    let [width, height] = picture.size.to_array().map(|pixels| pixels as usize);
    let is_smooth = |x: usize, y: usize| {
        let here = light[y * width + x];
        let mut around = (0..9).map(|i| light[(y + i / 3 - 1) * width + x + i % 3 - 1]);
        here > 0.0 && around.all(|beside| (beside - here).abs() <= 0.2 * here)
    };
    let places = (1..height - 1).flat_map(|y| (1..width - 1).map(move |x| (x, y)));
    places.filter(|(x, y)| is_smooth(*x, *y)).map(|(x, y)| y * width + x).collect()
}

/// The root mean square of the difference, divided by the mean, where the truth is smooth.
fn rmse_where_smooth(picture: &Picture, truth: &Picture) -> f64 {
    let [ours, light] = [picture, truth].map(|picture| luminances(picture).collect::<Vec<_>>());
    let places = smooth_places(truth);
    let squares: f64 = places.iter().map(|place| (ours[*place] - light[*place]).powi(2)).sum();
    let sum: f64 = places.iter().map(|place| light[*place]).sum();
    (squares * places.len() as f64).sqrt() / sum
}

/// In smooth parts of a picture, the first frame is already near the result of many frames.
#[test]
#[ignore = "slow: over three seconds"]
fn the_first_realtime_frame_has_a_small_error() {
    let scene = builtin("glow");
    let camera = orbit(&scene, 0);
    let truth = still(Preset::Balanced, &scene, &camera, 32);
    let error = rmse_where_smooth(&still(Preset::Realtime, &scene, &camera, 1), &truth);
    // Measured: 10.6 %; with marching cones 10.8 %.
    assert!(error < 0.117, "{error}");
}

/// The light of a pixel does not depend on its position in its block of 4x4.
#[test]
#[ignore = "slow: over three seconds"]
fn traced_pixel_blocks_are_not_visible() {
    let scene = builtin("cornell");
    let camera = orbit(&scene, 0);
    let truth = many_frames(Preset::Balanced, 48);
    let counts = [1, 6];
    for (frames, picture) in
        counts.into_iter().zip(&stills(Preset::Realtime, &scene, &camera, counts))
    {
        let mut errors = [(0.0, 0.0); 16];
        for (place, (ours, light)) in luminances(picture).zip(luminances(&truth)).enumerate() {
            let (x, y) = (place % 120, place / 120);
            let class = &mut errors[4 * (y % 4) + x % 4];
            *class = (class.0 + ours - light, class.1 + light);
        }
        let shares = errors.map(|(error, light)| error / light);
        let [least, most] = [f64::min, f64::max].map(|f| shares.into_iter().reduce(f).expect("16"));
        assert!(most - least < 0.1, "{frames} frames: {shares:?}");
    }
}

/// The darkest pixels, at contacts and corners, stay dark: the filter of the first frame adds some
/// light from around, which later frames remove.
#[test]
#[ignore = "slow: over three seconds"]
fn contact_shadows_are_not_blurred() {
    let scene = builtin("cornell");
    let camera = orbit(&scene, 0);
    let truth = many_frames(Preset::Balanced, 48);
    let surfaces = |picture: &Picture| -> Vec<f64> {
        luminances(picture).zip(&truth.hdr).filter(|(_, t)| t[3] > 0.99).map(|(l, _)| l).collect()
    };
    let light = surfaces(&truth);
    let mut sorted = light.clone();
    sorted.sort_by(f64::total_cmp);
    let dark = sorted[sorted.len() / 50];
    let counts = [1, 32];
    let pictures = stills(Preset::Realtime, &scene, &camera, counts);
    for ((frames, most), picture) in counts.into_iter().zip([0.8, 0.2]).zip(&pictures) {
        let pairs = surfaces(picture).into_iter().zip(&light).filter(|(_, l)| **l <= dark);
        let (ours, theirs) = pairs.fold((0.0, 0.0), |(a, b), (ours, light)| (a + ours, b + light));
        assert!((ours / theirs - 1.0).abs() < most, "{frames} frames: {}", ours / theirs);
    }
}
