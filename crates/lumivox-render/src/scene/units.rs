//! The unit of radiance on the GPU.
//!
//! Voxels and G-buffer store radiance in half floats, from 6e-5 (with full precision; down to 6e-8
//! with less) to 65 504. A sunlit street has 30 000 cd/m² with highlights far above, a room at
//! night a thousandth. So all emission is divided by a unit at upload, and the picture is
//! multiplied by it at the end. The unit is a power of two, so both steps are exact.

use std::f32::consts::PI;

use glam::Vec3;
use lumivox_scene::{Bounds, Environment, Scene};

use super::Lighting;

/// The stored value of the brightest expected radiance: a factor of 64 below the largest half
/// float, for highlights and for surfaces near a lamp, and 24 powers of two above the smallest
/// number with full precision.
const BRIGHTEST: f32 = 1024.0;

/// The least distance of a lamp, as a share of the scene's radius: its irradiance grows without
/// bounds towards it. Nearer surfaces use the headroom, down to an eighth of that distance.
const NEAREST: f32 = 1.0 / 16.0;

/// The unit for a scene, in cd/m².
///
/// It is the power of two that scales the brightest radiance to between 512 and 1024. The brightest
/// radiance is the maximum of emission, of the environment's radiance (for a map, four times its
/// mean: see below) and of irradiance / pi of the lights (on a white surface that faces them).
pub fn radiance_unit(scene: &Scene, lighting: &Lighting) -> f32 {
    radiance_unit_within(scene.bounds(), scene, lighting)
}

/// Like [`radiance_unit`], for a scene that moves within `bounds`: all its poses share one unit.
pub(crate) fn radiance_unit_within(bounds: Bounds, scene: &Scene, lighting: &Lighting) -> f32 {
    // Clamped so that the unit and its inverse are normal floats.
    let unit = |brightest: f32| (brightest / BRIGHTEST).log2().ceil().clamp(-100.0, 100.0).exp2();
    brightest(bounds, scene, lighting).map_or(1.0, unit)
}

/// Whether a unit still suits a scene whose lights have changed: an eighth of the headroom is left,
/// and a thousandth of the brightness still has precision. Darkness suits every unit.
pub(crate) fn suits(unit: f32, bounds: Bounds, scene: &Scene, lighting: &Lighting) -> bool {
    brightest(bounds, scene, lighting).is_none_or(|brightest| {
        let stored = brightest / unit;
        (BRIGHTEST / 2048.0..=8.0 * BRIGHTEST).contains(&stored)
    })
}

/// The largest expected radiance, in cd/m²; `None` in darkness.
fn brightest(bounds: Bounds, scene: &Scene, lighting: &Lighting) -> Option<f32> {
    let nearest_m = bounds.radius_m() * NEAREST;
    let lights = lighting.lights.iter().map(|light| {
        light.color.max_element() * light.illuminance_at(nearest_m.max(light.radius_m)) / PI
    });
    let emission = scene.materials.iter().map(|material| material.emissive.max_element());
    let brightest = lights
        .chain(emission)
        .chain([surroundings(&lighting.environment)])
        .filter(|radiance| radiance.is_finite())
        .fold(0.0, f32::max);
    (brightest > 0.0).then_some(brightest)
}

/// The largest radiance of a white surface that reflects the surroundings: irradiance / pi is at
/// most four times the mean radiance, which it reaches if all light comes from one direction.
fn surroundings(environment: &Environment) -> f32 {
    let mean = environment.map.as_ref().map_or(Vec3::ONE, |map| 4.0 * map.mean_radiance());
    (environment.radiance * mean).max_element()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_scales_the_brightest_light_into_range() {
        let unit_of = |radiance: f32| {
            let radiance = Vec3::new(0.0, radiance, 0.0);
            let environment = Environment { radiance, ..Environment::default() };
            radiance_unit(&Scene::default(), &Lighting { lights: Vec::new(), environment })
        };
        for radiance in [1e-6_f32, 0.3, 1.0, 1000.0, 1024.0, 3e9] {
            let unit = unit_of(radiance);
            let scaled = radiance / unit;
            assert!(scaled > 0.5 * BRIGHTEST && scaled <= BRIGHTEST, "{radiance}: {scaled}");
            assert_eq!(unit.log2().fract(), 0.0);
        }
        assert_eq!(unit_of(0.0), 1.0);
    }

    #[test]
    fn a_unit_fits_light_that_neither_overflows_nor_underflows() {
        let suits = |radiance: f32| {
            let environment =
                Environment { radiance: Vec3::splat(radiance), ..Environment::default() };
            let lighting = Lighting { lights: Vec::new(), environment };
            suits(1.0, Scene::default().bounds(), &Scene::default(), &lighting)
        };
        assert!(suits(BRIGHTEST) && suits(8.0 * BRIGHTEST) && suits(1.0) && suits(0.0));
        assert!(!suits(9.0 * BRIGHTEST) && !suits(0.4));
    }

    #[test]
    fn built_in_scenes_need_moderate_units() {
        for name in lumivox_scene::builtin::names() {
            let scene = lumivox_scene::builtin::scene(name).expect("a built-in scene");
            let unit = radiance_unit(&scene, &Lighting::of(&scene));
            assert!((1e-4..1e4).contains(&unit), "{name}: {unit}");
        }
    }
}
