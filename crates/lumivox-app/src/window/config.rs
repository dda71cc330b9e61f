//! What is kept between runs: the last settings, recent scenes, the window's size and panels.
//!
//! It is a JSON file in the user's folder for configuration (`lumivox/window.json`; on Linux below `$XDG_CONFIG_HOME`
//! or `~/.config`). Settings are kept by their names in [`lumivox_explorer::parameters`], so that a file of another
//! version loses what that version does not have and nothing else.

use std::collections::BTreeMap;
use std::path::PathBuf;

use lumivox_explorer::parameters::{PARAMETERS, Parameter, find_parameter, find_preset};
use lumivox_explorer::{Explorer, FRAME_BUDGET_MS, LONGEST_BUDGET_MS};
use lumivox_render::PresetChoice;
use serde::{Deserialize, Serialize};

use crate::args::settings::Given;

/// Scenes that are remembered.
const RECENT: usize = 10;

/// What is kept.
#[allow(clippy::struct_excessive_bools)] // Each is a switch of the window.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(default)]
pub struct Config {
    /// Width and height of the window in points of the screen.
    pub window: [f32; 2],
    /// Whether the panel on the left is open.
    pub left: bool,
    /// Whether the panel on the right is open.
    pub right: bool,
    /// Whether the console is open.
    pub console: bool,
    /// The picture has half as many pixels along each edge as there is room for.
    pub half_size: bool,
    /// The time that a frame may take while something moves, ms; 0: pictures are never coarser.
    pub frame_budget_ms: f32,
    /// How fast the camera flies, as a multiple of what fits the scene.
    pub speed: f32,
    /// Scenes, the newest first, as `load` takes them.
    pub recent: Vec<String>,
    /// The preset.
    pub preset: Option<String>,
    /// Settings by name.
    pub settings: BTreeMap<String, String>,
    #[serde(skip)]
    file: Option<PathBuf>,
    /// What the command line names, and its values there: for once, not to be kept.
    #[serde(skip)]
    once: Once,
    /// What was wrong with the file.
    #[serde(skip)]
    pub warning: Option<String>,
}

/// What a command line asks for.
#[derive(Clone, Debug, Default, PartialEq)]
struct Once {
    preset: Option<PresetChoice>,
    values: BTreeMap<&'static str, String>,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            window: [1280.0, 800.0],
            left: true,
            right: true,
            console: true,
            half_size: false,
            frame_budget_ms: FRAME_BUDGET_MS,
            speed: 1.0,
            recent: Vec::new(),
            preset: None,
            settings: BTreeMap::new(),
            once: Once::default(),
            file: None,
            warning: None,
        }
    }
}

impl Config {
    /// What was kept the last time; the defaults where there is nothing, or nothing that can be read. A `fresh` one has
    /// the recent scenes alone.
    pub fn load(is_fresh: bool) -> Self {
        let file = directories::ProjectDirs::from("", "", "lumivox")
            .map(|folders| folders.config_dir().join("window.json"));
        let text = file.as_ref().map(|file| {
            let bytes = lumivox_scene::read_regular(file)?;
            String::from_utf8(bytes).map_err(std::io::Error::other)
        });
        let mut config = match text {
            Some(Ok(text)) => Self::read(&text, file.as_ref()),
            Some(Err(error)) if error.kind() != std::io::ErrorKind::NotFound => Self {
                warning: Some(warning(file.as_ref(), &error.to_string())),
                ..Self::default()
            },
            _ => Self::default(),
        };
        if is_fresh {
            let (recent, warning) = (config.recent, config.warning);
            config = Self { recent, warning, ..Self::default() };
        }
        config.file = file;
        config
    }

    fn read(text: &str, file: Option<&PathBuf>) -> Self {
        let config = serde_json::from_str::<Self>(text).map(|config| {
            let is_usable = config.window.iter().all(|edge| (200.0..=16_384.0).contains(edge));
            let window = if is_usable { config.window } else { Self::default().window };
            let speed = if (1e-3..=1e3).contains(&config.speed) { config.speed } else { 1.0 };
            Self { window, speed, ..config }
        });
        config.unwrap_or_else(|error| Self {
            warning: Some(warning(file, &error.to_string())),
            ..Self::default()
        })
    }

    /// Writes it.
    ///
    /// # Errors
    /// When the folder or the file cannot be written.
    pub fn save(&self) -> anyhow::Result<()> {
        let Some(file) = &self.file else { return Ok(()) };
        if let Some(folder) = file.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let text = serde_json::to_string_pretty(self)? + "\n";
        lumivox_scene::write_atomically(file, |out| {
            std::io::Write::write_all(out, text.as_bytes())
        })?;
        Ok(())
    }

    /// Gives an explorer the settings that were kept, except for those that the command line gives; if it names a preset,
    /// none.
    pub fn apply(&mut self, explorer: &mut Explorer, given: &[Given], names_preset: bool) {
        explorer.pacing.budget_ms = self.frame_budget_ms.clamp(0.0, LONGEST_BUDGET_MS);
        for (parameter, _) in given {
            let value = parameter.get(explorer.settings()).to_string();
            self.once.values.insert(parameter.name, value);
        }
        if names_preset {
            self.once.preset = Some(explorer.preset());
            return;
        }
        let old = (explorer.settings().clone(), explorer.preset());
        let mut settings = old.0.clone();
        let preset = self.preset.as_deref();
        let preset = preset.and_then(find_preset);
        if let Some(preset) = preset {
            settings = settings.with_preset(preset, None);
        }
        for (name, text) in &self.settings {
            let Some(parameter) = find_parameter(name) else { continue };
            let value = parameter.parse(text);
            let set = value.and_then(|value| parameter.set(&mut settings, value));
            if let Err(error) = set {
                self.warning = Some(format!("a kept setting was ignored: {error}"));
            }
        }
        for (parameter, _) in given {
            // A value that it had is one that it can have.
            let _ = parameter.set(&mut settings, parameter.get(&old.0));
        }
        match explorer.set_settings(settings) {
            Ok(()) => explorer.note_preset(preset.unwrap_or(old.1)),
            Err(error) => {
                self.warning = Some(format!(
                    "the kept settings do not go together ({error:#}); these are the defaults"
                ));
            }
        }
    }

    /// Keeps the settings that differ from the preset's.
    pub fn keep_settings(&mut self, model: &super::model::Model) {
        self.frame_budget_ms = model.pacing.budget_ms;
        // What the command line asked for and nobody has changed since was for once.
        if self.once.preset == Some(model.preset) {
            return;
        }
        let before = std::mem::take(&mut self.settings);
        self.preset = Some(model.preset.name().to_owned());
        let differs = |p: &&Parameter| p.get(&model.settings) != p.get(&model.usual);
        // VXCT's cones do not matter to another look.
        let counts = |p: &&Parameter| p.means_something(&model.settings);
        let kept = PARAMETERS.iter().filter(counts).filter(differs);
        self.settings =
            kept.map(|p| (p.name.to_owned(), p.get(&model.settings).to_string())).collect();
        for (name, value) in &self.once.values {
            let now = find_parameter(name).map(|p| p.get(&model.settings).to_string());
            if now.as_ref() != Some(value) {
                continue;
            }
            match before.get(*name) {
                Some(kept) => self.settings.insert((*name).to_owned(), kept.clone()),
                None => self.settings.remove(*name),
            };
        }
    }

    /// Puts a scene first among the recent ones.
    pub fn note_recent(&mut self, source: &str) {
        self.recent.retain(|other| other != source);
        self.recent.insert(0, source.to_owned());
        self.recent.truncate(RECENT);
    }
}

fn warning(file: Option<&PathBuf>, reason: &str) -> String {
    let file = file.map(|file| file.display().to_string()).unwrap_or_default();
    format!("{file}: cannot be read ({reason}); the window starts with its defaults")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_kept_comes_back() {
        let mut config = Config { window: [700.0, 500.0], console: false, ..Config::default() };
        config.note_recent("builtin:cornell");
        config.note_recent("a b.glb");
        config.note_recent("builtin:cornell");
        config.settings.insert("bounces".to_owned(), "3".to_owned());
        let text = serde_json::to_string(&config).unwrap();
        assert_eq!(Config::read(&text, None), config);
        assert_eq!(config.recent, ["builtin:cornell", "a b.glb"]);
    }

    #[test]
    fn a_broken_file_is_a_warning() {
        for text in ["", "{", "3", "{\"window\": \"wide\"}", "\u{0}"] {
            let config = Config::read(text, Some(&"window.json".into()));
            assert!(
                config.warning.is_some_and(|warning| warning.contains("window.json")),
                "{text}"
            );
            assert_eq!(config.window, Config::default().window);
        }
        // What is missing has its default, what is unknown is passed over, and nonsense is not believed.
        let config = Config::read("{\"future\": 1, \"window\": [1e9, -5], \"speed\": 0}", None);
        assert_eq!(config, Config::default());
    }

    #[test]
    fn what_the_command_line_asks_for_once_is_not_kept() {
        let mut config = Config::default();
        config.settings.insert("bounces".to_owned(), "2".to_owned());
        config.once.values.insert("bounces", "5".to_owned());
        config.once.values.insert("frames", "3".to_owned());
        let mut model = crate::window::model::Model::default();
        (model.settings.bounces, model.settings.frames) = (5, 3);
        config.keep_settings(&model);
        assert_eq!(config.settings.get("bounces").map(String::as_str), Some("2"));
        assert!(!config.settings.contains_key("frames"));
        // Somebody has changed it in the window.
        (model.settings.bounces, model.settings.frames) = (4, 6);
        config.keep_settings(&model);
        assert_eq!(config.settings.get("bounces").map(String::as_str), Some("4"));
        assert_eq!(config.settings.get("frames").map(String::as_str), Some("6"));
        // So is a preset, with all that belongs to it.
        config.once.preset = Some(model.preset);
        let before = config.settings.clone();
        model.settings.bounces = 1;
        config.keep_settings(&model);
        assert_eq!(config.settings, before);
    }

    #[test]
    fn few_scenes_are_remembered() {
        let mut config = Config::default();
        for number in 0..30 {
            config.note_recent(&number.to_string());
        }
        assert_eq!(config.recent.len(), RECENT);
        assert_eq!(config.recent[0], "29");
    }
}
