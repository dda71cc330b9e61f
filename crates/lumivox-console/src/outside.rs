//! A console's access to files, and to scenes by name.

use std::fmt::Debug;
use std::pin::Pin;

use wgpu::WasmNotSend;

use crate::{SceneRequest, SceneSource};

/// A file that is being read.
pub type Reading<'a> = Pin<Box<dyn Future<Output = anyhow::Result<Vec<u8>>> + 'a>>;

/// The access of a console to things outside its explorer: the disk, or addresses and downloads in
/// a browser. Errors name the file and the remedy.
pub trait Outside: Debug + WasmNotSend {
    /// The scenes that can be opened by name, given the open one.
    fn scenes(&self, open: Option<&SceneRequest>) -> Vec<String>;

    /// The scene of a name or a path.
    ///
    /// # Errors
    /// When it is known not to exist.
    fn find(&self, name: &str, open: Option<&SceneRequest>) -> anyhow::Result<SceneSource>;

    /// Checks everything that is cheap to check before a scene is opened.
    ///
    /// # Errors
    /// When it is known that the scene cannot be opened.
    fn check(&self, opening: &SceneRequest) -> anyhow::Result<()>;

    /// A file's bytes.
    fn read<'a>(&'a self, file: &'a str) -> Reading<'a>;

    /// Checks that a file can be written, before work is done for it.
    ///
    /// # Errors
    /// When it is known that it cannot be written.
    fn check_output(&self, file: &str) -> anyhow::Result<()>;

    /// Writes a file. An existing file is replaced completely or not at all.
    ///
    /// # Errors
    /// When it cannot be written.
    fn write(&mut self, file: &str, bytes: &[u8]) -> anyhow::Result<()>;
}
