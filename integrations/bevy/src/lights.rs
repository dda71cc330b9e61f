//! Bevy's lights in Lumivox's form: all that shine, wherever the cameras look.

use bevy::camera::visibility::InheritedVisibility;
use bevy::color::LinearRgba;
use bevy::light::{DirectionalLight, PointLight, RectLight, SpotLight, SunDisk};
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;
use lumivox::{Light, LightSource, Shadow};
use std::f32::consts::{FRAC_PI_2, PI};

use crate::report::{LumivoxEvent, Reports};

/// Half the sun's angular diameter seen from the earth, rad.
const SUN_RADIUS: f32 = 0.004_65;

/// A light, in lux or candela.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SceneLight {
    pub(crate) light: Light,
    /// In the render world; none of a sun, whose maps are not read.
    pub(crate) entity: Option<Entity>,
}

/// The lights of a frame.
#[derive(Resource, Default)]
pub(crate) struct SceneLights {
    pub(crate) lights: Vec<SceneLight>,
}

/// Reads all lights. They are few, so that those that stand still are no case of their own.
pub(crate) fn extract_scene_lights(
    mut scene: ResMut<SceneLights>,
    suns: Extract<
        Query<(&DirectionalLight, &GlobalTransform, &InheritedVisibility, Option<&SunDisk>)>,
    >,
    points: Extract<Query<(RenderEntity, &PointLight, &GlobalTransform, &InheritedVisibility)>>,
    spots: Extract<Query<(RenderEntity, &SpotLight, &GlobalTransform, &InheritedVisibility)>>,
    rects: Extract<Query<(), With<RectLight>>>,
    reports: Res<Reports>,
) {
    scene.lights.clear();
    for (light, transform, visibility, disk) in &suns {
        let irradiance = rgb(light.color) * light.illuminance;
        let source = LightSource::Directional {
            direction: transform.forward().into(),
            irradiance,
            angular_radius_rad: disk
                .map_or(SUN_RADIUS, |disk| (0.5 * disk.angular_size).max(SUN_RADIUS)),
        };
        scene.add(source, irradiance, (None, light.shadow_maps_enabled), visibility);
    }
    for (entity, light, transform, visibility) in &points {
        // Lumen over the whole sphere.
        let intensity = rgb(light.color) * light.intensity / (4.0 * PI);
        let source = LightSource::Point {
            position: transform.translation(),
            intensity,
            radius_m: light.radius.max(0.0),
            range_m: Some(light.range),
        };
        scene.add(source, intensity, (Some(entity), light.shadow_maps_enabled), visibility);
    }
    for (entity, light, transform, visibility) in &spots {
        // As a point light of which the rest is covered: that is Bevy's meaning.
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
        scene.add(source, intensity, (Some(entity), light.shadow_maps_enabled), visibility);
    }
    if !rects.is_empty() {
        reports.once(LumivoxEvent::LightLeftOut { kind: "RectLight" });
    }
}

impl SceneLights {
    fn add(
        &mut self,
        source: LightSource,
        strength: Vec3,
        (entity, has_shadows): (Option<Entity>, bool),
        visibility: &InheritedVisibility,
    ) {
        if !visibility.get() || !strength.is_finite() || strength.max_element() <= 0.0 {
            return;
        }
        // A light that passes through walls on screen does so in the voxels.
        let shadow = if has_shadows { Shadow::Cone } else { Shadow::None };
        self.lights.push(SceneLight { light: Light { source, shadow }, entity });
    }
}

/// A light in another unit: `share` of its strength.
pub(crate) fn scaled(mut light: Light, share: f32) -> Light {
    match &mut light.source {
        LightSource::Directional { irradiance: strength, .. }
        | LightSource::Environment { irradiance: strength, .. }
        | LightSource::Point { intensity: strength, .. }
        | LightSource::Spot { intensity: strength, .. } => *strength *= share,
    }
    light
}

fn rgb(color: Color) -> Vec3 {
    LinearRgba::from(color).to_vec3()
}
