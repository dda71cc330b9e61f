//! Reading files piece by piece, with progress in bytes.
//!
//! A scan can be larger than half of the memory, so readers only hold the current piece of the
//! file: the peak is about the size of the scene.

use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::Path;

use super::regular::open_regular;
use super::source::key;
use super::{LoadOptions, foreign};
use crate::SceneError;

/// Bytes read at once, and the interval of progress reports: large enough for disks, small for
/// memory.
const PIECE: usize = 1 << 20;

/// A reader that counts its bytes and reports them.
pub(super) struct CountingReader<'s, 'o, R> {
    inner: R,
    done: u64,
    total: u64,
    options: &'s mut LoadOptions<'o>,
}

/// A reader of a file from the disk or another source.
pub(super) type FileReader<'s, 'o> = BufReader<CountingReader<'s, 'o, Box<dyn Read + 'o>>>;

/// Opens a regular file; also returns its length in bytes.
pub(super) fn open<'s, 'o>(
    file: &Path,
    options: &'s mut LoadOptions<'o>,
) -> Result<(FileReader<'s, 'o>, u64), SceneError> {
    let source = options.files;
    let opened = || -> io::Result<(Box<dyn Read + 'o>, u64)> {
        if let Some(source) = source {
            let bytes = source.read(&key(file))?;
            let length = bytes.len() as u64;
            return Ok((Box::new(Cursor::new(bytes)), length));
        }
        let (inner, length) = open_regular(file)?;
        Ok((Box::new(inner), length))
    };
    let (inner, total) =
        opened().map_err(|source| SceneError::Read { file: file.to_owned(), source })?;
    let counting = CountingReader { inner, done: 0, total, options };
    let mut reader = BufReader::with_capacity(PIECE, counting);
    // A read error is ignored here: the actual read reports it.
    if let Some(kind) = reader.fill_buf().ok().and_then(foreign::what) {
        return Err(SceneError::OtherKind { file: file.to_owned(), kind });
    }
    Ok((reader, total))
}

/// Reads a whole file, for formats whose parts refer to each other.
pub(super) fn read_all(file: &Path, options: &mut LoadOptions<'_>) -> Result<Vec<u8>, SceneError> {
    let (mut reader, length) = open(file, options)?;
    let mut bytes = Vec::new();
    let failed = |source| SceneError::Read { file: file.to_owned(), source };
    let length = usize::try_from(length).unwrap_or(usize::MAX);
    bytes.try_reserve_exact(length).map_err(|error| failed(io::Error::other(error)))?;
    reader.read_to_end(&mut bytes).map_err(failed)?;
    Ok(bytes)
}

impl<R: Read> Read for CountingReader<'_, '_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.inner.read(buffer)?;
        // A file may grow while it is read.
        self.done = self.done.saturating_add(count as u64).min(self.total);
        self.options.tell("reading", self.done, self.total);
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::LoadProgress;

    #[test]
    fn progress_grows_up_to_the_length() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("bytes");
        std::fs::write(&path, vec![7; PIECE * 2 + 5]).unwrap();
        let mut told = Vec::new();
        let mut listen = |progress: LoadProgress| told.push(progress);
        let mut options = LoadOptions { progress: Some(&mut listen), ..LoadOptions::default() };
        let (mut reader, length) = open(&path, &mut options).unwrap();
        assert_eq!(io::copy(&mut reader, &mut io::sink()).unwrap(), length);
        drop(reader);
        assert!(told.len() >= 3);
        assert!(told.windows(2).all(|w| w[0].done <= w[1].done));
        let last = told.last().unwrap();
        assert_eq!((last.stage, last.done, last.total), ("reading", length, length));
    }

    #[test]
    fn folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = open(folder.path(), &mut LoadOptions::default()).err().unwrap();
        assert!(matches!(error, SceneError::Read { .. }));
    }
}
