//! Measurements kept in a file, so that long work can continue.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use lumivox_console::Failure;
use lumivox_render::compare::{Cost, LayerFigures};
use lumivox_scene::{read_regular, write_atomically};
use serde::{Deserialize, Serialize};

use super::cases::Case;
use crate::quality::Leak;

/// The name of the file in its folder.
pub const NAME: &str = "measurements.json";

/// One measurement.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Entry {
    pub figures: LayerFigures,
    pub leak: Option<Leak>,
    pub cost: Cost,
}

/// All measurements so far.
#[derive(Debug)]
pub struct Store {
    file: Option<PathBuf>,
    content: Content,
}

/// The content of the file.
#[derive(Debug, Deserialize, Serialize)]
struct Content {
    /// A description of the settings of all measurements.
    settings: String,
    entries: BTreeMap<String, Entry>,
}

impl Store {
    /// Reads the measurements of a folder; `settings` describes those of all measurements.
    ///
    /// # Errors
    /// When the file exists but cannot be read, or was measured with other settings.
    pub fn open(folder: Option<&Path>, settings: String) -> anyhow::Result<Self> {
        let mut content = Content { settings, entries: BTreeMap::new() };
        let Some(folder) = folder else { return Ok(Self { file: None, content }) };
        let file = folder.join(NAME);
        if file.exists() {
            let refuse = |reason: String| {
                Failure::input(format!("{}: {reason}; delete it to measure again", file.display()))
            };
            let text = read_regular(&file).map_err(|e| refuse(e.to_string()))?;
            let kept: Content = serde_json::from_slice(&text).map_err(|e| refuse(e.to_string()))?;
            if kept.settings != content.settings {
                return Err(refuse(format!("it was measured with {}", kept.settings)).into());
            }
            content = kept;
        }
        Ok(Self { file: Some(file), content })
    }

    pub fn get(&self, case: &Case) -> Option<&Entry> {
        self.content.entries.get(&case.key())
    }

    /// Stores a measurement.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn put(&mut self, case: &Case, entry: Entry) -> anyhow::Result<()> {
        self.content.entries.insert(case.key(), entry);
        let Some(file) = &self.file else { return Ok(()) };
        let text = serde_json::to_string_pretty(&self.content)?;
        write_atomically(file, |out| out.write_all(text.as_bytes())).map_err(|error| {
            Failure::output(format!("{}: cannot be written: {error}", file.display())).into()
        })
    }
}
