//! Compares cubes and peaks with sums over the panorama.

mod on_gpu;

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Mat3, Vec3};

use super::Panorama;
use super::cube::{Cube, Image, direction, reduced, solid_angle_sr};
use super::peaks::split;

fn image(width: u32, radiance: impl Fn(DVec3) -> Vec3) -> Image {
    let height = width / 2;
    let empty = Panorama { width, height, rgb: &[] };
    let rgb = (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .map(|(x, y)| radiance(empty.direction(f64::from(x) + 0.5, f64::from(y) + 0.5)).to_array())
        .collect();
    Image { width, height, rgb }
}

/// Brute force: the sum over all texels of radiance, solid angle, and `weight` of the direction.
fn integral(panorama: Panorama<'_>, weight: impl Fn(DVec3) -> f64) -> DVec3 {
    let mut sum = DVec3::ZERO;
    for y in 0..panorama.height {
        for x in 0..panorama.width {
            let direction = panorama.direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
            let weight = weight(direction) * panorama.solid_angle_sr(y);
            sum += weight * panorama.at(x, y).as_dvec3();
        }
    }
    sum
}

fn irradiance(panorama: Panorama<'_>, normal: Vec3) -> Vec3 {
    integral(panorama, |direction| direction.dot(normal.as_dvec3()).max(0.0)).as_vec3()
}

/// Radiance of a colourful gradient, brighter towards +x and up.
fn gradient(direction: DVec3) -> Vec3 {
    Vec3::new(2.0 + direction.x as f32, 1.5 + direction.y as f32, 1.2 - direction.z as f32)
}

/// A disc around a direction, of a radius and an irradiance, added to `under`.
fn with_disc(to: Vec3, radius: f64, lux: f32, under: fn(DVec3) -> Vec3) -> impl Fn(DVec3) -> Vec3 {
    let radiance = lux / (PI * radius.sin().powi(2)) as f32;
    let to = to.normalize().as_dvec3();
    move |direction| {
        let inside = direction.dot(to) > radius.cos();
        under(direction) + if inside { Vec3::splat(radiance) } else { Vec3::ZERO }
    }
}

fn close(actual: Vec3, expected: Vec3, share: f32, what: &str) {
    let error = (actual - expected).abs().max_element() / expected.abs().max_element();
    assert!(error <= share, "{what}: {actual}, not {expected} (off by {error})");
}

#[test]
fn cube_texels_cover_the_whole_solid_angle() {
    for edge in [1, 2, 7, 16] {
        let texels = (0..edge).flat_map(|y| (0..edge).map(move |x| (x, y)));
        let face: f32 = texels.map(|(x, y)| solid_angle_sr(edge, x, y)).sum();
        assert!((f64::from(face) * 6.0 / (4.0 * PI) - 1.0).abs() < 1e-5, "{edge}: {face}");
    }
}

#[test]
fn every_mip_keeps_the_panoramas_total_light() {
    let image = image(64, with_disc(Vec3::new(0.3, 0.5, 0.7), 0.2, 30.0, gradient));
    let panorama = image.panorama();
    let total = integral(panorama, |_| 1.0).as_vec3();
    let mut cube = Cube::project(panorama, 16);
    let mut last = None;
    loop {
        let edge = cube.edge;
        let face_texels = (edge * edge) as usize;
        let mut sum = Vec3::ZERO;
        let mut moment = Vec3::ZERO;
        for (index, texel) in cube.texels.iter().enumerate() {
            let (face, place) = (index / face_texels, (index % face_texels) as u32);
            let (x, y) = (place % edge, place / edge);
            let weight = solid_angle_sr(edge, x, y);
            let middle = |i: u32| (2.0 * i as f32 + 1.0) / edge as f32 - 1.0;
            sum += weight * *texel;
            moment += weight * texel.x * direction(face, middle(x), middle(y)).normalize();
        }
        // 16 samples a texel, bilinear.
        close(sum, total, 2e-3, "light of a mip");
        // The light keeps its mean direction; coarse texels count at their middles.
        let first = integral(panorama, |_| 1.0).x;
        let expected = moment_of(panorama);
        let share = 0.01 + 2.0 / (edge * edge) as f32;
        assert!((moment - expected).length() < first as f32 * share, "{moment} {expected} {edge}");
        // Mips have equal light.
        if let Some(last) = last {
            close(sum, last, 1e-5, "light of two mips");
        }
        last = Some(sum);
        if edge == 1 {
            break;
        }
        cube = cube.halved();
    }
}

fn moment_of(panorama: Panorama<'_>) -> Vec3 {
    let along = |axis: DVec3| integral(panorama, |direction| direction.dot(axis)).x as f32;
    Vec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
}

#[test]
fn reduced_panoramas_keep_their_total_light() {
    let image = image(256, with_disc(Vec3::new(0.3, 0.5, 0.7), 0.05, 30.0, gradient));
    let small = reduced(image.panorama(), 64).expect("it is too large");
    assert_eq!((small.width, small.height), (64, 32));
    assert!(reduced(small.panorama(), 64).is_none());
    let sum = |image: &Image| integral(image.panorama(), |_| 1.0).as_vec3();
    close(sum(&small), sum(&image), 1e-5, "light");
}

/// The parts that are cut out and the rest add up, texel by texel and for surfaces that face both.
#[test]
fn extracting_a_sun_keeps_the_total_light() {
    // Suns from a pole to a seam of the panorama.
    let suns = [
        Vec3::new(0.3, 0.8, -0.4),
        Vec3::new(0.02, 1.0, 0.01),
        Vec3::new(0.0, 0.3, 1.0),
        Vec3::new(1.0, -0.2, 0.1),
    ];
    for to_sun in suns {
        let to_sun = to_sun.normalize();
        for radius in [0.02, 0.1] {
            let image = image(256, with_disc(to_sun, radius, 40.0, gradient));
            let panorama = image.panorama();
            let split = split(panorama);
            let rest = split.rest.expect("the sun was cut out");
            assert_eq!(split.peaks.len(), 1, "{to_sun} {radius}");
            let peak = split.peaks[0];
            assert!(peak.direction.dot(to_sun) > 1.0 - 1e-4, "{peak:?}, not {to_sun}");
            let found = f64::from(peak.angular_radius_rad);
            // A texel is 0.012 rad wide.
            assert!((found - radius).abs() < 0.013, "radius {found}, not {radius}");
            for normal in [to_sun, (to_sun + Vec3::new(0.2, -0.1, 0.3)).normalize()] {
                let parts = irradiance(rest.panorama(), normal)
                    + peak.irradiance * peak.direction.dot(normal);
                // For other normals, the colours' different centres cause errors.
                close(parts, irradiance(panorama, normal), 1e-4, "irradiance");
            }
            let facing = irradiance(rest.panorama(), peak.direction) + peak.irradiance;
            close(facing, irradiance(panorama, peak.direction), 1e-6, "irradiance");
            // The rest of the sun is as dark as its surroundings.
            let most = rest.rgb.iter().flatten().fold(0.0_f32, |a, b| a.max(*b));
            assert!(most < 3.5, "{most}");
        }
    }
}

#[test]
fn only_compact_peaks_are_extracted() {
    let cut = |image: &Image| split(image.panorama()).peaks.len();
    assert_eq!(cut(&image(64, |_| Vec3::ONE)), 0, "a constant");
    assert_eq!(cut(&image(64, |_| Vec3::ZERO)), 0, "nothing");
    assert_eq!(cut(&image(64, gradient)), 0, "a gradient");
    let half = |d: DVec3| if d.x > 0.0 { Vec3::splat(9.0) } else { Vec3::splat(0.1) };
    assert_eq!(cut(&image(128, half)), 0, "a half");
    let window = |d: DVec3| {
        let is_window = d.z < -0.5 && d.x.abs() < 0.3 && d.y.abs() < 0.2;
        Vec3::splat(if is_window { 50.0 } else { 0.5 })
    };
    assert_eq!(cut(&image(128, window)), 0, "a window");
    let tube = |d: DVec3| {
        let is_tube = d.y > 0.5 && d.x.abs() < 0.4 && d.z.abs() < 0.02;
        Vec3::splat(if is_tube { 200.0 } else { 0.5 })
    };
    assert_eq!(cut(&image(256, tube)), 0, "a tube");
    // A star of 1 % of a cone.
    let cone = PI as f32 / 12.0;
    let star = with_disc(Vec3::new(0.4, 0.5, 0.6), 0.03, 0.01 * cone, |_| Vec3::ONE);
    assert_eq!(cut(&image(256, star)), 0, "a star");
}

/// A peak with more light than a cone of the rest's radiance, pi / 12 times that, is cut out; a
/// weaker one stays.
#[test]
fn peaks_are_extracted_above_a_share_of_the_rest() {
    let disc = |lux| image(256, with_disc(Vec3::new(0.4, 0.5, 0.6), 0.03, lux, |_| Vec3::ONE));
    let light = |image: &Image| integral(image.panorama(), |_| 1.0).x - 4.0 * PI;
    // Texels change the disc's size slightly.
    let per_lux = light(&disc(1.0));
    for (share, expected) in [(1.01, 1), (0.99, 0)] {
        let image = disc((share * PI / 12.0 / per_lux) as f32);
        assert_eq!(split(image.panorama()).peaks.len(), expected, "{share} of a cone");
    }
}

#[test]
fn only_the_strongest_peaks_are_extracted() {
    // Six lamps in a dim room, each brighter than the previous one.
    let lamps: Vec<Vec3> = (0..6)
        .map(|i| {
            let (z, x) = (1.0 * i as f32).sin_cos();
            Vec3::new(x, 0.4, z).normalize()
        })
        .collect();
    let radiance = |direction: DVec3| {
        let mut sum = Vec3::splat(0.1);
        for (index, lamp) in lamps.iter().enumerate() {
            if direction.dot(lamp.as_dvec3()) > 0.04_f64.cos() {
                sum += Vec3::splat(1000.0 * (1 + index) as f32);
            }
        }
        sum
    };
    let image = image(256, radiance);
    let peaks = split(image.panorama()).peaks;
    let chosen: Vec<usize> = peaks
        .iter()
        .filter_map(|peak| lamps.iter().position(|lamp| lamp.dot(peak.direction) > 0.999))
        .collect();
    assert_eq!(chosen, [5, 4, 3, 2]);
}

/// Equal panoramas give the same bits; a turned panorama gives turned lights.
#[test]
fn extracted_peaks_are_deterministic_and_turn_with_the_panorama() {
    let scene = with_disc(Vec3::new(0.3, 0.4, -0.5), 0.05, 40.0, gradient);
    let straight = image(128, &scene);
    let bits = |image: &Image| {
        let peak = split(image.panorama()).peaks[0];
        (peak.direction.to_array().map(f32::to_bits), peak.irradiance.to_array().map(f32::to_bits))
    };
    assert_eq!(bits(&straight), bits(&straight));
    let mut turned = image(128, &scene);
    for row in turned.rgb.chunks_mut(128) {
        // Columns go to the right, clockwise seen from above.
        row.rotate_right(32);
    }
    let (a, b) = (split(straight.panorama()).peaks[0], split(turned.panorama()).peaks[0]);
    let expected = Mat3::from_rotation_y(-(TAU as f32) / 4.0) * a.direction;
    assert!(b.direction.dot(expected) > 1.0 - 1e-6);
    close(b.irradiance, a.irradiance, 1e-5, "irradiance");
}
