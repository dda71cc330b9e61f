//! Atomic file writes: the whole file or nothing.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Writes a temporary file in the folder of `path` and renames it once all of it is on the disk: a
/// reader finds either the old file or the complete new one.
///
/// # Errors
/// The error of `write` or of the system; the old file is then unchanged, and no temporary file is
/// left.
pub fn write_atomically(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<&File>) -> std::io::Result<()>,
) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut builder = tempfile::Builder::new();
    // Created here, so that it has the permissions of any new file; `tempfile` makes its own
    // private to the user.
    let file =
        builder.prefix(".").suffix(".part").make_in(folder, |name| File::create_new(name))?;
    let mut out = BufWriter::with_capacity(1 << 20, file.as_file());
    write(&mut out)?;
    out.flush()?;
    drop(out);
    file.as_file().sync_all()?;
    file.persist(path)?;
    Ok(())
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
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        write_atomically(&path, |out| out.write_all(b"new")).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert!(write_atomically(&folder.path().join(".."), |_| Ok(())).is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn the_file_has_the_permissions_of_every_new_file() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().unwrap();
        let (written, usual) = (folder.path().join("written"), folder.path().join("usual"));
        write_atomically(&written, |_| Ok(())).unwrap();
        File::create(&usual).unwrap();
        let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&written), mode(&usual));
    }
}
