//! White furnaces: uniform light shows how much a surface reflects, and that no surface adds light.

use lumivox_scene::{Clearcoat, MetallicRoughness, Phong, Shading};

use super::brdf::Lobes;
use super::*;

/// In a closed cube that emits 1 cd/m² and reflects a half everywhere, the light of n bounces is a
/// sum of powers of a half, and that of all bounces 2 cd/m².
#[test]
fn a_closed_furnace_is_a_geometric_series() {
    for (bounces, samples) in [(Some(0), 16), (Some(1), 16), (Some(3), 64), (None, 256)] {
        let asked = ReferenceSettings { bounces, ..settings(8, samples) };
        let layers = traced(&builtin("furnace"), &asked);
        let powers = |count: u32| 2.0 - 0.5_f64.powi(count as i32 - 1);
        let [radiance, irradiance] = match bounces {
            // Light of 0 to n reflections; the irradiance is the light before the last one.
            Some(n) => [powers(n + 1), powers(n)],
            None => [2.0, 2.0],
        };
        Estimate::radiance(&layers).assert_is(&format!("{bounces:?} bounces"), radiance);
        let what = format!("irradiance of {bounces:?} bounces");
        Estimate::full(&layers).assert_is(&what, std::f64::consts::PI * irradiance);
        assert!(layers.coverage.iter().all(|share| *share == 1.0), "a ray left a closed cube");
        assert!(layers.occlusion.iter().all(|open| *open == 0.0), "nothing is open inside");
    }
}

/// The angles of facets that turn away from the camera, in sections of one material each. The body
/// is convex, so that nothing blocks the light of a uniform sky.
const ANGLES: [f64; 5] = [0.05, 0.55, 0.95, 1.25, 1.45];

struct Section {
    what: &'static str,
    material: Material,
    lobes: Lobes,
}

fn sections() -> Vec<Section> {
    let metal = |roughness: f32| Section {
        what: "metal",
        material: Material {
            shading: Shading::MetallicRoughness(MetallicRoughness {
                metallic: 1.0,
                roughness,
                ..MetallicRoughness::default()
            }),
            ..Material::default()
        },
        lobes: Lobes {
            f0: 1.0,
            // The least alpha.
            alpha: f64::from(roughness * roughness).max(0.001),
            ..Lobes::default()
        },
    };
    let phong = |diffuse: f32, specular: f32, shininess: f32| Section {
        what: "Phong",
        material: Material {
            shading: Shading::Phong(Phong {
                diffuse: Vec3::splat(diffuse),
                specular: Vec3::splat(specular),
                shininess,
                ..Phong::default()
            }),
            ..Material::default()
        },
        lobes: Lobes {
            diffuse: diffuse.into(),
            f0: specular.into(),
            phong_exponent: shininess.into(),
            ..Lobes::default()
        },
    };
    let mut varnished = Material::diffuse("varnished", Vec3::splat(0.5));
    varnished.clearcoat = Clearcoat { strength: 1.0, roughness: 0.4, texture: None };
    vec![
        Section {
            what: "diffuse",
            material: Material::diffuse("diffuse", Vec3::splat(0.8)),
            lobes: Lobes { diffuse: 0.8, ..Lobes::default() },
        },
        metal(0.0),
        metal(0.3),
        metal(0.6),
        metal(1.0),
        phong(0.0, 1.0, 30.0),
        phong(0.6, 0.3, 4.0),
        Section {
            what: "varnish over a half",
            material: varnished,
            lobes: Lobes {
                diffuse: 0.5,
                coat_strength: 1.0,
                coat_alpha: 0.4 * 0.4,
                ..Lobes::default()
            },
        },
    ]
}

#[test]
fn surfaces_in_an_even_sky_show_their_directional_albedo() {
    let sections = sections();
    let mut scene = stage();
    scene.environment.radiance = Vec3::ONE;
    // To the camera the facets are equally wide; it is so far away that it sees all of them along
    // -z.
    let mut corner = Vec3::ZERO;
    for angle in ANGLES {
        let along = Vec3::new(1.0, 0.0, -(angle.tan() as f32));
        for (index, section) in sections.iter().enumerate() {
            let up = Vec3::Y * 0.5;
            let center = corner + 0.5 * along + Vec3::Y * (index as f32 + 0.5);
            add(&mut scene, quad(center, 0.5 * along, up), section.material.clone());
        }
        corner += along;
    }
    let (columns, rows) = (ANGLES.len() as u32, sections.len() as u32);
    let distance = 4000.0_f32;
    let middle = Vec3::new(0.5 * columns as f32, 0.5 * rows as f32, 0.0);
    let fov = 2.0 * (0.5 * rows as f32 / distance).atan();
    scene.cameras = vec![Camera::look_at(middle + Vec3::Z * distance, middle, fov)];
    // A cell has 6 x 6 pixels, of which the inner 4 x 4 count.
    let size = 6 * UVec2::new(columns, rows);
    let layers = traced(&scene, &ReferenceSettings { size, ..settings(1, 128) });
    for (column, angle) in ANGLES.into_iter().enumerate() {
        for (row, section) in sections.iter().enumerate() {
            let (x, y) = (6 * column as u32 + 1, 6 * (rows - 1 - row as u32) + 1);
            let pixels =
                (y..y + 4).flat_map(|y| (x..x + 4).map(move |x| (y * size.x + x) as usize));
            let seen = Estimate::over(pixels, &layers.radiance, &layers.radiance_variance);
            let expected = section.lobes.albedo(angle.cos());
            let what = format!("{}, {angle:.2} rad, {:?}", section.what, section.lobes.alpha);
            seen.assert_is(&what, expected);
            assert!(seen.mean < 1.0 + 4.0 * seen.error + ROUNDING, "{what} makes light: {seen:?}");
        }
    }
    // Every facet of a convex body gathers the whole sky. The last facet ends within a column of
    // pixels.
    let inner: Vec<usize> =
        (0..layers.full.len()).filter(|pixel| layers.coverage[*pixel] == 1.0).collect();
    assert!(inner.len() > layers.full.len() / 2, "{} pixels", inner.len());
    let open = inner.iter().all(|pixel| layers.occlusion[*pixel] == 1.0);
    assert!(open, "nothing is in the way");
    Estimate::over(inner, &layers.full, &layers.full_variance)
        .assert_is("irradiance", std::f64::consts::PI);
}
