//! Converts Bevy's lights to Lumivox's: all that are not hidden, in view or not.

use bevy::camera::visibility::InheritedVisibility;
use bevy::color::LinearRgba;
use bevy::ecs::system::SystemParam;
use bevy::light::atmosphere::ScatteringMedium;
use bevy::light::{Atmosphere, DirectionalLight, PointLight, RectLight, SpotLight, SunDisk};
use bevy::pbr::AtmosphereSettings;
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;
use lumivox::{Light, LightSource, Shadow};
use std::f32::consts::{FRAC_PI_2, PI};

use crate::light::surroundings::transmittance;
use crate::report::{LumivoxEvent, Reports};
use crate::settings::LumivoxGi;

/// Angular radius of the sun seen from the earth, rad.
const SUN_RADIUS: f32 = 0.004_65;

/// Quantization steps of the share of sunlight that the air transmits.
const AIR_SHADES: f32 = 512.0;

/// A light, in lux or candela.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SceneLight {
    pub(crate) light: Light,
    /// The light's entity in the render world.
    pub(crate) entity: Entity,
}

/// The lights of a frame.
#[derive(Resource, Default)]
pub(crate) struct SceneLights {
    pub(crate) lights: Vec<SceneLight>,
}

/// Extracts all lights every frame. They are few, so unchanged lights get no special case.
pub(crate) fn extract_scene_lights(
    mut scene: ResMut<SceneLights>,
    suns: Extract<
        Query<(
            RenderEntity,
            &DirectionalLight,
            &GlobalTransform,
            &InheritedVisibility,
            Option<&SunDisk>,
        )>,
    >,
    points: Extract<Query<(RenderEntity, &PointLight, &GlobalTransform, &InheritedVisibility)>>,
    spots: Extract<Query<(RenderEntity, &SpotLight, &GlobalTransform, &InheritedVisibility)>>,
    rects: Extract<Query<(), With<RectLight>>>,
    air: Extract<Air>,
    reports: Res<Reports>,
) {
    scene.lights.clear();
    for (entity, light, transform, visibility, disk) in &suns {
        let irradiance =
            rgb(light.color) * light.illuminance * air.left_of(transform.back().into());
        let source = LightSource::Directional {
            direction: transform.forward().into(),
            irradiance,
            angular_radius_rad: disk
                .map_or(SUN_RADIUS, |disk| (0.5 * disk.angular_size).max(SUN_RADIUS)),
        };
        scene.add(source, irradiance, (entity, light.shadow_maps_enabled), visibility);
    }
    for (entity, light, transform, visibility) in &points {
        // Bevy's `intensity` is in lumens over the whole sphere.
        let intensity = rgb(light.color) * light.intensity / (4.0 * PI);
        let source = LightSource::Point {
            position: transform.translation(),
            intensity,
            radius_m: light.radius.max(0.0),
            range_m: Some(light.range),
        };
        scene.add(source, intensity, (entity, light.shadow_maps_enabled), visibility);
    }
    for (entity, light, transform, visibility) in &spots {
        // As in Bevy, a spot light is a point light that is blocked outside its cone.
        let intensity = rgb(light.color) * light.intensity / (4.0 * PI);
        let outer = light.outer_angle.clamp(0.0, FRAC_PI_2 - 1e-4);
        let source = LightSource::Spot {
            position: transform.translation(),
            direction: transform.forward().into(),
            intensity,
            inner_angle_rad: light.inner_angle.clamp(0.0, outer),
            outer_angle_rad: outer,
            radius_m: light.radius.max(0.0),
            range_m: Some(light.range),
        };
        scene.add(source, intensity, (entity, light.shadow_maps_enabled), visibility);
    }
    if !rects.is_empty() {
        reports.once(LumivoxEvent::LightLeftOut { kind: "RectLight" });
    }
}

/// The atmosphere that the cameras see suns through.
#[derive(SystemParam)]
pub(crate) struct Air<'w, 's> {
    atmospheres: Query<'w, 's, (&'static Atmosphere, &'static GlobalTransform)>,
    cameras: Query<'w, 's, &'static GlobalTransform, (With<AtmosphereSettings>, With<LumivoxGi>)>,
    media: Option<Res<'w, Assets<ScatteringMedium>>>,
}

impl Air<'_, '_> {
    /// The share of sunlight from the direction `towards` that reaches the first camera. It is
    /// quantized in invisibly small steps, so that a moving camera does not change the light every
    /// frame.
    fn left_of(&self, towards: Vec3) -> Vec3 {
        let Some(camera) = self.cameras.iter().next().map(GlobalTransform::translation) else {
            return Vec3::ONE;
        };
        let distance = |planet: &GlobalTransform| planet.translation().distance_squared(camera);
        let nearest = self
            .atmospheres
            .iter()
            .min_by(|one, other| distance(one.1).total_cmp(&distance(other.1)));
        let Some((atmosphere, planet)) = nearest else { return Vec3::ONE };
        let media = self.media.as_ref();
        let Some(medium) = media.and_then(|media| media.get(&atmosphere.medium)) else {
            return Vec3::ONE;
        };
        let share = transmittance((atmosphere, planet), medium, camera, towards);
        (share * AIR_SHADES).round() / AIR_SHADES
    }
}

impl SceneLights {
    fn add(
        &mut self,
        source: LightSource,
        strength: Vec3,
        (entity, has_shadows): (Entity, bool),
        visibility: &InheritedVisibility,
    ) {
        if !visibility.get() || !strength.is_finite() || strength.max_element() <= 0.0 {
            return;
        }
        // Without shadow maps a light passes through walls on screen, so also in voxels.
        let shadow = if has_shadows { Shadow::Cone } else { Shadow::None };
        self.lights.push(SceneLight { light: Light { source, shadow }, entity });
    }
}

/// The light with its strength multiplied by `share`, to convert its unit.
pub(crate) fn scaled(mut light: Light, share: f32) -> Light {
    *light.source.strength_mut() *= share;
    light
}

fn rgb(color: Color) -> Vec3 {
    LinearRgba::from(color).to_vec3()
}
