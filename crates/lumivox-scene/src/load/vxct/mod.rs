//! Reads the scenes of VXCT, a program for voxel cone tracing of 2019: a text of names and blocks
//! that places OBJ files and point lights. `docs/looks.md` describes the format and the
//! meaning of its numbers here.
//!
//! | file | does |
//! | --- | --- |
//! | `token.rs` | text to tokens, which white space separates, with line and column |
//! | `tree.rs` | tokens to names with values and blocks |
//! | `keys.rs` | which names each kind of block knows, and of what kind their values are |
//! | `model.rs` | a model: its mesh, its place, its surface |
//! | `surface.rs` | its material in physical terms |
//! | `light.rs` | a light, and the cameras of the program |
//!
//! The program silently ignores many faults. This reader ignores them too, but reports them with
//! line and column. A text that cannot be intended (an open block, a word for a number) is an
//! error.

mod keys;
mod light;
mod model;
mod surface;
mod token;
mod tree;

use std::path::{Path, PathBuf};

use glam::Vec3;

use super::files::{folder_of, shorten};
use super::geometry::GeometryBudget;
use super::{LoadOptions, Notes, stream};
use crate::{Bounds, Scene, SceneError};
use keys::{FILE, SCENE, Values, find};
use tree::{Block, Value, fault, quote};

/// The most bytes of a text, enough for a hundred thousand models.
const LONGEST_TEXT: usize = 16 << 20;

/// The cube that VXCT always voxelizes.
const CUBE: Bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };

pub(super) fn load(file: &Path, options: &mut LoadOptions<'_>) -> Result<Scene, SceneError> {
    let bytes = stream::read_all(file, options)?;
    if bytes.len() > LONGEST_TEXT {
        return Err(SceneError::Malformed {
            file: file.to_owned(),
            part: "its text".to_owned(),
            reason: format!("it has {} bytes, more than {LONGEST_TEXT}", bytes.len()),
        });
    }
    let text = decode(bytes);
    let mut notes = Notes::default();
    let (root, strays) = tree::read(file, &text, &mut notes)?;
    let mut values = Values { file, notes: &mut notes };
    values.check(&root, &FILE);

    let name = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let mut scene = Scene {
        name: name.unwrap_or_default(),
        cameras: light::cameras(),
        grid_bounds: Some(CUBE),
        ..Scene::default()
    };
    scene.notes.scenes = scene_names(&root, &values)?;
    match choose(&root, &mut values, &scene.notes.scenes, options.scene.as_deref())? {
        Some(block) => fill(&mut scene, block, &mut values, options)?,
        // An empty file is an empty scene; a file with other content is not a scene.
        None if strays > 0 || !root.entries.is_empty() => {
            let first = token::Tokens::new(&text).next();
            let found = first.as_ref().map_or_else(String::new, quote);
            let at = first.map_or(root.at, |token| token.at);
            return Err(fault(file, at, format!("{found} and no scene after it"), "`scene {`"));
        }
        None => notes.warn("the file is empty, and so is the scene".to_owned()),
    }
    scene.notes.warnings = notes.warnings;
    crate::validate::validate(&mut scene, file)?;
    Ok(scene)
}

/// Text of UTF-8, or else of Latin-1, as older programs wrote.
fn decode(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes)
        .unwrap_or_else(|error| error.into_bytes().iter().map(|&byte| char::from(byte)).collect())
}

/// The names or numbers of the file's scenes.
fn scene_names(root: &Block<'_>, values: &Values<'_>) -> Result<Vec<String>, SceneError> {
    let mut names = Vec::new();
    for entry in root.entries.iter().filter(|entry| entry.key.text == "scene") {
        let block = values.block(entry, "model { } light { }")?;
        let name = match find(block, "name").map(|entry| &entry.value) {
            Some(Value::Word(word)) => shorten(word.text),
            _ => names.len().to_string(),
        };
        names.push(name);
    }
    Ok(names)
}

/// The scene `wanted`, by name or number; by default the first. `None` if the file has no scene.
fn choose<'e, 't>(
    root: &'e Block<'t>,
    values: &mut Values<'_>,
    names: &[String],
    wanted: Option<&str>,
) -> Result<Option<&'e Block<'t>>, SceneError> {
    let scenes: Vec<_> = root.entries.iter().filter(|entry| entry.key.text == "scene").collect();
    let index = match wanted {
        None => {
            if let [_, second, ..] = scenes.as_slice() {
                let text = "the first scene of the file counts, the others were ignored";
                values.warn(second.key.at, text);
            }
            0
        }
        Some(wanted) => {
            let by_name = names.iter().position(|name| name == wanted);
            let by_number = || wanted.parse().ok().filter(|&index| index < scenes.len());
            by_name.or_else(by_number).ok_or_else(|| SceneError::UnknownScene {
                file: values.file.to_owned(),
                wanted: shorten(wanted),
                known: names.to_vec(),
            })?
        }
    };
    scenes.get(index).map(|entry| values.block(entry, "model { } light { }")).transpose()
}

/// The folder of a scene, and VXCT's folder if the scene is in its folder `scenes`.
pub(super) fn folders(file: &Path, options: &LoadOptions<'_>) -> Vec<PathBuf> {
    let program = model::program_folder(file, options);
    let program = program.map(|(folder, _)| folder_of(&folder.join("program")));
    [folder_of(file)].into_iter().chain(program).collect()
}

/// Adds everything in a scene's block to the scene.
fn fill(
    scene: &mut Scene,
    block: &Block<'_>,
    values: &mut Values<'_>,
    options: &mut LoadOptions<'_>,
) -> Result<(), SceneError> {
    values.check(block, &SCENE);
    // The name is not used here, but must be a value.
    values.word(block, "name", "room")?;
    let budget = GeometryBudget::new(values.file, options.budget.geometry_bytes);
    let folders = folders(values.file, options);
    let mut models = model::Models::new(values.file, &folders, budget, options);
    for entry in &block.entries {
        match entry.key.text {
            "model" => {
                let block = values.block(entry, "path = models/box.obj")?;
                models.put(scene, block, entry.key.at, values)?;
            }
            "light" => {
                let block = values.block(entry, "position { x = 0 y = 0.5 z = 0 }")?;
                let light = light::light(block, scene.lights.len() + 1, values)?;
                scene.lights.push(light);
            }
            _ => {}
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
