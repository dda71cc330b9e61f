//! Tests of lux meters and luminance meters against closed forms and pictures.

use super::*;
use crate::RenderError;
use crate::reference::{LightMeter, MeterSettings, Reading, Sensor};

fn readings(scene: &Scene, sensors: &[Sensor], settings: MeterSettings) -> Vec<Reading> {
    let mut scene = scene.clone();
    scene.validate().expect("a valid scene");
    let gpu = gpu();
    let meter = LightMeter::new(&gpu, &scene, sensors, settings);
    let mut meter = pollster::block_on(meter).expect("a meter");
    let mut go_on = |_| std::ops::ControlFlow::Continue(());
    pollster::block_on(meter.measure(&mut go_on)).expect("readings");
    assert_eq!(meter.samples(), settings.samples);
    meter.readings()
}

fn up(at: Vec3) -> Sensor {
    Sensor::Irradiance { at, normal: Vec3::Y * 3.0 }
}

#[track_caller]
fn assert_reads(reading: &Reading, expected: f64) {
    let error = f64::from(reading.standard_error);
    Estimate { mean: reading.value.into(), error }.assert_is("a reading", expected);
}

/// A lamp above a black floor: the inverse square times the cosine, without noise; no light from
/// below.
#[test]
fn lamp_readings_follow_distance_and_cosine() {
    let mut scene = stage();
    let black = Material::diffuse("floor", Vec3::ZERO);
    add(&mut scene, quad(Vec3::ZERO, Vec3::X * 2.0, Vec3::NEG_Z * 2.0), black);
    scene.lights = vec![point_light(Vec3::new(0.0, 1.5, 0.0), 300.0, 0.0)];
    let at = Vec3::new(0.7, 0.0, -0.4);
    let sensors = [up(at), Sensor::Irradiance { at, normal: Vec3::NEG_Y }, up(Vec3::Y)];
    let readings = readings(&scene, &sensors, MeterSettings { samples: 32, ..Default::default() });
    let squared = f64::from(0.7_f32 * 0.7 + 0.4 * 0.4 + 1.5 * 1.5);
    assert_reads(&readings[0], 300.0 * 1.5 / squared.powf(1.5));
    assert_eq!(readings[0].direct, readings[0].total);
    assert!((readings[0].openness - 1.0).abs() < 1e-6);
    assert_eq!((readings[1].value, readings[1].openness), (0.0, 1.0), "below the floor");
    assert_reads(&readings[2], 300.0 / 0.25);
}

/// A vertical sensor above a black floor sees half of the sky; values are luminances of colours.
#[test]
fn sky_readings_follow_the_visible_hemisphere_share() {
    let mut scene = stage();
    let black = Material::diffuse("floor", Vec3::ZERO);
    add(&mut scene, quad(Vec3::ZERO, Vec3::X * 500.0, Vec3::NEG_Z * 500.0), black);
    scene.environment.radiance = Vec3::new(100.0, 200.0, 400.0);
    let at = Vec3::new(0.0, 0.01, 0.0);
    let sensors = [
        up(at),
        Sensor::Irradiance { at, normal: Vec3::X },
        Sensor::Radiance { at, direction: Vec3::new(0.3, 0.2, 0.1) },
        Sensor::Radiance { at, direction: Vec3::NEG_Y },
    ];
    let readings = readings(&scene, &sensors, MeterSettings::default());
    let luminance = 0.2126 * 100.0 + 0.7152 * 200.0 + 0.0722 * 400.0;
    assert_reads(&readings[0], std::f64::consts::PI * luminance);
    let [r, g, b] = readings[0].total;
    assert!((g / r - 2.0).abs() < 1e-3 && (b / r - 4.0).abs() < 1e-3, "{r} {g} {b}");
    assert_eq!(readings[0].direct, [0.0; 3], "a sky is no lamp");
    assert!((readings[1].openness - 0.5).abs() < 0.05);
    // The floor ends at 500 m, 1 cm below: at most 1e-4 of the sky is visible below the horizon.
    let half = 0.5 * std::f64::consts::PI * luminance;
    let error = f64::from(readings[1].standard_error);
    Estimate { mean: readings[1].value.into(), error }
        .assert_near("half a sky", Estimate { mean: half, error: 1e-4 * half });
    assert_reads(&readings[2], luminance);
    assert_eq!(readings[3].value, 0.0);
}

/// Sensors on surfaces read the light of pictures of these surfaces, with all bounces.
#[test]
#[ignore = "slow: over three seconds"]
fn sensors_agree_with_pictures() {
    let scene = builtin("cornell");
    let camera = &scene.cameras[0];
    let size = UVec2::splat(16);
    let picker = lumivox_scene::Picker::new(&scene);
    let pixels = [UVec2::new(8, 14), UVec2::new(3, 8), UVec2::new(8, 8)];
    let seen = pixels.map(|pixel| {
        let (origin, direction) = camera.ray(pixel.as_vec2() + 0.5, size);
        let pick = picker.pick(origin, direction).expect("a wall");
        (origin, direction, pick.position, pick.shading_normal)
    });
    let irradiance = seen.map(|(_, _, at, normal)| Sensor::Irradiance { at, normal });
    let radiance = seen.map(|(at, direction, ..)| Sensor::Radiance { at, direction });
    let sensors = [irradiance, radiance].concat();
    let settings = MeterSettings { samples: 512, ..Default::default() };
    let readings = readings(&scene, &sensors, settings);
    for (number, (at, direction, ..)) in seen.into_iter().enumerate() {
        // A picture of one pixel, a thousandth of a radian wide.
        let narrow = Camera::look_at(at, at + direction, 1e-3);
        let settings = ReferenceSettings { size: UVec2::ONE, ..super::settings(1, 512) };
        let gpu = gpu();
        let tracer = PathTracer::new(&gpu, &scene, Some(&narrow), settings);
        let layers = finish(pollster::block_on(tracer).expect("a path tracer"));
        let lux = |[r, g, b]: [f32; 3]| {
            f64::from(0.2126 * r) + f64::from(0.7152 * g) + f64::from(0.0722 * b)
        };
        // The full layer excludes direct light from lamps.
        let pixel =
            Estimate { mean: lux(layers.full[0]), error: layers.full_variance[0].sqrt().into() };
        let reading = &readings[number];
        let mean = lux(reading.total) - lux(reading.direct);
        Estimate { mean, error: reading.standard_error.into() }.assert_near("illuminance", pixel);
        let error = f64::from(layers.radiance_variance[0].sqrt());
        let reading = &readings[3 + number];
        Estimate { mean: reading.value.into(), error: reading.standard_error.into() }
            .assert_near("luminance", Estimate { mean: lux(layers.radiance[0]), error });
        assert!(readings[number].value > 0.0 && reading.value > 0.0);
    }
}

/// Readings with different seeds differ by the reported standard error.
#[test]
#[ignore = "slow: over three seconds"]
fn the_standard_error_matches_repeated_runs() {
    let scene = builtin("cornell");
    let sensor = [up(Vec3::new(0.1, 0.2, 0.1)), up(Vec3::new(-0.2, 0.3, 0.3))];
    let each: Vec<Vec<Reading>> = (0..12)
        .map(|seed| readings(&scene, &sensor, MeterSettings { samples: 256, seed, bounces: None }))
        .collect();
    for number in 0..sensor.len() {
        let values: Vec<f64> = each.iter().map(|seed| seed[number].value.into()).collect();
        let mean = values.iter().sum::<f64>() / 12.0;
        let spread = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 11.0;
        let told =
            each.iter().map(|seed| f64::from(seed[number].standard_error).powi(2)).sum::<f64>()
                / 12.0;
        println!("spread {} told {}", spread.sqrt(), told.sqrt());
        // In 999 of 1000 cases, the ratio of variances with 11 and 180 degrees of freedom is within
        // these bounds.
        assert!((0.2..3.0).contains(&(spread / told)), "{spread} {told}");
    }
}

#[test]
fn bad_sensors_are_named() {
    let (scene, gpu) = (builtin("cornell"), gpu());
    let bad = |sensors: &[Sensor]| {
        let meter = LightMeter::new(&gpu, &scene, sensors, MeterSettings::default());
        match pollster::block_on(meter) {
            Err(RenderError::Setting { name, value, .. }) => format!("{name}: {value}"),
            other => panic!("{other:?}"),
        }
    };
    assert!(bad(&[]).contains("number of sensors: 0"));
    assert!(bad(&[up(Vec3::ZERO), up(Vec3::NAN)]).contains("(number 1)"));
    let still = Sensor::Radiance { at: Vec3::ZERO, direction: Vec3::ZERO };
    assert!(bad(&[still]).contains("direction"));
}
