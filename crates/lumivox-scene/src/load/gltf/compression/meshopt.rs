//! `EXT_meshopt_compression` and `KHR_meshopt_compression` (Kapoulkine; Khronos): buffer views as
//! streams of the meshoptimizer library, whose own decoder reads them. It is made for streams that
//! nobody trusts.

use std::borrow::Cow;

use gltf::json::buffer::View;
use gltf::json::{Index, Root};
use serde_json::Value;

use super::{Buffers, MESHOPT, Sink, push_buffer};
use crate::SceneError;

/// Bytes that a byte of a stream can become: 256 vertices' byte of the same number need two bits
/// (meshoptimizer, vertex codec version 1), and indices less.
const MOST_BYTES_A_BYTE: u64 = 1024;
/// What even the shortest stream may become.
const FREE_BYTES: u64 = 1 << 20;

/// Decompresses all views that are compressed.
pub(super) fn decompress(
    root: &mut Root,
    buffers: &mut Buffers<'_>,
    sink: &mut Sink<'_>,
) -> Result<(), SceneError> {
    for index in 0..root.buffer_views.len() {
        let Some(stream) = extension(&root.buffer_views[index]) else { continue };
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

fn extension(view: &View) -> Option<Value> {
    let others = &view.extensions.as_ref()?.others;
    MESHOPT.iter().find_map(|name| others.get(*name)).cloned()
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
    let count = count as usize;
    let filter = stream["filter"].as_str().unwrap_or("NONE");
    let decoded = match (stream["mode"].as_str(), stride) {
        (Some("ATTRIBUTES"), _) => attributes(encoded, count, stride as usize)
            .and_then(|bytes| filtered(bytes, stride as usize, filter)),
        // The library takes this for granted, and would write beyond the end.
        (Some("TRIANGLES"), _) if !count.is_multiple_of(3) => {
            Err(format!("its {count} indices are no triangles"))
        }
        (Some("TRIANGLES"), 2) => meshopt::decode_index_buffer::<u16>(encoded, count)
            .map(|indices| indices.into_iter().flat_map(u16::to_le_bytes).collect())
            .map_err(|error| error.to_string()),
        (Some("TRIANGLES"), 4) => meshopt::decode_index_buffer::<u32>(encoded, count)
            .map(|indices| indices.into_iter().flat_map(u32::to_le_bytes).collect())
            .map_err(|error| error.to_string()),
        (Some("INDICES"), 2) => meshopt::decode_index_sequence::<u16>(encoded, count)
            .map(|indices| indices.into_iter().flat_map(u16::to_le_bytes).collect())
            .map_err(|error| error.to_string()),
        (Some("INDICES"), 4) => meshopt::decode_index_sequence::<u32>(encoded, count)
            .map(|indices| indices.into_iter().flat_map(u32::to_le_bytes).collect())
            .map_err(|error| error.to_string()),
        (Some("TRIANGLES" | "INDICES"), _) => Err("indices of a stride of not 2 or 4".to_owned()),
        _ => Err("its mode is unknown".to_owned()),
    };
    decoded.map_err(|reason| sink.malformed(part, reason))
}

/// An element of so many words of four bytes; the library writes elements of the type's size.
#[derive(Clone, Copy)]
struct Words<const N: usize>([u32; N]);

impl<const N: usize> Default for Words<N> {
    fn default() -> Self {
        Self([0; N])
    }
}

fn attributes_of<const N: usize>(encoded: &[u8], count: usize) -> Result<Vec<u8>, String> {
    let elements = meshopt::decode_vertex_buffer::<Words<N>>(encoded, count)
        .map_err(|error| error.to_string())?;
    // The bytes lie in memory as in the file.
    Ok(elements.iter().flat_map(|words| words.0).flat_map(u32::to_ne_bytes).collect())
}

/// Vertices of any stride that the format allows: multiples of 4 up to 256.
fn attributes(encoded: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, String> {
    macro_rules! by_words {
        ($($words:literal)*) => {
            match stride {
                $(stride if stride == $words * 4 => attributes_of::<$words>(encoded, count),)*
                _ => Err(format!("its stride of {stride} bytes is not a multiple of 4 up to 256")),
            }
        };
    }
    by_words!(
        1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32
        33 34 35 36 37 38 39 40 41 42 43 44 45 46 47 48 49 50 51 52 53 54 55 56 57 58 59 60 61
        62 63 64
    )
}

/// Undoes what was done to numbers so that they compress better.
fn filtered(bytes: Vec<u8>, stride: usize, filter: &str) -> Result<Vec<u8>, String> {
    let short = |bytes: [u8; 2]| i16::from_ne_bytes(bytes);
    match (filter, stride) {
        ("NONE", _) => Ok(bytes),
        ("OCTAHEDRAL", 4) => {
            let mut data = quads(&bytes, i8::from_ne_bytes);
            meshopt::decode_filter_oct(&mut data);
            Ok(data.into_iter().flatten().flat_map(i8::to_ne_bytes).collect())
        }
        ("OCTAHEDRAL", 8) => {
            let mut data = quads(&bytes, short);
            meshopt::decode_filter_oct(&mut data);
            Ok(data.into_iter().flatten().flat_map(i16::to_ne_bytes).collect())
        }
        ("QUATERNION", 8) => {
            let mut data = quads(&bytes, short);
            meshopt::decode_filter_quat(&mut data);
            Ok(data.into_iter().flatten().flat_map(i16::to_ne_bytes).collect())
        }
        ("COLOR", 4) => {
            let mut data = quads(&bytes, u8::from_ne_bytes);
            meshopt::decode_filter_color(&mut data);
            Ok(data.into_iter().flatten().collect())
        }
        ("COLOR", 8) => {
            let mut data = quads(&bytes, u16::from_ne_bytes);
            meshopt::decode_filter_color(&mut data);
            Ok(data.into_iter().flatten().flat_map(u16::to_ne_bytes).collect())
        }
        // Strides are multiples of four here.
        ("EXPONENTIAL", _) => {
            let words = bytes.as_chunks::<4>().0;
            let mut data: Vec<[u32; 1]> = words.iter().map(|w| [u32::from_ne_bytes(*w)]).collect();
            meshopt::decode_filter_exp(&mut data);
            Ok(data.into_iter().flatten().flat_map(u32::to_ne_bytes).collect())
        }
        _ => Err(format!(
            "its filter \"{}\" is unknown or does not go with a stride of {stride} bytes",
            crate::load::files::shorten(filter)
        )),
    }
}

/// Elements of four numbers.
fn quads<T, const N: usize>(bytes: &[u8], number: impl Fn([u8; N]) -> T) -> Vec<[T; 4]> {
    let numbers = bytes.as_chunks::<N>().0;
    numbers
        .as_chunks::<4>()
        .0
        .iter()
        .map(|&[a, b, c, d]| [number(a), number(b), number(c), number(d)])
        .collect()
}
