//! Writes a scene as one glTF 2.0 binary (Khronos, "glTF 2.0 specification", 2021, section 4.4).
//!
//! **Nothing is lost.** Loaded again, the scene is the same, bit by bit: floats read back exactly,
//! and images are losslessly compressed PNG. Properties that glTF cannot express (Phong's exponent,
//! lights' radii and fall-off, the environment, the box of the voxels, texture transforms with
//! shear) are written twice: in the closest form that other programs can show, and as the exact
//! value under `extras.lumivox`, which the loader prefers.
//!
//! **One scene has one file.** Only things that instances use are written, in the order of their
//! first use, and equal things once. So saving a loaded scene gives the same bytes, and the order
//! of unused or repeated things in memory does not matter. This *normal form* leaves out:
//!
//! - meshes, materials and textures that no instance uses, and instances of meshes without
//!   triangles;
//! - the second of two equal meshes, samplers or textures;
//! - the part of a camera's up that is along its line of sight, and the scale of a missing normal
//!   texture: they have no effect;
//! - second texture coordinates that the material does not use, and colours that are all white; if
//!   the material uses a missing second set, the first is written, which replaces it;
//! - the lighting of an unlit material: layers, emission, normals;
//! - the rest of names of more than 80 characters, which loaders cut;
//! - [`Scene::rig`]: the present pose is written, and no animations;
//! - [`Scene::name`], which is the file's, and notes and warnings.
//!
//! A transform with shear is written unchanged, although glTF requires matrices to be products of
//! translation, rotation and scale; programs that decompose them lose the shear.

mod binary;
mod container;
mod document;
mod environment;
mod layers;
mod material;
mod mesh;
mod node;
mod texture;

use std::path::{Path, PathBuf};

use crate::{Scene, SceneError, write_atomically};
use container::Container;
use document::Document;

impl Scene {
    /// Writes the scene to a `.glb` file (glTF 2.0, everything in one file), which loads as the
    /// same scene again, and which other programs read.
    ///
    /// The file is written under a temporary name in the same folder first and renamed at the end:
    /// a reader finds the old file or the whole new one. Needs additional memory only for the
    /// textures as PNG.
    ///
    /// # Errors
    /// [`SceneError::Write`] when the file cannot be written; no temporary file is left then.
    /// [`SceneError::TooLarge`] beyond 4 GiB, and the errors of [`Scene::validate`].
    pub fn save_glb(&self, path: impl AsRef<Path>) -> Result<(), SceneError> {
        let path = path.as_ref();
        let container = self.container(path)?;
        write_atomically(path, |out| container.write(out))
            .map_err(|source| SceneError::Write { file: path.to_owned(), source })
    }

    /// The bytes of the file that [`Scene::save_glb`] writes.
    ///
    /// # Errors
    /// As [`Scene::save_glb`], except for the disk.
    pub fn to_glb(&self) -> Result<Vec<u8>, SceneError> {
        let name = PathBuf::from(&self.name);
        let container = self.container(&name)?;
        let mut bytes = Vec::with_capacity(container.bytes() as usize);
        container
            .write(&mut bytes)
            .map_err(|source| SceneError::Write { file: name.clone(), source })?;
        Ok(bytes)
    }

    fn container(&self, file: &Path) -> Result<Container<'_>, SceneError> {
        crate::validate::check(self, file)?;
        let mut writer = Writer::new(self, file)?;
        writer.nodes();
        writer.scene_extras();
        let (json, binary) = writer.document.json();
        Container::new(json, binary)
            .map_err(|bytes| SceneError::TooLargeToSave { file: file.to_owned(), bytes })
    }
}

/// The state of writing one scene with valid indices.
struct Writer<'a> {
    scene: &'a Scene,
    document: Document<'a>,
    /// The file's index of each material of the scene.
    materials: Vec<Option<usize>>,
    /// The file's index of each texture of the scene; `None` if unused.
    textures: Vec<Option<usize>>,
}

impl<'a> Writer<'a> {
    fn new(scene: &'a Scene, file: &Path) -> Result<Self, SceneError> {
        let mut writer = Self {
            scene,
            document: Document::at(scene.origin),
            materials: vec![None; scene.materials.len()],
            textures: vec![None; scene.textures.len()],
        };
        writer.write_textures(file)?;
        Ok(writer)
    }
}
