//! Scenes from files, with one folder or file for each format.
//!
//! Files come from anywhere, so they are not trusted: sizes are checked against the bytes that
//! exist before memory is allocated, indices before they are used, paths before they are followed.

mod arrays;
pub(crate) mod color;
mod extensions;
mod files;
mod find;
pub(crate) mod foreign;
mod geometry;
#[cfg(feature = "gltf")]
mod gltf;
#[cfg(any(feature = "gltf", feature = "obj"))]
mod image;
mod normals;
#[cfg(feature = "obj")]
mod obj;
mod origin;
#[cfg(feature = "ply")]
mod ply;
#[cfg(any(feature = "obj", feature = "ply", feature = "stl"))]
mod polygon;
mod regular;
mod repair;
mod source;
mod stand_in;
#[cfg(feature = "stl")]
mod stl;
mod stream;
#[cfg(any(feature = "gltf", feature = "obj"))]
mod tangents;
mod text;
#[cfg(feature = "gltf")]
mod textures;
mod units;
#[cfg(feature = "vxct")]
mod vxct;

use std::path::{Path, PathBuf};

use crate::{Scene, SceneError};
pub use extensions::{EXTENSIONS, extensions_in_words};
use files::Reach;
#[cfg(feature = "save")]
pub(crate) use files::shorten;
pub use regular::{check_regular, read_regular};
pub use source::FileSource;

pub use units::UpAxis;

/// Options of loading a scene. The default reads no files outside the scene's folder.
pub struct LoadOptions<'a> {
    /// `true` if the scene may name files outside its own folder (for VXCT's scenes in a folder
    /// `scenes`: outside the parent folder). Default: no.
    pub allow_outside: bool,
    /// `true` to load a file that requires an unsupported glTF extension which may change the
    /// picture; a warning then names it. Extensions that only refine the picture are always
    /// allowed. Default: no.
    pub ignore_required: bool,
    /// The scene of a file to load (glTF, VXCT), by name or number. Default: the file's default
    /// scene, else its first.
    pub scene: Option<String>,
    /// The axis of the file that points up. Default: y. Use z if a CAD model or a scan lies on its
    /// back.
    pub up: UpAxis,
    /// The length of the file's unit in metres, above 0. Default: 1; 0.001 for files in
    /// millimetres, as is common in CAD. It multiplies lengths and positions, but not intensities.
    pub unit_m: f32,
    /// The angle from which an edge stays sharp, in radians from 0 (all edges do) to pi (none
    /// does), for the surfaces of OBJ, PLY and STL files without normals. Default: the format's:
    /// PLY is smooth, STL flat, OBJ flat outside its smoothing groups.
    pub crease_rad: Option<f32>,
    /// `true` to fill [`Mesh::uvs1`](crate::Mesh::uvs1) of a glTF file even if no texture uses the
    /// second set, as lightmaps do. Default: no.
    pub second_uvs: bool,
    /// The memory budget of the scene.
    pub budget: MemoryBudget,
    /// The source of all files, including the scene's own. Default: the disk.
    pub files: Option<&'a dyn FileSource>,
    /// A function that is called repeatedly with the progress.
    pub progress: Option<&'a mut dyn FnMut(LoadProgress)>,
}

impl Default for LoadOptions<'_> {
    fn default() -> Self {
        Self {
            allow_outside: false,
            ignore_required: false,
            scene: None,
            up: UpAxis::Y,
            unit_m: 1.0,
            crease_rad: None,
            second_uvs: false,
            budget: MemoryBudget::default(),
            files: None,
            progress: None,
        }
    }
}

/// The memory limits of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryBudget {
    /// Bytes of all textures at their finest levels. Larger textures are halved until all fit, with
    /// a warning. Default: 4 GiB.
    pub texture_bytes: u64,
    /// Bytes of all vertices and indices. A scene that needs more is refused before it is
    /// allocated. Default: 8 GiB.
    pub geometry_bytes: u64,
}

impl Default for MemoryBudget {
    fn default() -> Self {
        Self { texture_bytes: 4 << 30, geometry_bytes: 8 << 30 }
    }
}

/// The progress of loading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LoadProgress {
    /// The current stage: `reading` or `textures`.
    pub stage: &'static str,
    /// The amount done, from 0 to `total`: bytes of the file, or textures.
    pub done: u64,
    /// The total amount.
    pub total: u64,
}

impl<'a> LoadOptions<'a> {
    /// The files that a scene with these folders may name.
    fn reach<'f>(&self, folders: &'f [PathBuf]) -> Reach<'f>
    where
        'a: 'f,
    {
        Reach { anywhere: self.allow_outside, folders, source: self.files }
    }

    fn tell(&mut self, stage: &'static str, done: u64, total: u64) {
        if let Some(progress) = &mut self.progress {
            progress(LoadProgress { stage, done, total });
        }
    }
}

impl std::fmt::Debug for LoadOptions<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LoadOptions")
            .field("allow_outside", &self.allow_outside)
            .field("ignore_required", &self.ignore_required)
            .field("scene", &self.scene)
            .field("up", &self.up)
            .field("unit_m", &self.unit_m)
            .field("crease_rad", &self.crease_rad)
            .field("second_uvs", &self.second_uvs)
            .field("budget", &self.budget)
            .finish_non_exhaustive()
    }
}

impl Scene {
    /// Reads a scene from a file, and validates it: `.gltf` or `.glb` (glTF 2.0), `.obj` with its
    /// materials (Wavefront), `.ply` (Stanford), `.stl` (stereolithography), or the text of the
    /// program VXCT with its models (`.scene`, `.vxct`, `.txt`). Each has a feature of this crate.
    ///
    /// Features of the file that this crate does not support become warnings in [`Scene::notes`]
    /// and in the log.
    ///
    /// # Errors
    /// [`SceneError`] when the file's extension is unknown, its format is left out of this build
    /// ([`SceneError::LeftOut`]), the file or one that it names cannot be read, its content
    /// violates the format, it requires an unsupported extension, or [`Scene::validate`] fails.
    /// Never panics, whatever the bytes.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::load_with(path, &mut LoadOptions::default())
    }

    /// Reads a scene as [`Scene::load`] does, with options.
    ///
    /// # Errors
    /// As [`Scene::load`], and when the file does not have what the options ask for.
    pub fn load_with(
        path: impl AsRef<Path>,
        options: &mut LoadOptions<'_>,
    ) -> Result<Self, SceneError> {
        load(path.as_ref(), options)
    }

    /// Loads a scene whose file is in memory. `name` replaces its path: its extension decides the
    /// format, and messages begin with it. Files that it names are read through
    /// [`LoadOptions::files`], never from the disk; without `files` they do not exist.
    ///
    /// # Errors
    /// As [`Scene::load_with`].
    pub fn from_memory(
        name: &str,
        bytes: &[u8],
        options: &mut LoadOptions<'_>,
    ) -> Result<Self, SceneError> {
        let memory = source::Memory { name, bytes, others: options.files };
        let mut options = LoadOptions {
            allow_outside: options.allow_outside,
            ignore_required: options.ignore_required,
            scene: options.scene.clone(),
            up: options.up,
            unit_m: options.unit_m,
            crease_rad: options.crease_rad,
            second_uvs: options.second_uvs,
            budget: options.budget,
            files: Some(&memory),
            progress: options.progress.as_mut().map(|tell| &mut **tell as _),
        };
        load(Path::new(name), &mut options)
    }
}

/// Whether the scene `file` may name the existing file at `path` without
/// [`LoadOptions::allow_outside`]: its real path, with all links resolved, must be in the scene's
/// folder or below; for VXCT's scenes in a folder `scenes`, in the parent folder or below.
pub fn may_name(file: &Path, path: &Path) -> bool {
    let options = LoadOptions::default();
    let folders = match extension(file).as_str() {
        #[cfg(feature = "vxct")]
        "scene" | "vxct" | "txt" => vxct::folders(file, &options),
        _ => vec![files::folder_of(file)],
    };
    options.reach(&folders).admit(path).is_ok()
}

/// The path's extension in lower case.
fn extension(path: &Path) -> String {
    path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default()
}

fn load(path: &Path, options: &mut LoadOptions<'_>) -> Result<Scene, SceneError> {
    units::check(path, options)?;
    let extension = extension(path);
    let left_out =
        |format, feature| Err(SceneError::LeftOut { file: path.to_owned(), format, feature });
    #[allow(unreachable_patterns, reason = "a build has a format or leaves it out")]
    let loaded = match extension.as_str() {
        #[cfg(feature = "gltf")]
        "gltf" | "glb" => gltf::load(path, options),
        #[cfg(feature = "obj")]
        "obj" => obj::load(path, options),
        #[cfg(feature = "ply")]
        "ply" => ply::load(path, options),
        #[cfg(feature = "stl")]
        "stl" => stl::load(path, options),
        #[cfg(feature = "vxct")]
        "scene" | "vxct" | "txt" => vxct::load(path, options),
        "gltf" | "glb" => left_out("glTF", "gltf"),
        "obj" => left_out("OBJ", "obj"),
        "ply" => left_out("PLY", "ply"),
        "stl" => left_out("STL", "stl"),
        "scene" | "vxct" | "txt" => left_out("scenes of VXCT", "vxct"),
        _ => Err(SceneError::UnknownFormat { file: path.to_owned(), extension }),
    };
    let mut scene = loaded?;
    units::apply(&mut scene, path, options)?;
    origin::tell(&mut scene.notes.warnings, scene.origin);
    if let Some(outlier) = scene.outlier() {
        let warning =
            format!("{outlier}: next to it that is smaller than a voxel; move or remove it");
        scene.notes.warnings.push(warning);
    }
    for warning in &scene.notes.warnings {
        tracing::warn!("{}: {warning}", path.display());
    }
    tracing::info!(
        "{}: {} triangles in {} meshes, {} materials, {} textures, {} lights, {} cameras",
        path.display(),
        scene.triangle_count(),
        scene.meshes.len(),
        scene.materials.len(),
        scene.textures.len(),
        scene.lights.len(),
        scene.cameras.len()
    );
    Ok(scene)
}

/// A list of warnings without duplicates.
#[derive(Clone, Default)]
struct Notes {
    warnings: Vec<String>,
}

impl Notes {
    /// The most warnings that are stored: a hostile file could cause millions.
    const MOST: usize = 100;

    fn warn(&mut self, warning: String) {
        if self.warnings.len() < Self::MOST && !self.warnings.contains(&warning) {
            self.warnings.push(warning);
        }
    }
}
