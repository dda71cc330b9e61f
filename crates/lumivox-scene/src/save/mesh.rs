//! Meshes and their vertex data.

use glam::{Vec2, Vec3, Vec4};
use serde_json::{Map, Value, json};

use super::binary::{Source, Target, tangent};
use super::document::numbers;
use super::{Writer, material};
use crate::load::shorten;
use crate::model::any_tangent;
use crate::{Material, Mesh};

const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;

/// The largest 16-bit index: 65 535 restarts primitives (glTF 2.0, section 3.7.2.1).
const LAST_SHORT: u32 = 65_534;

impl<'a> Writer<'a> {
    /// Writes a mesh of the scene with a material, as one primitive, and returns its index. The
    /// winding is reversed if `mirrored`, since the loader will reverse it again.
    pub(super) fn mesh(&mut self, mesh: usize, material: usize, mirrored: bool) -> usize {
        let (mesh, of) = (&self.scene.meshes[mesh], &self.scene.materials[material]);
        let attributes = self.attributes(mesh, of, mirrored);
        let largest = mesh.indices.iter().max().copied().unwrap_or(0);
        let short = largest <= LAST_SHORT;
        let indices = self.document.accessor(
            Source::Indices { indices: &mesh.indices, short, turned: mirrored },
            Target::Indices,
            ("SCALAR", if short { UNSIGNED_SHORT } else { UNSIGNED_INT }),
            mesh.indices.len(),
            Value::Null,
        );
        let material = self.material(material);
        let primitive =
            json!({ "attributes": attributes, "indices": indices, "material": material });
        self.document
            .push_once("meshes", &json!({ "name": shorten(&mesh.name), "primitives": [primitive] }))
    }

    fn attributes(
        &mut self,
        mesh: &'a Mesh,
        material: &Material,
        mirrored: bool,
    ) -> Map<String, Value> {
        let count = mesh.positions.len();
        let textures = material::textures(material);
        let bumpy = material.normal_texture.is_some() && material::takes_light(material);
        let mut attributes = Map::new();
        let mut add = |name: &str, kind: &str, source: Source<'a>, more: Value| {
            let form = (kind, FLOAT);
            let accessor = self.document.accessor(source, Target::Vertices, form, count, more);
            attributes.insert(name.to_owned(), json!(accessor));
        };

        let start = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let (min, max) = mesh.positions.iter().fold(start, |(a, b), &p| (a.min(p), b.max(p)));
        let bounds = json!({ "min": numbers(min.as_ref()), "max": numbers(max.as_ref()) });
        add("POSITION", "VEC3", Source::Vec3(&mesh.positions), bounds);
        add("NORMAL", "VEC3", Source::Vec3(&mesh.normals), Value::Null);
        if bumpy || !has_default_tangents(mesh, mirrored) {
            let tangents = Source::Tangents {
                tangents: &mesh.tangents,
                normals: &mesh.normals,
                turned: mirrored,
            };
            add("TANGENT", "VEC4", tangents, Value::Null);
        }
        let textured = !textures.is_empty();
        if textured || mesh.uvs.iter().any(|&uv| is_not_zero(uv)) {
            add("TEXCOORD_0", "VEC2", Source::Vec2(&mesh.uvs), Value::Null);
        }
        if textures.iter().any(|reference| reference.uv_set == 1) {
            // If the second set is missing, the first is used instead.
            let uvs = if mesh.uvs1.is_empty() { &mesh.uvs } else { &mesh.uvs1 };
            add("TEXCOORD_1", "VEC2", Source::Vec2(uvs), Value::Null);
        }
        if mesh.colors.iter().any(|&color| color != Vec4::ONE) {
            add("COLOR_0", "VEC4", Source::Vec4(&mesh.colors), Value::Null);
        }
        attributes
    }
}

/// Whether the tangents equal the loader's defaults.
fn has_default_tangents(mesh: &Mesh, mirrored: bool) -> bool {
    mesh.tangents.iter().zip(&mesh.normals).all(|(&given, &normal)| {
        let written = tangent(given, normal, mirrored).to_array().map(f32::to_bits);
        written == any_tangent(normal).to_array().map(f32::to_bits)
    })
}

fn is_not_zero(uv: Vec2) -> bool {
    uv.to_array().iter().any(|x| x.to_bits() != 0)
}
