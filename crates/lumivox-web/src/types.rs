//! What a page hands over and gets back: plain objects, with declarations for TypeScript made from these types.

use glam::Vec3;
use lumivox_render::parameters::{Kind, PARAMETERS, Parameter};
use lumivox_render::{MemoryUse, RenderSettings};
use lumivox_scene::{Attenuation, Bounds, Scene};
use serde::{Deserialize, Serialize};
use tsify::Tsify;

use crate::error::WebError;
use crate::settings::SettingValue;

/// Where the picture is taken from. Lengths are in metres, y is up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// For lists and messages.
    #[serde(default)]
    #[tsify(optional)]
    pub name: String,
    /// The eye.
    #[tsify(type = "[number, number, number]")]
    pub position: Vec3,
    /// What it looks at; its distance is of no meaning.
    #[tsify(type = "[number, number, number]")]
    pub target: Vec3,
    /// Towards the top of the picture, not along the line of sight. Default: `[0, 1, 0]`.
    #[serde(default = "upright")]
    #[tsify(optional, type = "[number, number, number]")]
    pub up: Vec3,
    /// From the bottom to the top of the picture, above 0 and below 180. Default: 45.
    #[serde(default = "usual_fov")]
    #[tsify(optional)]
    pub vertical_fov_deg: f32,
}

fn upright() -> Vec3 {
    Vec3::Y
}

fn usual_fov() -> f32 {
    45.0
}

impl From<&lumivox_scene::Camera> for Camera {
    fn from(camera: &lumivox_scene::Camera) -> Self {
        Self {
            name: camera.name.clone(),
            position: camera.position,
            target: camera.position + camera.forward,
            up: camera.up,
            vertical_fov_deg: camera.vertical_fov_rad.to_degrees(),
        }
    }
}

impl Camera {
    /// The scene's kind of camera; the near plane stays that of `present`.
    ///
    /// # Errors
    /// When it looks nowhere, or at no angle.
    pub fn to_scene(
        &self,
        present: &lumivox_scene::Camera,
    ) -> Result<lumivox_scene::Camera, WebError> {
        let fail = |what: &str| Err(WebError::value(format!("the camera's {what}")));
        if ![self.position, self.target, self.up].iter().all(|v| v.is_finite()) {
            return fail("position, target and up must be finite numbers");
        }
        let Some(forward) = (self.target - self.position).try_normalize() else {
            return fail("target is its position; move one of them");
        };
        let Some(up) = self.up.try_normalize().filter(|up| up.cross(forward).length() > 1e-6)
        else {
            return fail("up is along its line of sight; turn one of them");
        };
        if !(self.vertical_fov_deg > 0.0 && self.vertical_fov_deg < 180.0) {
            return fail("vertical_fov_deg must be above 0 and below 180");
        }
        Ok(lumivox_scene::Camera {
            name: self.name.clone(),
            position: self.position,
            forward,
            up,
            vertical_fov_rad: self.vertical_fov_deg.to_radians(),
            near_m: present.near_m,
        })
    }
}

/// The kinds of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Tsify)]
#[serde(rename_all = "kebab-case")]
pub enum LightKind {
    /// Parallel light, as of the sun; its strength is in lux.
    Directional,
    /// In all directions from one place; its strength is in candela.
    Point,
    /// In a cone from one place; its strength is in candela.
    Spot,
}

/// A light that is not seen itself. What its kind has no use for is passed over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(default, deny_unknown_fields)]
pub struct Light {
    /// For lists and messages. Default: `"light"`.
    #[tsify(optional)]
    pub name: String,
    /// Default: `"point"`.
    #[tsify(optional)]
    pub kind: LightKind,
    /// Linear red, green and blue, at least 0. Default: white.
    #[tsify(optional, type = "[number, number, number]")]
    pub color: Vec3,
    /// Candela; of a directional light lux. At least 0. Default: 100.
    #[tsify(optional)]
    pub intensity: f32,
    /// Metres. Default: the origin.
    #[tsify(optional, type = "[number, number, number]")]
    pub position: Vec3,
    /// In which its light travels. Default: down.
    #[tsify(optional, type = "[number, number, number]")]
    pub direction: Vec3,
    /// Of what shines, in metres, for soft shadows. Default: 0.
    #[tsify(optional)]
    pub radius_m: f32,
    /// Half the angle under which a directional light is seen, in degrees. Default: 0; the sun has 0.27.
    #[tsify(optional)]
    pub angular_radius_deg: f32,
    /// Beyond which it may be cut off, in metres; `null` is nowhere, the default.
    #[tsify(optional, type = "number | null")]
    pub range_m: Option<f32>,
    /// Of a spot, from its axis, where it begins to fall, in degrees. Default: 0.
    #[tsify(optional)]
    pub inner_cone_deg: f32,
    /// And where it ends, at most 90. Default: 45.
    #[tsify(optional)]
    pub outer_cone_deg: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            name: "light".to_owned(),
            kind: LightKind::Point,
            color: Vec3::ONE,
            intensity: 100.0,
            position: Vec3::ZERO,
            direction: Vec3::NEG_Y,
            radius_m: 0.0,
            angular_radius_deg: 0.0,
            range_m: None,
            inner_cone_deg: 0.0,
            outer_cone_deg: 45.0,
        }
    }
}

impl From<&lumivox_scene::Light> for Light {
    fn from(light: &lumivox_scene::Light) -> Self {
        let common = Self {
            name: light.name.clone(),
            color: light.color,
            position: light.position,
            direction: light.direction,
            radius_m: light.radius_m,
            ..Self::default()
        };
        match light.kind {
            lumivox_scene::LightKind::Directional { illuminance_lux, angular_radius_rad } => Self {
                kind: LightKind::Directional,
                intensity: illuminance_lux,
                angular_radius_deg: angular_radius_rad.to_degrees(),
                ..common
            },
            lumivox_scene::LightKind::Point { intensity_cd, range_m } => {
                Self { kind: LightKind::Point, intensity: intensity_cd, range_m, ..common }
            }
            lumivox_scene::LightKind::Spot {
                intensity_cd,
                range_m,
                inner_angle_rad,
                outer_angle_rad,
            } => Self {
                kind: LightKind::Spot,
                intensity: intensity_cd,
                range_m,
                inner_cone_deg: inner_angle_rad.to_degrees(),
                outer_cone_deg: outer_angle_rad.to_degrees(),
                ..common
            },
        }
    }
}

impl Light {
    /// The scene's kind of light, checked; `attenuation` is what only the look of VXCT heeds.
    ///
    /// # Errors
    /// When a number is out of its range.
    pub fn to_scene(
        &self,
        attenuation: Option<Attenuation>,
    ) -> Result<lumivox_scene::Light, WebError> {
        let name = &self.name;
        let at_least_0 = |what: &str, number: f32| {
            if number >= 0.0 && number.is_finite() {
                return Ok(number);
            }
            Err(WebError::value(format!(
                "{what} of the light \"{name}\" is {number}, but must be at least 0"
            )))
        };
        for channel in self.color.to_array() {
            at_least_0("color", channel)?;
        }
        if !self.position.is_finite() {
            return Err(WebError::value(format!(
                "position of the light \"{name}\" must be finite numbers"
            )));
        }
        let direction = self.direction.try_normalize().ok_or_else(|| {
            WebError::value(format!("direction of the light \"{name}\" must not be zero"))
        })?;
        let intensity = at_least_0("intensity", self.intensity)?;
        if let Some(range_m) = self.range_m {
            at_least_0("range_m", range_m)?;
        }
        let (inner, outer) = (self.inner_cone_deg, self.outer_cone_deg);
        if !(0.0 <= inner && inner <= outer && 0.0 < outer && outer <= 90.0) {
            return Err(WebError::value(format!(
                "the cone of the light \"{name}\" is from {inner} to {outer} degrees, but must be from at least 0 to \
                 at most 90, the outer angle not below the inner one"
            )));
        }
        let kind = match self.kind {
            LightKind::Directional => lumivox_scene::LightKind::Directional {
                illuminance_lux: intensity,
                angular_radius_rad: at_least_0("angular_radius_deg", self.angular_radius_deg)?
                    .to_radians(),
            },
            LightKind::Point => {
                lumivox_scene::LightKind::Point { intensity_cd: intensity, range_m: self.range_m }
            }
            LightKind::Spot => lumivox_scene::LightKind::Spot {
                intensity_cd: intensity,
                range_m: self.range_m,
                inner_angle_rad: inner.to_radians(),
                outer_angle_rad: outer.to_radians(),
            },
        };
        Ok(lumivox_scene::Light {
            name: name.clone(),
            kind,
            color: self.color,
            position: self.position,
            direction,
            radius_m: at_least_0("radius_m", self.radius_m)?,
            attenuation,
        })
    }
}

/// How far something is that takes time.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct Progress {
    /// `fetching`, `reading`, `textures`, `compile`, `upload`, `voxelize` or `light`.
    pub stage: String,
    /// From 0 to `total`.
    pub done: f64,
    /// Bytes of files, or steps; 0 where nobody knows.
    pub total: f64,
}

/// A box along the axes, in metres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Tsify)]
pub struct Box3 {
    /// Its least corner.
    #[tsify(type = "[number, number, number]")]
    pub min: Vec3,
    /// Its greatest.
    #[tsify(type = "[number, number, number]")]
    pub max: Vec3,
}

impl From<Bounds> for Box3 {
    fn from(bounds: Bounds) -> Self {
        Self { min: bounds.min, max: bounds.max }
    }
}

/// An object of a scene: a mesh at some place.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct ObjectInfo {
    /// Each is there once.
    pub name: String,
    /// Whether it is left out.
    pub hidden: bool,
}

/// What moves in a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct AnimationInfo {
    /// As its file calls it.
    pub name: String,
    /// When it starts again, in seconds.
    pub duration_s: f32,
}

/// What is known of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct SceneInfo {
    /// The file's name without its extension.
    pub name: String,
    /// Triangles of all objects.
    pub triangles: usize,
    /// Voxels that it touches, at the present resolution.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub voxels: Option<u32>,
    /// Around all that is there.
    pub bounds: Box3,
    /// Those of the file.
    pub cameras: Vec<Camera>,
    /// The one in use.
    pub camera: Camera,
    /// Meshes at their places.
    pub objects: Vec<ObjectInfo>,
    /// Names of materials.
    pub materials: Vec<String>,
    /// All lights, with those that were added because nothing shone.
    pub lights: Vec<Light>,
    /// What can be played.
    pub animations: Vec<AnimationInfo>,
    /// What was approximated or passed over while loading, in sentences.
    pub notes: Vec<String>,
}

impl SceneInfo {
    /// Of a scene as it is seen.
    pub fn new(
        scene: &Scene,
        camera: &lumivox_scene::Camera,
        objects: &[String],
        voxels: Option<u32>,
        notes: Vec<String>,
    ) -> Self {
        let objects = objects.iter().zip(&scene.instances);
        Self {
            name: scene.name.clone(),
            triangles: scene.triangle_count(),
            voxels,
            bounds: scene.bounds().into(),
            cameras: scene.cameras.iter().map(Camera::from).collect(),
            camera: camera.into(),
            objects: objects
                .map(|(name, instance)| ObjectInfo {
                    name: name.clone(),
                    hidden: instance.is_hidden,
                })
                .collect(),
            materials: scene.materials.iter().map(|material| material.name.clone()).collect(),
            lights: scene.lights.iter().map(Light::from).collect(),
            animations: scene
                .animations()
                .into_iter()
                .map(|animation| AnimationInfo {
                    name: animation.name,
                    duration_s: animation.duration_s,
                })
                .collect(),
            notes,
        }
    }
}

/// The time of a stage of a frame.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct StageMs {
    /// `G-buffer`, `direct light`, `trace`, ...
    pub name: String,
    /// Milliseconds on the GPU.
    pub ms: f64,
}

/// What a frame has done.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct FrameReport {
    /// Frames in the picture so far.
    pub frame: u32,
    /// Frames that it will have.
    pub frames: u32,
    /// Whether nothing is left to do until something changes.
    pub complete: bool,
    /// What the last frame took, from the call until the GPU was done, in milliseconds.
    pub frame_ms: f64,
    /// Where the browser lets GPUs tell times, else empty.
    pub stages: Vec<StageMs>,
    /// Samples of each pixel in the reference, where one is shown.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference_samples: Option<u32>,
}

/// The right part of the picture shows something else.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// The name of a view, or `reference` for the path tracer.
    pub right: String,
    /// Where it begins, from 0 (at the left edge) to 1. Default: the middle.
    #[serde(default = "middle")]
    #[tsify(optional)]
    pub at: f32,
    /// Samples of each pixel that the reference takes, at least 1. Default: 256.
    #[serde(default = "usual_samples")]
    #[tsify(optional)]
    pub samples: u32,
}

fn middle() -> f32 {
    0.5
}

fn usual_samples() -> u32 {
    256
}

/// What GPU memory is used for.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct MemoryInfo {
    /// What it holds.
    pub name: String,
    /// How much.
    pub bytes: f64,
}

impl From<&MemoryUse> for MemoryInfo {
    fn from(used: &MemoryUse) -> Self {
        Self { name: used.name.clone(), bytes: used.bytes as f64 }
    }
}

/// A name to choose by, and what it is called.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct Named {
    /// What functions take.
    pub name: String,
    /// What people read.
    pub title: String,
    /// What it is, in a sentence without a full stop; empty where the title says it.
    pub summary: String,
}

/// One setting: what panels are made of.
#[derive(Clone, Debug, PartialEq, Serialize, Tsify)]
pub struct ParameterInfo {
    /// Its name in [`Settings`](crate::settings::Settings).
    pub name: String,
    /// `picture`, `view`, `overlay`, `volume`, `light`, `cones` or `vxct`.
    pub group: String,
    /// Of its numbers; empty where there is none.
    pub unit: String,
    /// What it is.
    pub summary: String,
    /// Which values there are.
    #[tsify(type = "\"switch\" | \"whole\" | \"number\" | \"vector\" | \"choice\"")]
    pub kind: String,
    /// The least.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub min: Option<f64>,
    /// The most.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max: Option<f64>,
    /// Whole numbers are multiples of this.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub multiple: Option<f64>,
    /// The names of a choice.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub choices: Vec<String>,
    /// What stands for no number: `auto`, `unlimited`.
    #[tsify(optional)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub word: Option<String>,
    /// Where nobody has set anything.
    #[tsify(type = "boolean | number | string | [number, number, number]")]
    pub default: SettingValue,
}

impl ParameterInfo {
    /// All of them, in the order of the table.
    pub fn all() -> Vec<Self> {
        let defaults = RenderSettings::default();
        PARAMETERS.iter().map(|parameter| Self::of(parameter, &defaults)).collect()
    }

    fn of(parameter: &Parameter, defaults: &RenderSettings) -> Self {
        let default = SettingValue::from(parameter.get(defaults));
        let kind = match parameter.kind {
            Kind::Switch => "switch",
            Kind::Whole { .. } => "whole",
            Kind::Number { .. } => "number",
            Kind::Vector { .. } => "vector",
            Kind::Choice(_) => "choice",
        };
        let mut info = Self {
            name: parameter.name.to_owned(),
            group: parameter.group.name().to_owned(),
            unit: parameter.unit.to_owned(),
            summary: parameter.summary.to_owned(),
            kind: kind.to_owned(),
            min: None,
            max: None,
            multiple: None,
            choices: Vec::new(),
            word: None,
            default,
        };
        match parameter.kind {
            Kind::Switch => {}
            Kind::Whole { low, high, multiple } => {
                (info.min, info.max) = (Some(low.into()), Some(high.into()));
                info.multiple = Some(multiple.into());
            }
            Kind::Number { low, high, word, .. } => {
                (info.min, info.max) = (Some(low.into()), Some(high.into()));
                info.word = word.map(str::to_owned);
            }
            Kind::Vector { low, below } => {
                (info.min, info.max) = (Some(low.into()), Some(below.into()));
            }
            Kind::Choice(names) => {
                info.choices = names.iter().map(|name| (*name).to_owned()).collect();
            }
        }
        info
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_come_back_as_they_went() {
        for name in lumivox_scene::builtin::names() {
            for light in &lumivox_scene::builtin::scene(name).unwrap().lights {
                let again = Light::from(light).to_scene(light.attenuation).unwrap();
                assert!(again.direction.distance(light.direction) < 1e-6);
                let again = lumivox_scene::Light { direction: light.direction, ..again };
                assert_eq!(Light::from(&again), Light::from(light));
            }
        }
    }

    #[test]
    fn what_a_light_cannot_be_is_told() {
        let message = |light: Light| light.to_scene(None).unwrap_err().message;
        let dark = Light { intensity: -1.0, ..Light::default() };
        assert!(message(dark).contains("intensity of the light \"light\" is -1"));
        let nowhere = Light { direction: Vec3::ZERO, ..Light::default() };
        assert!(message(nowhere).contains("direction"));
        let inside_out = Light { inner_cone_deg: 50.0, ..Light::default() };
        assert!(message(inside_out).contains("from 50 to 45 degrees"));
    }

    #[test]
    fn cameras_come_back_as_they_went() {
        let camera = lumivox_scene::Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, 0.7);
        let again = Camera::from(&camera).to_scene(&camera).unwrap();
        assert!(again.forward.distance(camera.forward) < 1e-6);
        assert!((again.vertical_fov_rad - camera.vertical_fov_rad).abs() < 1e-6);
        let of = |change: fn(&mut Camera)| {
            let mut changed = Camera::from(&camera);
            change(&mut changed);
            changed.to_scene(&camera).unwrap_err().message
        };
        assert!(of(|camera| camera.target = camera.position).contains("target"));
        assert!(of(|camera| camera.up = camera.target - camera.position).contains("up"));
        assert!(of(|camera| camera.vertical_fov_deg = 180.0).contains("below 180"));
        assert!(of(|camera| camera.position.x = f32::NAN).contains("finite"));
    }

    #[test]
    fn parameters_have_their_ranges() {
        let all = ParameterInfo::all();
        let of = |name: &str| all.iter().find(|info| info.name == name).unwrap();
        assert_eq!((of("frames").min, of("frames").max), (Some(1.0), Some(65_536.0)));
        assert_eq!(of("exposure").word.as_deref(), Some("auto"));
        assert!(of("view").choices.iter().any(|view| view == "indirect"));
        assert_eq!(all.len(), PARAMETERS.len());
    }
}
