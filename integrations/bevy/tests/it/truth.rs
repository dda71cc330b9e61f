//! Compares global illumination through Bevy, and by Lumivox's own renderer, with the path tracer.
//!
//! Only indirect light is compared: the picture with global illumination minus the one without.
//! Direct light is Bevy's own (whose diffuse BRDF is Burley's, not Lambert's).

use std::ops::ControlFlow;
use std::sync::OnceLock;

use bevy::camera::{Exposure, SubCameraView};
use bevy::prelude::*;
use bevy_lumivox::{GiQuality, GiVolume, LumivoxGi};
use lumivox_render::compare::{ErrorFigures, LinearPicture};
use lumivox_render::reference::{PathTracer, ReferenceSettings};
use lumivox_render::{Gpu, GpuOptions, RenderSettings, Renderer, View};
use lumivox_scene::Scene;

use crate::baked;
use crate::common::{headless, scene};
use crate::stage::Stage;

pub const SIZE: UVec2 = UVec2::new(48, 36);
const RESOLUTION: u32 = 64;
/// Frames whose mean is compared.
const FRAMES: u32 = 32;
/// Frames in which light settles.
const SETTLING: u32 = 32;

/// Indirect light on screen through Bevy, cd/m². The stage is left without global illumination.
fn through_bevy(stage: &mut Stage, name: &str) -> LinearPicture {
    let gi = LumivoxGi {
        quality: GiQuality::Balanced,
        volume: GiVolume::Scene { resolution: RESOLUTION },
        faces_per_frame: 0,
        ..LumivoxGi::default()
    };
    stage.camera().insert(gi);
    headless::wait_until_ready(&mut stage.app);
    stage.frames(SETTLING);
    let lit = antialiased(stage);
    stage.camera().remove::<LumivoxGi>();
    let direct = antialiased(stage);
    let name = format!("target/pictures/{name}");
    lit.save(format!("{name}-bevy.png"), 2.0);
    direct.save(format!("{name}-bevy-direct.png"), 2.0);
    difference_of(&lit, &direct)
}

/// The light that `lit` adds to `direct`, cd/m².
pub fn difference_of(lit: &headless::Shot, direct: &headless::Shot) -> LinearPicture {
    let exposure = Exposure { ev100: 4.0 }.exposure();
    let pixels = lit.rgb.iter().zip(&direct.rgb);
    let rgb = pixels.map(|(lit, direct)| ((*lit - *direct) / exposure).to_array());
    LinearPicture { size: SIZE, rgb: rgb.collect() }
}

/// The mean of frames, each at another sub-pixel position.
pub fn antialiased(stage: &mut Stage) -> headless::Shot {
    let (camera, image, mut frame) = (stage.camera, stage.image.clone(), 0);
    headless::mean_of(&mut stage.app, &image, FRAMES, |app| {
        // As in Lumivox's renderer: Halton 1960, in the bases 2 and 3.
        frame += 1;
        let place = Vec2::new(radical_inverse(frame, 2), radical_inverse(frame, 3));
        let mut camera = app.world_mut().get_mut::<Camera>(camera).expect("a camera");
        let full_size = SIZE;
        camera.sub_camera_view = Some(SubCameraView { full_size, offset: 0.5 - place, size: SIZE });
    })
}

fn radical_inverse(mut index: u32, base: u32) -> f32 {
    let (mut inverse, mut digit_value) = (0.0, 1.0 / base as f32);
    while index > 0 {
        inverse += (index % base) as f32 * digit_value;
        index /= base;
        digit_value /= base as f32;
    }
    inverse
}

/// Indirect light through Lumivox's own renderer, and the albedo of each pixel.
fn through_lumivox(gpu: &Gpu, given: &Scene) -> (LinearPicture, LinearPicture) {
    pollster::block_on(async {
        let settings = RenderSettings {
            size: SIZE,
            resolution: RESOLUTION,
            frames: FRAMES,
            view: View::Indirect,
            ..RenderSettings::default()
        };
        let mut renderer =
            Renderer::new(gpu, given, None, settings, &mut |_| {}).await.expect("a renderer");
        let picture = renderer.render(&mut |_| {}).await.expect("a picture");
        renderer.set_view(View::Albedo, 0).expect("a view");
        let albedo = renderer.render(&mut |_| {}).await.expect("a picture");
        (LinearPicture::from(&picture), LinearPicture::from(&albedo))
    })
}

/// Path-traced indirect light of matt surfaces, with its variance.
fn truth(gpu: &Gpu, given: &Scene, albedo: &LinearPicture) -> (LinearPicture, Vec<f32>) {
    let settings = ReferenceSettings { size: SIZE, samples: 128, ..ReferenceSettings::default() };
    let tracer = PathTracer::new(gpu, given, None, settings);
    let mut tracer = pollster::block_on(tracer).expect("a path tracer");
    pollster::block_on(tracer.render(&mut |_| ControlFlow::Continue(()))).expect("traced");
    let layers = tracer.layers();
    let share = |rgb: &[f32; 3]| Vec3::from(*rgb) / std::f32::consts::PI;
    let pixels = layers.full.iter().zip(&albedo.rgb);
    let rgb = pixels.map(|(light, albedo)| (Vec3::from(*light) * share(albedo)).to_array());
    let shares = layers.full_variance.iter().zip(&albedo.rgb);
    let variance =
        shares.map(|(variance, albedo)| variance * headless::luminance(share(albedo)).powi(2));
    (LinearPicture { size: SIZE, rgb: rgb.collect() }, variance.collect())
}

/// The mean light that uniform surroundings add to the path-traced Cornell box, cd/m².
pub fn light_of_surroundings(radiance: f32) -> f32 {
    let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).expect("a device");
    let [dark, lit] = [0.0, radiance].map(|radiance| {
        let mut given = scene::builtin("cornell");
        given.environment.radiance = Vec3::splat(radiance);
        // Only the mean is compared.
        let settings =
            ReferenceSettings { size: SIZE, samples: 32, ..ReferenceSettings::default() };
        let tracer = PathTracer::new(&gpu, &given, None, settings);
        let mut tracer = pollster::block_on(tracer).expect("a path tracer");
        pollster::block_on(tracer.render(&mut |_| ControlFlow::Continue(()))).expect("traced");
        let luminance = |rgb: &[f32; 3]| headless::luminance(Vec3::from(*rgb));
        tracer.layers().radiance.iter().map(luminance).collect::<Vec<f32>>()
    });
    // Without pixels that show the surroundings themselves.
    let surfaces = dark.iter().zip(&lit).filter(|(dark, _)| **dark > 0.0);
    surfaces.map(|(dark, lit)| lit - dark).sum::<f32>() / dark.len() as f32
}

/// Expected indirect light: by Lumivox's renderer, and by path tracing, with its variance.
pub struct Expected {
    own: LinearPicture,
    pub truth: LinearPicture,
    pub variance: Vec<f32>,
}

impl Expected {
    pub fn of(given: &Scene) -> Self {
        let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).expect("a device");
        let (own, albedo) = through_lumivox(&gpu, given);
        let (truth, variance) = truth(&gpu, given, &albedo);
        Self { own, truth, variance }
    }

    /// The expected light of the Cornell box; made once for several tests.
    pub fn of_cornell() -> &'static Self {
        static CORNELL: OnceLock<Expected> = OnceLock::new();
        CORNELL.get_or_init(|| Self::of(&scene::builtin("cornell")))
    }
}

/// Errors of Lumivox through Bevy and by itself, in per cent.
pub fn errors_of(expected: &Expected, stage: &mut Stage, name: &str) -> [ErrorFigures; 2] {
    let bevy = through_bevy(stage, name);
    let Expected { own, truth, variance } = expected;
    let errors = [&bevy, own]
        .map(|ours| ErrorFigures::new(truth, Some(variance), ours).expect("comparable"));
    for (label, picture) in [("bevy", &bevy), ("own", own), ("truth", truth)] {
        let rgb = picture.rgb.iter().map(|rgb| Vec3::from(*rgb)).collect();
        let shot = headless::Shot { size: SIZE, rgb };
        println!("{label}: {:.3}", shot.mean_luminance());
        shot.save(format!("target/pictures/{name}-indirect-{label}.png"), 0.15);
    }
    println!("{name}: through Bevy {:.2?}, through Lumivox {:.2?}", errors[0], errors[1]);
    errors
}

#[test]
fn the_cornell_box_matches_the_path_tracer() {
    let _alone = crate::stage::alone();
    let given = scene::builtin("cornell");
    let mut stage = Stage::of(&given, SIZE);
    let [bevy, own] = errors_of(Expected::of_cornell(), &mut stage, "cornell");
    assert!(bevy.rmse_percent <= 1.1 * own.rmse_percent);
    assert!(bevy.bias_percent.abs() <= own.bias_percent.abs() + 1.0);
    baked::a_baked_volume_lights_the_cornell_box_of_bevy(&mut stage);
}
