//! Meshes, and their instances in the world.

use glam::{Mat4, Vec2, Vec3, Vec4};

/// Indexed triangles in local space.
///
/// `normals`, `uvs` and `tangents` have one entry per position; `uvs1` and `colors` have as many or
/// none. Three indices form a triangle, counter-clockwise seen from its front.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// A name for lists and messages.
    pub name: String,
    /// Vertex positions in metres (before the instance's transform).
    pub positions: Vec<Vec3>,
    /// Unit normals. They transform by the inverse transpose of the instance's matrix.
    pub normals: Vec<Vec3>,
    /// Texture coordinates; (0, 0) is the upper left corner of the image, v grows downwards.
    pub uvs: Vec<Vec2>,
    /// A second set of texture coordinates; may be empty.
    pub uvs1: Vec<Vec2>,
    /// Linear RGB and alpha, each 0 to 1, that multiply the material's base colour (or diffuse
    /// colour); empty means white.
    pub colors: Vec<Vec4>,
    /// Unit tangents along growing u, orthogonal to the normal; w is the sign of the bitangent `w *
    /// cross(normal, tangent)` (glTF 2.0, section 3.7.2.1). `MikkTSpace` if the material has a
    /// normal texture, otherwise any orthogonal direction.
    pub tangents: Vec<Vec4>,
    /// Vertex numbers, three for each triangle.
    pub indices: Vec<u32>,
}

impl Mesh {
    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    /// The vertex numbers of each triangle.
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        self.indices.chunks_exact(3).map(|t| [t[0] as usize, t[1] as usize, t[2] as usize])
    }

    /// Reverses every triangle's winding and every bitangent: under a mirroring transform, front
    /// sides then stay front sides.
    pub(crate) fn flip_winding(&mut self) {
        for triangle in self.indices.chunks_exact_mut(3) {
            triangle.swap(1, 2);
        }
        for tangent in &mut self.tangents {
            tangent.w = -tangent.w;
        }
    }
}

/// Any tangent orthogonal to a unit `normal`, with a right-handed bitangent.
pub(crate) fn any_tangent(normal: Vec3) -> Vec4 {
    normal.any_orthonormal_vector().extend(1.0)
}

/// A mesh placed in the world with a material.
///
/// The loader reverses the winding of meshes that a transform mirrors (negative determinant), so
/// the front of a triangle is counter-clockwise in *world* space whatever the determinant's sign.
/// Normals need the inverse transpose of the matrix, including the determinant's sign: without it a
/// mirror would turn them inwards.
///
/// The default is the first mesh with the first material and no transform, static, voxelized and
/// shown.
#[expect(clippy::struct_excessive_bools, reason = "each says a thing of its own")]
#[derive(Clone, Debug, PartialEq)]
pub struct Instance {
    /// A name for lists and messages.
    pub name: String,
    /// Index into [`Scene::meshes`](super::Scene::meshes).
    pub mesh: usize,
    /// Index into [`Scene::materials`](super::Scene::materials).
    pub material: usize,
    /// Affine transform from the mesh's local space to the world. Invertible.
    pub world_from_local: Mat4,
    /// `true` if it never moves, so that renderers may cache data made from it. Default: yes,
    /// unless an animation can move it, by a node, a bone or a morph target.
    pub is_static: bool,
    /// `true` if it is voxelized, and so takes part in indirect light. Otherwise it is still drawn,
    /// casts shadows from shadow maps, and is visible to rays of the reference. Default: yes.
    pub is_voxelized: bool,
    /// `true` if it is ignored, except that it is saved (`KHR_node_visibility`): neither drawn nor
    /// voxelized, without shadow, outside [`Scene::bounds`](super::Scene::bounds). Default: no.
    pub is_hidden: bool,
    /// `true` if it belongs to the surroundings, such as the ground of a studio: drawn, lit and
    /// voxelized within the grid, but outside [`Scene::bounds`](super::Scene::bounds), so that
    /// neither the grid nor a camera is fitted to it. Default: no.
    pub is_backdrop: bool,
}

impl Default for Instance {
    fn default() -> Self {
        Self {
            name: "instance".to_owned(),
            mesh: 0,
            material: 0,
            world_from_local: Mat4::IDENTITY,
            is_static: true,
            is_voxelized: true,
            is_hidden: false,
            is_backdrop: false,
        }
    }
}
