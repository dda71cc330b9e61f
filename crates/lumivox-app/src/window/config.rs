//! State that is saved between runs: settings, recent scenes, the window's size and panels.
//!
//! The file is `lumivox/window.json` in the user's configuration folder (on Linux
//! `$XDG_CONFIG_HOME` or `~/.config`). It stores settings by their names in
//! [`lumivox_explorer::parameters`], so that a file of another version only loses settings that
//! this version does not have.

use std::collections::BTreeMap;
use std::path::PathBuf;

use lumivox_explorer::parameters::{PARAMETERS, Parameter, find_parameter, find_preset};
use lumivox_explorer::{Explorer, FRAME_BUDGET_MS, LONGEST_BUDGET_MS};
use lumivox_render::PresetChoice;
use serde::{Deserialize, Serialize};

use crate::args::settings::Given;

/// Maximum number of recent scenes.
const RECENT: usize = 10;

/// The saved state.
#[allow(clippy::struct_excessive_bools)] // Each is a switch of the window.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(default)]
pub struct Config {
    /// Width and height of the window in points of the screen.
    pub window: [f32; 2],
    /// `true` if the left panel is open.
    pub left: bool,
    /// `true` if the right panel is open.
    pub right: bool,
    /// `true` if the console is open.
    pub console: bool,
    /// `true` if pictures have half the width and height of their panel.
    pub half_size: bool,
    /// Maximum time of a frame in motion, ms; 0 disables coarser pictures.
    pub frame_budget_ms: f32,
    /// Flying speed, as a multiple of the scene's default.
    pub speed: f32,
    /// Recent scenes, the newest first, as arguments of `load`.
    pub recent: Vec<String>,
    /// The preset's name.
    pub preset: Option<String>,
    /// Settings that differ from the preset's, by name.
    pub settings: BTreeMap<String, String>,
    #[serde(skip)]
    file: Option<PathBuf>,
    /// Command-line overrides, which are not saved unless changed since.
    #[serde(skip)]
    once: Once,
    /// A problem with the file, if any.
    #[serde(skip)]
    pub warning: Option<String>,
}

/// Command-line overrides.
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
    /// Loads the saved state; the defaults if there is no readable file. If `is_fresh`, loads only
    /// the recent scenes.
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

    /// Writes the file.
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

    /// Applies the saved settings to an explorer, except those that the command line gives. Applies
    /// none if it names a preset.
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
            // Cannot fail: the parameter had this value.
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

    /// Stores the settings that differ from the preset's.
    pub fn keep_settings(&mut self, model: &super::model::Model) {
        self.frame_budget_ms = model.pacing.budget_ms;
        // Do not save a preset of the command line unless it has changed.
        if self.once.preset == Some(model.preset) {
            return;
        }
        let before = std::mem::take(&mut self.settings);
        self.preset = Some(model.preset.name().to_owned());
        let differs = |p: &&Parameter| p.get(&model.settings) != p.get(&model.usual);
        // Skip settings without effect, such as VXCT's cones in another look.
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
    fn saved_config_is_read_back_unchanged() {
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
    fn a_broken_config_file_gives_a_warning_and_defaults() {
        for text in ["", "{", "3", "{\"window\": \"wide\"}", "\u{0}"] {
            let config = Config::read(text, Some(&"window.json".into()));
            assert!(
                config.warning.is_some_and(|warning| warning.contains("window.json")),
                "{text}"
            );
            assert_eq!(config.window, Config::default().window);
        }
        // Missing and invalid values become the defaults; unknown ones are ignored.
        let config = Config::read("{\"future\": 1, \"window\": [1e9, -5], \"speed\": 0}", None);
        assert_eq!(config, Config::default());
    }

    #[test]
    fn command_line_overrides_are_not_saved_unless_changed() {
        let mut config = Config::default();
        config.settings.insert("bounces".to_owned(), "2".to_owned());
        config.once.values.insert("bounces", "5".to_owned());
        config.once.values.insert("frames", "3".to_owned());
        let mut model = crate::window::model::Model::default();
        (model.settings.bounces, model.settings.frames) = (5, 3);
        config.keep_settings(&model);
        assert_eq!(config.settings.get("bounces").map(String::as_str), Some("2"));
        assert!(!config.settings.contains_key("frames"));
        // Values changed in the window are saved.
        (model.settings.bounces, model.settings.frames) = (4, 6);
        config.keep_settings(&model);
        assert_eq!(config.settings.get("bounces").map(String::as_str), Some("4"));
        assert_eq!(config.settings.get("frames").map(String::as_str), Some("6"));
        // With a preset of the command line, no settings are saved.
        config.once.preset = Some(model.preset);
        let before = config.settings.clone();
        model.settings.bounces = 1;
        config.keep_settings(&model);
        assert_eq!(config.settings, before);
    }

    #[test]
    fn the_list_of_recent_scenes_is_bounded() {
        let mut config = Config::default();
        for number in 0..30 {
            config.note_recent(&number.to_string());
        }
        assert_eq!(config.recent.len(), RECENT);
        assert_eq!(config.recent[0], "29");
    }
}
