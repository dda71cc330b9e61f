//! Decompression of geometry into plain buffers, before anything reads it.
//!
//! Each decoder appends a buffer to the document and points views or accessors to it, so the rest
//! of the loader does not handle compression. The sizes that a stream claims are checked against
//! its length and against the budget before memory is allocated.

mod draco;
mod meshopt;

use std::borrow::Cow;
use std::path::Path;

use gltf::json::buffer::Buffer;
use gltf::json::{Index, Root};

use crate::SceneError;
use crate::load::geometry::{GeometryBudget, size_text};

/// The two names of the extension for compressed buffer views; `KHR_meshopt_compression`, the newer
/// one, may use more (Khronos).
const MESHOPT: [&str; 2] = ["KHR_meshopt_compression", "EXT_meshopt_compression"];

/// The bytes of a document's buffers; those of a GLB's own buffer are a slice of the file.
pub(super) type Buffers<'a> = Vec<Cow<'a, [u8]>>;

/// Decompresses all compressed buffers and accessors; `budget` is the memory that they may take, in
/// bytes.
pub(super) fn decompress(
    file: &Path,
    root: &mut Root,
    buffers: &mut Buffers<'_>,
    budget: u64,
) -> Result<(), SceneError> {
    let mut sink = Sink { file, budget: GeometryBudget::new(file, budget) };
    meshopt::decompress(root, buffers, &mut sink)?;
    draco::decompress(root, buffers, &mut sink)
}

/// Whether a buffer is never read, since all of its views are compressed and stored elsewhere. Not
/// all programs write the extension's flag for such a fallback buffer.
pub(super) fn is_stand_in(root: &Root, buffer: usize) -> bool {
    root.buffer_views.iter().all(|view| match meshopt::extension(view) {
        Some(stream) => stream["buffer"].as_u64() != Some(buffer as u64),
        None => view.buffer.value() != buffer,
    })
}

/// The limits of decompression, and the reporting of faults.
struct Sink<'a> {
    file: &'a Path,
    budget: GeometryBudget<'a>,
}

impl Sink<'_> {
    fn malformed(&self, part: &str, reason: impl Into<String>) -> SceneError {
        SceneError::Malformed {
            file: self.file.to_owned(),
            part: part.to_owned(),
            reason: reason.into(),
        }
    }

    /// Charges bytes to the budget.
    fn spend(&mut self, part: &str, bytes: u64) -> Result<(), SceneError> {
        self.budget.take(|| part.trim_end_matches(',').to_owned(), bytes)
    }

    /// The error of a decoder that stopped at its limit.
    fn too_large(&self, part: &str) -> SceneError {
        SceneError::TooLarge {
            file: self.file.to_owned(),
            part: part.trim_end_matches(',').to_owned(),
            needed: "more".to_owned(),
            budget: size_text(self.budget.left()),
        }
    }
}

/// Appends bytes to the document as a new buffer.
fn push_buffer(root: &mut Root, buffers: &mut Buffers<'_>, bytes: Vec<u8>) -> Index<Buffer> {
    root.buffers.push(Buffer {
        byte_length: (bytes.len() as u64).into(),
        name: None,
        uri: None,
        extensions: None,
        extras: gltf::json::Extras::default(),
    });
    buffers.push(bytes.into());
    Index::new(root.buffers.len() as u32 - 1)
}
