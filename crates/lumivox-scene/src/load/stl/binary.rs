//! Binary STL: a head of 84 bytes, then 50 bytes a triangle, all little-endian by the format.

use std::io::{ErrorKind, Read};

use glam::Vec3;

use super::{BINARY_HEAD, BINARY_TRIANGLE, Reading, Solid, length_of};
use crate::SceneError;

impl Reading<'_> {
    /// Reads all triangles of the file: some programs write a wrong count, or none.
    pub(super) fn binary(
        &mut self,
        mut reader: impl Read,
        length: u64,
    ) -> Result<Vec<Solid>, SceneError> {
        let mut head = [0; BINARY_HEAD];
        reader.read_exact(&mut head).map_err(|error| self.cut_off(error))?;
        let counted = [head[80], head[81], head[82], head[83]];
        let (little, big) = (u32::from_le_bytes(counted), u32::from_be_bytes(counted));
        let is_big = length_of(little) != length && length_of(big) == length;
        if is_big {
            self.notes.warn(
                "its numbers are big-endian, against the format, and were read so".to_owned(),
            );
        }
        let declared = u64::from(if is_big { big } else { little });
        let bytes = length.saturating_sub(BINARY_HEAD as u64);
        let held = bytes / BINARY_TRIANGLE as u64;
        let rest = bytes % BINARY_TRIANGLE as u64;
        // If triangles fill the file exactly, all are read; otherwise the rest is other data.
        let count = if declared == 0 || rest == 0 { held } else { declared.min(held) };
        if declared != held {
            let cause = if declared > held { "the file was cut off" } else { "it counts too few" };
            self.notes.warn(format!(
                "it declares {declared} triangles but has room for {held}: {count} are shown; if \
                 some are missing, {cause}"
            ));
        } else if rest != 0 {
            self.notes.warn(format!("{rest} bytes behind the last triangle were ignored"));
        }
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        let corner_count = count.saturating_mul(3);
        let part = || format!("its {count} triangles");
        self.budget.spend(part, corner_count, corner_count, false)?;

        let mut corners = Vec::with_capacity(corner_count);
        let mut colored = false;
        let mut triangle = [0; BINARY_TRIANGLE];
        self.is_f32 = true;
        for _ in 0..count {
            reader.read_exact(&mut triangle).map_err(|error| self.cut_off(error))?;
            for corner in triangle[12..48].chunks_exact(12) {
                let float = |at: usize| {
                    let bytes = [corner[at], corner[at + 1], corner[at + 2], corner[at + 3]];
                    if is_big { f32::from_be_bytes(bytes) } else { f32::from_le_bytes(bytes) }
                };
                let place = Vec3::new(float(0), float(4), float(8));
                corners.push(place);
            }
            colored |= triangle[48..] != [0, 0];
        }
        if colored {
            self.notes.warn(
                "the attribute bytes of its triangles (colours, to some programs) were ignored"
                    .to_owned(),
            );
        }
        Ok(vec![Solid { name: String::new(), corners }])
    }

    fn cut_off(&self, error: std::io::Error) -> SceneError {
        if error.kind() == ErrorKind::UnexpectedEof {
            return SceneError::Malformed {
                file: self.file.to_owned(),
                part: "the file".to_owned(),
                reason: "it is neither text that begins with \"solid\" nor a whole binary STL file"
                    .to_owned(),
            };
        }
        SceneError::Read { file: self.file.to_owned(), source: error }
    }
}
