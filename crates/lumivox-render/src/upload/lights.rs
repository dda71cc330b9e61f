//! A scene's lights in the library's terms and the renderer's unit.

use std::f32::consts::PI;

use glam::Vec3;
use lumivox::{Light, LightSource, Shadow};
use lumivox_scene::{Environment, LightKind, Scene};

/// What shines in a scene, apart from its surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    /// Analytic lights.
    pub lights: Vec<lumivox_scene::Light>,
    /// What lies around the scene.
    pub environment: Environment,
}

impl Lighting {
    /// The lighting of a scene.
    ///
    /// Where nothing shines at all, a default lets the scene be seen: an environment of 1 cd/m² from
    /// everywhere, and a sun of pi lux from above and one side, which adds 1 cd/m² to a white surface
    /// that faces it. A warning in the log says so.
    pub fn of(scene: &Scene) -> Self {
        let given = Self { lights: scene.lights.clone(), environment: scene.environment.clone() };
        let emits = |material: &lumivox_scene::Material| material.emissive.max_element() > 0.0;
        let shines = !given.lights.is_empty()
            || given.environment.radiance.max_element() > 0.0
            || scene.materials.iter().any(emits);
        if shines {
            return given;
        }
        tracing::warn!(
            "nothing shines in the scene \"{}\": it is shown under a sky of 1 cd/m² and a sun of pi \
             lux; add a light, an environment or an emissive material",
            scene.name
        );
        Self::default_of_dark_scenes()
    }

    fn default_of_dark_scenes() -> Self {
        let sun = lumivox_scene::Light {
            name: "default sun".to_owned(),
            // The sun's own size.
            kind: LightKind::Directional { illuminance_lux: PI, angular_radius_rad: 0.004_65 },
            direction: Vec3::new(-0.4, -0.8, -0.45).normalize(),
            ..lumivox_scene::Light::default()
        };
        let environment = Environment { radiance: Vec3::ONE, ..Environment::default() };
        Self { lights: vec![sun], environment }
    }

    /// The lights for the GPU, divided by the unit of radiance, with shadows by cones.
    pub(crate) fn to_gpu(&self, radiance_unit: f32) -> Vec<Light> {
        self.lights.iter().map(|light| convert(light, radiance_unit)).collect()
    }
}

fn convert(light: &lumivox_scene::Light, radiance_unit: f32) -> Light {
    let strength = |value: f32| light.color * (value / radiance_unit);
    let (position, direction, radius_m) = (light.position, light.direction, light.radius_m);
    let source = match light.kind {
        LightKind::Directional { illuminance_lux, angular_radius_rad } => {
            let irradiance = strength(illuminance_lux);
            LightSource::Directional { direction, irradiance, angular_radius_rad }
        }
        LightKind::Point { intensity_cd, range_m } => {
            let intensity = strength(intensity_cd);
            LightSource::Point { position, intensity, radius_m, range_m }
        }
        LightKind::Spot { intensity_cd, range_m, inner_angle_rad, outer_angle_rad } => {
            LightSource::Spot {
                position,
                direction,
                intensity: strength(intensity_cd),
                inner_angle_rad,
                outer_angle_rad,
                radius_m,
                range_m,
            }
        }
    };
    Light { source, shadow: Shadow::Cone }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_dark_scenes_get_default_light() {
        let mut scene = lumivox_scene::builtin::scene("cornell").expect("a scene");
        assert_eq!(Lighting::of(&scene).lights, scene.lights);
        scene.lights.clear();
        assert!(Lighting::of(&scene).lights.is_empty(), "the lamp's face still shines");
        for material in &mut scene.materials {
            material.emissive = Vec3::ZERO;
        }
        let default = Lighting::of(&scene);
        assert_eq!(default.environment.radiance, Vec3::ONE);
        scene.lights = default.lights;
        scene.validate().expect("the default sun is a valid light");
    }

    #[test]
    fn strengths_are_in_multiples_of_the_unit() {
        let scene = lumivox_scene::builtin::scene("atrium").expect("a scene");
        let lights = Lighting::of(&scene).to_gpu(64.0);
        let LightSource::Directional { irradiance, .. } = lights[0].source else {
            panic!("the atrium has a sun")
        };
        assert_eq!(irradiance.x, 80_000.0 / 64.0);
    }
}
