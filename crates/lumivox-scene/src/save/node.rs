//! Instances, lights and cameras, each on a separate node.

use glam::{DVec3, Mat4, Vec3};
use serde_json::{Value, json};

use super::Writer;
use super::document::{number, numbers, own_extras};
use super::material::{Object, power_of_two_above};
use crate::load::shorten;
use crate::model::to_unit;
use crate::{Attenuation, Camera, Instance, Light, Scene};

/// The instances that have anything to show, hidden ones included.
pub(super) fn shown(scene: &Scene) -> impl Iterator<Item = &Instance> {
    scene.instances.iter().filter(|instance| !scene.meshes[instance.mesh].indices.is_empty())
}

impl Writer<'_> {
    pub(super) fn nodes(&mut self) {
        let scene = self.scene;
        for instance in shown(scene) {
            let mirrored = instance.world_from_local.as_dmat4().determinant() < 0.0;
            let mesh = self.mesh(instance.mesh, instance.material, mirrored);
            let mut node = placed(&instance.name, instance.world_from_local);
            node.set("mesh", json!(mesh));
            // Only exceptions are marked: animations are not saved, so the loader makes everything
            // static.
            let marks = [
                ("static", instance.is_static, true),
                ("voxelized", instance.is_voxelized, true),
                ("backdrop", instance.is_backdrop, false),
            ];
            let unusual = marks.into_iter().filter(|(_, mark, usual)| mark != usual);
            let own = unusual.map(|(name, mark, _)| (name.to_owned(), json!(mark))).collect();
            own_extras(&mut node.0, &own);
            if instance.is_hidden {
                const EXTENSION: &str = "KHR_node_visibility";
                self.document.uses(EXTENSION);
                node.set("extensions", json!({ EXTENSION: { "visible": false } }));
            }
            self.document.push("nodes", &Value::Object(node.0));
        }
        for light in &scene.lights {
            const EXTENSION: &str = "KHR_lights_punctual";
            self.document.uses(EXTENSION);
            let number = self.document.push("lights", &convert_light(light));
            let direction = to_unit(light.direction).unwrap_or(Vec3::NEG_Z);
            let up = direction.any_orthonormal_vector();
            let mut node = placed(&light.name, looking(light.position, direction, up));
            node.set("extensions", json!({ EXTENSION: { "light": number } }));
            self.document.push("nodes", &Value::Object(node.0));
        }
        for camera in &scene.cameras {
            let number = self.document.push("cameras", &convert_camera(camera));
            let (forward, up) = axes(camera);
            let mut node = placed(&camera.name, looking(camera.position, forward, up));
            node.set("camera", json!(number));
            self.document.push("nodes", &Value::Object(node.0));
        }
    }
}

/// A node with a transform.
fn placed(name: &str, world_from_local: Mat4) -> Object {
    let mut node = Object::default();
    node.set("name", json!(shorten(name)));
    if world_from_local != Mat4::IDENTITY {
        // Converts -0 to 0, since multiplying by a parent's identity would drop the sign.
        let matrix = world_from_local.to_cols_array().map(|x| x + 0.0);
        node.set("matrix", numbers(&matrix));
    }
    node
}

/// The transform at a position with the -z axis along `forward` and y along `up`, both of unit
/// length.
fn looking(position: Vec3, forward: Vec3, up: Vec3) -> Mat4 {
    Mat4::from_cols(
        forward.cross(up).normalize().extend(0.0),
        up.extend(0.0),
        (-forward).extend(0.0),
        position.extend(1.0),
    )
}

fn convert_light(light: &Light) -> Value {
    let mut json = Object::default();
    let mut own = Object::default();
    json.set("name", json!(shorten(&light.name)));
    own.factor("radiusM", light.radius_m, 0.0);
    if let Some(Attenuation { constant, linear, quadratic }) = light.attenuation {
        own.set("attenuation", numbers(&[constant, linear, quadratic]));
    }
    own.factor("angularRadiusRad", light.angular_radius_rad, 0.0);
    if let Some([inner, outer]) = light.cone_rad() {
        // glTF requires at most pi/2, which f32's pi/2 exceeds, and an inner angle below the outer
        // one. In f64 both hold, and the numbers are unchanged when read as f32.
        let outer = f64::from(outer).min(std::f64::consts::FRAC_PI_2);
        let inner = f64::from(inner).min(outer * (1.0 - 1e-12));
        json.set("spot", json!({ "innerConeAngle": inner, "outerConeAngle": outer }));
    }
    json.set("type", json!(light.kind.name()));
    if let Some(range_m) = light.range_m.filter(|_| light.kind.has("range")) {
        json.set("range", number(range_m));
    }
    // glTF's colours are at most 1. A power of two is moved to the intensity, without loss.
    let scale = power_of_two_above(light.color.max_element());
    let (color, scaled) = (light.color / scale, light.intensity * scale);
    let exact =
        color * scale == light.color && (scaled / scale).to_bits() == light.intensity.to_bits();
    if scale > 1.0 && exact {
        own.set("colorScale", number(scale));
        json.set("color", numbers(color.as_ref()));
        json.set("intensity", number(scaled));
    } else {
        json.color("color", light.color, Vec3::ONE);
        json.set("intensity", number(light.intensity));
    }
    own_extras(&mut json.0, &own.0);
    Value::Object(json.0)
}

fn convert_camera(camera: &Camera) -> Value {
    let perspective =
        json!({ "yfov": number(camera.vertical_fov_rad), "znear": number(camera.near_m) });
    json!({ "name": shorten(&camera.name), "perspective": perspective, "type": "perspective" })
}

/// The forward direction, and an up vector orthogonal to it.
fn axes(camera: &Camera) -> (Vec3, Vec3) {
    let forward = to_unit(camera.forward).unwrap_or(Vec3::NEG_Z);
    let (f, u) = (forward.as_dvec3(), camera.up.as_dvec3());
    // Vectors that are orthogonal up to f32's rounding of about 1e-7 are unchanged.
    if f.dot(u).abs() < 1e-6
        && let Some(up) = to_unit(camera.up)
    {
        return (forward, up);
    }
    // The squared length is 1 up to rounding; dividing by it matters if `up` is almost along the
    // line of sight.
    let up = (u - f * (f.dot(u) / f.length_squared())).try_normalize().map(DVec3::as_vec3);
    (forward, up.unwrap_or_else(|| forward.any_orthonormal_vector()))
}
