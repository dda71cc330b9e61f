//! The triangles of a scene for ray tracing: flattened, in world space, in the order of a bounding
//! volume hierarchy.

use std::collections::HashMap;

use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3, Vec2, Vec3, Vec4};
use lumivox_scene::{Mesh, Scene};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::PlocBuilder;

/// Flag in the link of a box: the box is a leaf.
pub(super) const LEAF: u32 = 1 << 31;
/// Flag in a triangle's first vertex: the triangle is double-sided.
pub(super) const DOUBLE_SIDED: u32 = 1 << 31;
/// Flag in a triangle's first vertex: alpha or glass, through which light may pass.
pub(super) const SEE_THROUGH: u32 = 1 << 30;
/// The triangle index of a ray that hits none.
pub(super) const NO_TRIANGLE: u32 = u32::MAX;
/// Rays hit the sides that the camera sees: fronts, and the backs of double-sided surfaces.
pub(super) const AS_SEEN: u32 = 0;
/// Rays hit both sides of all surfaces.
pub(super) const BOTH_SIDES: u32 = 1;
/// Rays hit as with [`AS_SEEN`], and also the backs of opaque surfaces: a wall blocks light from
/// behind, too. The rays of cones do the same.
pub(super) const BLOCKING: u32 = 2;
/// The most triangles of a leaf: a leaf's link stores their number in three bits.
const MOST_PER_LEAF: u32 = 4;
/// The least ratio of a triangle's height to its longest edge: eight roundings of f32. A flatter
/// triangle has neither normal nor area.
const LEAST_SLENDERNESS: f64 = 1.0 / (1 << 20) as f64;
/// The most triangles: a leaf's link stores the first one in 28 bits.
pub(super) const MOST_TRIANGLES: usize = 1 << 28;

/// `Node` of `world.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub(crate) struct NodeRecord {
    pub(crate) low: [f32; 3],
    pub(crate) link: u32,
    pub(crate) high: [f32; 3],
    padding: u32,
}

/// `Triangle` of `world.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub(crate) struct TriangleRecord {
    pub(crate) corner: [f32; 3],
    pub(crate) vertex_0: u32,
    pub(crate) edge_1: [f32; 3],
    pub(crate) vertex_1: u32,
    pub(crate) edge_2: [f32; 3],
    pub(crate) vertex_2: u32,
}

/// `Vertex` of `world.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub(crate) struct VertexRecord {
    pub(crate) normal: [f32; 3],
    pub(crate) material: u32,
    pub(crate) tangent: [f32; 4],
    pub(crate) texcoords: [f32; 4],
    pub(crate) color: [u16; 4],
    padding: [u32; 2],
}

/// The properties of a material that rays use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each says a thing of its own")]
pub(super) struct Sides {
    /// Whether the surface exists nowhere.
    pub(super) is_absent: bool,
    /// Whether it has no textures, so that it needs neither texture coordinates nor tangents.
    pub(super) is_plain: bool,
    pub(super) is_double_sided: bool,
    /// Whether light may pass where the surface does not exist.
    pub(super) is_see_through: bool,
}

/// All triangles of a scene.
#[derive(Clone, Debug)]
#[expect(clippy::struct_field_names, reason = "they are what the shader calls them")]
pub(super) struct Triangles {
    pub(super) nodes: Vec<NodeRecord>,
    /// The link of the root.
    pub(super) root: u32,
    /// The most pending links during a traversal.
    pub(super) stack: u32,
    pub(super) triangles: Vec<TriangleRecord>,
    pub(super) vertices: Vec<VertexRecord>,
    /// The offset of the origin, m: f32 is most precise near zero.
    pub(super) origin: DVec3,
    /// Half the diagonal of the bounds, m.
    pub(super) radius_m: f32,
}

impl Triangles {
    /// Collects all visible triangles of a valid scene, except those of absent materials.
    pub(super) fn new(scene: &Scene, sides: &[Sides]) -> Self {
        let bounds = scene.bounds();
        let origin = bounds.center().as_dvec3();
        let mut triangles = Vec::new();
        let mut vertices = Vec::new();
        let mut known = HashMap::new();
        for instance in scene.shown() {
            let sides = sides[instance.material];
            if sides.is_absent {
                continue;
            }
            let mesh = &scene.meshes[instance.mesh];
            let world_from_local = instance.world_from_local.as_dmat4();
            let mut own = vertices_of(mesh, world_from_local, instance.material as u32);
            if sides.is_plain {
                for vertex in &mut own {
                    *vertex = VertexRecord { tangent: [0.0; 4], texcoords: [0.0; 4], ..*vertex };
                }
            }
            // Vertex records contain no positions, so copies of a mesh share most of them.
            let numbers: Vec<u32> = own
                .into_iter()
                .map(|vertex| {
                    *known.entry(bytemuck::cast::<_, [u64; 8]>(vertex)).or_insert_with(|| {
                        vertices.push(vertex);
                        vertices.len() as u32 - 1
                    })
                })
                .collect();
            let positions: Vec<Vec3> = mesh
                .positions
                .iter()
                .map(|p| (world_from_local.transform_point3(p.as_dvec3()) - origin).as_vec3())
                .collect();
            // Mirroring an instance must not swap front and back.
            let is_mirrored = world_from_local.determinant() < 0.0;
            let bits = if sides.is_double_sided { DOUBLE_SIDED } else { 0 }
                | if sides.is_see_through { SEE_THROUGH } else { 0 };
            for [a, b, c] in mesh.triangles() {
                let [b, c] = if is_mirrored { [c, b] } else { [b, c] };
                let triangle = TriangleRecord {
                    corner: positions[a].to_array(),
                    edge_1: (positions[b] - positions[a]).to_array(),
                    edge_2: (positions[c] - positions[a]).to_array(),
                    vertex_0: numbers[a] | bits,
                    vertex_1: numbers[b],
                    vertex_2: numbers[c],
                };
                if triangle.has_normal() {
                    triangles.push(triangle);
                }
            }
        }
        let bvh = build(&triangles);
        let ordered = bvh.primitive_indices.iter().map(|&index| triangles[index as usize]);
        let triangles: Vec<TriangleRecord> = ordered.collect();
        let nodes: Vec<NodeRecord> = bvh
            .nodes
            .iter()
            .map(|node| NodeRecord {
                low: Vec3::from(node.aabb.min).to_array(),
                link: link(node.prim_count, node.first_index),
                high: Vec3::from(node.aabb.max).to_array(),
                padding: 0,
            })
            .collect();
        let stack = if nodes.is_empty() { 1 } else { bvh.depth(0) as u32 + 1 };
        Self {
            root: nodes.first().map_or(LEAF, |node| node.link),
            // Buffers may not be empty; a ray never hits a triangle without area.
            triangles: or_one(triangles),
            nodes: or_one(nodes),
            vertices: or_one(vertices),
            stack,
            origin,
            radius_m: bounds.radius_m(),
        }
    }

    /// The material of a triangle.
    pub(super) fn material(&self, triangle: &TriangleRecord) -> usize {
        let vertex = triangle.vertex_0 & !(DOUBLE_SIDED | SEE_THROUGH);
        self.vertices[vertex as usize].material as usize
    }
}

impl TriangleRecord {
    /// Whether a triangle has a normal: whether its height exceeds the rounding error of its
    /// longest edge in f32.
    fn has_normal(&self) -> bool {
        let [a, b] = [self.edge_1, self.edge_2].map(|edge| Vec3::from(edge).as_dvec3());
        let longest_squared = a.length_squared().max(b.length_squared()).max(a.distance_squared(b));
        2.0 * self.area_m2() > LEAST_SLENDERNESS * longest_squared
    }

    pub(super) fn area_m2(&self) -> f64 {
        let [a, b] = [self.edge_1, self.edge_2].map(|edge| Vec3::from(edge).as_dvec3());
        0.5 * a.cross(b).length()
    }
}

fn or_one<T: Default>(records: Vec<T>) -> Vec<T> {
    if records.is_empty() { vec![T::default()] } else { records }
}

fn link(count: u32, first: u32) -> u32 {
    if count == 0 { first } else { LEAF | (count - 1) << 28 | first }
}

fn build(triangles: &[TriangleRecord]) -> Bvh2 {
    let corners: Vec<obvhs::triangle::Triangle> = triangles
        .iter()
        .map(|triangle| {
            let corner = Vec3::from(triangle.corner);
            obvhs::triangle::Triangle {
                v0: corner.into(),
                v1: (corner + Vec3::from(triangle.edge_1)).into(),
                v2: (corner + Vec3::from(triangle.edge_2)).into(),
            }
        })
        .collect();
    if corners.is_empty() {
        return Bvh2::default();
    }
    // The steps of `build_bvh2_from_tris`, which requires a clock that browsers do not have.
    let quality = BvhBuildParams::medium_build();
    let mut hierarchy = PlocBuilder::with_capacity(corners.len()).build(
        quality.ploc_search_distance,
        &corners,
        (0..corners.len() as u32).collect::<Vec<_>>(),
        quality.sort_precision,
        quality.search_depth_threshold,
    );
    let mut optimizer = ReinsertionOptimizer::default();
    let share = quality.reinsertion_batch_ratio;
    optimizer.run(&mut hierarchy, share, None);
    collapse(&mut hierarchy, MOST_PER_LEAF, quality.collapse_traversal_cost);
    let share = share * quality.post_collapse_reinsertion_batch_ratio_multiplier;
    optimizer.run(&mut hierarchy, share, None);
    hierarchy
}

fn vertices_of(mesh: &Mesh, world_from_local: DMat4, material: u32) -> Vec<VertexRecord> {
    let linear = glam::DMat3::from_mat4(world_from_local);
    // Multiplied by the determinant's sign: mirroring must not turn normals inwards.
    let normal_from_local = linear.inverse().transpose();
    let vertex = |index: usize| {
        let normal = mesh.normals.get(index).copied().unwrap_or(Vec3::Y);
        let tangent = mesh.tangents.get(index).copied();
        let tangent = tangent.unwrap_or_else(|| normal.any_orthonormal_vector().extend(1.0));
        let normal = (normal_from_local * normal.as_dvec3()).normalize_or_zero().as_vec3();
        let along = linear * tangent.truncate().as_dvec3();
        let texcoord = mesh.uvs.get(index).copied().unwrap_or(Vec2::ZERO);
        let texcoord_1 = mesh.uvs1.get(index).copied().unwrap_or(texcoord);
        let color = mesh.colors.get(index).copied().unwrap_or(Vec4::ONE);
        VertexRecord {
            normal: normal.to_array(),
            material,
            tangent: along.normalize_or_zero().as_vec3().extend(tangent.w).to_array(),
            texcoords: [texcoord.x, texcoord.y, texcoord_1.x, texcoord_1.y],
            color: color
                .to_array()
                .map(|x| (x.clamp(0.0, 1.0) * f32::from(u16::MAX)).round() as u16),
            padding: [0; 2],
        }
    };
    (0..mesh.positions.len()).map(vertex).collect()
}
