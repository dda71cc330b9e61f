//! Things outside of a console: files, and scenes by name.

use std::fmt::Debug;
use std::pin::Pin;

use wgpu::WasmNotSend;

use crate::{SceneRequest, SceneSource};

/// A file that is being read.
pub type Reading<'a> = Pin<Box<dyn Future<Output = anyhow::Result<Vec<u8>>> + 'a>>;

/// The access of a console to things outside of its explorer: to a disk, or to those of a browser.
/// Errors name the file and the remedy.
pub trait Outside: Debug + WasmNotSend {
    /// The scenes that are found by name, where one is open or none.
    fn scenes(&self, open: Option<&SceneRequest>) -> Vec<String>;

    /// The scene of a name or a path.
    ///
    /// # Errors
    /// When it is known that there is none.
    fn find(&self, name: &str, open: Option<&SceneRequest>) -> anyhow::Result<SceneSource>;

    /// Checks everything that is cheap to check before a scene is opened.
    ///
    /// # Errors
    /// When it is known that it cannot be.
    fn check(&self, opening: &SceneRequest) -> anyhow::Result<()>;

    /// A file's bytes.
    fn read<'a>(&'a self, file: &'a str) -> Reading<'a>;

    /// Checks that a file can be written, before work is done for it.
    ///
    /// # Errors
    /// When it is known that it cannot be.
    fn check_output(&self, file: &str) -> anyhow::Result<()>;

    /// Writes a file; one of that name is replaced, never half.
    ///
    /// # Errors
    /// When it cannot be written.
    fn write(&mut self, file: &str, bytes: &[u8]) -> anyhow::Result<()>;
}
