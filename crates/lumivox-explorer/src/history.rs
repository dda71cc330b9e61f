//! Undo and redo.
//!
//! Every change keeps only the previous value: a material, the list of lights, the edit of an
//! object, or the settings. Meshes and textures are never copied. [`Explorer::note_change`] makes a
//! step of all values kept since the last step. Changes of the same things are one step until
//! [`Explorer::end_gesture`], so that a drag is undone as a whole.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::parameters::PARAMETERS;
use lumivox_render::{PresetChoice, RenderSettings};
use lumivox_scene::{Environment, Light, Material};

use crate::objects::Edit;
use crate::{Explorer, ExplorerError};

/// The number of steps that can be undone.
const DEPTH: usize = 100;

/// The thing that a change is about.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Key {
    Settings,
    Lights,
    Environment,
    Material(usize),
    Object(String),
}

/// A previous value.
#[derive(Clone, Debug)]
pub(crate) enum Value {
    Settings(Box<SettingsSnapshot>),
    Lights(Vec<Light>),
    Environment(Environment),
    Material(Box<Material>),
    Object(Option<Edit>),
}

/// Settings as the user asked for them.
#[derive(Clone, Debug)]
pub(crate) struct SettingsSnapshot {
    settings: RenderSettings,
    preset: PresetChoice,
    has_fitted_grid: bool,
}

impl SettingsSnapshot {
    /// These settings with the present values of those that no user sets: the window's size, the
    /// panels' timing, and the box, which widens by itself.
    fn beside(mut self, now: &RenderSettings, has_fitted_grid: bool) -> RenderSettings {
        self.settings.size = now.size;
        self.settings.timing = now.timing;
        if self.has_fitted_grid && has_fitted_grid {
            self.settings.grid_bounds = now.grid_bounds;
        }
        self.settings
    }

    fn is_same(&self, other: &Self) -> bool {
        let alike = self.clone().beside(&other.settings, other.has_fitted_grid);
        alike == other.settings
            && (self.preset, self.has_fitted_grid) == (other.preset, other.has_fitted_grid)
    }
}

impl Value {
    fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Settings(a), Self::Settings(b)) => a.is_same(b),
            (Self::Lights(a), Self::Lights(b)) => a == b,
            (Self::Environment(a), Self::Environment(b)) => {
                let is_same_map = match (&a.map, &b.map) {
                    (Some(a), Some(b)) => Arc::ptr_eq(a, b),
                    (None, None) => true,
                    _ => false,
                };
                is_same_map && (a.radiance, a.rotation_rad) == (b.radiance, b.rotation_rad)
            }
            (Self::Material(a), Self::Material(b)) => a == b,
            (Self::Object(a), Self::Object(b)) => {
                a.clone().unwrap_or_default() == b.clone().unwrap_or_default()
            }
            _ => false,
        }
    }
}

type Values = BTreeMap<Key, Value>;

/// One step, with the values that undoing or redoing it restores.
#[derive(Clone, Debug)]
struct Step {
    words: String,
    values: Values,
    /// Whether the renderer has shown its result.
    is_shown: bool,
}

/// The steps that can be undone, and those that can be redone.
#[derive(Clone, Debug, Default)]
pub(crate) struct History {
    past: Vec<Step>,
    future: Vec<Step>,
    /// Values before the changes that are not a step yet.
    before: Values,
    /// Whether further changes of the same things belong to the last step.
    is_open: bool,
}

impl History {
    /// Notes that the renderer has accepted all changes.
    pub(crate) fn accept(&mut self) {
        for step in self.past.iter_mut().rev().take_while(|step| !step.is_shown) {
            step.is_shown = true;
        }
    }

    /// Notes that the renderer has refused the settings: requests the previous ones, and removes
    /// steps to the refused ones.
    pub(crate) fn refuse_settings(&mut self) {
        let unseen = self.past.iter().rposition(|step| step.is_shown).map_or(0, |at| at + 1);
        for step in &mut self.past[unseen..] {
            step.values.remove(&Key::Settings);
        }
        self.past.retain(|step| !step.values.is_empty());
    }
}

impl Explorer {
    /// Makes a step of all changes since the last call; none if nothing differs. A front end calls
    /// it after each action of its user.
    pub fn note_change(&mut self) {
        let before = std::mem::take(&mut self.history.before);
        let is_changed = |key: &Key, value: &Value| {
            self.value_of(key).is_some_and(|current| !current.is_same(value))
        };
        let values: Values =
            before.into_iter().filter(|(key, value)| is_changed(key, value)).collect();
        if values.is_empty() {
            return;
        }
        let words = self.words_of(&values);
        let history = &mut self.history;
        history.future.clear();
        let goes_on = history.is_open
            && history
                .past
                .last()
                .is_some_and(|last| last.words == words && last.values.keys().eq(values.keys()));
        if !goes_on {
            history.past.push(Step { words, values, is_shown: false });
            let surplus = history.past.len().saturating_sub(DEPTH);
            history.past.drain(..surplus);
        }
        history.is_open = true;
    }

    /// Ends the last step: the next change begins a new one, even of the same thing.
    pub fn end_gesture(&mut self) {
        self.note_change();
        self.history.is_open = false;
    }

    /// Undoes the last step, and returns a description of it.
    ///
    /// # Errors
    /// [`ExplorerError::Nothing`] when there is no step.
    pub fn undo(&mut self) -> Result<String, ExplorerError> {
        self.end_gesture();
        let nothing = || ExplorerError::Nothing { what: "undo" };
        // A refusal by the renderer may have left a step that changes nothing.
        loop {
            let step = self.history.past.pop().ok_or_else(nothing)?;
            if let Some(step) = self.step_back(step) {
                let words = step.words.clone();
                self.history.future.push(step);
                return Ok(words);
            }
        }
    }

    /// Redoes the step that was undone last, and returns a description of it.
    ///
    /// # Errors
    /// [`ExplorerError::Nothing`] when no step was undone, or something else has changed since.
    pub fn redo(&mut self) -> Result<String, ExplorerError> {
        self.end_gesture();
        let nothing = || ExplorerError::Nothing { what: "redo" };
        loop {
            let step = self.history.future.pop().ok_or_else(nothing)?;
            if let Some(step) = self.step_back(step) {
                let words = step.words.clone();
                self.history.past.push(step);
                return Ok(words);
            }
        }
    }

    /// Description of the step that [`Self::undo`] would undo.
    pub fn undoable(&self) -> Option<&str> {
        self.history.past.last().map(|step| step.words.as_str())
    }

    /// Description of the step that [`Self::redo`] would redo.
    pub fn redoable(&self) -> Option<&str> {
        self.history.future.last().map(|step| step.words.as_str())
    }

    /// Keeps the present value before it is changed.
    pub(crate) fn keep(&mut self, key: Key) {
        if !self.history.before.contains_key(&key)
            && let Some(value) = self.value_of(&key)
        {
            self.history.before.insert(key, value);
        }
    }

    /// Restores a step's values, and returns the step that leads back; `None` if nothing differs.
    fn step_back(&mut self, step: Step) -> Option<Step> {
        let mut values = Values::new();
        for (key, value) in step.values {
            let Some(current) = self.value_of(&key).filter(|current| !current.is_same(&value))
            else {
                continue;
            };
            self.restore(&key, value);
            values.insert(key, current);
        }
        let is_shown = false;
        (!values.is_empty()).then_some(Step { words: step.words, values, is_shown })
    }

    fn value_of(&self, key: &Key) -> Option<Value> {
        let opened = self.opened.as_ref();
        Some(match key {
            Key::Settings => Value::Settings(Box::new(SettingsSnapshot {
                settings: self.settings.clone(),
                preset: self.preset,
                has_fitted_grid: self.has_fitted_grid(),
            })),
            Key::Lights => Value::Lights(opened?.scene.lights.clone()),
            Key::Environment => Value::Environment(opened?.scene.environment.clone()),
            Key::Material(number) => {
                Value::Material(Box::new(opened?.scene.materials.get(*number)?.clone()))
            }
            Key::Object(name) => Value::Object(opened?.edits.get(name).cloned()),
        })
    }

    fn restore(&mut self, key: &Key, value: Value) {
        if let Value::Settings(asked) = value {
            let (preset, fitted) = (asked.preset, asked.has_fitted_grid);
            self.settings = asked.beside(&self.settings, self.has_fitted_grid());
            self.preset = preset;
            self.set_grid_widens(fitted);
            return;
        }
        let Some(opened) = &mut self.opened else { return };
        match (key, value) {
            (Key::Lights, Value::Lights(lights)) => {
                opened.scene.lights = lights;
                self.pending.lights = true;
            }
            (Key::Environment, Value::Environment(environment)) => {
                opened.scene.environment = environment;
                self.pending.lights = true;
            }
            (Key::Material(number), Value::Material(material)) => {
                if let Some(place) = opened.scene.materials.get_mut(*number) {
                    *place = *material;
                    self.pending.materials = true;
                }
            }
            (Key::Object(name), Value::Object(edit)) => {
                match edit {
                    Some(edit) => opened.edits.insert(name.clone(), edit),
                    None => opened.edits.remove(name),
                };
                if let Some(object) = opened.names.iter().position(|other| other == name) {
                    opened.apply_edit(object);
                    self.note_moved(object);
                }
            }
            _ => {}
        }
    }

    /// Describes the changes since the given values.
    fn words_of(&self, before: &Values) -> String {
        let objects = before.keys().filter(|key| matches!(key, Key::Object(_))).count();
        let mut words = Vec::new();
        for (key, value) in before {
            words.push(match (key, value) {
                (Key::Settings, Value::Settings(before)) => self.words_of_settings(before),
                (Key::Lights, Value::Lights(before)) => self.words_of_lights(before),
                (Key::Material(number), _) => {
                    let names = self.material_names();
                    format!("material \"{}\"", names.get(*number).map_or("", String::as_str))
                }
                (Key::Object(name), _) if objects == 1 => format!("object \"{name}\""),
                (Key::Object(_), _) => continue,
                _ => "surroundings".to_owned(),
            });
        }
        if objects > 1 {
            words.push(format!("{objects} objects"));
        }
        words.join(", ")
    }

    fn words_of_settings(&self, before: &SettingsSnapshot) -> String {
        if before.preset != self.preset {
            return format!("preset {}", self.preset.name());
        }
        let mut names: Vec<&str> = PARAMETERS
            .iter()
            .filter(|parameter| {
                let (was, is) = (parameter.get(&before.settings), parameter.get(&self.settings));
                was != is && parameter.name != "size"
            })
            .map(|parameter| parameter.name)
            .collect();
        if before.settings.grid_bounds != self.settings.grid_bounds {
            names.push("grid_bounds");
        }
        match names.as_slice() {
            [] | [_, _, _, _, ..] => "settings".to_owned(),
            names => names.join(", "),
        }
    }

    fn words_of_lights(&self, before: &[Light]) -> String {
        let lights = self.scene().map_or(&[][..], |scene| &scene.lights);
        let mut changed = lights.iter().zip(before).zip(self.light_names());
        let mut changed = changed.by_ref().filter(|((is, was), _)| is != was).map(|(_, name)| name);
        match (changed.next(), changed.next()) {
            (Some(name), None) if lights.len() == before.len() => format!("light \"{name}\""),
            _ => "lights".to_owned(),
        }
    }
}
