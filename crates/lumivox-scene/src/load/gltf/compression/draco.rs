//! `KHR_draco_mesh_compression` (Google, Khronos): a primitive's indices and attributes as one
//! stream of the Draco library, decoded by `draco-core`.
//!
//! The accessors of the compressed attributes have no data; they get the decoded data. Draco may
//! split vertices, so the decoder returns the number of vertices.

use std::borrow::Cow;
use std::collections::HashMap;

use draco_core::{
    DataType, DecodeLimits, DecoderBuffer, ErrorKind, Mesh, MeshDecoder, PointAttribute,
};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::View;
use gltf::json::mesh::Mode;
use gltf::json::validation::{Checked, USize64};
use gltf::json::{Index, Root};
use serde_json::Value;

use super::{Buffers, Sink, push_buffer};
use crate::SceneError;

const EXTENSION: &str = "KHR_draco_mesh_compression";

/// Decompresses all primitives that are compressed.
pub(super) fn decompress(
    root: &mut Root,
    buffers: &mut Buffers<'_>,
    sink: &mut Sink<'_>,
) -> Result<(), SceneError> {
    // The decoded data of accessors: primitives may share them.
    let mut filled: HashMap<usize, usize> = HashMap::new();
    for mesh in 0..root.meshes.len() {
        for index in 0..root.meshes[mesh].primitives.len() {
            let primitive = &root.meshes[mesh].primitives[index];
            let Some(stream) = primitive.extensions.as_ref().and_then(|e| e.others.get(EXTENSION))
            else {
                continue;
            };
            let stream = stream.clone();
            let part = format!("mesh {mesh}, primitive {index}, its Draco compression,");
            let Some(view) = stream["bufferView"].as_u64().and_then(|v| usize::try_from(v).ok())
            else {
                return Err(sink.malformed(&part, "its buffer view is missing"));
            };
            if primitive.indices.is_none() {
                return Err(sink.malformed(&part, "its indices are missing"));
            }
            let wanted = wanted(root, mesh, index, &stream);
            if wanted.iter().all(|(accessor, _)| filled.get(accessor) == Some(&view)) {
                continue;
            }
            if let Some((accessor, _)) = wanted.iter().find(|(a, _)| filled.contains_key(a)) {
                let reason = format!("accessor {accessor} belongs to another compressed primitive");
                return Err(sink.malformed(&part, reason));
            }
            let decoded = decode(root, buffers, view, &part, sink)?;
            for (accessor, id) in wanted {
                fill(root, buffers, &decoded, accessor, id, &part, sink)?;
                filled.insert(accessor, view);
            }
            // Draco only stores triangles, whatever mode the primitive names.
            root.meshes[mesh].primitives[index].mode = Checked::Valid(Mode::Triangles);
        }
    }
    Ok(())
}

/// The primitive's compressed accessors, with their IDs in Draco; indices have no ID.
fn wanted(root: &Root, mesh: usize, index: usize, stream: &Value) -> Vec<(usize, Option<u64>)> {
    let primitive = &root.meshes[mesh].primitives[index];
    let mut wanted: Vec<(usize, Option<u64>)> =
        primitive.indices.iter().map(|indices| (indices.value(), None)).collect();
    for (semantic, accessor) in &primitive.attributes {
        let Checked::Valid(semantic) = semantic else { continue };
        let id = &stream["attributes"][semantic.to_string()];
        if !id.is_null() {
            // An ID that is not a number cannot match any attribute.
            wanted.push((accessor.value(), Some(id.as_u64().unwrap_or(u64::MAX))));
        }
    }
    // The order of the map differs between runs.
    wanted.sort_unstable();
    wanted
}

fn decode(
    root: &Root,
    buffers: &[Cow<'_, [u8]>],
    view: usize,
    part: &str,
    sink: &mut Sink<'_>,
) -> Result<Mesh, SceneError> {
    let encoded = root.buffer_views.get(view).and_then(|view| {
        let offset = view.byte_offset.map_or(0, |offset| offset.0);
        let buffer = buffers.get(view.buffer.value())?;
        super::super::accessor::sub_slice(buffer, offset, view.byte_length.0)
    });
    let Some(encoded) = encoded else {
        return Err(sink.malformed(part, format!("buffer view {view} does not fit in its buffer")));
    };
    // A face has three indices of four bytes, and a point has at least a position.
    let limits = DecodeLimits::default()
        .with_max_decoded_bytes(sink.budget.left())
        .with_max_faces(sink.budget.left() / 12)
        .with_max_points((sink.budget.left() / 12).min(u64::from(u32::MAX)));
    let mut mesh = Mesh::new();
    MeshDecoder::new()
        .decode(&mut DecoderBuffer::new(encoded).with_limits(limits), &mut mesh)
        .map_err(|error| match error.kind() {
            ErrorKind::LimitExceeded => sink.too_large(part),
            _ => sink.malformed(part, format!("it cannot be decoded: {error}")),
        })?;
    Ok(mesh)
}

/// Gives an accessor its part of the decoded data.
fn fill(
    root: &mut Root,
    buffers: &mut Buffers<'_>,
    decoded: &Mesh,
    accessor: usize,
    id: Option<u64>,
    part: &str,
    sink: &mut Sink<'_>,
) -> Result<(), SceneError> {
    let (bytes, component, components, count) = if let Some(id) = id {
        let id = u32::try_from(id).ok();
        let Some(attribute) = id.and_then(|id| decoded.attribute_by_unique_id(id)) else {
            return Err(sink.malformed(part, "it names an attribute that its stream lacks"));
        };
        let points = decoded.num_points();
        let components = usize::from(attribute.num_components());
        let Some(component) = component_type(attribute.data_type()) else {
            return Err(sink.malformed(part, "an attribute has numbers of a type that glTF lacks"));
        };
        let size = component.size();
        sink.spend(part, (points * components * size) as u64)?;
        let bytes = points_of(attribute, points, components * size)
            .ok_or_else(|| sink.malformed(part, "an attribute has no value for some vertex"))?;
        (bytes, component, components, points)
    } else {
        let count = decoded.num_faces() * 3;
        sink.spend(part, count as u64 * 4)?;
        let corners = decoded.faces().as_flattened().iter();
        let bytes = corners.flat_map(|point| point.0.to_le_bytes()).collect();
        (bytes, ComponentType::U32, 1, count)
    };
    let Some(json) = root.accessors.get(accessor) else {
        return Err(sink.malformed(part, "it names an accessor that does not exist"));
    };
    let expected = match json.type_ {
        Checked::Valid(Type::Scalar) => 1,
        Checked::Valid(Type::Vec2) => 2,
        Checked::Valid(Type::Vec3) => 3,
        Checked::Valid(Type::Vec4) => 4,
        _ => 0,
    };
    if components != expected {
        let reason = format!("an attribute has {components} components instead of {expected}");
        return Err(sink.malformed(part, reason));
    }
    let length = bytes.len() as u64;
    let buffer = push_buffer(root, buffers, bytes);
    root.buffer_views.push(View {
        buffer,
        byte_length: USize64(length),
        byte_offset: None,
        byte_stride: None,
        name: None,
        target: None,
        extensions: None,
        extras: gltf::json::Extras::default(),
    });
    let view = Index::new(root.buffer_views.len() as u32 - 1);
    let json = &mut root.accessors[accessor];
    json.buffer_view = Some(view);
    json.byte_offset = None;
    json.sparse = None;
    json.count = USize64(count as u64);
    json.component_type = Checked::Valid(GenericComponentType(component));
    Ok(())
}

/// An attribute's bytes, in the order of the points.
fn points_of(attribute: &PointAttribute, points: usize, size: usize) -> Option<Vec<u8>> {
    let stride = usize::try_from(attribute.byte_stride()).ok()?;
    let data = attribute.buffer().data();
    let mut bytes = Vec::with_capacity(points * size);
    for point in 0..points as u32 {
        let value = attribute.mapped_index(draco_core::PointIndex(point)).0 as usize;
        let begin = value.checked_mul(stride)?;
        bytes.extend(data.get(begin..begin.checked_add(size)?)?);
    }
    Some(bytes)
}

fn component_type(kind: DataType) -> Option<ComponentType> {
    Some(match kind {
        DataType::Int8 => ComponentType::I8,
        DataType::Uint8 => ComponentType::U8,
        DataType::Int16 => ComponentType::I16,
        DataType::Uint16 => ComponentType::U16,
        DataType::Uint32 => ComponentType::U32,
        DataType::Float32 => ComponentType::F32,
        _ => return None,
    })
}
