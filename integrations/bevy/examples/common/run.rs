//! Runs an example: in a window with the feature `window`, otherwise without one, saving pictures.
//!
//! `cargo run --release --example NAME -- [--frames N] [--size WIDTHxHEIGHT] [--out FOLDER]
//! [--lit]` saves three of the frames (in `pictures/`), and prints the time of a frame with global
//! illumination and, unless `--lit` is given, without.

use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;

/// Seconds since the example began: real time in a window, otherwise 1/30 for each frame.
#[derive(Resource, Default)]
pub struct Clock(pub f32);

/// Replaces Bevy's default tone mapping, whose table needs a feature.
fn tone_map(added: On<Add<Camera3d>>, mut commands: Commands) {
    commands.entity(added.entity).insert(Tonemapping::AcesFitted);
}

/// Runs the example. `build` adds the plugin and systems; cameras are spawned at startup.
#[cfg(feature = "window")]
pub fn run(_name: &str, build: impl FnOnce(&mut App)) {
    let mut app = App::new();
    app.add_plugins(DefaultPlugins);
    app.init_resource::<Clock>().add_observer(tone_map);
    app.add_systems(First, |mut clock: ResMut<Clock>, time: Res<Time>| {
        clock.0 = time.elapsed_secs()
    });
    build(&mut app);
    app.run();
}

/// Runs the example. `build` adds the plugin and systems; cameras are spawned at startup.
#[cfg(not(feature = "window"))]
pub fn run(name: &str, build: impl FnOnce(&mut App)) {
    use std::time::Instant;

    use bevy_lumivox::LumivoxGi;
    use bevy_lumivox::lumivox::gpu::MadeResources;

    use super::headless;

    let Arguments { frames, size, out, is_lit_alone } = arguments();
    let mut app = App::new();
    app.add_plugins(headless::plugins(None));
    app.init_resource::<Clock>().add_observer(tone_map);
    build(&mut app);
    headless::start(&mut app);
    let (image, target) = headless::target(&mut app, size);
    // Cameras render into the image.
    app.add_observer(move |added: On<Add<Camera3d>>, mut commands: Commands| {
        commands.entity(added.entity).insert(target.clone());
    });
    app.update();
    let world = app.world_mut();
    let is_lit = world.query::<&LumivoxGi>().iter(world).next().is_some();
    if is_lit {
        headless::wait_until_ready(&mut app);
    }
    let timed = |app: &mut App, saves: bool| {
        headless::wait_for_gpu(app);
        let (start, made) = (Instant::now(), MadeResources::now());
        for frame in 0..frames {
            app.world_mut().resource_mut::<Clock>().0 += 1.0 / 30.0;
            app.update();
            let place = [frames / 3, 2 * frames / 3, frames - 1].iter().position(|at| *at == frame);
            if let Some(place) = place.filter(|_| saves) {
                headless::shot(app, &image).save(out.join(format!("{name}-{place}.png")), 1.0);
            }
        }
        headless::wait_for_gpu(app);
        let ms = start.elapsed().as_secs_f64() * 1e3 / f64::from(frames);
        let now = MadeResources::now();
        (
            ms,
            now.buffers + now.textures + now.bind_groups
                - made.buffers
                - made.textures
                - made.bind_groups,
        )
    };
    let (with, made) = timed(&mut app, true);
    if !is_lit || is_lit_alone {
        println!("{name}: {frames} frames of {}x{}: {with:.0} ms each", size.x, size.y);
        return;
    }
    let world = app.world_mut();
    let mut lit = world.query_filtered::<Entity, With<LumivoxGi>>();
    for camera in lit.iter(world).collect::<Vec<_>>() {
        app.world_mut().entity_mut(camera).remove::<LumivoxGi>();
    }
    app.update();
    let (without, _) = timed(&mut app, false);
    println!(
        "{name}: {frames} frames of {}x{}: {with:.0} ms each, {without:.0} ms without global illumination; {made} \
         resources made",
        size.x, size.y
    );
}

#[cfg(not(feature = "window"))]
struct Arguments {
    frames: u32,
    size: UVec2,
    out: std::path::PathBuf,
    is_lit_alone: bool,
}

#[cfg(not(feature = "window"))]
fn arguments() -> Arguments {
    let arguments: Vec<String> = std::env::args().collect();
    let value = |name: &str| {
        let place = arguments.iter().position(|argument| argument == name)?;
        arguments.get(place + 1).cloned()
    };
    let frames = value("--frames").and_then(|frames| frames.parse().ok()).unwrap_or(90);
    let size = value("--size").and_then(|size| {
        let (width, height) = size.split_once('x')?;
        Some(UVec2::new(width.parse().ok()?, height.parse().ok()?))
    });
    let out = value("--out").unwrap_or_else(|| "pictures".to_owned()).into();
    let is_lit_alone = arguments.iter().any(|argument| argument == "--lit");
    Arguments { frames, size: size.unwrap_or(UVec2::new(320, 180)), out, is_lit_alone }
}
