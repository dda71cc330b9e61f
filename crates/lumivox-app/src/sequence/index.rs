//! The index of a sequence: its finished pictures, their content, and their settings.
//!
//! The index is written atomically after each picture. Whenever the program is stopped, the index
//! and the files that it lists are complete, and the same command resumes. Different settings are
//! an error: their pictures would not match the existing ones.

use std::io::Write as _;
use std::ops::Range;
use std::path::Path;

use lumivox_console::Failure;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use lumivox_scene::{read_regular, write_atomically};

use super::FrameFiles;

/// The index of a sequence.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Index {
    /// The number of pictures of the whole sequence.
    pub frame_count: u32,
    /// The settings of all pictures. Equal settings give equal pictures.
    pub settings: Map<String, Value>,
    /// The common exposure of all pictures in stops, if there is one.
    pub exposure: Option<f32>,
    /// The GPU that rendered the last picture.
    pub adapter: String,
    /// The finished pictures, in order.
    pub frames: Vec<Frame>,
}

/// A picture.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Frame {
    /// Its number in the sequence, from 0.
    pub number: u32,
    /// Its file, beside the index.
    pub file: String,
    /// The size of the file in bytes.
    pub bytes: u64,
    /// The time of the scene, s.
    pub time_s: f64,
    /// The camera.
    pub camera: Value,
    /// The exposure in stops; `None` if the view has none.
    pub exposure: Option<f32>,
    /// The seconds it took to render.
    pub seconds: f64,
}

/// The work that is left.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// The index to continue.
    pub index: Index,
    /// The numbers of the missing pictures, in order.
    pub missing: Vec<u32>,
}

impl Index {
    /// An index without pictures.
    pub fn new(frame_count: u32, settings: Map<String, Value>) -> Self {
        // Round-trip through JSON: the last digit of a number may change.
        let text = Value::Object(settings).to_string();
        let settings = serde_json::from_str(&text).unwrap_or_default();
        Self { frame_count, settings, exposure: None, adapter: String::new(), frames: Vec::new() }
    }

    /// Reads an existing index, and determines which of the pictures `numbers` are missing.
    ///
    /// # Errors
    /// A [`Failure`] of input when the existing index has other settings; one of output when it
    /// cannot be read, or when pictures exist without an index. `--restart` ignores the index.
    pub fn start(
        mut self,
        files: &FrameFiles,
        numbers: Range<u32>,
        is_restart: bool,
    ) -> anyhow::Result<Start> {
        let file = files.index();
        let found = read(&file);
        if is_restart {
            if let Ok(Some(old)) = found {
                old.remove_pictures(files);
            }
            return Ok(Start { index: self, missing: numbers.collect() });
        }
        let Some(old) = found? else {
            let in_the_way = numbers.clone().map(|n| files.path(n)).find(|p| p.exists());
            if let Some(picture) = in_the_way {
                return Err(Failure::output(format!(
                    "{}: is there already, but there is no index {} that says how it was rendered; \
                     choose another place, or replace it with --restart",
                    picture.display(),
                    file.display()
                ))
                .into());
            }
            return Ok(Start { index: self, missing: numbers.collect() });
        };
        if let Some(difference) = difference(&old.settings, &self.settings) {
            return Err(Failure::input(format!(
                "{}: the pictures there were rendered with other settings ({difference}); use the \
                 same, choose another place, or render all again with --restart",
                file.display()
            ))
            .into());
        }
        self.exposure = old.exposure;
        self.adapter = old.adapter;
        self.frames = old.frames;
        self.frames.retain(|frame| {
            let is_ours = numbers.contains(&frame.number) && frame.file == files.name(frame.number);
            let size = std::fs::metadata(files.path(frame.number)).map(|data| data.len());
            is_ours && size.is_ok_and(|size| size == frame.bytes)
        });
        self.frames.sort_by_key(|frame| frame.number);
        self.frames.dedup_by_key(|frame| frame.number);
        let is_there =
            |number: &u32| self.frames.binary_search_by_key(number, |frame| frame.number).is_ok();
        let missing = numbers.filter(|number| !is_there(number)).collect();
        Ok(Start { index: self, missing })
    }

    /// Adds a picture and writes the index.
    ///
    /// # Errors
    /// A [`Failure`] of output.
    pub fn add(&mut self, frame: Frame, files: &FrameFiles) -> anyhow::Result<()> {
        let place = self.frames.partition_point(|other| other.number < frame.number);
        self.frames.insert(place, frame);
        self.write(files)
    }

    /// Writes the index. It must exist before the first picture, so that a run can resume whenever
    /// it was stopped.
    ///
    /// # Errors
    /// A [`Failure`] of output.
    pub fn write(&self, files: &FrameFiles) -> anyhow::Result<()> {
        let text = format!("{}\n", serde_json::to_string_pretty(self)?);
        let file = files.index();
        write_atomically(&file, |out| out.write_all(text.as_bytes())).map_err(|error| {
            let file = file.display();
            let message = format!("{file}: cannot write the index: {error}; check the folder");
            Failure::output(message).into()
        })
    }

    /// Removes the index and its pictures; skips listed names that do not match `files`.
    fn remove_pictures(&self, files: &FrameFiles) {
        for frame in &self.frames {
            if frame.file == files.name(frame.number) {
                // Ignore errors: the file will be replaced.
                let _ = std::fs::remove_file(files.path(frame.number));
            }
        }
        let _ = std::fs::remove_file(files.index());
    }
}

fn read(file: &Path) -> anyhow::Result<Option<Index>> {
    let fail = |reason: String| {
        Failure::output(format!(
            "{}: cannot read the index of the pictures there: {reason}; choose another place, or \
             render all again with --restart",
            file.display()
        ))
    };
    match read_regular(file) {
        Ok(text) => match serde_json::from_slice(&text) {
            Ok(index) => Ok(Some(index)),
            Err(error) => Err(fail(error.to_string()).into()),
        },
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(fail(error.to_string()).into()),
    }
}

/// A description of the first setting that differs.
fn difference(old: &Map<String, Value>, new: &Map<String, Value>) -> Option<String> {
    let keys = old.keys().chain(new.keys().filter(|key| !old.contains_key(*key)));
    let mut keys = keys.filter(|key| old.get(*key) != new.get(*key));
    let key = keys.next()?;
    let word = |settings: &Map<String, Value>| {
        let text = settings.get(key).map_or("nothing".to_owned(), Value::to_string);
        match text.chars().count() {
            0..=60 => text,
            _ => text.chars().take(60).chain("...".chars()).collect(),
        }
    };
    Some(format!("{key} was {}, is {} now", word(old), word(new)))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn settings(value: &Value) -> Map<String, Value> {
        value.as_object().unwrap().clone()
    }

    fn frame(number: u32, files: &FrameFiles, content: &str) -> Frame {
        std::fs::write(files.path(number), content).unwrap();
        Frame {
            number,
            file: files.name(number),
            bytes: content.len() as u64,
            time_s: f64::from(number) / 24.0,
            camera: json!({ "name": "a" }),
            exposure: Some(0.1),
            seconds: 1.0,
        }
    }

    #[test]
    fn only_incomplete_pictures_are_rendered_again() {
        let folder = tempfile::tempdir().unwrap();
        let files = FrameFiles::new(folder.path()).unwrap();
        let new = || Index::new(4, settings(&json!({ "frames": 16, "scale": 0.1_f32 })));
        let Start { mut index, missing } = new().start(&files, 0..4, false).unwrap();
        assert_eq!(missing, [0, 1, 2, 3]);
        index.exposure = Some(-7.3);
        for number in [2, 0, 3] {
            index.add(frame(number, &files, "picture"), &files).unwrap();
        }
        // One file was truncated, one removed.
        std::fs::write(files.path(0), "pic").unwrap();
        std::fs::remove_file(files.path(3)).unwrap();
        let start = new().start(&files, 0..4, false).unwrap();
        assert_eq!(start.missing, [0, 1, 3]);
        assert_eq!(start.index.exposure, Some(-7.3));
        let again = new().start(&files, 0..4, true).unwrap();
        assert_eq!(again.missing, [0, 1, 2, 3]);
        assert!(again.index.frames.is_empty() && !files.path(2).exists());
    }

    #[test]
    fn resuming_with_changed_settings_is_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let files = FrameFiles::new(folder.path()).unwrap();
        let old = json!({ "frames": 16, "sun": null });
        let mut index = Index::new(1, settings(&old));
        index.add(frame(0, &files, "a"), &files).unwrap();
        for (new, needle) in [
            (json!({ "frames": 8, "sun": null }), "frames was 16, is 8 now"),
            (json!({ "frames": 16 }), "sun was null, is nothing now"),
            (json!({ "frames": 16, "sun": null, "x": 1 }), "x was nothing, is 1 now"),
        ] {
            let error =
                Index::new(1, settings(&new)).start(&files, 0..1, false).unwrap_err().to_string();
            assert!(error.contains(needle) && error.contains("--restart"), "{error}");
        }
        std::fs::write(files.index(), "{").unwrap();
        let error =
            Index::new(1, settings(&old)).start(&files, 0..1, false).unwrap_err().to_string();
        assert!(error.contains("cannot read the index"), "{error}");
    }

    #[test]
    fn pictures_without_an_index_are_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let files = FrameFiles::new(folder.path()).unwrap();
        std::fs::write(files.path(1), "a photograph").unwrap();
        let error = Index::new(2, Map::new()).start(&files, 0..2, false).unwrap_err().to_string();
        assert!(error.contains("0001.png") && error.contains("no index"), "{error}");
        assert!(Index::new(1, Map::new()).start(&files, 0..1, false).is_ok());
        assert!(Index::new(2, Map::new()).start(&files, 0..1, false).is_ok(), "nor asked for");
        assert!(Index::new(2, Map::new()).start(&files, 0..2, true).is_ok());
    }
}
