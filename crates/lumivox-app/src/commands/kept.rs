//! Measurements saved in a folder, so that a stopped run can continue.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use lumivox_console::Failure;
use lumivox_scene::read_regular;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::args::output;
use crate::lock::Lock;

/// The name of the file in its folder.
const NAME: &str = "measurements.json";

/// All measurements so far, each under its key.
#[derive(Debug)]
pub struct Kept<T> {
    file: Option<PathBuf>,
    content: Content<T>,
    _lock: Option<Lock>,
}

/// The content of the file.
#[derive(Debug, Deserialize, Serialize)]
struct Content<T> {
    /// A description of the settings of all measurements.
    settings: String,
    entries: BTreeMap<String, T>,
}

impl<T: Serialize + DeserializeOwned> Kept<T> {
    /// Reads the measurements of a folder, which is created if it is missing; without a folder,
    /// none are saved. `settings` describes the settings of all measurements.
    ///
    /// # Errors
    /// When the folder cannot be made, another process measures into it, or its file cannot be read
    /// or was measured with other settings.
    pub fn open(folder: Option<&Path>, settings: String) -> anyhow::Result<Self> {
        let mut content = Content { settings, entries: BTreeMap::new() };
        let Some(folder) = folder else { return Ok(Self { file: None, content, _lock: None }) };
        output::make_folder(folder)?;
        let file = folder.join(NAME);
        let lock = Lock::take(&file, "measures into it")?;
        if file.exists() {
            let refuse = |reason: String| {
                Failure::input(format!("{}: {reason}; delete it to measure again", file.display()))
            };
            let text = read_regular(&file).map_err(|e| refuse(e.to_string()))?;
            let kept: Content<T> =
                serde_json::from_slice(&text).map_err(|e| refuse(e.to_string()))?;
            if kept.settings != content.settings {
                return Err(refuse(format!("it was measured with {}", kept.settings)).into());
            }
            content = kept;
        }
        Ok(Self { file: Some(file), content, _lock: Some(lock) })
    }

    /// The measurement of a key, if it was made.
    pub fn get(&self, key: &str) -> Option<&T> {
        self.content.entries.get(key)
    }

    /// Stores a measurement.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn put(&mut self, key: String, entry: T) -> anyhow::Result<()> {
        self.content.entries.insert(key, entry);
        let Some(file) = &self.file else { return Ok(()) };
        let text = serde_json::to_string_pretty(&self.content)?;
        output::write(file, text.as_bytes())
    }
}
