//! The JSON of the file, list by list.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt::Write as _;

use glam::DVec3;
use serde_json::{Map, Value, json};

use super::binary::{Binary, Source, Target};

/// A glTF document being written.
///
/// Entries are converted to text immediately: that takes a tenth of the memory of a tree of values,
/// and equal entries have equal text.
#[derive(Default)]
pub(super) struct Document<'a> {
    lists: BTreeMap<&'static str, List>,
    extensions: BTreeSet<&'static str>,
    pub(super) binary: Binary<'a>,
    /// The position of the scene's zero in the file's coordinates.
    pub(super) origin: DVec3,
    /// The scene's entry; the numbers of its root nodes are added at the end.
    pub(super) scene: Map<String, Value>,
}

#[derive(Default)]
struct List {
    json: String,
    count: usize,
    known: HashMap<String, usize>,
}

impl<'a> Document<'a> {
    /// An empty document for a scene with this origin.
    pub(super) fn at(origin: DVec3) -> Self {
        Self { origin, ..Self::default() }
    }

    /// Appends to a list of the document, and returns the index.
    pub(super) fn push(&mut self, list: &'static str, entry: &Value) -> usize {
        self.lists.entry(list).or_default().push(&entry.to_string())
    }

    /// Appends an entry unless the list has an equal one, and returns its index.
    pub(super) fn push_once(&mut self, list: &'static str, entry: &Value) -> usize {
        let list = self.lists.entry(list).or_default();
        let text = entry.to_string();
        if let Some(&known) = list.known.get(&text) {
            return known;
        }
        let index = list.push(&text);
        list.known.insert(text, index);
        index
    }

    /// Records that an extension is in use.
    pub(super) fn uses(&mut self, extension: &'static str) {
        self.extensions.insert(extension);
    }

    /// An accessor of all of `source`; `kind` is its type (`VEC3`), `component` its component
    /// type's number, `more` its other properties.
    pub(super) fn accessor(
        &mut self,
        source: Source<'a>,
        target: Target,
        (kind, component): (&str, u32),
        count: usize,
        more: Value,
    ) -> usize {
        let view = self.binary.view(source, target);
        let mut accessor = json!({
            "bufferView": view, "componentType": component, "count": count, "type": kind,
        });
        if let (Value::Object(accessor), Value::Object(mut more)) = (&mut accessor, more) {
            accessor.append(&mut more);
        }
        self.push_once("accessors", &accessor)
    }

    /// The document as text.
    pub(super) fn json(mut self) -> (String, Binary<'a>) {
        for view in &self.binary.views {
            let mut json =
                json!({ "buffer": 0, "byteOffset": view.offset, "byteLength": view.bytes });
            match view.target {
                Target::None => {}
                Target::Vertices => json["target"] = json!(34_962),
                Target::Indices => json["target"] = json!(34_963),
            }
            self.lists.entry("bufferViews").or_default().push(&json.to_string());
        }
        if self.binary.bytes > 0 {
            let buffer = json!({ "byteLength": self.binary.bytes });
            self.lists.entry("buffers").or_default().push(&buffer.to_string());
        }
        let nodes = self.lists.get("nodes").map_or(0, |nodes| nodes.count);
        if nodes == 0 {
            // Empty lists are forbidden, and many readers require nodes.
            self.push("nodes", &json!({ "name": "empty" }));
        }
        let mut roots: Value = (0..nodes.max(1)).collect();
        if self.origin != DVec3::ZERO {
            let place = self.origin.to_array();
            let moved = json!({ "name": "origin", "translation": place, "children": roots });
            roots = json!([self.push("nodes", &moved)]);
        }
        self.scene.insert("nodes".to_owned(), roots);

        let mut json = format!(
            r#"{{"asset":{{"generator":"Lumivox {}","version":"2.0"}}"#,
            env!("CARGO_PKG_VERSION")
        );
        let lights = self.lists.remove("lights");
        if !self.extensions.is_empty() {
            // Writing to a string does not fail.
            let _ = write!(json, r#","extensionsUsed":{}"#, json!(self.extensions));
        }
        if let Some(lights) = lights {
            let _ = write!(
                json,
                r#","extensions":{{"KHR_lights_punctual":{{"lights":[{}]}}}}"#,
                lights.json
            );
        }
        let _ = write!(json, r#","scene":0,"scenes":[{}]"#, Value::Object(self.scene));
        for (name, list) in &self.lists {
            let _ = write!(json, r#","{name}":[{}]"#, list.json);
        }
        json.push('}');
        (json, self.binary)
    }
}

impl List {
    fn push(&mut self, entry: &str) -> usize {
        if self.count > 0 {
            self.json.push(',');
        }
        self.json.push_str(entry);
        self.count += 1;
        self.count - 1
    }
}

/// The shortest number that reads back as the same `f32`, bit by bit.
///
/// Readers parse JSON numbers as f64 and round them. With the shortest digits of an f32, an error
/// of one or two units in the last place of the f64 is harmless, except in rare cases, which get
/// the digits of the f64.
pub(super) fn number(value: f32) -> Value {
    let exact = f64::from(value);
    let short: f64 = value.to_string().parse().unwrap_or(exact);
    let off = [short.next_down().next_down(), short, short.next_up().next_up()];
    let safe = off.into_iter().all(|off| (off as f32).to_bits() == value.to_bits());
    json!(if safe { short } else { exact })
}

/// [`number`] for each value.
pub(super) fn numbers(values: &[f32]) -> Value {
    values.iter().map(|&v| number(v)).collect()
}

/// Writes what glTF cannot express, under this project's name in an entry's `extras`.
pub(super) fn own_extras(entry: &mut Map<String, Value>, own: &Map<String, Value>) {
    if !own.is_empty() {
        entry.insert("extras".to_owned(), json!({ crate::EXTRAS: own }));
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read_back(value: f32) -> f32 {
        // As in the loader: from text to f64 to f32.
        serde_json::from_str(&number(value).to_string()).unwrap()
    }

    proptest! {
        #[test]
        fn numbers_read_back_to_the_bit(bits in any::<u32>()) {
            let value = f32::from_bits(bits);
            if value.is_finite() {
                prop_assert_eq!(read_back(value).to_bits(), bits, "{}", number(value));
            }
        }
    }

    #[test]
    fn numbers_are_written_in_shortest_form() {
        assert_eq!(number(0.1).to_string(), "0.1");
        assert_eq!(number(-0.0).to_string(), "-0.0");
        for value in
            [0.0, -0.0, 1e-45, f32::MIN_POSITIVE, f32::MAX, f32::MIN, 16_777_216.0, 1.0 / 3.0]
        {
            assert_eq!(read_back(value).to_bits(), value.to_bits());
        }
    }

    #[test]
    fn push_once_merges_equal_entries() {
        let mut document = Document::default();
        assert_eq!(document.push_once("samplers", &json!({ "wrapS": 1 })), 0);
        assert_eq!(document.push_once("samplers", &json!({ "wrapS": 2 })), 1);
        assert_eq!(document.push_once("samplers", &json!({ "wrapS": 1 })), 0);
        assert_eq!(document.push("nodes", &json!({})), 0);
        assert_eq!(document.push("nodes", &json!({})), 1);
        let json: Value = serde_json::from_str(&document.json().0).unwrap();
        assert_eq!(json["samplers"].as_array().unwrap().len(), 2);
        assert_eq!(json["scenes"][0]["nodes"], json!([0, 1]));
    }
}
