//! The caller's geometry, checked against its buffers and sorted.
//!
//! The draws of a batch are sorted into groups that share their textures, so that a group is one
//! run of triangles and one dispatch; all materials without textures form one group.

mod check;
mod key;

use bytemuck::{Pod, Zeroable};
use glam::{Affine2, Mat4, Vec3};

pub(crate) use check::check_materials;
use check::{check_buffers, check_draw};
pub(crate) use key::ShareKey;

use super::hook::Detail;
use crate::cascades::Walked;
use crate::geometry::{Draw, GeometryBatch};
use crate::{Geometry, GiError, Grid, Indices, SurfaceMaterial, SurfaceTexture};

/// `TexturePlace` of `triangles.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct TexturePlace {
    pub u_row: [f32; 3],
    pub word: u32,
    pub v_row: [f32; 3],
    padding: u32,
}

/// `Draw` of `triangles.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct DrawRecord {
    pub grid_from_local_x: [f32; 4],
    pub grid_from_local_y: [f32; 4],
    pub grid_from_local_z: [f32; 4],
    pub reflectance: [f32; 4],
    pub emission: [f32; 3],
    pub first_triangle: u32,
    pub first_index: u32,
    pub base_vertex: u32,
    pub flags: u32,
    pub transmission: f32,
    pub reflectance_place: TexturePlace,
    pub emission_place: TexturePlace,
    pub transmission_place: TexturePlace,
    pub vertex_words: u32,
    pub color_word: u32,
    pub position_word: u32,
    pub position_words: u32,
    pub gloss: [f32; 3],
    pub cascades: u32,
}

/// Bits of [`DrawRecord::flags`].
pub(crate) const DOUBLE_SIDED: u32 = 1;
/// The material's alpha is coverage.
pub(crate) const ALPHA_IS_COVERAGE: u32 = 2;
/// The vertices have colours.
pub(crate) const HAS_COLORS: u32 = 4;
/// Indices have 16 bits.
pub(crate) const HAS_SHORT_INDICES: u32 = 8;
/// Colours are four floats, or four bytes; otherwise four 16-bit numbers.
pub(crate) const HAS_FLOAT_COLORS: u32 = 16;
pub(crate) const HAS_BYTE_COLORS: u32 = 32;

/// Light from behind passes through a single-sided surface.
pub(crate) const OPEN_BEHIND: u32 = 64;

/// Neighbouring draws that share their textures.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DrawGroup {
    /// The material of one of its draws, for the textures.
    pub material: u32,
    /// The detail to sample.
    pub detail: Detail,
    /// The group's triangles, in the batch's numbering.
    pub triangles: std::ops::Range<u32>,
    /// The group's draws, in the batch's order.
    pub draws: std::ops::Range<u32>,
}

/// A batch, ready for the GPU.
#[derive(Clone, Debug)]
pub(crate) struct PreparedBatch {
    /// All draws, group by group.
    pub draws: Vec<DrawRecord>,
    /// The groups.
    pub groups: Vec<DrawGroup>,
    /// Triangles of all draws.
    pub triangle_count: u32,
}

/// The draws of one share of the surface, static or dynamic, checked and sorted.
#[derive(Clone, Debug, Default)]
pub(crate) struct ShareInput<'a> {
    /// Batches with triangles in this share.
    pub batches: Vec<(&'a GeometryBatch, PreparedBatch)>,
    /// Triangles of static draws outside of the walked boxes.
    pub left_out: u64,
}

impl<'a> ShareInput<'a> {
    /// The share of either the static or the dynamic draws. Static draws outside of the walked
    /// boxes are left out; dynamic ones are kept, so that nothing is rebound when they enter or
    /// leave.
    ///
    /// # Errors
    /// [`GiError::Geometry`] and [`GiError::Limit`] as [`super::Voxelizer::voxelize`] says.
    pub(crate) fn new(
        geometry: &'a Geometry,
        is_static: bool,
        (grid, walked): (&Grid, &Walked),
        limits: &wgpu::Limits,
    ) -> Result<Self, GiError> {
        Self::of_draws(geometry, |draw| draw.is_static == is_static, (grid, walked), limits)
    }

    /// The emissive draws, both static and dynamic.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(crate) fn of_emitters(
        geometry: &'a Geometry,
        grid: &Grid,
        limits: &wgpu::Limits,
    ) -> Result<Self, GiError> {
        let emits = |draw: &Draw| emits(&geometry.materials[draw.material as usize]);
        Self::of_draws(geometry, emits, (grid, &Walked::default()), limits)
    }

    fn of_draws(
        geometry: &'a Geometry,
        is_wanted: impl Fn(&Draw) -> bool,
        place: (&Grid, &Walked),
        limits: &wgpu::Limits,
    ) -> Result<Self, GiError> {
        let mut input = Self::default();
        for (index, batch) in geometry.batches.iter().enumerate() {
            let left_out = &mut input.left_out;
            let prepared = prepare_batch(geometry, index, &is_wanted, (place, left_out), limits)?;
            input.batches.extend(prepared.map(|prepared| (batch, prepared)));
        }
        Ok(input)
    }

    /// `true` if there are no triangles.
    pub(crate) fn is_empty(&self) -> bool {
        self.batches.is_empty()
    }

    /// The draws of each batch, in the GPU's format.
    pub(crate) fn draws(&self) -> impl Iterator<Item = &[DrawRecord]> {
        self.batches.iter().map(|(_, prepared)| prepared.draws.as_slice())
    }

    /// The details of all runs of triangles.
    pub(crate) fn details(&self) -> impl Iterator<Item = Detail> {
        let groups = self.batches.iter().flat_map(|(_, prepared)| &prepared.groups);
        groups.map(|group| group.detail)
    }

    /// The number of triangles.
    pub(crate) fn triangle_count(&self) -> u64 {
        self.batches.iter().map(|(_, prepared)| u64::from(prepared.triangle_count)).sum()
    }
}

/// The scale of stored emission: the smallest power of two that no material's emission exceeds. A
/// flickering lamp rarely changes this power, so voxels of static draws stay valid.
pub(crate) fn emission_scale(geometry: &Geometry) -> f32 {
    let emissions = geometry.materials.iter().map(|material| material.emission.max_element());
    emissions.fold(0.0, f32::max).log2().ceil().exp2()
}

/// `true` if a material emits light.
pub(crate) fn emits(material: &SurfaceMaterial) -> bool {
    material.emission.max_element() > 0.0
}

/// Checks a batch and sorts the draws of a share; `None` if they have no triangles.
fn prepare_batch(
    geometry: &Geometry,
    index: usize,
    is_wanted: &impl Fn(&Draw) -> bool,
    ((grid, walked), left_out): ((&Grid, &Walked), &mut u64),
    limits: &wgpu::Limits,
) -> Result<Option<PreparedBatch>, GiError> {
    let batch = &geometry.batches[index];
    let groups = texture_groups(&geometry.materials, batch);
    check_buffers(batch, index, limits)?;
    for (number, draw) in batch.draws.iter().enumerate() {
        check_draw(geometry, batch, draw).map_err(|problem| GiError::Geometry {
            place: format!("draw {number} of batch {index}"),
            problem,
        })?;
    }

    let wanted = batch.draws.iter().filter(|draw| draw.index_count > 0 && is_wanted(draw));
    let mut order: Vec<(&Draw, u32)> =
        wanted.map(|draw| (draw, walked.cascades_of(draw))).collect();
    order.retain(|(draw, cascades)| {
        let stays = *cascades != 0 || !draw.is_static;
        *left_out += if stays { 0 } else { u64::from(draw.index_count / 3) };
        stays
    });
    let triangles: u64 = order.iter().map(|(draw, _)| u64::from(draw.index_count / 3)).sum();
    // The items' starts are one word per triangle, plus one.
    let available = limits.max_storage_buffer_binding_size / 4 - 1;
    if triangles > available {
        return Err(GiError::Limit {
            what: format!("the numbering of the triangles of batch {index}"),
            needed: triangles * 4 + 4,
            unit: "bytes",
            limit: "max_storage_buffer_binding_size",
            available: limits.max_storage_buffer_binding_size,
            remedy: "share its draws out to several batches".to_owned(),
        });
    }
    if triangles == 0 {
        return Ok(None);
    }
    let draw_bytes = order.len() as u64 * size_of::<DrawRecord>() as u64;
    if draw_bytes > limits.max_storage_buffer_binding_size {
        return Err(GiError::Limit {
            what: format!("the {} draws of batch {index}", order.len()),
            needed: draw_bytes,
            unit: "bytes",
            limit: "max_storage_buffer_binding_size",
            available: limits.max_storage_buffer_binding_size,
            remedy: "share them out to several batches".to_owned(),
        });
    }

    let emission_scale = emission_scale(geometry);
    order.sort_by_key(|(draw, _)| groups[draw.material as usize]);
    let mut prepared = PreparedBatch {
        draws: Vec::with_capacity(order.len()),
        groups: Vec::new(),
        triangle_count: 0,
    };
    let mut group = None;
    for (place, (draw, cascades)) in order.into_iter().enumerate() {
        let material = &geometry.materials[draw.material as usize];
        let first = prepared.triangle_count;
        let end = first + draw.index_count / 3;
        if group != Some(groups[draw.material as usize]) {
            group = Some(groups[draw.material as usize]);
            prepared.groups.push(DrawGroup {
                material: draw.material,
                detail: detail(material, batch),
                triangles: first..end,
                draws: place as u32..place as u32,
            });
        }
        if let Some(group) = prepared.groups.last_mut() {
            group.triangles.end = end;
            group.draws.end = place as u32 + 1;
        }
        prepared.draws.push(draw_record(
            (draw, cascades),
            material,
            batch,
            grid,
            emission_scale,
            first,
        ));
        prepared.triangle_count = end;
    }
    Ok(Some(prepared))
}

fn textures(material: &SurfaceMaterial) -> [Option<&SurfaceTexture>; 3] {
    [&material.reflectance_texture, &material.emission_texture, &material.transmission_texture]
        .map(Option::as_ref)
}

fn is_textured(material: &SurfaceMaterial) -> bool {
    textures(material).iter().any(Option::is_some)
}

fn has_colors(batch: &GeometryBatch) -> bool {
    batch.attributes.as_ref().is_some_and(|attributes| attributes.color.is_some())
}

fn color_flags(batch: &GeometryBatch) -> u32 {
    let Some(attributes) = batch.attributes.as_ref().filter(|_| has_colors(batch)) else {
        return 0;
    };
    HAS_COLORS
        | match attributes.color_format {
            wgpu::VertexFormat::Float32x4 => HAS_FLOAT_COLORS,
            wgpu::VertexFormat::Unorm8x4 => HAS_BYTE_COLORS,
            _ => 0,
        }
}

/// The detail to sample for a material on a batch's vertices.
fn detail(material: &SurfaceMaterial, batch: &GeometryBatch) -> Detail {
    let varies = material.reflectance_texture.is_some() || has_colors(batch);
    let has_holes = material.alpha_is_coverage && (varies || material.reflectance.w < 1.0);
    if has_holes || material.transmission > 0.0 {
        Detail::Pierced
    } else if is_textured(material) || has_colors(batch) {
        Detail::Varied
    } else {
        Detail::Uniform
    }
}

/// For each material, the number of its group, which shares textures and detail.
fn texture_groups(materials: &[SurfaceMaterial], batch: &GeometryBatch) -> Vec<usize> {
    let is_same = |a: &SurfaceMaterial, b: &SurfaceMaterial| {
        let same_textures = textures(a).into_iter().zip(textures(b)).all(|(a, b)| match (a, b) {
            // The texture's transform is stored per draw.
            (Some(a), Some(b)) => a.view == b.view && a.sampler == b.sampler,
            (None, None) => true,
            _ => false,
        });
        same_textures && detail(a, batch) == detail(b, batch)
    };
    let mut firsts: Vec<&SurfaceMaterial> = Vec::new();
    let group = |material| {
        firsts.iter().position(|first| is_same(first, material)).unwrap_or_else(|| {
            firsts.push(material);
            firsts.len() - 1
        })
    };
    materials.iter().map(group).collect()
}

/// How the vertices of a batch map to a texture; arbitrary if there is no texture.
fn place(texture: Option<&SurfaceTexture>, batch: &GeometryBatch) -> TexturePlace {
    let transform = texture.map_or(Affine2::IDENTITY, |texture| texture.transform);
    let [first, second] = batch.attributes.as_ref().map_or([None; 2], |a| a.texcoords);
    let second = second.filter(|_| texture.is_some_and(|texture| texture.texcoord_set == 1));
    TexturePlace {
        u_row: transform.matrix2.row(0).extend(transform.translation.x).to_array(),
        word: first_attribute_word(batch) + second.or(first).unwrap_or(0) / 4,
        v_row: transform.matrix2.row(1).extend(transform.translation.y).to_array(),
        padding: 0,
    }
}

/// Bytes of an index.
fn index_bytes(indices: &Indices) -> u64 {
    u64::from(indices.format.byte_size())
}

/// The word at which the attributes of vertex 0 start.
fn first_attribute_word(batch: &GeometryBatch) -> u32 {
    batch.attributes.as_ref().map_or(0, |attributes| (attributes.offset / 4) as u32)
}

fn draw_record(
    (draw, cascades): (&Draw, u32),
    material: &SurfaceMaterial,
    batch: &GeometryBatch,
    grid: &Grid,
    emission_scale: f32,
    first_triangle: u32,
) -> DrawRecord {
    // Computed in f64, since the grid's origin may be far from the world's.
    let scale = 1.0 / f64::from(grid.voxel_size_m);
    let origin = grid.origin_in_world.as_dvec3();
    let world_from_local: Mat4 = draw.world_from_local;
    let row = |axis: usize| {
        let row = world_from_local.row(axis).as_dvec4();
        let offset = row.w - origin[axis];
        [row.x, row.y, row.z, offset].map(|value| (value * scale) as f32)
    };
    let relative_emission =
        if emission_scale > 0.0 { material.emission / emission_scale } else { Vec3::ZERO };
    let flag = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
    let [reflectance_place, emission_place, transmission_place] =
        textures(material).map(|texture| place(texture, batch));
    let attributes = batch.attributes.as_ref();
    DrawRecord {
        grid_from_local_x: row(0),
        grid_from_local_y: row(1),
        grid_from_local_z: row(2),
        reflectance: material.reflectance.to_array(),
        emission: relative_emission.to_array(),
        first_triangle,
        first_index: (batch.indices.offset / index_bytes(&batch.indices)) as u32 + draw.first_index,
        base_vertex: draw.base_vertex,
        flags: flag(material.double_sided, DOUBLE_SIDED)
            | flag(material.open_behind, OPEN_BEHIND)
            | flag(material.alpha_is_coverage, ALPHA_IS_COVERAGE)
            | color_flags(batch)
            | flag(batch.indices.format == wgpu::IndexFormat::Uint16, HAS_SHORT_INDICES),
        transmission: material.transmission,
        reflectance_place,
        emission_place,
        transmission_place,
        vertex_words: attributes.map_or(0, |attributes| attributes.stride / 4),
        color_word: first_attribute_word(batch)
            + attributes.and_then(|attributes| attributes.color).unwrap_or(0) / 4,
        position_word: (batch.positions.offset / 4) as u32,
        position_words: batch.positions.stride / 4,
        gloss: material.gloss.to_array(),
        cascades,
    }
}
