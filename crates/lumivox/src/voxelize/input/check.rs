//! Checks the caller's geometry; errors name the place and the remedy.

use super::{index_bytes, is_textured, textures};
use crate::geometry::{Draw, GeometryBatch};
use crate::{Geometry, GiError, Gloss, Indices, VertexAttributes, VertexPositions};

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
        let Gloss { mean, grazing, kept_out } = material.gloss;
        if ![mean, kept_out].iter().all(|share| (0.0..=1.0).contains(share))
            || !(-1.0..=1.0).contains(&grazing)
        {
            return fail(
                "its gloss must be shares from 0 to 1, and from -1 to 1 at grazing angles",
            );
        }
        if !(0.0..=1.0).contains(&material.transmission) {
            return fail("its transmission must be from 0 to 1");
        }
        for texture in textures(material).into_iter().flatten() {
            if !texture.transform.is_finite() {
                return fail("the transform of a texture's coordinates must be finite");
            }
            if texture.texcoord_set > 1 {
                return fail("vertices have texture coordinates of the sets 0 and 1 alone");
            }
        }
    }
    Ok(())
}

/// Checks that the buffers of a batch can be bound, and their layouts.
pub(super) fn check_buffers(
    batch: &GeometryBatch,
    index: usize,
    limits: &wgpu::Limits,
) -> Result<(), GiError> {
    let buffers = [
        ("positions", Some(&batch.positions.buffer)),
        ("attributes", batch.attributes.as_ref().map(|attributes| &attributes.buffer)),
        ("indices", Some(&batch.indices.buffer)),
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
    check_positions(&batch.positions)
        .and_then(|()| check_indices(&batch.indices))
        .and_then(|()| batch.attributes.as_ref().map_or(Ok(()), check_attributes))
        .map_err(|problem| GiError::Geometry { place: format!("batch {index}"), problem })
}

/// Rejects a byte offset that is unaligned or beyond its buffer.
fn check_offset(name: &str, offset: u64, size: u64, buffer: &wgpu::Buffer) -> Result<(), String> {
    if !offset.is_multiple_of(size) {
        return Err(format!(
            "its {name} start at byte {offset}, which is no multiple of {size}: align them"
        ));
    }
    if offset > buffer.size() {
        return Err(format!(
            "its {name} start at byte {offset}, but their buffer ends at {}",
            buffer.size()
        ));
    }
    Ok(())
}

fn check_positions(positions: &VertexPositions) -> Result<(), String> {
    let VertexPositions { buffer, stride, offset } = positions;
    if !stride.is_multiple_of(4) || *stride < 12 {
        return Err(format!(
            "the stride of its positions, {stride} bytes, must be a multiple of 4 and at least 12"
        ));
    }
    check_offset("positions", *offset, 4, buffer)
}

fn check_indices(indices: &Indices) -> Result<(), String> {
    let bytes = indices.buffer.size();
    if !bytes.is_multiple_of(4) {
        return Err(format!(
            "the buffer of its indices has {bytes} bytes, which is no multiple of 4: add an index \
             that nothing uses"
        ));
    }
    check_offset("indices", indices.offset, index_bytes(indices), &indices.buffer)
}

/// Checks that a batch's attributes are aligned to words and lie within a vertex.
fn check_attributes(attributes: &VertexAttributes) -> Result<(), String> {
    let VertexAttributes { buffer, stride, offset, texcoords, color, color_format } = attributes;
    let color_bytes = match color_format {
        wgpu::VertexFormat::Unorm8x4 => 4,
        wgpu::VertexFormat::Unorm16x4 => 8,
        wgpu::VertexFormat::Float32x4 => 16,
        other => {
            return Err(format!(
                "its colours have the format {other:?}; give Unorm8x4, Unorm16x4 or Float32x4"
            ));
        }
    };
    check_offset("attributes", *offset, 4, buffer)?;
    if !stride.is_multiple_of(4) {
        return Err(format!("the stride of its attributes, {stride} bytes, is no multiple of 4"));
    }
    let sized = texcoords.iter().map(|offset| (offset, 8)).chain([(color, color_bytes)]);
    for (offset, bytes) in sized.filter_map(|(offset, bytes)| Some(((*offset)?, bytes))) {
        let fits =
            offset.is_multiple_of(4) && offset.checked_add(bytes).is_some_and(|end| end <= *stride);
        if !fits {
            return Err(format!(
                "an attribute at byte {offset} does not lie in whole words within the stride of \
                 {stride} bytes"
            ));
        }
    }
    Ok(())
}

/// Checks a draw against its batch and the materials.
pub(super) fn check_draw(
    geometry: &Geometry,
    batch: &GeometryBatch,
    draw: &Draw,
) -> Result<(), String> {
    if !draw.index_count.is_multiple_of(3) {
        return Err(format!("it has {} indices, which is no multiple of 3", draw.index_count));
    }
    let end = u64::from(draw.first_index) + u64::from(draw.index_count);
    let Indices { buffer, offset, .. } = &batch.indices;
    let indices = buffer.size().saturating_sub(*offset) / index_bytes(&batch.indices);
    if end > indices && draw.index_count > 0 {
        return Err(format!("its indices end at {end}, but the batch has {indices}"));
    }
    if draw.bounds.is_some_and(|[low, high]| !low.cmple(high).all()) {
        return Err(
            "the first corner of its bounds must not be above the second, along any axis; \
                    leave bounds out that are not known"
                .to_owned(),
        );
    }
    let Some(material) = geometry.materials.get(draw.material as usize) else {
        return Err(format!(
            "it names material {}, but there are {}",
            draw.material,
            geometry.materials.len()
        ));
    };
    let has_texcoords = batch.attributes.as_ref().is_some_and(|a| a.texcoords[0].is_some());
    if is_textured(material) && !has_texcoords {
        return Err(format!(
            "its material {} has a texture, but the batch has no texture coordinates",
            draw.material
        ));
    }
    Ok(())
}
