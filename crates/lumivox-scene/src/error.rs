//! The errors of scenes: each names the fault, its place, and a remedy.

use std::path::PathBuf;

/// An error in loading, making or saving a scene. Each message names the file (or the scene), the
/// part of it, and a remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file's extension does not belong to a known format.
    #[error(
        "{}: cannot tell the format from the extension \"{extension}\"; {}",
        file.display(), readable()
    )]
    UnknownFormat {
        /// The file.
        file: PathBuf,
        /// Its extension in lower case; may be empty.
        extension: String,
    },

    /// The format's feature is disabled in this build.
    #[error(
        "{}: this build does not read {format}; build it with the feature {feature} of lumivox-scene, \
         or convert the file with a program that reads it (lumivox convert)",
        file.display()
    )]
    LeftOut {
        /// The file asked for.
        file: PathBuf,
        /// Its format.
        format: &'static str,
        /// The feature of this crate that reads it.
        feature: &'static str,
    },

    /// There is no built-in scene of that name.
    #[error("no built-in scene is called \"{name}\"; there are: {}", known.join(", "))]
    UnknownBuiltin {
        /// The name.
        name: String,
        /// The names of the built-in scenes.
        known: Vec<&'static str>,
    },

    /// The file itself cannot be read.
    #[error("{}: cannot read the file: {source}; check the path and its permissions", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },

    /// A file that the scene names cannot be read.
    #[error(
        "{}: {part} names the file {}, which cannot be read: {source}; \
         put it beside the scene or re-export with everything embedded",
        file.display(), missing.display()
    )]
    ReadExternal {
        /// The scene's file.
        file: PathBuf,
        /// The part that names the other file, such as `buffer 0`.
        part: String,
        /// The path of the other file.
        missing: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },

    /// A file that the scene names is outside the folders that scenes may read.
    #[error(
        "{}: {part} names \"{uri}\": {reason}; scenes may only name files in their own folder \
         and below: copy it there, or allow others to a scene that you trust (--allow-outside)",
        file.display()
    )]
    RefusedUri {
        /// The scene's file.
        file: PathBuf,
        /// The part that names the other file.
        part: String,
        /// The path or URI that it names, shortened.
        uri: String,
        /// The reason for the refusal.
        reason: String,
    },

    /// The file is not what its name says: an archive, a web page, a pointer.
    #[error("{}: {kind}", file.display())]
    OtherKind {
        /// The file.
        file: PathBuf,
        /// The actual kind of the file, and the remedy.
        kind: &'static str,
    },

    /// The content violates the format.
    #[error("{}: {part} is malformed: {reason}; re-export the scene", file.display())]
    Malformed {
        /// The scene's file.
        file: PathBuf,
        /// The broken part, such as `accessor 3`.
        part: String,
        /// The fault.
        reason: String,
    },

    /// A text violates its grammar.
    #[error("{}:{line}:{column}: found {found}, expected {expected}", file.display())]
    Syntax {
        /// The scene's file.
        file: PathBuf,
        /// The line, from 1.
        line: u32,
        /// The character in the line, from 1.
        column: u32,
        /// The text at that place.
        found: String,
        /// The expected text.
        expected: String,
    },

    /// The file is glTF of another version.
    #[error("{}: is glTF {version}, but only glTF 2.0 is read; {remedy}", file.display())]
    Version {
        /// The scene's file.
        file: PathBuf,
        /// The file's version.
        version: String,
        /// The remedy.
        remedy: &'static str,
    },

    /// The file requires an extension that is not supported.
    #[error(
        "{}: requires the glTF extension {}, which is not supported; re-export without it, or see \
         what is left without it (--ignore-required); supported: {}",
        file.display(), extensions.join(", "), supported.join(", ")
    )]
    RequiredExtension {
        /// The scene's file.
        file: PathBuf,
        /// The extensions that are required and missing.
        extensions: Vec<String>,
        /// The extensions that are understood.
        supported: Vec<&'static str>,
    },

    /// A texture cannot be encoded.
    #[error("{}: {image} cannot be saved as PNG: {reason}; replace it", file.display())]
    Image {
        /// The file to be written.
        file: PathBuf,
        /// The texture.
        image: String,
        /// The fault.
        reason: String,
    },

    /// A picture cannot be the surroundings of a scene.
    #[error("{}: cannot be an environment map: {reason}; {remedy}", file.display())]
    EnvironmentMap {
        /// The picture's file.
        file: PathBuf,
        /// The fault.
        reason: String,
        /// The remedy.
        remedy: &'static str,
    },

    /// The scene needs more memory than its budget.
    #[error(
        "{}: with {part} vertices and indices need {needed}, but the budget is {budget}; raise the \
         budget for geometry or simplify the scene",
        file.display()
    )]
    TooLarge {
        /// The scene's file.
        file: PathBuf,
        /// The part that exceeds the budget.
        part: String,
        /// The memory that all parts up to this one need, with a unit.
        needed: String,
        /// The budget, with a unit.
        budget: String,
    },

    /// A number is NaN or infinite.
    #[error("{}: {part} has a number that is not finite; repair it in the modelling program", file.display())]
    NotFinite {
        /// The scene's file or name.
        file: PathBuf,
        /// The part, such as `mesh "wall", position 7`.
        part: String,
    },

    /// A number is outside its range.
    #[error("{}: {part} is {value}, but must be {expected}; correct it", file.display())]
    OutOfRange {
        /// The scene's file or name.
        file: PathBuf,
        /// The part.
        part: String,
        /// The value in the file.
        value: String,
        /// The allowed values.
        expected: String,
    },

    /// An index is out of range.
    #[error(
        "{}: {part} is {index}, but there are only {count} {target}; re-export the scene",
        file.display()
    )]
    IndexOutOfRange {
        /// The scene's file or name.
        file: PathBuf,
        /// The part that holds the index.
        part: String,
        /// The index.
        index: usize,
        /// The number of things that it could point at.
        count: usize,
        /// The kind of these things, such as `vertices`.
        target: &'static str,
    },

    /// The file cannot be written.
    #[error(
        "{}: cannot write the file: {source}; check the folder, its permissions and its free space",
        file.display()
    )]
    Write {
        /// The file to be written.
        file: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },

    /// The scene is too large for the format.
    #[error(
        "{}: the scene takes {bytes} bytes, but a GLB file holds at most {}; \
         save it in parts or with smaller textures",
        file.display(), u32::MAX
    )]
    TooLargeToSave {
        /// The file to be written.
        file: PathBuf,
        /// The size of the file that the scene would need.
        bytes: u64,
    },

    /// The scene has nothing to show.
    #[error(
        "{}: no triangles to show ({reason}); export at least one mesh with triangles in the \
         default scene",
        file.display()
    )]
    NoTriangles {
        /// The scene's file or name.
        file: PathBuf,
        /// The reason.
        reason: String,
    },

    /// All vertices are at one point.
    #[error(
        "{}: the scene has size zero, all of it lies at {point}; check the export for its units, \
         its scales, and numbers that are not finite",
        file.display()
    )]
    ZeroSize {
        /// The scene's file or name.
        file: PathBuf,
        /// The point of all vertices.
        point: String,
    },

    /// The file has no such scene.
    #[error(
        "{}: has no scene \"{wanted}\"; give one by name or number: {}",
        file.display(), list(known)
    )]
    UnknownScene {
        /// The scene's file.
        file: PathBuf,
        /// The requested name or number.
        wanted: String,
        /// The scenes that exist, each with number and name.
        known: Vec<String>,
    },

    /// The scene has no such animation.
    #[error("{}: has no animation {index}; there are: {}", file.display(), list(known))]
    UnknownAnimation {
        /// The scene's file or name.
        file: PathBuf,
        /// The requested number.
        index: usize,
        /// The names of the animations.
        known: Vec<String>,
    },

    /// An animation hides everything at this time.
    #[error(
        "{}: nothing is visible at {time_s} s, all meshes are scaled to nothing; choose another \
         time or animation",
        file.display()
    )]
    NothingAtTime {
        /// The scene's file or name.
        file: PathBuf,
        /// The requested time, in seconds.
        time_s: f32,
    },
}

/// The readable formats, for the error about an unknown format.
fn readable() -> String {
    if crate::EXTENSIONS.is_empty() {
        return "this build reads no files, turn on a feature of lumivox-scene such as gltf"
            .to_owned();
    }
    format!("give a {} file", crate::extensions_in_words())
}

/// Lists names in a message, shortened: a file may have thousands.
fn list(names: &[String]) -> String {
    const MOST: usize = 20;
    if names.is_empty() {
        return "none".to_owned();
    }
    if names.len() <= MOST {
        return names.join(", ");
    }
    format!("{} and {} more", names[..MOST].join(", "), names.len() - MOST)
}
