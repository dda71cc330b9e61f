//! Lumivox's own additions to glTF, under `extras.lumivox`; `save` writes them.
//!
//! Other programs keep extras while they change the rest of a file. So values that do not fit are
//! ignored with a warning, never refused.

use std::sync::Arc;

use glam::{Affine2, Vec3};
use gltf::json::Extras;
use serde_json::Value;

use super::Loader;
use crate::{Attenuation, Bounds, Environment, EnvironmentMap, Light, Phong, Shading, Strengths};

/// The part of an entry's extras that belongs to Lumivox.
pub(super) fn own(extras: &Extras) -> Option<Value> {
    let raw = extras.as_ref()?;
    let mut extras: Value = serde_json::from_str(raw.get()).ok()?;
    Some(extras.get_mut(crate::EXTRAS)?.take()).filter(|own| !own.is_null())
}

/// A finite number.
fn number(value: &Value) -> Option<f32> {
    value.as_f64().map(|number| number as f32).filter(|number| number.is_finite())
}

fn not_negative(value: &Value) -> Option<f32> {
    number(value).filter(|&number| number >= 0.0)
}

fn numbers<const N: usize>(value: &Value) -> Option<[f32; N]> {
    let list = value.as_array()?.iter().map(number).collect::<Option<Vec<_>>>()?;
    list.try_into().ok()
}

/// The exact matrix of a texture transform.
pub(super) fn texture_transform(extras: &Extras) -> Option<Affine2> {
    exact_transform(&own(extras)?)
}

/// Reads the exact matrix from Lumivox's part of the extras.
pub(super) fn exact_transform(own: &Value) -> Option<Affine2> {
    numbers(own.get("matrix")?).map(|columns: [f32; 6]| Affine2::from_cols_array(&columns))
}

/// Lumivox's additions to a node, about its mesh.
#[expect(clippy::struct_field_names, reason = "as the scene's instances call them")]
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Marks {
    /// Whether the mesh is static; `None` if the file does not say.
    pub(super) is_static: Option<bool>,
    /// `true` if the mesh is not voxelized.
    pub(super) is_kept_out_of_voxels: bool,
    /// `true` if the mesh belongs to the surroundings.
    pub(super) is_backdrop: bool,
}

impl Marks {
    pub(super) fn of(extras: &Extras) -> Self {
        let Some(own) = own(extras) else { return Self::default() };
        Self {
            is_static: own["static"].as_bool(),
            is_kept_out_of_voxels: own["voxelized"].as_bool() == Some(false),
            is_backdrop: own["backdrop"].as_bool() == Some(true),
        }
    }
}

/// Restores the properties of a light that glTF cannot express.
pub(super) fn restore_light(light: &mut Light, extras: &Extras) {
    let Some(own) = own(extras) else { return };
    light.radius_m = not_negative(&own["radiusM"]).unwrap_or(light.radius_m);
    light.attenuation = attenuation(&own["attenuation"]);
    let scale = number(&own["colorScale"]).filter(|&scale| scale >= 1.0).unwrap_or(1.0);
    light.color *= scale;
    light.intensity /= scale;
    let angular_radius_rad = not_negative(&own["angularRadiusRad"]);
    light.angular_radius_rad = angular_radius_rad
        .filter(|radius_rad| *radius_rad <= std::f32::consts::FRAC_PI_2)
        .unwrap_or(light.angular_radius_rad);
}

fn attenuation(value: &Value) -> Option<Attenuation> {
    let [constant, linear, quadratic] = numbers(value)?;
    let all = [constant, linear, quadratic];
    let sum: f32 = all.iter().sum();
    let fits = all.iter().all(|&part| part >= 0.0) && sum > 0.0 && sum.is_finite();
    fits.then_some(Attenuation { constant, linear, quadratic })
}

/// Restores a Phong surface from its metallic-roughness substitute and the exponent in the extras.
pub(super) fn restore_phong(shading: Shading, extras: &Extras) -> Shading {
    let Shading::MetallicRoughness(m) = shading else { return shading };
    let Some(own) = own(extras) else { return shading };
    let Some(shininess) = not_negative(&own["phong"]["shininess"]) else { return shading };
    Shading::Phong(Phong {
        diffuse: m.base_color.truncate(),
        diffuse_texture: m.base_color_texture,
        opacity: m.base_color.w,
        specular: m.specular_color.min(Vec3::ONE),
        specular_texture: m.specular_texture,
        shininess,
    })
}

/// The surface's properties in the look of VXCT.
pub(super) fn strengths(extras: &Extras) -> Option<Strengths> {
    let own = own(extras)?;
    let saved = own.get("strengths")?;
    Some(Strengths {
        color: Vec3::from_array(numbers(&saved["color"])?),
        ambient: number(&saved["ambient"])?,
        diffuse: number(&saved["diffuse"])?,
        specular: number(&saved["specular"])?,
        shininess: number(&saved["shininess"])?,
        is_rounded: saved["rounded"].as_bool() == Some(true),
    })
}

/// Reads a box; `None` if its size is not above zero.
fn grid_bounds(json: &Value) -> Option<Bounds> {
    let corner = |key: &str| numbers(&json[key]).map(Vec3::from_array);
    let bounds = Bounds { min: corner("min")?, max: corner("max")? };
    let size = bounds.size();
    (size.is_finite() && size.max_element() > 0.0).then_some(bounds)
}

impl Loader<'_> {
    /// The surroundings and the box of the voxels, from the scene's extras.
    pub(super) fn restore_scene(&mut self, extras: &Extras) {
        let Some(own) = own(extras) else { return };
        let mut misfits = Vec::new();
        if let Some(environment) = own.get("environment") {
            match self.environment(environment) {
                Some(environment) => self.scene.environment = environment,
                None => misfits.push("environment"),
            }
        }
        if let Some(grid) = own.get("grid") {
            self.scene.grid_bounds = grid_bounds(grid);
            if self.scene.grid_bounds.is_none() {
                misfits.push("grid");
            }
        }
        for misfit in misfits {
            self.notes.warn(format!(
                "the {misfit} in the scene's extras does not fit the file and was ignored"
            ));
        }
    }

    fn environment(&self, json: &Value) -> Option<Environment> {
        let radiance = Vec3::from_array(numbers(&json["radiance"])?);
        let rotation_rad = number(&json["rotationRad"])?;
        let map = match &json["map"] {
            Value::Null => None,
            map => Some(Arc::new(self.environment_map(map)?)),
        };
        let fits = radiance.cmpge(Vec3::ZERO).all();
        fits.then_some(Environment { radiance, map, rotation_rad })
    }

    /// Reads a map of three floats per texel from a buffer view.
    fn environment_map(&self, json: &Value) -> Option<EnvironmentMap> {
        let word = |key: &str| json[key].as_u64().and_then(|n| u32::try_from(n).ok());
        let (width, height) = (word("width")?, word("height")?);
        let bytes = self.view(usize::try_from(json["bufferView"].as_u64()?).ok()?).ok()?;
        let texels = u64::from(width) * u64::from(height);
        if texels == 0 || texels.checked_mul(12) != Some(bytes.len() as u64) {
            return None;
        }
        let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        let rgb: Vec<[f32; 3]> = bytes
            .chunks_exact(12)
            .map(|texel| [float(&texel[..4]), float(&texel[4..8]), float(&texel[8..])])
            .collect();
        let fits = rgb.iter().flatten().all(|&x| x.is_finite() && x >= 0.0);
        let name = json["name"].as_str().unwrap_or("environment").to_owned();
        fits.then_some(EnvironmentMap { name, width, height, rgb, ..EnvironmentMap::default() })
    }
}
