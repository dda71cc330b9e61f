//! Tests that the light of earlier frames reduces the error while the camera moves, and neither
//! lags nor stays.

#![allow(clippy::float_cmp)] // Counts of frames.

mod artifacts;

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use glam::{Mat4, Quat, UVec2, Vec3};
use lumivox::{Preset, TraceResolution, TraceSettings};
use lumivox_render::{Picture, RenderError, RenderSettings, Renderer, View};
use lumivox_scene::{Camera, Instance, Scene};

use crate::common::{builtin, gpu, renderer};

fn settings(preset: Preset) -> RenderSettings {
    RenderSettings {
        size: UVec2::new(120, 68),
        resolution: 64,
        // Pictures are taken after single frames, but with more than one, samples are jittered
        // within pixels.
        frames: 2,
        shadow_resolution: 128,
        view: View::Diffuse,
        trace: TraceSettings::preset(preset),
        ..RenderSettings::default()
    }
}

/// A camera that orbits the scene, 1/6 degree a step.
fn orbit(scene: &Scene, step: u32) -> Camera {
    let mut camera = scene.cameras[0].clone();
    let centre = camera.position + 3.0 * camera.forward;
    let turn = Quat::from_axis_angle(Vec3::Y, (step as f32 / 6.0).to_radians());
    camera.position = centre + turn * (camera.position - centre);
    camera.forward = turn * camera.forward;
    camera
}

fn frame(renderer: &mut Renderer) -> Picture {
    pollster::block_on(async {
        renderer.render_frame().await?;
        renderer.finish().await
    })
    .expect("a frame")
}

/// The picture of a still camera after `frames` frames.
fn still(preset: Preset, scene: &Scene, camera: &Camera, frames: u32) -> Picture {
    let [picture] = stills(preset, scene, camera, [frames]);
    picture
}

/// Pictures of one sequence of frames, after each count of frames, in ascending order.
fn stills<const COUNT: usize>(
    preset: Preset,
    scene: &Scene,
    camera: &Camera,
    frames: [u32; COUNT],
) -> [Picture; COUNT] {
    let mut renderer = renderer(&gpu(), scene, settings(preset));
    renderer.set_camera(camera.clone());
    let mut count = 0;
    frames.map(|frames| {
        let more = (count..frames).map(|_| frame(&mut renderer)).last();
        count = frames;
        more.expect("at least one")
    })
}

/// The Cornell box from its own camera, after many frames of a preset without history; rendered
/// once for several tests.
fn many_frames(preset: Preset, frames: u32) -> Arc<Picture> {
    type Known = BTreeMap<(String, u32), Arc<OnceLock<Arc<Picture>>>>;
    static KNOWN: Mutex<Known> = Mutex::new(BTreeMap::new());
    let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
    let place = Arc::clone(known.entry((format!("{preset:?}"), frames)).or_default());
    drop(known);
    let make = || {
        let scene = builtin("cornell");
        Arc::new(still(preset, &scene, &orbit(&scene, 0), frames))
    };
    Arc::clone(place.get_or_init(make))
}

/// Pairs of the channels of both pictures, in pixels that show a surface.
fn pairs<'a>(a: &'a Picture, b: &'a Picture) -> impl Iterator<Item = (f64, f64)> + 'a {
    let surfaces = a.hdr.iter().zip(&b.hdr).filter(|(a, b)| a[3] > 0.99 && b[3] > 0.99);
    surfaces.flat_map(|(a, b)| (0..3).map(|channel| (f64::from(a[channel]), f64::from(b[channel]))))
}

/// The root mean square of the difference, divided by the mean of the second picture.
fn rmse(a: &Picture, b: &Picture) -> f64 {
    let (squares, sum, count) = pairs(a, b)
        .fold((0.0, 0.0, 0.0), |(squares, sum, count), (a, b)| {
            (squares + (a - b).powi(2), sum + b, count + 1.0)
        });
    f64::sqrt(squares / count) / (sum / count)
}

fn mean(picture: &Picture) -> f64 {
    let (sum, count) = pairs(picture, picture).fold((0.0, 0.0), |(s, n), (a, _)| (s + a, n + 1.0));
    sum / count
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_moving_camera_keeps_its_light_history() {
    let scene = builtin("cornell");
    let truth = many_frames(Preset::Balanced, 48);
    let mut moving = renderer(&gpu(), &scene, settings(Preset::Realtime));
    let run = |moving: &mut Renderer| -> Vec<Picture> {
        let steps = (0..=12).rev();
        steps
            .map(|step| {
                moving.set_camera(orbit(&scene, step));
                frame(moving)
            })
            .collect()
    };
    let pictures = run(&mut moving);
    // The first frame has a small error even without history; history reduces it.
    let first = rmse(&still(Preset::Realtime, &scene, &orbit(&scene, 0), 1), &truth);
    assert!(first < 0.12, "{first} in the first frame");
    let error = rmse(&pictures[12], &truth);
    assert!(error < first, "{error} in motion, {first} in the first frame");
    let bias = mean(&pictures[12]) / mean(&truth) - 1.0;
    assert!(bias.abs() < 0.03, "{bias}");

    // Another run is bit-identical.
    let mut again = renderer(&gpu(), &scene, settings(Preset::Realtime));
    assert!(run(&mut again) == pictures, "two runs differ");
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_switched_lamp_changes_the_picture_at_once() {
    let lit = builtin("cornell");
    let mut dark = lit.clone();
    // A hundredth, since without any light there would be nothing to measure.
    for light in &mut dark.lights {
        light.color *= 0.01;
    }
    let camera = orbit(&lit, 0);
    let all = mean(&many_frames(Preset::Fast, 96));
    let rest = mean(&still(Preset::Fast, &dark, &camera, 32));
    let mut renderer = renderer(&gpu(), &lit, settings(Preset::Realtime));
    (0..8).for_each(|_| drop(frame(&mut renderer)));
    // The share of the change that is still missing after each frame.
    let mut missing = |scene: &Scene, to: f64| {
        pollster::block_on(renderer.set_lights(scene, &mut |_| {})).expect("the same scene");
        [(); 12].map(|()| (mean(&frame(&mut renderer)) - to).abs() / (all - rest))
    };
    // In the voxels, light travels one bounce a frame.
    for (scene, to) in [(&dark, rest), (&lit, all)] {
        let missing = missing(scene, to);
        assert!(missing[0] < 0.4 && missing[3] < 0.15 && missing[11] < 0.04, "{missing:?}");
    }
}

/// A lamp dims by less than the differences at edges. Still, after six frames the picture is nearer
/// to the new light than the first frame of a new renderer.
#[test]
#[ignore = "slow: over three seconds"]
fn a_slightly_dimmed_lamp_updates_within_six_frames() {
    let lit = builtin("cornell");
    let mut dimmed = lit.clone();
    for light in &mut dimmed.lights {
        light.color *= 0.7;
    }
    let after = still(Preset::Fast, &dimmed, &orbit(&lit, 0), 24);
    let renderer_of = |scene: &Scene| renderer(&gpu(), scene, settings(Preset::Realtime));
    let mut renderer = renderer_of(&lit);
    (0..24).for_each(|_| drop(frame(&mut renderer)));
    pollster::block_on(renderer.set_lights(&dimmed, &mut |_| {})).expect("the same scene");
    let picture = (0..6).map(|_| frame(&mut renderer)).last().expect("at least one");
    let mut other = renderer_of(&dimmed);
    let errors = [rmse(&frame(&mut other), &after), rmse(&picture, &after)];
    assert!(errors[1] < errors[0], "{errors:?}");
    let bias = mean(&picture) / mean(&after) - 1.0;
    assert!(bias.abs() < 0.03, "{bias}");
}

#[test]
#[ignore = "slow: over three seconds"]
fn still_pictures_converge_to_those_without_history() {
    let scene = builtin("cornell");
    let camera = orbit(&scene, 0);
    let expected = many_frames(Preset::Fast, 96);
    let [few, many] = stills(Preset::Realtime, &scene, &camera, [8, 96]);
    let errors = [rmse(&few, &expected), rmse(&many, &expected)];
    assert!(errors[1] < 0.03 && errors[1] < 0.9 * errors[0], "{errors:?}");
}

/// A block that moves out of its front plane keeps its history: only edges, where jittered samples
/// meet other surfaces, have new light.
#[test]
#[ignore = "slow: over three seconds"]
fn moving_objects_keep_their_light_history() {
    let mut scene = builtin("cornell");
    let block = scene.instances.len() - 1;
    scene.instances[block].is_static = false;
    let beside = vec![View::Disocclusion];
    let settings = RenderSettings { view: View::Final, beside, ..settings(Preset::Realtime) };
    let mut moving = renderer(&gpu(), &scene, settings);
    let mut new = Vec::new();
    for step in 0..8 {
        let mut moved = scene.clone();
        let away = Mat4::from_translation(Vec3::new(0.0, 0.0, -0.05 * step as f32));
        let instance = &mut moved.instances[block];
        instance.world_from_local = away * instance.world_from_local;
        let pixels = pollster::block_on(async {
            moving.move_instances(&moved, &[block], &mut |_| {}).await?;
            moving.render_frame().await?;
            moving.read_beside(View::Disocclusion).await
        });
        let pixels = pixels.expect("it fits").expect("it was asked for");
        new.push(pixels.iter().filter(|pixel| pixel[0] > 0.5).count());
    }
    assert!(
        new[1..].iter().all(|count| *count * 50 < new[0]),
        "{new:?} of {} pixels are new",
        new[0]
    );
}

/// Edges in motion are smoother than with one sample a pixel, which has an error of 0.22, and
/// nothing of earlier views remains.
#[test]
#[ignore = "slow: over three seconds"]
fn edges_are_smooth_in_motion() {
    let scene = builtin("cornell");
    let realtime = |camera: Camera| {
        let settings =
            RenderSettings { frames: 64, view: View::Final, ..settings(Preset::Realtime) };
        let mut renderer = renderer(&gpu(), &scene, settings);
        renderer.set_camera(camera);
        renderer
    };
    // More than a pixel a step.
    let last = orbit(&scene, 72);
    let settings = RenderSettings { frames: 64, view: View::Final, ..settings(Preset::Balanced) };
    let mut still = renderer(&gpu(), &scene, settings);
    still.set_camera(last.clone());
    let truth = (0..32).map(|_| frame(&mut still)).last().expect("at least one");
    let mut moving = realtime(orbit(&scene, 0));
    let picture = (0..=12).map(|step| {
        moving.set_camera(orbit(&scene, 6 * step));
        frame(&mut moving)
    });
    let error = rmse(&picture.last().expect("at least one"), &truth);
    println!("edges: {error} in motion");
    assert!(error < 0.13, "{error} in motion");

    // Another view restarts the mean: nothing of the former view is visible.
    moving.set_view(View::Normal, 0).expect("a view of surfaces");
    let seen = frame(&mut moving);
    let mut fresh = realtime(last);
    fresh.set_view(View::Normal, 0).expect("a view of surfaces");
    let expected = frame(&mut fresh);
    let far = |a: &[f32; 4], b: &[f32; 4]| (0..3).any(|i| (a[i] - b[i]).abs() > 0.05);
    let differ = seen.hdr.iter().zip(&expected.hdr).filter(|(a, b)| far(a, b)).count();
    assert!(differ * 10 < seen.hdr.len(), "{differ} pixels of another view");
}

/// The history counts the frames of surfaces that stay visible, and starts again where a surface is
/// disoccluded; one view shows each.
#[test]
#[ignore = "slow: over three seconds"]
fn history_grows_until_a_pixel_is_disoccluded() {
    let scene = builtin("cornell");
    let beside = vec![View::History, View::Disocclusion];
    let settings = RenderSettings { view: View::Final, beside, ..settings(Preset::Realtime) };
    let mut renderer = renderer(&gpu(), &scene, settings);
    // For each pixel that shows a surface: the number of frames, and whether it had no known light.
    let mut frame = |camera: Camera| -> Vec<(f32, bool)> {
        renderer.set_camera(camera);
        let [history, new] = pollster::block_on(async {
            renderer.render_frame().await?;
            let history = renderer.read_beside(View::History).await?;
            Ok::<_, RenderError>([history, renderer.read_beside(View::Disocclusion).await?])
        })
        .expect("a frame")
        .map(|pixels| pixels.expect("it was asked for"));
        let pixels = history.iter().zip(&new).filter(|(pixel, _)| pixel[3] > 0.0);
        pixels.map(|(history, new)| (history[0], new[0] > 0.5)).collect()
    };
    let median = |pixels: &[(f32, bool)]| {
        let mut frames: Vec<f32> = pixels.iter().map(|pixel| pixel.0).collect();
        *frames.select_nth_unstable_by(pixels.len() / 2, f32::total_cmp).1
    };
    let share = |pixels: &[(f32, bool)]| {
        pixels.iter().filter(|pixel| pixel.1).count() as f32 / pixels.len() as f32
    };
    let stills: Vec<_> = (0..6).map(|_| frame(orbit(&scene, 0))).collect();
    assert!(stills[0].iter().all(|pixel| *pixel == (2.0, true)), "the first counts for two");
    // Because of the jitter, pixels at edges may show another surface.
    assert!(share(&stills[5]) < 0.01, "{} of a still picture are new", share(&stills[5]));
    assert_eq!(median(&stills[5]), 7.0);

    let moved = frame(orbit(&scene, 60));
    assert!((0.005..0.2).contains(&share(&moved)), "{} of it came into view", share(&moved));
    assert!(median(&moved) > 4.0, "{} frames of the rest", median(&moved));
    assert!(moved.iter().all(|(frames, is_new)| !is_new || *frames == 2.0));
}

/// Pictures of a larger or smaller size continue the history.
#[test]
#[ignore = "slow: over three seconds"]
fn history_survives_a_resize() {
    let scene = builtin("cornell");
    let camera = orbit(&scene, 0);
    let [small, large] = [UVec2::new(84, 48), settings(Preset::Fast).size];
    for (from, to) in [(small, large), (large, small)] {
        let mut renderer =
            renderer(&gpu(), &scene, RenderSettings { size: from, ..settings(Preset::Realtime) });
        renderer.set_camera(camera.clone());
        (0..12).for_each(|_| drop(frame(&mut renderer)));
        let resize = |renderer: &mut Renderer, size, preset| {
            let settings = RenderSettings { size, ..settings(preset) };
            pollster::block_on(renderer.set_settings(settings, &mut |_| {})).expect("valid");
        };
        let is_kept = |renderer: &mut Renderer| {
            let figures = pollster::block_on(renderer.trace_figures()).expect("figures");
            let history = figures.and_then(|figures| figures.history_frames).expect("it is kept");
            assert!(history > 8.0, "{history} frames after 13, at {to}");
        };
        resize(&mut renderer, to, Preset::Realtime);
        let resized = frame(&mut renderer);
        is_kept(&mut renderer);
        // Two changes of size without a frame in between.
        resize(&mut renderer, from, Preset::Realtime);
        resize(&mut renderer, to, Preset::Realtime);
        let again = frame(&mut renderer);
        is_kept(&mut renderer);

        // Another preset discards the history; the next frame has the error of a first frame.
        resize(&mut renderer, to, Preset::Fast);
        resize(&mut renderer, to, Preset::Realtime);
        let first = frame(&mut renderer);
        let truth = if to == large {
            many_frames(Preset::Balanced, 48)
        } else {
            resize(&mut renderer, to, Preset::Balanced);
            let frames = (0..16).map(|_| frame(&mut renderer));
            Arc::new(frames.last().expect("at least one"))
        };
        let errors = [&resized, &again, &first].map(|picture| rmse(picture, &truth));
        // All three pictures have one sample a pixel at edges, each a different one.
        assert!(errors[..2].iter().all(|error| *error < errors[2]), "{errors:?} at {to}");
    }
}

/// The figures equal the views' values at one pixel of each 8x8.
#[test]
#[ignore = "slow: over three seconds"]
fn trace_figures_match_the_history_and_cost_views() {
    let scene = builtin("cornell");
    let beside = vec![View::History, View::Cost];
    let settings = RenderSettings { view: View::Final, beside, ..settings(Preset::Realtime) };
    let size = settings.size;
    let mut renderer = renderer(&gpu(), &scene, settings.clone());
    let figures =
        |renderer: &mut Renderer| pollster::block_on(renderer.trace_figures()).expect("figures");
    assert_eq!(figures(&mut renderer), None);
    // A first frame has more cones than the others; setting a camera restarts the mean over frames.
    drop(frame(&mut renderer));
    let first = figures(&mut renderer).expect("it was traced").samples_per_pixel;
    renderer.set_camera(orbit(&scene, 0));
    (0..3).for_each(|_| drop(frame(&mut renderer)));
    let shown = figures(&mut renderer).expect("it was traced");
    let seen = |view| {
        let pixels = pollster::block_on(renderer.read_beside(view)).expect("it is shown");
        let pixels = pixels.expect("it was asked for");
        let rows = (0..size.y as usize).step_by(8);
        let columns = |y| (0..size.x as usize).step_by(8).map(move |x| (x, y));
        rows.flat_map(columns).map(|(x, y)| pixels[y * size.x as usize + x][0]).collect::<Vec<_>>()
    };
    let [history, cost] = [View::History, View::Cost].map(seen);
    let known: Vec<f32> = history.into_iter().filter(|frames| *frames > 0.0).collect();
    let mean = known.iter().sum::<f32>() / known.len() as f32;
    assert!(known.len() > 30 && (shown.history_frames.unwrap() - mean).abs() < 1e-3, "{shown:?}");
    // The view shows the mean over frames of the counted samples.
    let samples = cost.iter().sum::<f32>() / cost.len() as f32;
    let error = shown.samples_per_pixel / samples - 1.0;
    assert!(samples > 1.0 && error.abs() < 0.2, "{shown:?}, {samples} in the mean");
    assert!(
        (2.5..4.5).contains(&(first / samples)),
        "{first} in the first frame, {samples} after it"
    );
    // At full resolution four times as many pixels are traced, each with more rays to emitters.
    let mut full = settings;
    full.trace.resolution = TraceResolution::Full;
    pollster::block_on(renderer.set_settings(full, &mut |_| {})).expect("valid");
    (0..3).for_each(|_| drop(frame(&mut renderer)));
    let full = figures(&mut renderer).expect("it was traced").samples_per_pixel;
    assert!((5.0..7.5).contains(&(full / samples)), "{full} at full resolution, {samples} at half");
}

/// The history of reflections is looked up at the former places of their images: in motion their
/// error is smaller than that of one frame with one sample a pixel, 0.34, and they are not darker.
#[test]
#[ignore = "slow: 81 frames of 240x136 pixels"]
fn reflections_keep_their_history_in_motion() {
    let scene = builtin("lacquer");
    let size = UVec2::new(240, 136);
    let own = |preset| RenderSettings { view: View::Specular, size, ..settings(preset) };
    let pose = |step: u32| orbit(&scene, 3 * step);
    let stood = |preset, frames| -> Vec<Picture> {
        let mut renderer = renderer(&gpu(), &scene, own(preset));
        renderer.set_camera(pose(24));
        (0..frames).map(|_| frame(&mut renderer)).collect()
    };
    let truth = stood(Preset::Balanced, 32).pop().expect("at least one");
    let still = stood(Preset::Realtime, 24);
    let mut camera = renderer(&gpu(), &scene, own(Preset::Realtime));
    let moving = (0..=24).map(|step| {
        camera.set_camera(pose(step));
        frame(&mut camera)
    });
    let moving = moving.last().expect("at least one");
    let errors = [&still[0], &moving, &still[23]].map(|picture| rmse(picture, &truth));
    let bias = mean(&moving) / mean(&truth) - 1.0;
    println!("reflections: {errors:?} in a first frame, in motion, and of a still picture");
    assert!(errors[0] < 0.33 && errors[1] < 0.33 && errors[2] < 0.22, "{errors:?}");
    assert!(bias.abs() < 0.08, "{bias}");
}

/// After a cut, pictures are bit-identical to those of a new renderer, whatever was shown before:
/// other surfaces, lamps, cameras, many frames. Without a cut they are not.
#[test]
#[ignore = "slow: over three seconds"]
fn a_cut_discards_all_history() {
    let gpu = gpu();
    let mut rest = builtin("cornell");
    let is_block = |instance: &Instance| instance.name == "short block";
    let block = rest.instances.iter().position(is_block).expect("the scene has it");
    rest.instances[block].is_static = false;
    let mut moved = rest.clone();
    let away = Mat4::from_translation(Vec3::new(-0.1, 0.2, 0.1));
    moved.instances[block].world_from_local = away * moved.instances[block].world_from_local;
    let mut bent = moved.clone();
    for position in &mut bent.meshes[moved.instances[block].mesh].positions {
        position.y *= 0.75;
    }
    bent.lights[0].position.x += 0.2;
    let mut lit = rest.clone();
    lit.lights[0].position.x -= 0.2;
    let settings = RenderSettings {
        size: UVec2::new(48, 27),
        resolution: 32,
        view: View::Final,
        ..settings(Preset::Realtime)
    };
    let pictures = |renderer: &mut Renderer| [(); 3].map(|()| frame(renderer));
    let mut travelling = renderer(&gpu, &rest, settings.clone());
    drop(pictures(&mut travelling));
    let mut goes_on = false;
    for (number, scene) in [&moved, &bent, &rest, &rest, &lit].into_iter().enumerate() {
        let camera = orbit(&rest, 12 * number as u32);
        pollster::block_on(async {
            match number {
                0 => travelling.move_instances(scene, &[block], &mut |_| {}).await?,
                // Only the camera moves.
                3 => {}
                4 => travelling.set_lights(scene, &mut |_| {}).await?,
                _ => travelling.set_scene(scene, &mut |_| {}).await?,
            }
            travelling.set_camera(camera.clone());
            travelling.cut(&mut |_| {}).await
        })
        .expect("the same scene");
        let seen = pictures(&mut travelling);
        let mut fresh = renderer(&gpu, scene, settings.clone());
        fresh.set_camera(camera.clone());
        assert!(seen == pictures(&mut fresh), "pose {number}: something is left");
        // Without a cut, the light of these pictures remains.
        travelling.set_camera(orbit(&rest, 0));
        travelling.set_camera(camera);
        goes_on |= frame(&mut travelling) != seen[0];
    }
    assert!(goes_on, "a cut changes something");
}

/// Each frame of a film is a picture, and continues from the one before, so edges become smooth.
#[test]
#[ignore = "slow: over three seconds"]
fn film_frames_have_antialiased_edges() {
    let scene = builtin("cornell");
    let settings = RenderSettings { frames: 2, view: View::Albedo, ..settings(Preset::Realtime) };
    let mut film = renderer(&gpu(), &scene, settings);
    let mut blended = || {
        let picture = pollster::block_on(film.render_more(1, &mut |_| ControlFlow::Continue(())));
        let picture = picture.expect("a frame").expect("not stopped");
        let mut colors: Vec<[u32; 4]> = picture.hdr.iter().map(|c| c.map(f32::to_bits)).collect();
        colors.sort_unstable();
        colors.dedup();
        colors.len()
    };
    let counts = [(); 8].map(|()| blended());
    assert!(counts[7] > 4 * counts[0], "{counts:?} colours: edges have those in between");
}
