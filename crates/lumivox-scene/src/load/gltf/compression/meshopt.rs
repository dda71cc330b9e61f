//! `EXT_meshopt_compression` and `KHR_meshopt_compression` (Kapoulkine; Khronos): buffer views as
//! streams of the meshoptimizer library, read by an equivalent decoder in safe Rust.

use std::borrow::Cow;

use gltf::json::buffer::View;
use gltf::json::{Index, Root};
use meshoptimizer_rs::{Limits, Workspace, codec};
use serde_json::Value;

use super::{Buffers, MESHOPT, Sink, push_buffer};
use crate::SceneError;

/// The most bytes that one byte of a stream decodes to: two bits can hold the same byte of 256
/// vertices (meshoptimizer, vertex codec version 1), and indices compress less.
const MOST_BYTES_A_BYTE: u64 = 1024;
/// The size to which even the shortest stream may decode.
const FREE_BYTES: u64 = 1 << 20;

/// Decompresses all views that are compressed.
pub(super) fn decompress(
    root: &mut Root,
    buffers: &mut Buffers<'_>,
    sink: &mut Sink<'_>,
) -> Result<(), SceneError> {
    for index in 0..root.buffer_views.len() {
        let Some(stream) = extension(&root.buffer_views[index]).cloned() else { continue };
        let part = format!("buffer view {index}, its meshopt compression,");
        let bytes = decode(&stream, buffers, &part, sink)?;
        let view_length = root.buffer_views[index].byte_length.0;
        if (bytes.len() as u64) < view_length {
            let reason = format!("it holds {} bytes of {view_length}", bytes.len());
            return Err(sink.malformed(&part, reason));
        }
        let buffer = push_buffer(root, buffers, bytes);
        let view = &mut root.buffer_views[index];
        view.buffer = Index::new(buffer.value() as u32);
        view.byte_offset = None;
    }
    Ok(())
}

pub(super) fn extension(view: &View) -> Option<&Value> {
    let others = &view.extensions.as_ref()?.others;
    MESHOPT.iter().find_map(|name| others.get(*name))
}

fn decode(
    stream: &Value,
    buffers: &[Cow<'_, [u8]>],
    part: &str,
    sink: &mut Sink<'_>,
) -> Result<Vec<u8>, SceneError> {
    let number = |key: &str| stream[key].as_u64();
    let (Some(buffer), Some(length), Some(stride), Some(count)) =
        (number("buffer"), number("byteLength"), number("byteStride"), number("count"))
    else {
        return Err(sink.malformed(part, "its buffer, length, stride or count is missing"));
    };
    let offset = number("byteOffset").unwrap_or(0);
    let encoded = usize::try_from(buffer)
        .ok()
        .and_then(|buffer| buffers.get(buffer))
        .and_then(|buffer| super::super::accessor::sub_slice(buffer, offset, length))
        .ok_or_else(|| {
            let reason = format!("{length} bytes at byte {offset} do not fit in buffer {buffer}");
            sink.malformed(part, reason)
        })?;
    let bytes = count.checked_mul(stride).filter(|&bytes| {
        bytes <= FREE_BYTES.saturating_add(length.saturating_mul(MOST_BYTES_A_BYTE))
    });
    let Some(bytes) = bytes else {
        let reason = format!("it claims {count} elements, which its {length} bytes cannot hold");
        return Err(sink.malformed(part, reason));
    };
    sink.spend(part, bytes)?;
    let filter = stream["filter"].as_str().unwrap_or("NONE");
    let layout = (count as usize, stride as usize);
    decode_stream(encoded, stream["mode"].as_str(), layout, filter)
        .map_err(|reason| sink.malformed(part, reason))
}

/// Decodes a stream, given the number of its elements and their size.
fn decode_stream(
    encoded: &[u8],
    mode: Option<&str>,
    (count, stride): (usize, usize),
    filter: &str,
) -> Result<Vec<u8>, String> {
    // The decoded size was already checked against the budget.
    let limits = Limits { max_bytes: usize::MAX, max_work: u64::MAX };
    let workspace = &mut Workspace::new(limits);
    let bytes = match (mode, stride) {
        (Some("ATTRIBUTES"), _) if stride == 0 || stride > 256 || !stride.is_multiple_of(4) => {
            return Err(format!("its stride of {stride} bytes is not a multiple of 4 up to 256"));
        }
        (Some("ATTRIBUTES"), _) => codec::decode_vertex_buffer(count, stride, encoded, workspace),
        (Some("TRIANGLES"), _) if !count.is_multiple_of(3) => {
            return Err(format!("its {count} indices are not whole triangles"));
        }
        (Some("TRIANGLES"), 2 | 4) => codec::decode_index_buffer(count, stride, encoded, workspace),
        (Some("INDICES"), 2 | 4) => codec::decode_index_sequence(count, stride, encoded, workspace),
        (Some("TRIANGLES" | "INDICES"), _) => {
            return Err("its indices have a stride other than 2 or 4".to_owned());
        }
        _ => return Err("its mode is unknown".to_owned()),
    };
    let mut bytes = bytes.map_err(|error| error.to_string())?;
    if mode != Some("ATTRIBUTES") {
        return Ok(bytes);
    }
    // Inverts the filters that improve compression.
    let undone = match (filter, stride) {
        ("NONE", _) => Ok(()),
        ("OCTAHEDRAL", 4 | 8) => codec::decode_filter_oct(&mut bytes, count, stride, workspace),
        ("QUATERNION", 8) => codec::decode_filter_quat(&mut bytes, count, stride, workspace),
        ("COLOR", 4 | 8) => codec::decode_filter_color(&mut bytes, count, stride, workspace),
        ("EXPONENTIAL", _) => codec::decode_filter_exp(&mut bytes, count, stride, workspace),
        _ => {
            let filter = crate::load::files::shorten(filter);
            return Err(format!(
                "its filter \"{filter}\" is unknown or does not go with a stride of {stride} bytes"
            ));
        }
    };
    undone.map_err(|error| error.to_string())?;
    Ok(bytes)
}
