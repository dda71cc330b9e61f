//! Texture coordinates and colours of a primitive, and the memory of all its attributes.

use glam::{Vec2, Vec4};
use gltf::Semantic;
use gltf::json::validation::Checked;
use gltf::mesh::Mode;

use super::{Loader, own_vertices};
use crate::SceneError;

/// Bytes of a vertex that every mesh has: position, normal, texture coordinates, tangent.
const PLAIN_VERTEX_BYTES: u64 = 12 + 12 + 8 + 16;

impl Loader<'_> {
    /// Charges a primitive to the budget before any of it is read.
    pub(super) fn spend_geometry(
        &mut self,
        part: &str,
        primitive: &gltf::Primitive<'_>,
    ) -> Result<(), SceneError> {
        // A wrong count is reported when the accessor is checked, not as an exceeded budget.
        let positions = primitive.get(&Semantic::Positions).map(|a| (a.index(), "positions"));
        let indices = primitive.indices().map(|a| (a.index(), "indices"));
        for (accessor, what) in positions.into_iter().chain(indices) {
            self.check_room(accessor, what)?;
        }
        let count = |accessor: Option<usize>| {
            accessor.and_then(|a| self.root().accessors.get(a)).map(|accessor| accessor.count.0)
        };
        let of = |semantic: Semantic| count(primitive.get(&semantic).map(|a| a.index()));
        let given = of(Semantic::Positions).unwrap_or(0);
        let listed = count(primitive.indices().map(|a| a.index())).unwrap_or(given);
        let corners = match primitive.mode() {
            Mode::TriangleStrip | Mode::TriangleFan => listed.saturating_sub(2).saturating_mul(3),
            _ => listed,
        };
        // Without normals, every corner becomes a vertex.
        let vertices = match of(Semantic::Normals) {
            Some(_) => own_vertices::kept(given, corners),
            None => given.max(corners),
        };
        let second = of(Semantic::TexCoords(1)).map_or(0, |_| 8);
        let colors = of(Semantic::Colors(0)).map_or(0, |_| 16);
        let bytes = vertices
            .saturating_mul(PLAIN_VERTEX_BYTES + second + colors)
            .saturating_add(corners.saturating_mul(4));
        self.spend_bytes(part, bytes)
    }

    /// Charges memory for geometry to the budget before it is allocated.
    pub(super) fn spend_bytes(&mut self, part: &str, bytes: u64) -> Result<(), SceneError> {
        self.budget.geometry.take(|| part.to_owned(), bytes)
    }

    pub(super) fn read_uvs(&self, accessor: usize) -> Result<Vec<Vec2>, SceneError> {
        let uvs = self.read_floats::<2>(accessor, "texture coordinates")?;
        Ok(uvs.into_iter().map(Vec2::from_array).collect())
    }

    /// Reads the second texture coordinates, if the material or the caller uses them.
    pub(super) fn read_second_uvs(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        part: &str,
        material: usize,
    ) -> Result<Vec<Vec2>, SceneError> {
        let is_textured =
            self.scene.materials[material].textures().any(|texture| texture.uv_set == 1);
        if !is_textured && !self.second_uvs {
            return Ok(Vec::new());
        }
        if let Some(uvs) = primitive.get(&Semantic::TexCoords(1)) {
            return self.read_uvs(uvs.index());
        }
        if !is_textured {
            return Ok(Vec::new());
        }
        self.notes.warn(format!(
            "{part}: its material wants coordinate set 1, which it does not have; set 0 is used"
        ));
        Ok(Vec::new())
    }

    /// Reads colours of three or four components.
    pub(super) fn read_colors(&self, accessor: usize) -> Result<Vec<Vec4>, SceneError> {
        use gltf::json::accessor::Type;
        let what = "colours";
        let kind = self.root().accessors.get(accessor).map(|json| json.type_);
        let colors: Vec<Vec4> = if kind == Some(Checked::Valid(Type::Vec3)) {
            let colors = self.read_shares::<3>(accessor, what)?;
            colors.into_iter().map(|[r, g, b]| Vec4::new(r, g, b, 1.0)).collect()
        } else {
            let colors = self.read_shares::<4>(accessor, what)?;
            colors.into_iter().map(Vec4::from_array).collect()
        };
        Ok(colors)
    }
}
