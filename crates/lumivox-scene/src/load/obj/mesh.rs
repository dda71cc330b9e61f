//! Converts the triangles of a submesh to a mesh with its own vertices.

use std::collections::HashMap;

use glam::{Vec2, Vec3};

use super::corners::{Corner, Normal};
use super::read::{Model, Submesh};
use crate::load::geometry::GeometryBudget;
use crate::load::{Notes, color, normals, repair};
use crate::{Mesh, SceneError};

/// A finished submesh.
pub(super) struct Built {
    pub(super) name: String,
    pub(super) material: Option<usize>,
    pub(super) mesh: Mesh,
}

/// Makes the meshes of a model.
pub(super) struct Builder<'m> {
    model: &'m Model,
    /// The normals of corners in smoothing groups, by corner.
    group_normals: &'m [Vec3],
    crease_rad: Option<f32>,
    /// The vertex of each corner in the current submesh; [`Corner::NONE`] for other corners.
    vertices: Vec<u32>,
    /// The largest value of colours: 1 or 255.
    full_color: f32,
}

impl<'m> Builder<'m> {
    pub(super) fn new(
        model: &'m Model,
        group_normals: &'m [Vec3],
        crease_rad: Option<f32>,
    ) -> Self {
        // Most programs write colours from 0 to 1, up to rounding; some write bytes.
        let largest =
            model.colors.iter().fold(0.0, |most: f32, color| most.max(color.max_element()));
        let full_color = if largest > 2.0 { 255.0 } else { 1.0 };
        let vertices = vec![Corner::NONE; model.corners.len()];
        Self { model, group_normals, crease_rad, vertices, full_color }
    }

    /// The mesh of a submesh; `None` if it has no triangles.
    pub(super) fn build(
        &mut self,
        submesh: Submesh,
        budget: &mut GeometryBudget<'_>,
        notes: &mut Notes,
    ) -> Result<Option<Built>, SceneError> {
        let model = self.model;
        let Submesh { name, material, mut indices } = submesh;
        if indices.is_empty() {
            return Ok(None);
        }
        let creased = self.crease_rad.is_some();
        let order = self.number_vertices(&mut indices, creased);
        let places = order.iter().map(|&corner| model.corners.get(corner));
        let colored = places.clone().any(|corner| {
            model.colors.get(corner.position as usize).is_some_and(|color| !color.is_nan())
        });
        budget.spend(|| format!("mesh \"{name}\""), order.len(), indices.len(), colored)?;

        let uv = |corner: Corner| model.uvs.get(corner.uv as usize).copied().unwrap_or(Vec2::ZERO);
        let mut mesh = Mesh {
            name: name.clone(),
            positions: places.clone().map(|c| model.positions[c.position as usize]).collect(),
            uvs: places.clone().map(uv).collect(),
            indices,
            ..Mesh::default()
        };
        if colored {
            mesh.colors = places.clone().map(|c| self.color(c).extend(1.0)).collect();
        }
        repair::attributes(&mut mesh, notes);
        // Zero for the normal of the face, which is set later.
        mesh.normals = order
            .iter()
            .map(|&number| {
                let normal = model.corners.get(number).normal;
                match normal.as_given() {
                    Some(given) => model.normals[given],
                    None if normal.is_group() => self.group_normals[number as usize],
                    None => Vec3::ZERO,
                }
            })
            .collect();
        let flat = order.iter().any(|&corner| model.corners.get(corner).normal == Normal::FLAT);
        match self.crease_rad {
            Some(crease_rad) if flat => {
                budget.spend_split(&mesh)?;
                let corners = self.crease(&mesh, &order, crease_rad);
                normals::set_corner_normals(&mut mesh, &corners);
            }
            _ if flat => {
                face_normals(&mut mesh, |i| model.corners.get(order[i]).normal == Normal::FLAT);
            }
            _ => {}
        }
        drop(order);
        repair::directions(&mut mesh, notes);
        normals::set_any_tangents(&mut mesh);
        Ok(Some(Built { name, material, mesh }))
    }

    /// Converts indices of corners to indices of vertices, and returns the corner of each vertex.
    /// Each corner with the normal of its face gets its own vertex, unless `share_flat` is set.
    fn number_vertices(&mut self, indices: &mut [u32], share_flat: bool) -> Vec<u32> {
        let mut order = Vec::new();
        for index in indices {
            let corner = *index;
            if !share_flat && self.model.corners.get(corner).normal == Normal::FLAT {
                *index = order.len() as u32;
                order.push(corner);
                continue;
            }
            let vertex = &mut self.vertices[corner as usize];
            if *vertex == Corner::NONE {
                *vertex = order.len() as u32;
                order.push(corner);
            }
            *index = *vertex;
        }
        for &corner in &order {
            self.vertices[corner as usize] = Corner::NONE;
        }
        order
    }

    /// The normals of a mesh's corners. Those that the file does not give are smooth across edges
    /// below the angle.
    fn crease(&self, mesh: &Mesh, order: &[u32], crease_rad: f32) -> Vec<Vec3> {
        let corners = &self.model.corners;
        // Welds vertices at seams of the texture, where the surface is connected.
        let mut known = HashMap::new();
        let mut positions = Vec::new();
        let places: Vec<u32> = order
            .iter()
            .zip(&mesh.positions)
            .map(|(&corner, &position)| {
                *known.entry(corners.get(corner).position).or_insert_with(|| {
                    positions.push(position);
                    (positions.len() - 1) as u32
                })
            })
            .collect();
        let welded: Vec<u32> = mesh.indices.iter().map(|&i| places[i as usize]).collect();
        let mut creased = normals::creased(&positions, &welded, crease_rad);
        for (&i, normal) in mesh.indices.iter().zip(&mut creased) {
            if corners.get(order[i as usize]).normal != Normal::FLAT {
                *normal = mesh.normals[i as usize];
            }
        }
        creased
    }

    fn color(&self, corner: Corner) -> Vec3 {
        match self.model.colors.get(corner.position as usize) {
            Some(color) => (*color / self.full_color).map(color::linear_from_srgb),
            None => Vec3::NAN,
        }
    }
}

/// Gives the vertices for which `is_flat` is true, which no triangles share, the normals of their
/// faces.
fn face_normals(mesh: &mut Mesh, is_flat: impl Fn(usize) -> bool) {
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|i| triangle[i] as usize);
        let normal = normals::face_normal(corners.map(|i| mesh.positions[i]));
        for i in corners.into_iter().filter(|&i| is_flat(i)) {
            // A triangle without a normal has no area and is removed later.
            mesh.normals[i] = if normal == Vec3::ZERO { Vec3::Y } else { normal };
        }
    }
}
