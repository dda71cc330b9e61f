//! The file's only buffer: lists that are not copied until they are written.
//!
//! A scene may hold gigabytes, so the buffer is never assembled in memory: a view borrows its list
//! and converts it to bytes block by block, first to hash it, then to write it. Lists with the same
//! bytes share one view: the mirrored copies that the loader makes of meshes, and meshes that have
//! several materials, take no space in the file.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hasher};
use std::io::Write;
use std::ops::Range;

use glam::{Vec2, Vec3, Vec4};

use crate::model::any_tangent;

/// Data that is converted to bytes, little-endian (glTF 2.0, section 3.6.2.2).
pub(super) enum Source<'a> {
    /// Bytes, unchanged.
    Bytes(Vec<u8>),
    /// Pairs of floats.
    Vec2(&'a [Vec2]),
    /// Triples of floats.
    Vec3(&'a [Vec3]),
    /// Quadruples of floats.
    Vec4(&'a [Vec4]),
    /// Tangents of unit length with a sign, of the unchanged mesh or with its winding reversed.
    Tangents { tangents: &'a [Vec4], normals: &'a [Vec3], turned: bool },
    /// Vertex numbers, unchanged or with each triangle's winding reversed.
    Indices { indices: &'a [u32], short: bool, turned: bool },
    /// Linear RGB.
    Texels(&'a [[f32; 3]]),
}

/// Elements converted at once; a multiple of three keeps triangles whole.
const BLOCK: usize = 3 << 12;

impl Source<'_> {
    /// The number of elements: vectors, numbers, bytes.
    fn elements(&self) -> usize {
        match self {
            Self::Bytes(bytes) => bytes.len(),
            Self::Vec2(list) => list.len(),
            Self::Vec3(list) => list.len(),
            Self::Vec4(list) => list.len(),
            Self::Tangents { tangents, .. } => tangents.len(),
            Self::Indices { indices, .. } => indices.len(),
            Self::Texels(list) => list.len(),
        }
    }

    fn element_bytes(&self) -> usize {
        match self {
            Self::Bytes(_) => 1,
            Self::Indices { short: true, .. } => 2,
            Self::Indices { short: false, .. } => 4,
            Self::Vec2(_) => 8,
            Self::Vec3(_) | Self::Texels(_) => 12,
            Self::Vec4(_) | Self::Tangents { .. } => 16,
        }
    }

    fn bytes(&self) -> u64 {
        self.elements() as u64 * self.element_bytes() as u64
    }

    /// Appends the bytes of some elements.
    fn append(&self, range: Range<usize>, out: &mut Vec<u8>) {
        let mut floats = |values: &[f32]| out.extend(values.iter().flat_map(|v| v.to_le_bytes()));
        match self {
            Self::Bytes(bytes) => out.extend(&bytes[range]),
            Self::Vec2(list) => list[range].iter().for_each(|v| floats(v.as_ref())),
            Self::Vec3(list) => list[range].iter().for_each(|v| floats(v.as_ref())),
            Self::Vec4(list) => list[range].iter().for_each(|v| floats(v.as_ref())),
            Self::Texels(list) => list[range].iter().for_each(|v| floats(v)),
            Self::Tangents { tangents, normals, turned } => {
                for i in range {
                    floats(tangent(tangents[i], normals[i], *turned).as_ref());
                }
            }
            Self::Indices { indices, short, turned } => {
                for triangle in indices[range].chunks(3) {
                    let order = if *turned && triangle.len() == 3 { [0, 2, 1] } else { [0, 1, 2] };
                    for &corner in &order[..triangle.len()] {
                        let bytes = triangle[corner].to_le_bytes();
                        out.extend(&bytes[..if *short { 2 } else { 4 }]);
                    }
                }
            }
        }
    }

    /// Calls `each` with all bytes, a block at a time, until it fails.
    fn blocks<E>(&self, mut each: impl FnMut(&[u8]) -> Result<(), E>) -> Result<(), E> {
        let mut block = Vec::with_capacity(BLOCK * self.element_bytes());
        let count = self.elements();
        for begin in (0..count).step_by(BLOCK) {
            block.clear();
            self.append(begin..count.min(begin + BLOCK), &mut block);
            each(&block)?;
        }
        Ok(())
    }

    fn hash(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        hasher.write_u64(self.bytes());
        let Ok(()) = self.blocks(|block| -> Result<(), std::convert::Infallible> {
            hasher.write(block);
            Ok(())
        });
        hasher.finish()
    }

    fn same_bytes(&self, other: &Self) -> bool {
        if self.bytes() != other.bytes() || self.element_bytes() != other.element_bytes() {
            return false;
        }
        let mut begin = 0;
        let mut theirs = Vec::new();
        let compared = self.blocks(|ours| {
            theirs.clear();
            let end = other.elements().min(begin + BLOCK);
            other.append(begin..end, &mut theirs);
            begin = end;
            if ours == theirs { Ok(()) } else { Err(()) }
        });
        compared.is_ok()
    }
}

/// A tangent as glTF requires it, not zero, with a sign of 1 or -1. A tangent without direction
/// becomes the loader's default.
pub(super) fn tangent(tangent: Vec4, normal: Vec3, turned: bool) -> Vec4 {
    let sign = if (tangent.w < 0.0) == turned { 1.0 } else { -1.0 };
    let direction = tangent.truncate();
    if direction == Vec3::ZERO {
        return any_tangent(normal).truncate().extend(sign);
    }
    direction.extend(sign)
}

/// The target of a view (glTF 2.0, section 5.11.5).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Target {
    /// No vertex data, such as an image.
    None,
    /// Vertex attributes.
    Vertices,
    /// Vertex numbers.
    Indices,
}

/// A range of the buffer.
pub(super) struct BufferView<'a> {
    source: Source<'a>,
    pub(super) target: Target,
    /// The start of the range in bytes, a multiple of four.
    pub(super) offset: u64,
    /// The length in bytes, without padding.
    pub(super) bytes: u64,
}

/// The buffer.
#[derive(Default)]
pub(super) struct Binary<'a> {
    pub(super) views: Vec<BufferView<'a>>,
    pub(super) known: HashMap<(u64, Target), Vec<usize>>,
    /// The length of all views, a multiple of four.
    pub(super) bytes: u64,
}

impl<'a> Binary<'a> {
    /// The view of the bytes of `source`; new unless an equal view exists.
    pub(super) fn view(&mut self, source: Source<'a>, target: Target) -> usize {
        let twins = self.known.entry((source.hash(), target)).or_default();
        if let Some(&twin) = twins.iter().find(|&&i| self.views[i].source.same_bytes(&source)) {
            return twin;
        }
        twins.push(self.views.len());
        let bytes = source.bytes();
        self.views.push(BufferView { source, target, offset: self.bytes, bytes });
        self.bytes += bytes.next_multiple_of(4);
        self.views.len() - 1
    }

    pub(super) fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        for view in &self.views {
            view.source.blocks(|block| out.write_all(block))?;
            let padding = view.bytes.next_multiple_of(4) - view.bytes;
            out.write_all(&[0; 3][..padding as usize])?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(binary: &Binary<'_>) -> Vec<u8> {
        let mut bytes = Vec::new();
        binary.write(&mut bytes).unwrap();
        assert_eq!(bytes.len() as u64, binary.bytes);
        bytes
    }

    #[test]
    fn views_are_aligned_and_padded() {
        let pair = [Vec2::new(1.0, -2.0)];
        let mut binary = Binary::default();
        assert_eq!(binary.view(Source::Bytes(vec![1, 2, 3, 4, 5]), Target::None), 0);
        assert_eq!(binary.view(Source::Vec2(&pair), Target::Vertices), 1);
        assert_eq!(binary.views[1].offset, 8);
        let bytes = written(&binary);
        assert_eq!(bytes[..8], [1, 2, 3, 4, 5, 0, 0, 0]);
        assert_eq!(bytes[8..], [0, 0, 0x80, 0x3f, 0, 0, 0, 0xc0]);
    }

    #[test]
    fn equal_bytes_are_stored_once() {
        let straight = [0, 1, 2, 2, 1, 3];
        let turned = [0, 2, 1, 2, 3, 1];
        let mut binary = Binary::default();
        let indices = |indices, turned| Source::Indices { indices, short: true, turned };
        let first = binary.view(indices(&straight, false), Target::Indices);
        assert_eq!(binary.view(indices(&turned, true), Target::Indices), first);
        assert_ne!(binary.view(indices(&turned, false), Target::Indices), first);
        // A view has only one target.
        assert_ne!(binary.view(indices(&straight, false), Target::Vertices), first);
    }

    #[test]
    fn turning_long_index_lists_keeps_triangles_intact() {
        let long: Vec<u32> = (0..3 * 20_001).collect();
        let mut binary = Binary::default();
        binary
            .view(Source::Indices { indices: &long, short: false, turned: true }, Target::Indices);
        let words: Vec<u32> = written(&binary)
            .chunks_exact(4)
            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
            .collect();
        for (triangle, written) in long.chunks_exact(3).zip(words.chunks_exact(3)) {
            assert_eq!(written, [triangle[0], triangle[2], triangle[1]]);
        }
    }

    #[test]
    fn tangents_have_a_direction_and_a_sign() {
        assert_eq!(tangent(Vec4::new(1.0, 0.0, 0.0, -0.5), Vec3::Z, false).w, -1.0);
        assert_eq!(tangent(Vec4::new(1.0, 0.0, 0.0, -1.0), Vec3::Z, true).w, 1.0);
        assert_eq!(tangent(Vec4::X + Vec4::W, Vec3::Z, true).w, -1.0);
        assert_ne!(tangent(Vec4::W, Vec3::Z, false).truncate(), Vec3::ZERO);
    }
}
