//! The keys of blocks, and the kinds of their values.

use std::path::Path;

use glam::Vec3;

use super::token::{Place, Token};
use super::tree::{Block, Entry, Value, fault, quote};
use crate::SceneError;
use crate::load::Notes;

/// The keys of a kind of block.
pub(super) struct Keys {
    /// The name of the kind, with its article.
    pub(super) what: &'static str,
    /// Keys whose first occurrence counts.
    pub(super) once: &'static [&'static str],
    /// Keys that may be repeated.
    pub(super) many: &'static [&'static str],
}

pub(super) const FILE: Keys = Keys { what: "the file", once: &[], many: &["scene"] };
pub(super) const SCENE: Keys = Keys { what: "a scene", once: &["name"], many: &["model", "light"] };
pub(super) const MODEL: Keys = Keys {
    what: "a model",
    once: &[
        "name",
        "active",
        "static",
        "path",
        "primitive",
        "position",
        "rotation",
        "scale",
        "scale_x",
        "scale_y",
        "scale_z",
        "shader",
        "material",
    ],
    many: &[],
};
pub(super) const MATERIAL: Keys = Keys {
    what: "a material",
    once: &["shininess", "specular_str", "diffuse_str", "ambient_str", "color"],
    many: &[],
};
pub(super) const LIGHT: Keys = Keys {
    what: "a light",
    once: &["position", "color", "att_constant", "att_linear", "att_quadratic"],
    many: &[],
};
/// The keys of positions and angles.
pub(super) const XYZ: Keys = Keys { what: "a vector", once: &["x", "y", "z"], many: &[] };
pub(super) const RGB: Keys = Keys { what: "a colour", once: &["r", "g", "b"], many: &[] };

/// Reads the values of blocks, and notes ignored entries.
pub(super) struct Values<'v> {
    pub(super) file: &'v Path,
    pub(super) notes: &'v mut Notes,
}

impl Values<'_> {
    /// Notes unknown and repeated keys of a block.
    pub(super) fn check(&mut self, block: &Block<'_>, keys: &Keys) {
        let mut seen = 0_u32;
        for Entry { key, .. } in &block.entries {
            if let Some(place) = keys.once.iter().position(|name| *name == key.text) {
                if seen & (1 << place) != 0 {
                    let kind = keys.what;
                    self.warn(
                        key.at,
                        format!("{} of {kind} comes twice, the first counts", quote(key)),
                    );
                }
                seen |= 1 << place;
            } else if !keys.many.contains(&key.text) {
                let known = [keys.once, keys.many].concat().join(", ");
                let text = format!("{} knows no {}, it was ignored", keys.what, quote(key));
                self.warn(key.at, format!("{text}; there are: {known}"));
            }
        }
    }

    pub(super) fn warn(&mut self, at: Place, text: impl std::fmt::Display) {
        self.notes.warn(format!("{at}: {text}"));
    }

    /// The block of an entry.
    pub(super) fn block<'e, 't>(
        &self,
        entry: &'e Entry<'t>,
        like: &str,
    ) -> Result<&'e Block<'t>, SceneError> {
        match &entry.value {
            Value::Block(block) => Ok(block),
            Value::Word(word) => {
                let expected = format!("a block: `{} {{ {like} }}`", entry.key.text);
                Err(fault(self.file, word.at, quote(word), expected))
            }
        }
    }

    /// The word of an entry, if it has one.
    pub(super) fn word<'t>(
        &self,
        block: &Block<'t>,
        name: &str,
        like: &str,
    ) -> Result<Option<Token<'t>>, SceneError> {
        match find(block, name).map(|entry| &entry.value) {
            None => Ok(None),
            Some(Value::Word(word)) => Ok(Some(*word)),
            Some(Value::Block(inner)) => {
                Err(fault(self.file, inner.at, "`{`", format!("a value: `{name} = {like}`")))
            }
        }
    }

    pub(super) fn number(
        &self,
        block: &Block<'_>,
        name: &str,
        default: f32,
    ) -> Result<f32, SceneError> {
        let word = self.word(block, name, "0.5f")?;
        word.map_or(Ok(default), |word| self.parse(&word))
    }

    /// Parses digits, optionally followed by an `f` and a comma.
    fn parse(&self, word: &Token<'_>) -> Result<f32, SceneError> {
        let fault = |expected: &str| fault(self.file, word.at, quote(word), expected);
        let text = word.text.strip_suffix(',').unwrap_or(word.text);
        let text = text.strip_suffix('f').unwrap_or(text);
        // Rust's parser accepts words for infinity and NaN.
        let is_number =
            text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E'));
        match text.parse::<f32>() {
            Ok(number) if is_number && number.is_finite() => Ok(number),
            Ok(_) if is_number => Err(fault("a number between -3.4e38 and 3.4e38")),
            _ => Err(fault("a number such as 0.5, 0.5f or -1e3")),
        }
    }

    /// Reads a flag: `true` is true, any other word is false.
    pub(super) fn flag(
        &mut self,
        block: &Block<'_>,
        name: &str,
        default: bool,
    ) -> Result<bool, SceneError> {
        let Some(word) = self.word(block, name, "true")? else { return Ok(default) };
        if !matches!(word.text, "true" | "false") {
            self.warn(
                word.at,
                format!("{} for \"{name}\" counts as false; only true is true", quote(&word)),
            );
        }
        Ok(word.text == "true")
    }

    /// Reads three numbers. A missing number equals the first given one.
    pub(super) fn vector(
        &mut self,
        block: &Block<'_>,
        name: &str,
        keys: &Keys,
        default: Vec3,
    ) -> Result<Vec3, SceneError> {
        let Some(entry) = find(block, name) else { return Ok(default) };
        let like: Vec<String> = keys.once.iter().map(|key| format!("{key} = 0.5")).collect();
        let inner = self.block(entry, &like.join(" "))?;
        self.check(inner, keys);
        let first = inner.entries.iter().find(|entry| keys.once.contains(&entry.key.text));
        let Some(first) = first else {
            self.warn(entry.key.at, format!("\"{name}\" has no number and keeps its default"));
            return Ok(default);
        };
        let fallback = self.number(inner, first.key.text, 0.0)?;
        let mut vector = [fallback; 3];
        for (value, key) in vector.iter_mut().zip(keys.once) {
            if find(inner, key).is_none() {
                let first = quote(&first.key);
                let text = format!("\"{name}\" has no \"{key}\", which takes the value of {first}");
                self.warn(entry.key.at, text);
            }
            *value = self.number(inner, key, fallback)?;
        }
        Ok(Vec3::from_array(vector))
    }
}

/// The first entry of that name.
pub(super) fn find<'e, 't>(block: &'e Block<'t>, name: &str) -> Option<&'e Entry<'t>> {
    block.entries.iter().find(|entry| entry.key.text == name)
}
