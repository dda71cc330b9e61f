//! Locks for files on which only one process may work at a time.
//!
//! The lock is the operating system's, on a hidden file beside the locked one. The system releases
//! it when the process ends, even if it is killed; the hidden file then remains, unlocked.

use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use lumivox_console::Failure;

/// A lock that is held until it is dropped.
#[derive(Debug)]
pub struct Lock {
    path: PathBuf,
    file: File,
}

impl Lock {
    /// Takes the lock of `path`. `work` completes the error message "another process ...", as in
    /// "renders this sequence".
    ///
    /// # Errors
    /// A [`Failure`] of output when another process has the lock, or its file cannot be made.
    pub fn take(path: &Path, work: &str) -> Result<Self, Failure> {
        let hidden = hidden(path);
        let fail = |error: &io::Error| {
            Failure::output(format!(
                "{}: the lock file {} cannot be made: {error}; check the folder and its permissions",
                path.display(),
                hidden.display()
            ))
        };
        loop {
            let opened = OpenOptions::new().write(true).create(true).truncate(false).open(&hidden);
            let file = opened.map_err(|error| fail(&error))?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => {
                    return Err(Failure::output(format!(
                        "{}: another process {work}; wait until it has ended, or choose another \
                         place",
                        path.display()
                    )));
                }
                // Some network file systems have no locks.
                Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {
                    tracing::warn!(
                        "{}: files cannot be locked there ({error}); make sure that no other process \
                         {work}",
                        path.display()
                    );
                }
                Err(TryLockError::Error(error)) => return Err(fail(&error)),
            }
            // The previous owner may have removed the file after it was opened here; a lock on it
            // is then worthless.
            if is_at(&file, &hidden) {
                return Ok(Self { path: hidden, file });
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // Remove the file while it is locked: afterwards it could be another process's. A file left
        // behind does no harm.
        let _ = std::fs::remove_file(&self.path);
        let _ = self.file.unlock();
    }
}

/// The lock's file: `.NAME.lock` beside a file.
fn hidden(path: &Path) -> PathBuf {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(".lock");
    path.with_file_name(name)
}

/// Whether the open file is still the one at the path.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    let place = |metadata: std::fs::Metadata| (metadata.dev(), metadata.ino());
    match (file.metadata(), std::fs::metadata(path)) {
        (Ok(open), Ok(there)) => place(open) == place(there),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lock_is_exclusive_and_removes_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("index.json");
        let first = Lock::take(&path, "renders this sequence").unwrap();
        let error = Lock::take(&path, "renders this sequence").unwrap_err().to_string();
        assert!(error.contains("index.json: another process renders this sequence"), "{error}");
        // Other files in the same folder have locks of their own.
        drop(Lock::take(&folder.path().join("b_index.json"), "renders").unwrap());
        drop(first);
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
        drop(Lock::take(&path, "renders").unwrap());
    }

    #[test]
    fn a_stale_lock_file_does_not_block() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("index.json");
        std::fs::write(folder.path().join(".index.json.lock"), "").unwrap();
        drop(Lock::take(&path, "renders").unwrap());
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }

    #[test]
    fn only_one_thread_holds_the_lock_at_a_time() {
        use std::sync::atomic::{AtomicU32, Ordering};
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("sums");
        let (holders, taken) = (AtomicU32::new(0), AtomicU32::new(0));
        std::thread::scope(|scope| {
            for _ in 0..8 {
                scope.spawn(|| {
                    for _ in 0..200 {
                        let Ok(lock) = Lock::take(&path, "traces") else { continue };
                        assert_eq!(holders.fetch_add(1, Ordering::SeqCst), 0);
                        taken.fetch_add(1, Ordering::SeqCst);
                        holders.fetch_sub(1, Ordering::SeqCst);
                        drop(lock);
                    }
                });
            }
        });
        assert!(taken.into_inner() > 0);
    }
}
