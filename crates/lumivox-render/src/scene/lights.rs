//! A scene's lights in the library's form, in the renderer's unit.

use lumivox::{Light, LightSource, Shadow};
use lumivox_scene::{Environment, LightKind, Scene};

/// The light sources of a scene, except its emissive surfaces.
#[derive(Clone, Debug, PartialEq)]
pub struct Lighting {
    /// Analytic lights.
    pub lights: Vec<lumivox_scene::Light>,
    /// The surroundings of the scene.
    pub environment: Environment,
}

impl Lighting {
    /// The lighting of a scene.
    ///
    /// Without any light the picture will be black: [`Scene::stage`](lumivox_scene::Scene::stage)
    /// adds some.
    pub fn of(scene: &Scene) -> Self {
        Self { lights: scene.lights.clone(), environment: scene.environment.clone() }
    }

    /// The lights for the GPU, divided by the unit of radiance, with shadows by cones.
    pub fn to_gpu(&self, radiance_unit: f32) -> Vec<Light> {
        self.lights.iter().map(|light| convert(light, radiance_unit)).collect()
    }
}

fn convert(light: &lumivox_scene::Light, radiance_unit: f32) -> Light {
    let intensity = light.color * (light.intensity / radiance_unit);
    let lumivox_scene::Light { position, direction, radius_m, range_m, .. } = *light;
    let source = match light.kind {
        LightKind::Directional => LightSource::Directional {
            direction,
            irradiance: intensity,
            angular_radius_rad: light.angular_radius_rad,
        },
        LightKind::Point => LightSource::Point { position, intensity, radius_m, range_m },
        LightKind::Spot => LightSource::Spot {
            position,
            direction,
            intensity,
            inner_angle_rad: light.inner_angle_rad,
            outer_angle_rad: light.outer_angle_rad,
            radius_m,
            range_m,
        },
    };
    Light { source, shadow: Shadow::Cone }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_without_lights_gets_none() {
        let scene = lumivox_scene::builtin::scene("cornell").expect("a scene");
        assert_eq!(Lighting::of(&scene).lights, scene.lights);
        let dark = Scene { lights: Vec::new(), ..scene };
        let environment = Environment::default();
        assert_eq!(Lighting::of(&dark), Lighting { lights: Vec::new(), environment });
    }

    #[test]
    fn light_strengths_are_divided_by_the_unit() {
        let scene = lumivox_scene::builtin::scene("atrium").expect("a scene");
        let lights = Lighting::of(&scene).to_gpu(64.0);
        let LightSource::Directional { irradiance, .. } = lights[0].source else {
            panic!("the atrium has a sun")
        };
        assert_eq!(irradiance.x, 80_000.0 / 64.0);
    }
}
