//! Numbers from buffers, with every bound checked before anything is read or allocated.

use gltf::accessor::{DataType, Dimensions};
use gltf::json;
use gltf::json::validation::Checked;

use super::Loader;
use crate::SceneError;

impl<'a> Loader<'a> {
    /// Reads vectors of `N` floats. Integers are normalised to 0..1 or -1..1 if the accessor says
    /// so (glTF 2.0, section 3.11).
    pub(super) fn read_floats<const N: usize>(
        &self,
        accessor: usize,
        what: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let layout = self.layout(accessor, what)?;
        self.read_vectors(accessor, what, &layout)
    }

    /// As [`Self::read_floats`], but always normalises integers: for values that can only be
    /// shares, such as colours.
    pub(super) fn read_shares<const N: usize>(
        &self,
        accessor: usize,
        what: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let layout = Layout { normalized: true, ..self.layout(accessor, what)? };
        self.read_vectors(accessor, what, &layout)
    }

    fn read_vectors<const N: usize>(
        &self,
        accessor: usize,
        what: &str,
        layout: &Layout,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        if layout.components != N {
            return Err(self.bad_accessor(
                accessor,
                what,
                &format!("it has {} components instead of {N}", layout.components),
            ));
        }
        let convert = |bytes: &[u8]| -> [f32; N] {
            let size = layout.component_size;
            std::array::from_fn(|i| layout.float(&bytes[i * size..(i + 1) * size]))
        };
        let mut values = match self.slice(accessor, what, layout)? {
            Some(bytes) => {
                bytes.chunks(layout.stride).take(layout.count).map(convert).collect::<Vec<_>>()
            }
            None => vec![[0.0; N]; layout.count],
        };
        self.apply_sparse(accessor, what, layout, |i, bytes| values[i] = convert(bytes))?;
        Ok(values)
    }

    /// Reads vertex numbers of 8, 16 or 32 bits.
    pub(super) fn read_indices(&self, accessor: usize) -> Result<Vec<u32>, SceneError> {
        let what = "indices";
        let layout = self.layout(accessor, what)?;
        let unsigned = matches!(layout.kind, DataType::U8 | DataType::U16 | DataType::U32);
        if layout.components != 1 || !unsigned {
            return Err(self.bad_accessor(accessor, what, "they are not unsigned scalars"));
        }
        let convert = |bytes: &[u8]| unsigned_number(&bytes[..layout.component_size]);
        let mut values = match self.slice(accessor, what, &layout)? {
            Some(bytes) => {
                bytes.chunks(layout.stride).take(layout.count).map(convert).collect::<Vec<_>>()
            }
            None => vec![0; layout.count],
        };
        self.apply_sparse(accessor, what, &layout, |i, bytes| values[i] = convert(bytes))?;
        Ok(values)
    }

    /// Checks that the bytes of an accessor exist, before memory is allocated for them.
    pub(super) fn check_room(&self, accessor: usize, what: &str) -> Result<(), SceneError> {
        let layout = self.layout(accessor, what)?;
        self.slice(accessor, what, &layout).map(drop)
    }

    fn bad_accessor(&self, accessor: usize, what: &str, reason: &str) -> SceneError {
        self.malformed(&format!("accessor {accessor} ({what})"), reason)
    }

    fn layout(&self, accessor: usize, what: &str) -> Result<Layout, SceneError> {
        let Some(json) = self.root().accessors.get(accessor) else {
            return Err(self.bad_accessor(accessor, what, "it does not exist"));
        };
        let (Checked::Valid(kind), Checked::Valid(dimensions)) = (json.component_type, json.type_)
        else {
            return Err(self.bad_accessor(accessor, what, "its type is unknown"));
        };
        let components = match dimensions {
            Dimensions::Scalar => 1,
            Dimensions::Vec2 => 2,
            Dimensions::Vec3 => 3,
            Dimensions::Vec4 => 4,
            // A 4 x 4 matrix never has padding between columns; smaller matrices may.
            Dimensions::Mat4 => 16,
            _ => return Err(self.bad_accessor(accessor, what, "it holds small matrices")),
        };
        let component_size = kind.0.size();
        let element = components * component_size;
        let stride = json
            .buffer_view
            .and_then(|view| self.root().buffer_views.get(view.value()))
            .and_then(|view| view.byte_stride)
            // A stride of zero counts as missing.
            .filter(|stride| stride.0 > 0)
            .map_or(element, |stride| stride.0);
        if stride < element {
            let reason = format!("its stride of {stride} bytes is below its {element} bytes");
            return Err(self.bad_accessor(accessor, what, &reason));
        }
        let count = usize::try_from(json.count.0)
            .map_err(|_| self.bad_accessor(accessor, what, "its count is larger than memory"))?;
        Ok(Layout {
            kind: kind.0,
            normalized: json.normalized,
            components,
            component_size,
            element,
            stride,
            count,
        })
    }

    /// The accessor's bytes, from its first element to the end of its last; `None` for an accessor
    /// without a buffer view, which is all zeros.
    fn slice(
        &self,
        accessor: usize,
        what: &str,
        layout: &Layout,
    ) -> Result<Option<&'a [u8]>, SceneError> {
        let json = &self.root().accessors[accessor];
        let Some(view) = json.buffer_view else {
            // Zeros take no space in the file, so their number is limited by the file's bytes.
            let available: usize = self.buffers.iter().map(|buffer| buffer.len()).sum();
            if layout.count > available {
                let reason = format!("it claims {} elements without data", layout.count);
                return Err(self.bad_accessor(accessor, what, &reason));
            }
            return Ok(None);
        };
        let offset = json.byte_offset.map_or(0, |offset| offset.0);
        let view = self.view(view.value())?;
        let length = match layout.count {
            0 => Some(0),
            count => {
                (count - 1).checked_mul(layout.stride).and_then(|l| l.checked_add(layout.element))
            }
        };
        let bytes = length.and_then(|length| sub_slice(view, offset, length as u64));
        match bytes {
            Some(bytes) => Ok(Some(bytes)),
            None => Err(self.bad_accessor(
                accessor,
                what,
                &format!(
                    "{} elements at byte {offset} do not fit in its view of {} bytes",
                    layout.count,
                    view.len()
                ),
            )),
        }
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize) -> Result<&'a [u8], SceneError> {
        let part = || format!("buffer view {index}");
        let Some(view) = self.root().buffer_views.get(index) else {
            return Err(self.malformed(&part(), "it does not exist"));
        };
        let Some(buffer) = self.buffers.get(view.buffer.value()) else {
            return Err(self.malformed(&part(), "its buffer does not exist"));
        };
        let offset = view.byte_offset.map_or(0, |offset| offset.0);
        sub_slice(buffer, offset, view.byte_length.0).ok_or_else(|| {
            let reason = format!(
                "{} bytes at byte {offset} do not fit in its buffer of {} bytes",
                view.byte_length.0,
                buffer.len()
            );
            self.malformed(&part(), &reason)
        })
    }

    /// Replaces the elements of a sparse accessor (glTF 2.0, section 3.6.2.3).
    fn apply_sparse(
        &self,
        accessor: usize,
        what: &str,
        layout: &Layout,
        mut set: impl FnMut(usize, &[u8]),
    ) -> Result<(), SceneError> {
        let Some(sparse) = &self.root().accessors[accessor].sparse else { return Ok(()) };
        let bad = |reason: &str| self.bad_accessor(accessor, &format!("sparse {what}"), reason);
        let Checked::Valid(json::accessor::IndexComponentType(kind)) =
            sparse.indices.component_type
        else {
            return Err(bad("the type of its indices is unknown"));
        };
        let size = kind.size();
        let values_at = sparse.values.byte_offset.0;
        let bytes = |view: usize, offset: u64, each: usize| -> Result<&'a [u8], SceneError> {
            let length = sparse.count.0.checked_mul(each as u64);
            length
                .and_then(|length| self.view(view).ok().and_then(|v| sub_slice(v, offset, length)))
                .ok_or_else(|| bad("its elements do not fit in their buffer view"))
        };
        let indices =
            bytes(sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0, size)?;
        let values = bytes(sparse.values.buffer_view.value(), values_at, layout.element)?;
        for (index, value) in indices.chunks(size).zip(values.chunks(layout.element)) {
            let index = unsigned_number(index) as usize;
            if index >= layout.count {
                return Err(bad("it replaces an element beyond the last"));
            }
            set(index, value);
        }
        Ok(())
    }
}

/// The memory layout of an accessor's elements.
struct Layout {
    kind: DataType,
    normalized: bool,
    components: usize,
    component_size: usize,
    /// Bytes of one element.
    element: usize,
    /// Bytes from one element to the next.
    stride: usize,
    count: usize,
}

impl Layout {
    fn float(&self, bytes: &[u8]) -> f32 {
        let (value, largest) = match (self.kind, bytes) {
            (DataType::F32, &[a, b, c, d]) => return f32::from_le_bytes([a, b, c, d]),
            (DataType::I8, &[a]) => (f32::from(a.cast_signed()), 127.0),
            (DataType::I16, &[a, b]) => (f32::from(i16::from_le_bytes([a, b])), 32_767.0),
            (DataType::U8, &[a]) => (f32::from(a), 255.0),
            (DataType::U16, &[a, b]) => (f32::from(u16::from_le_bytes([a, b])), 65_535.0),
            (_, bytes) => (unsigned_number(bytes) as f32, u32::MAX as f32),
        };
        // Limits the lowest signed value, which would be a little below -1.
        if self.normalized { (value / largest).max(-1.0) } else { value }
    }
}

/// A little-endian number of up to four bytes.
fn unsigned_number(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |number, &byte| number << 8 | u32::from(byte))
}

/// `bytes[offset..offset + length]`; `None` if that is out of bounds.
pub(super) fn sub_slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let begin = usize::try_from(offset).ok()?;
    let end = begin.checked_add(usize::try_from(length).ok()?)?;
    bytes.get(begin..end)
}
