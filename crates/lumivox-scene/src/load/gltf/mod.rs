//! Reads glTF 2.0 (Khronos, "glTF 2.0 specification", 2021), as `.gltf` with its files or as
//! `.glb`.
//!
//! Files come from anywhere, so they are not trusted: sizes are checked against the bytes that
//! exist before memory is allocated, indices before they are used, paths before they are followed.
//! Only things that the chosen scene uses are loaded. One primitive becomes one
//! [`Mesh`](crate::Mesh), with a copy of reversed winding for transforms that mirror, and a copy
//! for each use that bones or morph targets deform.
//!
//! The steps: `container` parses and checks, `compression` decompresses buffers, `extensions`
//! refuses or warns. Then nodes are added to a [`Rig`], the things on them are converted, and the
//! rig places everything: at rest now, and at other times on request. `extras` restores Lumivox's
//! own additions to glTF. Textures are only listed at first and made at the end, within the memory
//! budget (`load::textures`).

mod about;
mod accessor;
mod animation;
mod attributes;
mod compression;
mod container;
mod copies;
mod dangling;
mod deformed;
mod extensions;
mod extras;
mod json;
mod lights;
mod material;
mod node;
mod origin;
mod own_vertices;
mod primitive;
mod put;
mod repair;
mod scenes;
mod sharing;
mod skin;
mod texture;
mod version;

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::path::Path;

use gltf::json::Root;

use super::files::{self, Reach};
use super::geometry::GeometryBudget;
use super::textures::{NotMade, Textures};
use super::{LoadOptions, Notes, stream, tangents};
use crate::pose::Parts;
use crate::{Rig, Scene, SceneError};

/// The limits of a scene, whatever its file claims: a small file can refer to the same data many
/// times.
struct Budget<'a> {
    geometry: GeometryBudget<'a>,
    /// The number of instances that may still be added.
    instances: usize,
    weights: usize,
}

/// The state of loading one file.
struct Loader<'a> {
    file: &'a Path,
    reach: Reach<'a>,
    /// Whether second texture coordinates are read even if no texture uses them.
    second_uvs: bool,
    document: &'a gltf::Document,
    buffers: &'a [Cow<'a, [u8]>],
    /// The text of the document.
    json: &'a [u8],
    scene: Scene,
    /// The rig that places the scene's instances, lights and cameras.
    rig: Parts,
    notes: Notes,
    budget: Budget<'a>,
    /// Skins of the rig by glTF skin.
    skins: HashMap<usize, usize>,
    /// The names of the lights and cameras loaded so far, by kind.
    names: HashSet<(&'static str, String)>,
    /// Meshes of the scene by primitive; `None` for skipped primitives.
    meshes: HashMap<sharing::MeshKey, Option<usize>>,
    /// The scene's material for each material of a primitive.
    materials: HashMap<material::Key, usize>,
    /// The scene's textures, which are made at the end.
    textures: Textures<'a>,
    /// Listed images by glTF image, or the reason why one is missing.
    images: HashMap<usize, texture::Listed>,
}

pub(super) fn load(file: &Path, options: &mut LoadOptions<'_>) -> Result<Scene, SceneError> {
    let bytes = stream::read_all(file, options)?;
    load_bytes(file, &json::utf8(&bytes), options)
}

/// Loads from memory; other files are read beside `file`.
fn load_bytes(
    file: &Path,
    bytes: &[u8],
    options: &mut LoadOptions<'_>,
) -> Result<Scene, SceneError> {
    let mut notes = Notes::default();
    let folders = [files::folder_of(file)];
    let reach = options.reach(&folders);
    let parsed = container::parse(file, bytes, reach, options, &mut notes)?;
    let name = file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    // Images are only decoded at the end. If some cannot be decoded, everything is assembled again
    // without them.
    let mut bad: HashMap<usize, texture::Listed> = HashMap::new();
    loop {
        let name = name.clone().unwrap_or_default();
        let mut loader = Loader {
            file,
            reach,
            second_uvs: options.second_uvs,
            document: &parsed.document,
            buffers: &parsed.buffers,
            json: parsed.json,
            scene: Scene { name, notes: parsed.about.clone(), ..Scene::default() },
            rig: Parts { file: file.to_owned(), ..Parts::default() },
            notes: notes.clone(),
            budget: Budget {
                geometry: GeometryBudget::new(file, options.budget.geometry_bytes),
                instances: 1_000_000,
                weights: 10_000_000,
            },
            skins: HashMap::new(),
            names: HashSet::new(),
            meshes: HashMap::new(),
            materials: HashMap::new(),
            textures: Textures::default(),
            images: bad.clone(),
        };
        loader.load_nodes(options.scene.as_deref())?;
        let Loader { mut scene, rig, textures, mut notes, images, .. } = loader;
        match textures.make(file, options, &mut notes) {
            Ok(textures) => scene.textures = textures,
            Err(NotMade::Images(faults)) => {
                bad.extend(texture::unlisted(&images, &faults, &parsed.document));
                continue;
            }
            Err(NotMade::Scene(error)) => return Err(error),
        }
        scene.notes.warnings = notes.warnings;
        Rig::install(&mut scene, rig)?;
        return match crate::validate::validate(&mut scene, file) {
            Ok(()) => Ok(scene),
            Err(error) => Err(scenes::with_others(error, &parsed.document)),
        };
    }
}

impl<'a> Loader<'a> {
    fn root(&self) -> &'a Root {
        self.document.as_json()
    }

    fn malformed(&self, part: &str, reason: &str) -> SceneError {
        SceneError::Malformed {
            file: self.file.to_owned(),
            part: part.to_owned(),
            reason: reason.to_owned(),
        }
    }

    /// The text of an error for a warning, without the file's name, which warnings already have.
    fn without_file(&self, error: &SceneError) -> String {
        let text = error.to_string();
        let file = format!("{}: ", self.file.display());
        text.strip_prefix(&file).unwrap_or(&text).to_owned()
    }

    fn too_many(&self, part: &str, what: &str) -> SceneError {
        self.malformed(part, &format!("with it the scene has too many {what}, split it up"))
    }
}

/// The name of a part of a glTF file: its own, or its number. It is shortened, since many things
/// can share one.
fn name_or_index(name: Option<&str>, kind: &str, index: usize) -> String {
    name.map_or_else(|| format!("{kind} {index}"), files::shorten)
}
