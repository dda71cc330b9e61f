//! Lights (`KHR_lights_punctual`) and cameras.

use glam::Vec3;
use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;

use super::node::Site;
use super::{Loader, name_or_index};
use crate::pose::place_camera;
use crate::{Camera, Light, LightKind};

impl Loader<'_> {
    pub(super) fn put_light(&mut self, light: &gltf::khr_lights_punctual::Light<'_>, site: &Site) {
        let intensity = light.intensity();
        // The extension wants a range above zero; zero is a common "unlimited".
        let range_m = light.range().filter(|&range| range != 0.0);
        let kind = match light.kind() {
            Kind::Directional => {
                LightKind::Directional { illuminance_lux: intensity, angular_radius_rad: 0.0 }
            }
            Kind::Point => LightKind::Point { intensity_cd: intensity, range_m },
            Kind::Spot { inner_cone_angle, outer_cone_angle } => LightKind::Spot {
                intensity_cd: intensity,
                range_m,
                // Files with a hard edge have both equal, up to rounding.
                inner_angle_rad: inner_cone_angle.min(outer_cone_angle),
                outer_angle_rad: outer_cone_angle,
            },
        };
        // The rig puts it in its place.
        self.scene.lights.push(Light {
            name: name_or_index(light.name(), "light", light.index()),
            kind,
            color: Vec3::from_array(light.color()),
            ..Light::default()
        });
        self.rig.lights.push(site.node);
    }

    pub(super) fn put_camera(&mut self, camera: &gltf::Camera<'_>, site: &Site) {
        match convert_camera(camera, site) {
            Some(camera) => {
                self.scene.cameras.push(camera);
                self.rig.cameras.push(site.node);
            }
            None => self.notes.warn(format!(
                "camera {} at {}: only perspective cameras with sensible numbers are supported, \
                 it was skipped",
                camera.index(),
                site.name
            )),
        }
    }
}

fn convert_camera(camera: &gltf::Camera<'_>, site: &Site) -> Option<Camera> {
    let Projection::Perspective(perspective) = camera.projection() else { return None };
    let (fov, near_m) = (perspective.yfov(), perspective.znear());
    if !(fov > 0.0 && fov < std::f32::consts::PI && near_m > 0.0) {
        return None;
    }
    let mut camera = Camera {
        name: name_or_index(camera.name(), "camera", camera.index()),
        vertical_fov_rad: fov,
        near_m,
        ..Camera::default()
    };
    // A scale of zero leaves no direction; an animation may give one.
    (place_camera(&mut camera, site.world_from_node) || site.moves).then_some(camera)
}
