//! The caller's geometry, checked against its buffers and put in order.
//!
//! The draws of a batch are sorted into groups that share their textures, so that a group is one run of
//! triangles and one dispatch; materials without textures are one group.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use crate::geometry::{Draw, GeometryBatch};
use crate::{Geometry, GiError, Grid, SurfaceMaterial};

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
    padding: u32,
}

/// Bits of [`DrawRecord::flags`].
pub(crate) const DOUBLE_SIDED: u32 = 1;
/// Alpha cuts holes.
pub(crate) const ALPHA_IS_COVERAGE: u32 = 2;

/// Neighbouring draws that share their textures.
#[derive(Clone, Debug)]
pub(crate) struct DrawGroup {
    /// The material of one of them: what its textures are.
    pub material: u32,
    /// Whether there are textures.
    pub is_textured: bool,
    /// Whether alpha may cut holes.
    pub is_covered: bool,
    /// Its triangles, in the batch's numbering.
    pub triangles: std::ops::Range<u32>,
    /// Its draws, in the batch's order.
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

/// The largest emission of any material: what emission is stored relative to.
pub(crate) fn emission_scale(geometry: &Geometry) -> f32 {
    geometry.materials.iter().map(|material| material.emission.max_element()).fold(0.0, f32::max)
}

/// Checks all materials.
pub(crate) fn check_materials(geometry: &Geometry) -> Result<(), GiError> {
    for (index, material) in geometry.materials.iter().enumerate() {
        let fail = |problem: &str| {
            Err(GiError::Geometry {
                place: format!("material {index}"),
                problem: problem.to_owned(),
            })
        };
        if !material.reflectance.is_finite() || material.reflectance.min_element() < 0.0 {
            return fail("its reflectance must be finite and not negative");
        }
        if !material.emission.is_finite() || material.emission.min_element() < 0.0 {
            return fail("its emission must be finite and not negative");
        }
        if is_textured(material) && material.sampler.is_none() {
            return fail("it has a texture, but no sampler");
        }
    }
    Ok(())
}

/// Checks a batch and puts its draws in order; `None` if it has no triangles.
pub(crate) fn prepare_batch(
    geometry: &Geometry,
    index: usize,
    grid: &Grid,
    emission_scale: f32,
    limits: &wgpu::Limits,
) -> Result<Option<PreparedBatch>, GiError> {
    let batch = &geometry.batches[index];
    let groups = texture_groups(&geometry.materials);
    check_buffers(batch, index, limits)?;
    for (number, draw) in batch.draws.iter().enumerate() {
        check_draw(geometry, batch, draw).map_err(|problem| GiError::Geometry {
            place: format!("draw {number} of batch {index}"),
            problem,
        })?;
    }

    let triangles: u64 = batch.draws.iter().map(|draw| u64::from(draw.index_count / 3)).sum();
    // The items' starts take a word per triangle, and one more.
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

    let mut order: Vec<&Draw> = batch.draws.iter().filter(|draw| draw.index_count > 0).collect();
    order.sort_by_key(|draw| groups[draw.material as usize]);
    let mut prepared = PreparedBatch {
        draws: Vec::with_capacity(order.len()),
        groups: Vec::new(),
        triangle_count: 0,
    };
    let mut group = None;
    for (place, draw) in order.into_iter().enumerate() {
        let material = &geometry.materials[draw.material as usize];
        let first = prepared.triangle_count;
        let end = first + draw.index_count / 3;
        if group != Some(groups[draw.material as usize]) {
            group = Some(groups[draw.material as usize]);
            prepared.groups.push(DrawGroup {
                material: draw.material,
                is_textured: is_textured(material),
                is_covered: has_holes(material),
                triangles: first..end,
                draws: place as u32..place as u32,
            });
        }
        if let Some(group) = prepared.groups.last_mut() {
            group.triangles.end = end;
            group.draws.end = place as u32 + 1;
        }
        prepared.draws.push(draw_record(draw, material, grid, emission_scale, first));
        prepared.triangle_count = end;
    }
    Ok(Some(prepared))
}

fn is_textured(material: &SurfaceMaterial) -> bool {
    material.reflectance_texture.is_some() || material.emission_texture.is_some()
}

fn has_holes(material: &SurfaceMaterial) -> bool {
    material.alpha_is_coverage
        && (material.reflectance_texture.is_some() || material.reflectance.w < 1.0)
}

/// For each material, the number of the group that shares its textures and use of alpha.
fn texture_groups(materials: &[SurfaceMaterial]) -> Vec<usize> {
    let is_same = |a: &SurfaceMaterial, b: &SurfaceMaterial| {
        let same_textures = a.reflectance_texture == b.reflectance_texture
            && a.emission_texture == b.emission_texture
            && (a.sampler == b.sampler || !is_textured(a));
        same_textures && has_holes(a) == has_holes(b)
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

fn check_buffers(
    batch: &GeometryBatch,
    index: usize,
    limits: &wgpu::Limits,
) -> Result<(), GiError> {
    let buffers = [
        ("positions", Some(&batch.positions)),
        ("texture coordinates", batch.texcoords.as_ref()),
        ("indices", Some(&batch.indices)),
    ];
    for (name, buffer) in buffers {
        let Some(buffer) = buffer else { continue };
        if !buffer.usage().contains(wgpu::BufferUsages::STORAGE) {
            return Err(GiError::Geometry {
                place: format!("batch {index}"),
                problem: format!("the buffer of its {name} lacks BufferUsages::STORAGE"),
            });
        }
        if buffer.size() > limits.max_storage_buffer_binding_size {
            return Err(GiError::Limit {
                what: format!("the buffer of the {name} of batch {index}"),
                needed: buffer.size(),
                unit: "bytes",
                limit: "max_storage_buffer_binding_size",
                available: limits.max_storage_buffer_binding_size,
                remedy: "share its triangles out to several batches".to_owned(),
            });
        }
    }
    Ok(())
}

fn check_draw(geometry: &Geometry, batch: &GeometryBatch, draw: &Draw) -> Result<(), String> {
    if !draw.index_count.is_multiple_of(3) {
        return Err(format!("it has {} indices, which is no multiple of 3", draw.index_count));
    }
    let end = u64::from(draw.first_index) + u64::from(draw.index_count);
    let indices = batch.indices.size() / 4;
    if end > indices {
        return Err(format!("its indices end at {end}, but the batch has {indices}"));
    }
    let Some(material) = geometry.materials.get(draw.material as usize) else {
        return Err(format!(
            "it names material {}, but there are {}",
            draw.material,
            geometry.materials.len()
        ));
    };
    if is_textured(material) && batch.texcoords.is_none() {
        return Err(format!(
            "its material {} has a texture, but the batch has no texture coordinates",
            draw.material
        ));
    }
    Ok(())
}

fn draw_record(
    draw: &Draw,
    material: &SurfaceMaterial,
    grid: &Grid,
    emission_scale: f32,
    first_triangle: u32,
) -> DrawRecord {
    // In f64: the grid's origin may be far from the world's.
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
    DrawRecord {
        grid_from_local_x: row(0),
        grid_from_local_y: row(1),
        grid_from_local_z: row(2),
        reflectance: material.reflectance.to_array(),
        emission: relative_emission.to_array(),
        first_triangle,
        first_index: draw.first_index,
        base_vertex: draw.base_vertex,
        flags: flag(material.double_sided, DOUBLE_SIDED)
            | flag(has_holes(material), ALPHA_IS_COVERAGE),
        padding: 0,
    }
}
