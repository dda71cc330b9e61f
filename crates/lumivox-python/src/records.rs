//! Cameras, lights, materials and instances as dictionaries, whose keys are the fields of the
//! package's classes.

use std::collections::BTreeMap;

use glam::{Mat4, Vec3, Vec4};
use lumivox_scene::{Camera, Instance, Light, LightValue, Material, MetallicRoughness, Shading};
use pyo3::{FromPyObject, IntoPyObject};

use crate::error::Fault;

#[derive(FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
pub struct CameraRecord {
    name: String,
    position: [f32; 3],
    forward: [f32; 3],
    up: [f32; 3],
    vertical_fov_deg: f32,
    near_m: f32,
}

impl From<&Camera> for CameraRecord {
    fn from(camera: &Camera) -> Self {
        Self {
            name: camera.name.clone(),
            position: camera.position.into(),
            forward: camera.forward.into(),
            up: camera.up.into(),
            vertical_fov_deg: camera.vertical_fov_rad.to_degrees(),
            near_m: camera.near_m,
        }
    }
}

impl From<CameraRecord> for Camera {
    fn from(record: CameraRecord) -> Self {
        Self {
            name: record.name,
            position: record.position.into(),
            forward: unit(record.forward),
            up: unit(record.up),
            vertical_fov_rad: record.vertical_fov_deg.to_radians(),
            near_m: record.near_m,
        }
    }
}

/// The vector at unit length. A vector without a direction is returned unchanged; the scene's check
/// refuses it.
fn unit(vector: [f32; 3]) -> Vec3 {
    let vector = Vec3::from(vector);
    vector.try_normalize().unwrap_or(vector)
}

/// A light: `name`, `kind`, and the fields of the table of lights.
pub type LightRecord = BTreeMap<String, Option<LightPart>>;

/// A value of a light's record.
#[derive(FromPyObject, IntoPyObject)]
pub enum LightPart {
    Text(String),
    Number(f64),
    Vector([f64; 3]),
}

/// The record of a light.
pub fn light_record(light: &Light) -> LightRecord {
    let part = |value| match value {
        LightValue::None => None,
        LightValue::Text(text) => Some(LightPart::Text(text)),
        LightValue::Number(number) => Some(LightPart::Number(number)),
        LightValue::Vector(vector) => Some(LightPart::Vector(vector)),
    };
    light.record().map(|(key, value)| (key.to_owned(), part(value))).collect()
}

/// The light of a record.
///
/// # Errors
/// A message, if the kind or a field is unknown, or a value is not allowed.
pub fn light(record: &LightRecord) -> Result<Light, String> {
    let value = |part: &Option<LightPart>| match part {
        None => LightValue::None,
        Some(LightPart::Text(text)) => LightValue::Text(text.clone()),
        Some(LightPart::Number(number)) => LightValue::Number(*number),
        Some(LightPart::Vector(vector)) => LightValue::Vector(*vector),
    };
    let record: Vec<_> = record.iter().map(|(key, part)| (key.as_str(), value(part))).collect();
    Light::of_record(&record)
}

/// The numbers of a metallic-roughness material; for other models only the colour. Changing one of
/// these numbers replaces another model, but keeps the textures of metallic-roughness.
#[derive(Clone, FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
pub struct MaterialRecord {
    name: String,
    base_color: [f32; 3],
    metallic: f32,
    roughness: f32,
    specular: f32,
    emissive: [f32; 3],
    double_sided: bool,
}

impl From<&Material> for MaterialRecord {
    fn from(material: &Material) -> Self {
        let (base_color, metallic, roughness, specular) = match &material.shading {
            Shading::MetallicRoughness(m) => {
                (m.base_color.truncate(), m.metallic, m.roughness, m.specular)
            }
            Shading::Phong(p) => (p.diffuse, 0.0, 1.0, 0.0),
            Shading::Unlit(u) => (u.color.truncate(), 0.0, 1.0, 0.0),
        };
        Self {
            name: material.name.clone(),
            base_color: base_color.into(),
            metallic,
            roughness,
            specular,
            emissive: material.emissive.into(),
            double_sided: material.double_sided,
        }
    }
}

impl MaterialRecord {
    /// The material of these numbers, without textures.
    pub fn material(&self) -> Material {
        let mut material = Material {
            shading: Shading::MetallicRoughness(MetallicRoughness::default()),
            ..Material::default()
        };
        self.change(&mut material);
        material
    }

    /// Sets the numbers of a material that differ from its own.
    pub fn change(&self, material: &mut Material) {
        let was = Self::from(&*material);
        material.name.clone_from(&self.name);
        material.emissive = self.emissive.into();
        material.double_sided = self.double_sided;
        let numbers =
            |record: &Self| (record.base_color, record.metallic, record.roughness, record.specular);
        if numbers(&was) == numbers(self) {
            return;
        }
        let mut model = match material.shading {
            Shading::MetallicRoughness(model) => model,
            Shading::Phong(_) | Shading::Unlit(_) => MetallicRoughness::default(),
        };
        model.base_color = Vec3::from(self.base_color).extend(model.base_color.w);
        (model.metallic, model.roughness) = (self.metallic, self.roughness);
        model.specular = self.specular;
        material.shading = Shading::MetallicRoughness(model);
    }
}

#[derive(FromPyObject, IntoPyObject)]
#[pyo3(from_item_all)]
pub struct InstanceRecord {
    name: String,
    mesh: usize,
    material: usize,
    /// The matrix, row by row.
    world_from_local: [[f32; 4]; 4],
    hidden: bool,
    voxelized: bool,
}

impl From<&Instance> for InstanceRecord {
    fn from(instance: &Instance) -> Self {
        Self {
            name: instance.name.clone(),
            mesh: instance.mesh,
            material: instance.material,
            world_from_local: instance.world_from_local.transpose().to_cols_array_2d(),
            hidden: instance.is_hidden,
            voxelized: instance.is_voxelized,
        }
    }
}

impl InstanceRecord {
    /// Changes an instance, except for its mesh.
    ///
    /// # Errors
    /// When the transform is not affine and invertible, or mirrors what was not mirrored.
    pub fn change(self, instance: &mut Instance) -> Result<(), Fault> {
        let place = transform(&self.world_from_local, &self.name)?;
        if place.determinant().signum() != instance.world_from_local.determinant().signum() {
            return Err(Fault::input(format!(
                "instance \"{}\": its world_from_local mirrors it, which would turn its surface inside out; make a \
                 mirrored mesh instead",
                self.name
            )));
        }
        instance.name = self.name;
        instance.material = self.material;
        instance.world_from_local = place;
        instance.is_hidden = self.hidden;
        instance.is_voxelized = self.voxelized;
        Ok(())
    }
}

/// The matrix of these rows.
///
/// # Errors
/// When it is not affine and invertible.
pub fn transform(rows: &[[f32; 4]; 4], name: &str) -> Result<Mat4, Fault> {
    let matrix = Mat4::from_cols_array_2d(rows).transpose();
    let is_affine = matrix.is_finite() && matrix.row(3) == Vec4::W;
    if is_affine && matrix.determinant() != 0.0 && matrix.inverse().is_finite() {
        return Ok(matrix);
    }
    Err(Fault::input(format!(
        "instance \"{name}\": its world_from_local must be finite and invertible, with 0, 0, 0, 1 as its last row"
    )))
}
