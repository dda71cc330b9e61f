//! Lights (`KHR_lights_punctual`) and cameras.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::Vec3;
use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;

use super::node::Site;
use super::{Loader, extras, name_or_index};
use crate::load::files;
use crate::pose::place_camera;
use crate::{Camera, Light, LightKind};

impl Loader<'_> {
    pub(super) fn put_light(
        &mut self,
        light: &gltf::khr_lights_punctual::Light<'_>,
        node: Option<&str>,
        site: &Site,
    ) {
        let mut warn = |what: String| {
            self.notes.warn(format!("light {} at {}: {what}", light.index(), site.name));
        };
        if light.intensity() < 0.0 {
            warn(format!("its intensity of {} is negative and counts as 0", light.intensity()));
        }
        let mut converted = Light::default();
        match light.kind() {
            Kind::Directional => converted.kind = LightKind::Directional,
            Kind::Point => converted.kind = LightKind::Point,
            Kind::Spot { inner_cone_angle, outer_cone_angle } => {
                let ([inner_rad, outer_rad], repair) = cone([inner_cone_angle, outer_cone_angle]);
                if let Some(repair) = repair {
                    warn(format!(
                        "its cone angles of {inner_cone_angle} and {outer_cone_angle} {repair}"
                    ));
                }
                converted.kind = LightKind::Spot;
                converted.outer_angle_rad = outer_rad;
                // For a hard edge, files have two equal angles, up to rounding.
                converted.inner_angle_rad = inner_rad.min(outer_rad);
            }
        }
        converted.intensity = light.intensity().max(0.0);
        converted.color = Vec3::from_array(light.color());
        // The extension forbids a range of zero, which commonly means unlimited.
        converted.range_m = light.range().filter(|&range| range != 0.0);
        // The rig sets its position and direction.
        converted.name = self.name_on(node, light.name(), "light", light.index());
        extras::restore_light(&mut converted, light.extras());
        self.scene.lights.push(converted);
        self.rig.lights.push(site.node);
    }

    pub(super) fn put_camera(
        &mut self,
        camera: &gltf::Camera<'_>,
        node: Option<&str>,
        site: &Site,
    ) {
        match convert_camera(camera, site) {
            Some((converted, in_degrees)) => {
                if let Some(yfov) = in_degrees {
                    self.notes.warn(format!(
                        "camera {} at {}: its yfov of {yfov} counts as degrees",
                        camera.index(),
                        site.name
                    ));
                }
                let name = self.name_on(node, camera.name(), "camera", camera.index());
                self.scene.cameras.push(Camera { name, ..converted });
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

    /// The name of a light or a camera: its own, or its node's if another light or camera has it.
    /// If the name differs from the node's, the notes record both.
    fn name_on(
        &mut self,
        node: Option<&str>,
        own: Option<&str>,
        kind: &'static str,
        index: usize,
    ) -> String {
        let is_used = |own: &&str| self.names.contains(&(kind, (*own).to_owned()));
        let name = name_or_index(own.filter(|own| !is_used(own)).or(node).or(own), kind, index);
        self.names.insert((kind, name.clone()));
        if let Some(node) = node.map(files::shorten).filter(|node| *node != name) {
            self.scene.notes.nodes.entry(node).or_insert_with(|| name.clone());
        }
        name
    }
}

/// The inner and outer angle of a spot light in radians, and the repair that was needed.
fn cone(given: [f32; 2]) -> ([f32; 2], Option<&'static str>) {
    if given.iter().all(|angle| (0.0..=FRAC_PI_2).contains(angle)) && given[1] > 0.0 {
        return (given, None);
    }
    if given[0] >= 0.0 && given[1] > PI && given[1] <= 90.0 {
        return (given.map(f32::to_radians), Some("count as degrees"));
    }
    if given[1] <= 0.0 {
        // The outer angle is the extension's default.
        return ([0.0, FRAC_PI_4], Some("leave no cone; it has one of 45 degrees"));
    }
    (given.map(|angle| angle.clamp(0.0, FRAC_PI_2)), Some("were limited to 0 to pi/2"))
}

/// The camera, and its angle if the file gives it in degrees.
fn convert_camera(camera: &gltf::Camera<'_>, site: &Site) -> Option<(Camera, Option<f32>)> {
    let Projection::Perspective(perspective) = camera.projection() else { return None };
    let (given, near_m) = (perspective.yfov(), perspective.znear());
    let in_degrees = Some(given).filter(|&given| given > PI);
    let fov = in_degrees.map_or(given, f32::to_radians);
    if !(fov > 0.0 && fov < PI && near_m > 0.0) {
        return None;
    }
    let mut camera = Camera { vertical_fov_rad: fov, near_m, ..Camera::default() };
    // A node scaled to zero has no direction, unless an animation scales it.
    (place_camera(&mut camera, site.world_from_node) || site.moves).then_some((camera, in_degrees))
}
