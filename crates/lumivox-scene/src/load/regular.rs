//! Regular files. Reading a pipe, a socket or a device might block or never end.

use std::fs::{File, FileType, Metadata};
use std::io::{self, Read as _};
use std::path::Path;

/// Opens a regular file; also returns its length in bytes.
pub(super) fn open_regular(path: &Path) -> io::Result<(File, u64)> {
    // The kind is checked before opening, because opening a pipe blocks.
    let metadata = check_regular(path)?;
    Ok((File::open(path)?, metadata.len()))
}

/// Reads a regular file.
///
/// # Errors
/// When it is a folder, a pipe, a socket or a device, which the error names, or when the system
/// reports an error.
pub fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    let (mut file, length) = open_regular(path)?;
    let mut bytes = Vec::new();
    bytes
        .try_reserve_exact(usize::try_from(length).unwrap_or(usize::MAX))
        .map_err(io::Error::other)?;
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Checks, without opening it, that a path is a regular file, and returns the system's metadata.
///
/// # Errors
/// As [`read_regular`].
pub fn check_regular(path: &Path) -> io::Result<Metadata> {
    let metadata = std::fs::metadata(path)?;
    if metadata.is_file() {
        return Ok(metadata);
    }
    Err(io::Error::other(format!("it is {}, not a file", kind(metadata.file_type()))))
}

fn kind(file: FileType) -> &'static str {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt as _;
        if file.is_fifo() {
            return "a pipe";
        }
        if file.is_socket() {
            return "a socket";
        }
        if file.is_char_device() || file.is_block_device() {
            return "a device";
        }
    }
    if file.is_dir() { "a folder" } else { "something else" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_and_folders_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a");
        std::fs::write(&file, "content").unwrap();
        assert_eq!(read_regular(&file).unwrap(), b"content");
        assert_eq!(check_regular(&file).unwrap().len(), 7);
        let error = read_regular(folder.path()).unwrap_err().to_string();
        assert_eq!(error, "it is a folder, not a file");
        assert_eq!(
            read_regular(&folder.path().join("b")).unwrap_err().kind(),
            io::ErrorKind::NotFound
        );
    }

    /// The pipe has no writer: opening it would block for ever.
    #[cfg(unix)]
    #[test]
    fn pipes_and_sockets_are_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&pipe).status().unwrap();
        assert!(made.success());
        let socket = folder.path().join("socket");
        let _socket = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        for (path, expected) in [
            (pipe.as_path(), "it is a pipe, not a file"),
            (&socket, "it is a socket, not a file"),
            (Path::new("/dev/zero"), "it is a device, not a file"),
        ] {
            assert_eq!(read_regular(path).unwrap_err().to_string(), expected);
        }
    }
}
