//! Tests against closed forms for the light of lamps and panels.

use std::f64::consts::PI;

use glam::DVec3;

use super::*;

/// Irradiance divided by radiance at a point with a normal, by a polygon entirely above it:
/// Lambert, "Photometria" (1760); in the form of Arvo 1995, "Analytic methods for simulated light
/// transport", section 3.1. The corners are counter-clockwise as seen from the point.
fn polygon_irradiance(point: DVec3, normal: DVec3, corners: &[DVec3]) -> f64 {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let each = |(a, b): (&DVec3, &DVec3)| {
        let (a, b) = ((*a - point).normalize(), (*b - point).normalize());
        a.angle_between(b) * a.cross(b).normalize().dot(normal)
    };
    0.5 * edges.map(each).sum::<f64>().abs()
}

/// The mean of a quantity over a pixel of a camera that looks straight down on a square of the
/// floor with edge `edge_m`.
fn pixel_mean(pixel: usize, edge_pixels: u32, edge_m: f64, of: impl Fn(DVec3) -> f64) -> f64 {
    let at = |pixel: u32, part: u32| {
        ((f64::from(pixel) + (f64::from(part) + 0.5) / 4.0) / f64::from(edge_pixels) - 0.5) * edge_m
    };
    let (column, row) = (pixel as u32 % edge_pixels, pixel as u32 / edge_pixels);
    let parts = (0..16).map(|part| of(DVec3::new(at(column, part % 4), 0.0, at(row, part / 4))));
    parts.sum::<f64>() / 16.0
}

fn look_down(scene: &mut Scene, height_m: f32, edge_m: f32) {
    let fov = 2.0 * (0.5 * edge_m / height_m).atan();
    scene.cameras = vec![Camera::look_at(Vec3::Y * height_m, Vec3::ZERO, fov)];
}

#[test]
fn a_panel_lights_a_floor_by_lamberts_formula() {
    let mut scene = builtin("panel");
    // The panel faces down, so it is invisible from above.
    look_down(&mut scene, 6.0, 5.8);
    let corners = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)];
    let corners = corners.map(|(x, z)| DVec3::new(x, 1.0, z));
    let edge = 24;
    let layers = traced(&scene, &ReferenceSettings { bounces: Some(1), ..settings(edge, 256) });
    let expected: Vec<f64> = (0..layers.full.len())
        .map(|pixel| pixel_mean(pixel, edge, 5.8, |at| polygon_irradiance(at, DVec3::Y, &corners)))
        .collect();
    let mean = expected.iter().sum::<f64>() / expected.len() as f64;
    // The panel's share of the hemisphere is not open, unless the panel is out of reach.
    let open: Vec<[f32; 3]> = layers.occlusion.iter().map(|open| [*open; 3]).collect();
    Estimate::of(&open, &layers.occlusion_variance).assert_is("openness", 1.0 - mean / PI);
    let near = ReferenceSettings { occlusion_distance_m: 0.9, ..settings(2, 16) };
    assert!(traced(&scene, &near).occlusion.iter().all(|open| *open == 1.0));
    Estimate::full(&layers).assert_is("irradiance", mean);
    let once = Estimate::of(&layers.one_bounce, &layers.one_bounce_variance);
    once.assert_is("irradiance of one bounce", mean);
    // The floor reflects half of the light.
    Estimate::radiance(&layers).assert_is("radiance", 0.5 * mean / PI);
    // Individual pixels, too: the squares of their errors in standard deviations have a mean of 1,
    // within the spread of chi squared with one degree of freedom per pixel, plus a tenth, since
    // the deviations are themselves estimates.
    let squares = layers.full.iter().zip(&layers.full_variance).zip(&expected).map(
        |(([value, ..], variance), expected)| {
            (f64::from(*value) - expected).powi(2) / f64::from(*variance)
        },
    );
    let score = squares.sum::<f64>() / expected.len() as f64;
    println!("mean square error of the pixels: {score:.3} variances");
    let scatter = 4.0 * (2.0 / expected.len() as f64).sqrt() + 0.1;
    assert!((score - 1.0).abs() < scatter, "{score} variances");
}

/// Lamps without size have no noise, except from the choice between several.
#[test]
fn lamps_light_a_floor_by_their_distance_and_cosine() {
    let albedo = 0.6;
    let mut scene = stage();
    let white = Material::diffuse("floor", Vec3::splat(albedo as f32));
    add(&mut scene, quad(Vec3::ZERO, Vec3::X * 2.0, Vec3::NEG_Z * 2.0), white);
    look_down(&mut scene, 5.0, 2.0);
    let lamp = DVec3::new(0.7, 1.5, -0.4);
    let spot = DVec3::new(-0.5, 2.0, 0.3);
    let toward_sun = DVec3::new(0.3, 1.0, 0.2).normalize();
    let by_lamp = |at: DVec3, lamp: DVec3, candela: f64| {
        let away = lamp - at;
        candela * away.normalize().y / away.length_squared()
    };
    let spot_light = Light {
        kind: LightKind::Spot,
        // All visible points are inside the inner cone.
        inner_angle_rad: 1.2,
        outer_angle_rad: 1.3,
        ..point_light(spot.as_vec3(), 3.0, 0.0)
    };
    let of_lamps = |at: DVec3| by_lamp(at, lamp, 5.0) + by_lamp(at, spot, 3.0) + 2.0 * toward_sun.y;
    let edge = 8;
    for (lights, expected) in [
        (
            vec![point_light(lamp.as_vec3(), 5.0, 0.0)],
            &(|at| by_lamp(at, lamp, 5.0)) as &dyn Fn(_) -> _,
        ),
        (
            vec![
                point_light(lamp.as_vec3(), 5.0, 0.05),
                spot_light,
                sun(-toward_sun.as_vec3(), 2.0, 0.01),
                // A dark lamp.
                point_light(Vec3::Y, 0.0, 0.2),
            ],
            &of_lamps,
        ),
    ] {
        scene.lights = lights;
        let layers = traced(&scene, &settings(edge, 256));
        let pixels = layers.direct.len();
        let mean = (0..pixels).map(|pixel| pixel_mean(pixel, edge, 2.0, expected)).sum::<f64>();
        let direct = Estimate::of(&layers.direct, &layers.direct_variance);
        direct.assert_is("direct light", albedo / PI * mean / pixels as f64);
        assert_eq!(layers.direct, layers.radiance, "nothing else sends light");
        assert!(layers.full.iter().all(|pixel| *pixel == [0.0; 3]), "no gather finds any");
    }
}

/// Half of a round lamp is visible from where the plane through the wall's edge and the lamp's
/// centre meets the floor.
#[test]
fn the_penumbra_middle_gets_half_the_lamps_light() {
    let mut scene = stage();
    let white = Material::diffuse("floor", Vec3::ONE);
    add(&mut scene, quad(Vec3::ZERO, Vec3::X * 2.0, Vec3::NEG_Z * 2.0), white.clone());
    // A wall at x > 0, invisible from above.
    add(&mut scene, quad(Vec3::new(2.0, 1.0, 0.0), Vec3::X * 2.0, Vec3::Z * 4.0), white);
    scene.lights = vec![point_light(Vec3::Y * 2.0, 4.0, 0.2)];
    let edge_m = 0.08_f32;
    look_down(&mut scene, 0.9, edge_m);
    let layers = traced(&scene, &settings(8, 512));
    let direct = Estimate::of(&layers.direct, &layers.direct_variance);
    // I / d² at the centre, 8e-4 more than 4 cm beside it.
    let whole = 4.0 / 4.0 / PI;
    direct.assert_near("half a lamp", Estimate { mean: 0.5 * whole, error: 2e-4 * whole });
    let column = |x: usize| {
        let pixels = (0..8).map(|y| 8 * y + x);
        Estimate::over(pixels, &layers.direct, &layers.direct_variance).mean
    };
    assert!(column(0) > 1.05 * column(7), "it grows darker: {} to {}", column(0), column(7));
}
