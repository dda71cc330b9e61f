//! The brightness of unlit surfaces.
//!
//! `KHR_materials_unlit` specifies the colour, but not how bright the picture's white is. Here it
//! is the radiance of a white wall in the same scene: a white diffuse surface that faces the
//! strongest light. So scans with baked light match lit objects beside them, whatever the exposure.

use std::f32::consts::PI;

use glam::Vec3;
use lumivox_scene::Scene;

use super::Lighting;

/// The least distance of a lamp, as a share of the scene's radius. The distance is measured from
/// the scene's centre and clamped to this: a wall of the room matters, not the lampshade.
const NEAREST: f32 = 0.25;

/// The radiance of white, in cd/m²: the maximum of irradiance / pi by each light and of the mean
/// radiance of the surroundings; without either, the strongest emission; in a scene without light 1
/// cd/m².
pub(crate) fn reference_white(scene: &Scene, lighting: &Lighting) -> f32 {
    let bounds = scene.bounds();
    let nearest_m = bounds.radius_m() * NEAREST;
    let lights = lighting.lights.iter().map(|light| {
        let distance_m = light.position.distance(bounds.center());
        let distance_m = distance_m.max(nearest_m).max(light.radius_m);
        light.color.max_element() * light.illuminance_at(distance_m) / PI
    });
    let emission = scene.materials.iter().map(|material| material.emissive.max_element());
    let strongest = |radiances: &mut dyn Iterator<Item = f32>| {
        let strongest = radiances.filter(|radiance| radiance.is_finite()).fold(0.0, f32::max);
        (strongest > 0.0).then_some(strongest)
    };
    let environment = &lighting.environment;
    let mean = environment.map.as_ref().map_or(Vec3::ONE, |map| map.mean_radiance());
    strongest(&mut lights.chain([(environment.radiance * mean).max_element()]))
        .or_else(|| strongest(&mut emission.into_iter()))
        .unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumivox_scene::Environment;

    #[test]
    fn reference_white_is_the_luminance_of_a_lit_wall() {
        let mut scene = lumivox_scene::builtin::scene("atrium").expect("a scene");
        let white = reference_white(&scene, &Lighting::of(&scene));
        assert!((white - 80_000.0 / PI).abs() < 1.0, "{white}");
        scene.lights.clear();
        let sky = scene.environment.radiance.max_element();
        assert!((reference_white(&scene, &Lighting::of(&scene)) - sky).abs() < 1e-3 * sky);
        let dark = Lighting { lights: Vec::new(), environment: Environment::default() };
        scene.materials[0].emissive = Vec3::splat(30.0);
        assert!((reference_white(&scene, &dark) - 30.0).abs() < 1e-3);
        for material in &mut scene.materials {
            material.emissive = Vec3::ZERO;
        }
        assert!((reference_white(&scene, &dark) - 1.0).abs() < 1e-6);
    }

    /// If a lamp is at the centre, white is that of a wall around it.
    #[test]
    fn central_lamps_are_measured_at_the_wall_distance() {
        let scene = lumivox_scene::builtin::scene("cornell").expect("a scene");
        let wall_m = 0.25 * scene.bounds().radius_m();
        for aside_m in [0.0, 0.5 * wall_m, 2.0 * wall_m] {
            let lamp = lumivox_scene::Light {
                intensity: 100.0,
                position: scene.bounds().center() + Vec3::X * aside_m,
                ..lumivox_scene::Light::default()
            };
            let lighting = Lighting { lights: vec![lamp], environment: Environment::default() };
            let expected = 100.0 / wall_m.max(aside_m).powi(2) / PI;
            let white = reference_white(&scene, &lighting);
            assert!((white / expected - 1.0).abs() < 1e-5, "{white} at {aside_m} m");
        }
    }
}
