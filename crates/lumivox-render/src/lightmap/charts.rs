//! The triangles of a scene with the texture coordinates of its lightmap.

use glam::{Mat3, Vec2, Vec3};
use lumivox_scene::{Instance, Mesh, Scene};

use super::{LightmapError, LightmapNode};

/// How far coordinates may be outside the unit square, by rounding.
const SLACK: f32 = 1e-3;

/// A triangle in the world and in the map.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// World space, m.
    pub(super) corners: [Vec3; 3],
    pub(super) normals: [Vec3; 3],
    /// The mesh's coordinates; after layout, in texels of the map.
    pub(super) uvs: [Vec2; 3],
    pub(super) node: u32,
}

impl Triangle {
    /// Twice the signed area in texture coordinates.
    pub(super) fn double_area_uv(&self) -> f32 {
        let [a, b, c] = self.uvs;
        (b - a).perp_dot(c - a)
    }

    pub(super) fn at(&self, weights: Vec3) -> Vec3 {
        weights.x * self.corners[0] + weights.y * self.corners[1] + weights.z * self.corners[2]
    }

    /// The unit normal of the triangle's front; zero without area.
    pub(super) fn front(&self) -> Vec3 {
        let [a, b, c] = self.corners.map(Vec3::as_dvec3);
        (b - a).cross(c - a).normalize_or_zero().as_vec3()
    }
}

/// The surfaces of a map.
pub(super) struct Charts {
    pub(super) nodes: Vec<LightmapNode>,
    pub(super) triangles: Vec<Triangle>,
    /// Visible instances that animations move.
    pub(super) left_out: usize,
}

/// Collects the static visible instances of a scene, by nodes.
pub(super) fn of(scene: &Scene, set: u32) -> Result<Charts, LightmapError> {
    let mut charts = Charts { nodes: Vec::new(), triangles: Vec::new(), left_out: 0 };
    let mut last: Option<&Instance> = None;
    for (index, instance) in scene.instances.iter().enumerate() {
        if instance.is_hidden || instance.is_backdrop {
            continue;
        }
        let Some(mesh) = scene.meshes.get(instance.mesh).filter(|mesh| mesh.triangle_count() > 0)
        else {
            continue;
        };
        if !instance.is_static {
            charts.left_out += 1;
            continue;
        }
        // The primitives of a node are instances in a row, at the same place.
        let is_same_node = last.is_some_and(|last| {
            last.name == instance.name
                && last.world_from_local == instance.world_from_local
                && primitive_of(scene, last).is_some()
                && primitive_of(scene, last) == primitive_of(scene, instance)
        });
        if !is_same_node {
            charts.nodes.push(LightmapNode {
                name: instance.name.clone(),
                instances: Vec::new(),
                rect: [0.0, 0.0, 1.0, 1.0],
                texels_per_metre: 0.0,
                edge: 0,
                corner: [0; 2],
                area_m2: 0.0,
                area_uv: 0.0,
            });
        }
        last = Some(instance);
        charts.add(index, instance, mesh, set)?;
    }
    if charts.nodes.is_empty() {
        return Err(LightmapError::Nothing);
    }
    Ok(charts)
}

impl Charts {
    fn add(
        &mut self,
        index: usize,
        instance: &Instance,
        mesh: &Mesh,
        set: u32,
    ) -> Result<(), LightmapError> {
        let uvs = coordinates(mesh, set)?;
        let number = self.nodes.len() - 1;
        let Some(node) = self.nodes.last_mut() else { return Ok(()) };
        node.instances.push(index);
        // By the inverse transpose, with the determinant's sign, as in the renderer.
        let normal_from_local = Mat3::from_mat4(instance.world_from_local).inverse().transpose();
        let mut area_uv = 0.0;
        for corners in mesh.triangles() {
            let triangle = Triangle {
                corners: corners
                    .map(|i| instance.world_from_local.transform_point3(mesh.positions[i])),
                normals: corners.map(|i| (normal_from_local * mesh.normals[i]).normalize_or_zero()),
                uvs: corners.map(|i| uvs[i]),
                node: number as u32,
            };
            let [a, b, c] = triangle.corners.map(Vec3::as_dvec3);
            node.area_m2 += 0.5 * (b - a).cross(c - a).length();
            area_uv += 0.5 * f64::from(triangle.double_area_uv().abs());
            self.triangles.push(triangle);
        }
        if area_uv <= 1e-12 {
            return Err(LightmapError::Flat { mesh: mesh.name.clone(), set });
        }
        node.area_uv += area_uv;
        Ok(())
    }
}

/// The name of the glTF mesh of which an instance shows one of several primitives.
fn primitive_of<'a>(scene: &'a Scene, instance: &Instance) -> Option<&'a str> {
    let (mesh, _) = scene.meshes[instance.mesh].name.rsplit_once(", primitive ")?;
    Some(mesh)
}

/// The checked coordinates of a mesh.
fn coordinates(mesh: &Mesh, set: u32) -> Result<&[Vec2], LightmapError> {
    let uvs = match set {
        0 => &mesh.uvs,
        _ => &mesh.uvs1,
    };
    if uvs.len() != mesh.positions.len() {
        return Err(LightmapError::Missing { mesh: mesh.name.clone(), set });
    }
    let used = mesh.indices.iter().map(|&index| uvs[index as usize]);
    let (min, max) = used
        .fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(min, max), uv| (min.min(uv), max.max(uv)));
    if min.min_element() < -SLACK || max.max_element() > 1.0 + SLACK {
        let mesh = mesh.name.clone();
        return Err(LightmapError::Outside { mesh, set, min: min.into(), max: max.into() });
    }
    Ok(uvs)
}
