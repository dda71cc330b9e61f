//! Primitives that share a mesh.
//!
//! glTF ties a primitive to one material, so a shape in several materials is several primitives
//! over the same accessors. A [`Mesh`](crate::Mesh) has no material, so it is read once for all of
//! them.

use gltf::Semantic;

use super::Loader;

/// All inputs of a mesh.
#[derive(PartialEq, Eq, Hash)]
pub(super) struct MeshKey {
    name: String,
    /// The accessors by the attributes' names in the file.
    attributes: Vec<(String, usize)>,
    indices: Option<usize>,
    mode: u32,
    /// Whether its winding is reversed.
    mirrored: bool,
    /// Whether the material or the caller uses the second texture coordinates.
    needs_second_uvs: bool,
    /// The input of computed tangents: the normal texture's coordinate set and transform (floats by
    /// their bits). `None` if tangents are not computed.
    tangents: Option<(u32, [u32; 6])>,
}

impl Loader<'_> {
    pub(super) fn mesh_key(
        &self,
        name: &str,
        primitive: &gltf::Primitive<'_>,
        mirrored: bool,
        material: usize,
    ) -> MeshKey {
        let mut attributes: Vec<_> =
            primitive.attributes().map(|(name, a)| (name.to_string(), a.index())).collect();
        attributes.sort_unstable();
        let material = &self.scene.materials[material];
        let given = primitive.get(&Semantic::Tangents).is_some();
        let normal = material.normal_texture.filter(|_| !given);
        MeshKey {
            name: name.to_owned(),
            attributes,
            indices: primitive.indices().map(|a| a.index()),
            mode: primitive.mode().as_gl_enum(),
            mirrored,
            needs_second_uvs: self.second_uvs
                || material.textures().any(|texture| texture.uv_set == 1),
            tangents: normal.map(|n| (n.uv_set, n.transform.to_cols_array().map(f32::to_bits))),
        }
    }
}
