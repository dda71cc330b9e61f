//! Meshes packed into few vertex and index buffers, each small enough for a storage binding.
//!
//! The rasterizer and the voxelizer read the same buffers. The voxelizer binds positions (12 bytes
//! a vertex), attributes (texture coordinates, 8; with a second set and colours, 24) and indices
//! (4) as storage; normals and tangents (28) are only for the rasterizer. A mesh is stored once,
//! however many instances show it. Meshes that need all attributes have separate batches, so that
//! the others stay small.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};
use lumivox_scene::Mesh;

/// The data of a vertex that only the rasterizer reads.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct Shading {
    pub(crate) normal: [f32; 3],
    pub(crate) tangent: [f32; 4],
}

/// The attributes of a batch's vertices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Attributes {
    /// One set of texture coordinates.
    #[default]
    Texcoords,
    /// Two sets, and a colour.
    All,
}

/// The attributes of a vertex with [`Attributes::All`]. Other vertices only have the first field.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub(crate) struct AllAttributes {
    pub(crate) texcoord: [f32; 2],
    pub(crate) texcoord_1: [f32; 2],
    /// Linear; 65 535 is one. 8 bits would not resolve dark colours.
    pub(crate) color: [u16; 4],
}

/// Bytes of a vertex in all buffers together, with [`Attributes::Texcoords`].
pub(crate) const VERTEX_BYTES: u64 =
    (size_of::<[f32; 3]>() + size_of::<[f32; 2]>() + size_of::<Shading>()) as u64;

/// The kind of a batch: meshes of the same kind share batches. Static meshes have separate batches,
/// whose buffers are kept when others are replaced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(crate) struct BatchKind {
    pub(crate) attributes: Attributes,
    pub(crate) is_static: bool,
}

/// The content of one batch's buffers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Batch {
    pub(crate) kind: BatchKind,
    pub(crate) positions: Vec<[f32; 3]>,
    /// The attributes of all vertices, in the layout of `kind.attributes`.
    pub(crate) attribute_bytes: Vec<u8>,
    pub(crate) shading: Vec<Shading>,
    pub(crate) indices: Vec<u32>,
}

/// The capacity of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BatchLimits {
    pub(crate) vertices: usize,
    pub(crate) indices: usize,
}

/// A run of a batch's triangles: a mesh, or a part of one that does not fit into a single batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Piece {
    pub(crate) batch: usize,
    pub(crate) first_index: u32,
    pub(crate) index_count: u32,
    pub(crate) base_vertex: u32,
}

/// Neighbouring triangles of a piece; each cascade voxelizes the runs whose box it overlaps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Run {
    pub(crate) piece: Piece,
    /// The corners of the box around their positions.
    pub(crate) bounds: [Vec3; 2],
}

/// Triangles of a run: few enough that a cascade skips most triangles outside its box, but far more
/// than the cost of a draw.
const RUN_TRIANGLES: u32 = 2048;

/// The runs of a piece.
pub(crate) fn runs(batch: &Batch, piece: &Piece) -> Vec<Run> {
    let end = piece.first_index + piece.index_count;
    let run = |first_index: u32| {
        let index_count = (end - first_index).min(3 * RUN_TRIANGLES);
        let indices = first_index as usize..(first_index + index_count) as usize;
        let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
        let bounds = batch.indices[indices].iter().fold(nothing, |[low, high], index| {
            let position = Vec3::from(batch.positions[(piece.base_vertex + index) as usize]);
            [low.min(position), high.max(position)]
        });
        Run { piece: Piece { first_index, index_count, ..*piece }, bounds }
    };
    (piece.first_index..end).step_by(3 * RUN_TRIANGLES as usize).map(run).collect()
}

impl Batch {
    /// A hash of the content, of 128 bits.
    pub(crate) fn fingerprint(&self) -> [u64; 2] {
        [0_u64, 1].map(|seed| {
            let mut hasher = DefaultHasher::new();
            seed.hash(&mut hasher);
            self.kind.hash(&mut hasher);
            bytemuck::cast_slice::<_, u8>(&self.positions).hash(&mut hasher);
            self.attribute_bytes.hash(&mut hasher);
            bytemuck::cast_slice::<_, u8>(&self.shading).hash(&mut hasher);
            self.indices.hash(&mut hasher);
            hasher.finish()
        })
    }
}

impl Attributes {
    /// Bytes of a vertex.
    pub(crate) fn bytes(self) -> u64 {
        match self {
            Self::Texcoords => size_of::<[f32; 2]>() as u64,
            Self::All => size_of::<AllAttributes>() as u64,
        }
    }

    /// The attributes that a mesh needs: a second set of coordinates is needed if a material uses
    /// it.
    pub(crate) fn needed(mesh: &Mesh, uses_second_set: bool) -> Self {
        let is_colored = mesh.colors.iter().any(|color| *color != Vec4::ONE);
        if is_colored || (uses_second_set && !mesh.uvs1.is_empty()) {
            Self::All
        } else {
            Self::Texcoords
        }
    }

    /// Appends the attributes of a vertex.
    fn append(self, bytes: &mut Vec<u8>, mesh: &Mesh, vertex: usize) {
        let texcoord = mesh.uvs.get(vertex).copied().unwrap_or(Vec2::ZERO).to_array();
        match self {
            Self::Texcoords => bytes.extend_from_slice(bytemuck::bytes_of(&texcoord)),
            Self::All => {
                let color = mesh.colors.get(vertex).copied().unwrap_or(Vec4::ONE).to_array();
                bytes.extend_from_slice(bytemuck::bytes_of(&AllAttributes {
                    texcoord,
                    texcoord_1: mesh.uvs1.get(vertex).map_or(texcoord, Vec2::to_array),
                    color: color.map(|x| (x * f32::from(u16::MAX)).round() as u16),
                }));
            }
        }
    }
}

impl BatchLimits {
    /// The largest batch that fits into the device's storage bindings and buffers.
    pub(crate) fn of_device(limits: &wgpu::Limits) -> Self {
        let binding = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        let by_shading = limits.max_buffer_size / size_of::<Shading>() as u64;
        let by_attributes = binding / Attributes::All.bytes();
        // `base_vertex` of a draw is an `i32`.
        let vertices = by_attributes.min(by_shading).min(1 << 31) - 1;
        // Whole triangles, counted by a `u32`.
        let indices = (binding / size_of::<u32>() as u64).min(u64::from(u32::MAX)) / 3 * 3;
        Self { vertices: vertices as usize, indices: indices as usize }
    }
}

/// Packs `meshes`, grouped by kind; returns the batches, and the pieces of each mesh.
pub(crate) fn pack(
    meshes: &[Mesh],
    kinds: &[BatchKind],
    limits: BatchLimits,
) -> (Vec<Batch>, Vec<Vec<Piece>>) {
    let mut batches = Vec::new();
    let pieces = meshes
        .iter()
        .zip(kinds)
        .map(|(mesh, &kind)| {
            let mut append = |vertices: &[usize], indices: &[u32]| {
                append(&mut batches, kind, mesh, vertices, indices, limits)
            };
            let fits =
                mesh.positions.len() <= limits.vertices && mesh.indices.len() <= limits.indices;
            if fits {
                let vertices: Vec<usize> = (0..mesh.positions.len()).collect();
                return vec![append(&vertices, &mesh.indices)];
            }
            split(mesh, limits)
                .into_iter()
                .map(|(vertices, indices)| append(&vertices, &indices))
                .collect()
        })
        .collect();
    (batches, pieces)
}

/// Appends vertices of a mesh, and triangles between them, to the last batch of their kind or, if
/// that is full, to a new one.
fn append(
    batches: &mut Vec<Batch>,
    kind: BatchKind,
    mesh: &Mesh,
    vertices: &[usize],
    indices: &[u32],
    limits: BatchLimits,
) -> Piece {
    let last = batches.iter().rposition(|batch| {
        batch.kind == kind
            && batch.positions.len() + vertices.len() <= limits.vertices
            && batch.indices.len() + indices.len() <= limits.indices
    });
    let last = last.unwrap_or_else(|| {
        batches.push(Batch { kind, ..Batch::default() });
        batches.len() - 1
    });
    let batch = &mut batches[last];
    let piece = Piece {
        batch: last,
        first_index: batch.indices.len() as u32,
        index_count: indices.len() as u32,
        base_vertex: batch.positions.len() as u32,
    };
    for &vertex in vertices {
        batch.positions.push(mesh.positions[vertex].to_array());
        kind.attributes.append(&mut batch.attribute_bytes, mesh, vertex);
        let normal = mesh.normals.get(vertex).copied().unwrap_or(Vec3::Y);
        let tangent = mesh.tangents.get(vertex).copied();
        let tangent = tangent.unwrap_or_else(|| normal.any_orthonormal_vector().extend(1.0));
        batch.shading.push(Shading { normal: normal.to_array(), tangent: tangent.to_array() });
    }
    batch.indices.extend_from_slice(indices);
    piece
}

/// Splits a mesh into parts that each fit: the mesh's vertices in the part, and the triangles
/// between them.
fn split(mesh: &Mesh, limits: BatchLimits) -> Vec<(Vec<usize>, Vec<u32>)> {
    let mut parts = Vec::new();
    let mut vertices: Vec<usize> = Vec::new();
    let mut indices: Vec<u32> = Vec::new();
    let mut places: HashMap<usize, u32> = HashMap::new();
    for triangle in mesh.triangles() {
        if vertices.len() + 3 > limits.vertices || indices.len() + 3 > limits.indices {
            parts.push((std::mem::take(&mut vertices), std::mem::take(&mut indices)));
            places.clear();
        }
        for vertex in triangle {
            let place = *places.entry(vertex).or_insert_with(|| {
                vertices.push(vertex);
                vertices.len() as u32 - 1
            });
            indices.push(place);
        }
    }
    if !indices.is_empty() {
        parts.push((vertices, indices));
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of `n` triangles between `n + 2` vertices.
    fn strip(n: u32) -> Mesh {
        Mesh {
            positions: (0..n + 2).map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.0)).collect(),
            uvs: (0..n + 2).map(|i| Vec2::new(i as f32, 0.0)).collect(),
            indices: (0..n).flat_map(|i| [i, i + 1, i + 2]).collect(),
            ..Mesh::default()
        }
    }

    /// The corners of all triangles of a mesh, read from the batches.
    fn corners(batches: &[Batch], pieces: &[Piece]) -> Vec<[f32; 3]> {
        pieces
            .iter()
            .flat_map(|piece| {
                let batch = &batches[piece.batch];
                let first = piece.first_index as usize;
                batch.indices[first..first + piece.index_count as usize]
                    .iter()
                    .map(|index| batch.positions[(index + piece.base_vertex) as usize])
            })
            .collect()
    }

    #[test]
    fn packing_keeps_every_triangle_within_batch_limits() {
        let meshes = [strip(2), strip(40), strip(5)];
        let whole = BatchLimits { vertices: 1000, indices: 3000 };
        let limits = BatchLimits { vertices: 10, indices: 21 };
        let kinds = [BatchKind::default(); 3];
        let (one, reference) = pack(&meshes, &kinds, whole);
        assert_eq!(one.len(), 1);
        let (batches, pieces) = pack(&meshes, &kinds, limits);
        for batch in &batches {
            assert!(batch.positions.len() <= limits.vertices);
            assert!(batch.indices.len() <= limits.indices);
            assert_eq!(batch.positions.len() * 8, batch.attribute_bytes.len());
            assert_eq!(batch.positions.len(), batch.shading.len());
        }
        for (split, whole) in pieces.iter().zip(&reference) {
            assert_eq!(corners(&batches, split), corners(&one, whole));
        }
    }

    #[test]
    fn only_meshes_with_extra_attributes_store_them() {
        let plain = Mesh { uvs1: vec![Vec2::Y; 4], colors: vec![Vec4::ONE; 4], ..strip(2) };
        let colored = Mesh { colors: vec![Vec4::new(0.5, 0.0, 1.0, 0.25); 4], ..strip(2) };
        assert_eq!(Attributes::needed(&plain, false), Attributes::Texcoords);
        let meshes = [plain.clone(), colored, plain];
        let needed = [false, false, true].map(|second| (second, &meshes));
        let needed: Vec<_> = needed
            .iter()
            .enumerate()
            .map(|(i, (second, meshes))| Attributes::needed(&meshes[i], *second))
            .collect();
        assert_eq!(needed, [Attributes::Texcoords, Attributes::All, Attributes::All]);
        let limits = BatchLimits { vertices: 1000, indices: 3000 };
        let kind = |&attributes: &Attributes| BatchKind { attributes, is_static: true };
        let kinds: Vec<_> = needed.iter().map(kind).collect();
        let (batches, pieces) = pack(&meshes, &kinds, limits);
        assert_eq!(batches.len(), 2);
        assert_eq!(batches[0].attribute_bytes.len(), 4 * 8);
        let all: Vec<AllAttributes> = bytemuck::pod_collect_to_vec(&batches[1].attribute_bytes);
        let [first, second] = [1, 2].map(|mesh| all[pieces[mesh][0].base_vertex as usize + 1]);
        assert_eq!(first.color, [32768, 0, 65535, 16384]);
        assert_eq!((first.texcoord, first.texcoord_1), ([1.0, 0.0], [1.0, 0.0]));
        assert_eq!((second.color, second.texcoord_1), ([u16::MAX; 4], [0.0, 1.0]));
    }

    #[test]
    fn dynamic_meshes_get_their_own_batch_and_fingerprint() {
        let kinds =
            [true, false, true].map(|is_static| BatchKind { is_static, ..BatchKind::default() });
        let limits = BatchLimits { vertices: 1000, indices: 3000 };
        let mut meshes = [strip(2), strip(40), strip(5)];
        let (before, pieces) = pack(&meshes, &kinds, limits);
        assert_eq!(pieces.iter().map(|pieces| pieces[0].batch).collect::<Vec<_>>(), [0, 1, 0]);
        meshes[1].positions[3].y += 1e-6;
        let (after, _) = pack(&meshes, &kinds, limits);
        assert_eq!(before[0].fingerprint(), after[0].fingerprint());
        assert_ne!(before[1].fingerprint(), after[1].fingerprint());
        meshes[2].normals = vec![Vec3::X; 7];
        let (turned, _) = pack(&meshes, &kinds, limits);
        assert_ne!(before[0].fingerprint(), turned[0].fingerprint());
    }

    #[test]
    fn batches_fit_the_default_limits() {
        let limits = wgpu::Limits::default();
        let batch = BatchLimits::of_device(&limits);
        assert!(batch.vertices as u64 * 28 <= limits.max_buffer_size);
        assert!(batch.vertices as u64 * 24 <= limits.max_storage_buffer_binding_size);
        assert!(batch.indices as u64 * 4 <= limits.max_storage_buffer_binding_size);
    }
}
