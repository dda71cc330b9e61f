//! The container, and a file that is there as a whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use super::binary::Binary;

/// A GLB file (glTF 2.0, section 4.4): a header, a chunk of JSON, a chunk of bytes.
pub(super) struct Container<'a> {
    json: String,
    binary: Binary<'a>,
    bytes: u32,
}

const HEADER_BYTES: u64 = 12;
const CHUNK_HEADER_BYTES: u64 = 8;

impl<'a> Container<'a> {
    /// Fails with the length where it does not fit the format's 32 bits.
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

/// Writes a file under a temporary name beside `path`, and renames it when all of it is on the disk.
pub(super) fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let (temporary, file) = create_beside(path)?;
    let mut out = BufWriter::with_capacity(1 << 20, &file);
    let finished = write(&mut out)
        .and_then(|()| out.flush())
        .and_then(|()| file.sync_all())
        .and_then(|()| fs::rename(&temporary, path));
    if finished.is_err() {
        // The first error is the one to tell; a file that cannot be removed either is a detail.
        let _ = fs::remove_file(&temporary);
    }
    finished
}

/// A new file in the folder of `path`, with a name that nobody uses.
fn create_beside(path: &Path) -> std::io::Result<(PathBuf, File)> {
    let Some(name) = path.file_name() else {
        return Err(std::io::Error::other("the path names no file"));
    };
    let process = std::process::id();
    let mut attempt = 0;
    loop {
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{process}-{attempt}.part"));
        let temporary = path.with_file_name(hidden);
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => return Ok((temporary, file)),
            Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists && attempt < 1000 => {
                attempt += 1;
            }
            Err(error) => return Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.glb");
        write_atomically(&path, |out| out.write_all(b"old")).unwrap();
        let fault = write_atomically(&path, |out| {
            out.write_all(b"half of the n")?;
            Err(std::io::Error::other("the disk is full"))
        });
        assert_eq!(fault.unwrap_err().to_string(), "the disk is full");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        write_atomically(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(write_atomically(&folder.path().join(".."), |_| Ok(())).is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn what_does_not_fit_32_bits_is_refused() {
        let huge = Binary { bytes: u64::from(u32::MAX) - 27, ..Binary::default() };
        assert_eq!(Container::new(String::new(), huge).err(), Some(u64::from(u32::MAX) + 1));
        let fits = Binary { bytes: u64::from(u32::MAX) - 31, ..Binary::default() };
        assert!(Container::new(String::new(), fits).is_ok());
    }
}
