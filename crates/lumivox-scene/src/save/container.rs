//! The container of JSON and binary data.

use std::io::Write;

use super::binary::Binary;

/// A GLB file (glTF 2.0, section 4.4): a header, a JSON chunk, a binary chunk.
pub(super) struct Container<'a> {
    json: String,
    binary: Binary<'a>,
    bytes: u32,
}

const HEADER_BYTES: u64 = 12;
const CHUNK_HEADER_BYTES: u64 = 8;

impl<'a> Container<'a> {
    /// The error is the length, if it exceeds the format's 32 bits.
    pub(super) fn new(mut json: String, binary: Binary<'a>) -> Result<Self, u64> {
        // Chunks end at multiples of four; JSON is padded with spaces.
        let padding = json.len().next_multiple_of(4) - json.len();
        json.extend(std::iter::repeat_n(' ', padding));
        let mut bytes = HEADER_BYTES + CHUNK_HEADER_BYTES + json.len() as u64;
        if binary.bytes > 0 {
            bytes += CHUNK_HEADER_BYTES + binary.bytes;
        }
        let bytes = u32::try_from(bytes).map_err(|_| bytes)?;
        Ok(Self { json, binary, bytes })
    }

    /// The length of the file.
    pub(super) fn bytes(&self) -> u32 {
        self.bytes
    }

    pub(super) fn write(&self, out: &mut dyn Write) -> std::io::Result<()> {
        out.write_all(b"glTF")?;
        out.write_all(&2_u32.to_le_bytes())?;
        out.write_all(&self.bytes.to_le_bytes())?;
        out.write_all(&(self.json.len() as u32).to_le_bytes())?;
        out.write_all(b"JSON")?;
        out.write_all(self.json.as_bytes())?;
        if self.binary.bytes > 0 {
            out.write_all(&(self.binary.bytes as u32).to_le_bytes())?;
            out.write_all(b"BIN\0")?;
            self.binary.write(out)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn glb_files_beyond_32_bit_sizes_are_refused() {
        let huge = Binary { bytes: u64::from(u32::MAX) - 27, ..Binary::default() };
        assert_eq!(Container::new(String::new(), huge).err(), Some(u64::from(u32::MAX) + 1));
        let fits = Binary { bytes: u64::from(u32::MAX) - 31, ..Binary::default() };
        assert!(Container::new(String::new(), fits).is_ok());
    }
}
