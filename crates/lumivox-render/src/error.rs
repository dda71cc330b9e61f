//! What can go wrong in rendering, typed, with the remedy in the message.

use std::path::PathBuf;

use lumivox::GiError;
use lumivox::gpu::ShaderError;
use lumivox::settings::SettingError;
use lumivox_scene::Scene;

/// An error of the renderer. Every message says what was asked, what stands in the way and what
/// would help.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// There is no adapter at all, or none with the name asked for.
    #[error("{problem}; {remedy}")]
    Adapter {
        /// What was looked for, and what there is instead.
        problem: String,
        /// What would help.
        remedy: String,
    },
    /// The adapter does not give a device with WebGPU's default limits.
    #[error(
        "{adapter} offers no device with WebGPU's default limits: {reason}; choose another adapter"
    )]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// What the driver said.
        reason: String,
    },
    /// The device was lost, ran out of memory, or refused a command.
    #[error("the GPU failed while {doing}: {reason}")]
    Device {
        /// What was under way.
        doing: &'static str,
        /// What the driver said.
        reason: String,
    },
    /// Something is larger than the device allows.
    #[error(
        "{what} needs {needed} {unit}, but this device's limit `{limit}` is {available}; {remedy}"
    )]
    Limit {
        /// The thing that does not fit.
        what: String,
        /// How much it needs.
        needed: u64,
        /// The unit of `needed` and `available`.
        unit: &'static str,
        /// The name of the limit.
        limit: &'static str,
        /// What the device offers.
        available: u64,
        /// What would fit, or help.
        remedy: String,
    },
    /// The device has too little memory.
    #[error("{what} needs {}; {remedy}", shortage(*needed_mib, *available_mib))]
    OutOfMemory {
        /// The thing that does not fit.
        what: String,
        /// How much it needs, in MiB; `None` where that shows only while it grows.
        needed_mib: Option<u64>,
        /// How much the device has left, in MiB; `None` where its driver does not tell, as that of no GPU does.
        available_mib: Option<u64>,
        /// What would help.
        remedy: String,
    },
    /// Nothing of a scene becomes a voxel.
    #[error(
        "the scene \"{scene}\" has no triangle that is large enough to be seen in a grid around all {triangles}; {remedy}"
    )]
    NothingToVoxelize {
        /// The scene's name.
        scene: String,
        /// How many triangles it has.
        triangles: u64,
        /// Why that is, and what would help.
        remedy: String,
    },
    /// A setting lies outside its range.
    #[error("{name} is {value}, but must be {expected}")]
    Setting {
        /// The name of the setting.
        name: &'static str,
        /// What it was set to.
        value: String,
        /// What is allowed.
        expected: String,
    },
    /// The extension of a picture's file is none that is written here.
    #[error(
        "{}: cannot tell the picture's format from the extension \"{extension}\"; end the name \
         with .png (8 bits a channel, tone mapped) or .exr (linear, full range)",
        file.display()
    )]
    UnknownFormat {
        /// The file asked for.
        file: PathBuf,
        /// Its extension, maybe empty.
        extension: String,
    },
    /// A picture cannot be written.
    #[error("{}: cannot write the picture: {reason}; check the folder and its permissions", file.display())]
    Write {
        /// The file asked for.
        file: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// A reference cannot be read.
    #[error("{}: cannot read the reference: {reason}; trace it anew", file.display())]
    Reference {
        /// The file.
        file: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// Global illumination failed.
    #[error(transparent)]
    Gi(#[from] GiError),
    /// A shader failed to link or to validate: a defect of this crate.
    #[error(transparent)]
    Shader(#[from] ShaderError),
}

impl RenderError {
    /// An error of the library with the scene that it was met in: what the library cannot know is why there is nothing
    /// to voxelize.
    pub fn of_scene(error: GiError, scene: &Scene) -> Self {
        let GiError::NothingToVoxelize { triangles, .. } = error else { return Self::Gi(error) };
        let remedy = match scene.outlier() {
            Some(outlier) => format!("{outlier}: move or remove it"),
            None => "check the units and scales of the export".to_owned(),
        };
        Self::NothingToVoxelize { scene: scene.name.clone(), triangles, remedy }
    }
}

/// What is needed, and what there is.
fn shortage(needed_mib: Option<u64>, available_mib: Option<u64>) -> String {
    let needed =
        needed_mib.map_or("more GPU memory".to_owned(), |mib| format!("{mib} MiB of GPU memory"));
    match (available_mib, needed_mib) {
        (Some(available), Some(_)) => format!(
            "{needed}, but {available} MiB are free (a software driver takes those of the machine)"
        ),
        (Some(available), None) => format!(
            "{needed} than the {available} MiB that are free (a software driver takes those of the machine)"
        ),
        (None, Some(_)) => {
            format!("{needed}, more than the driver gave; it does not tell how much it has")
        }
        (None, None) => {
            format!("{needed} than the driver gave, which does not tell how much it has")
        }
    }
}

impl From<SettingError> for RenderError {
    fn from(error: SettingError) -> Self {
        let SettingError { name, expected, got } = error;
        Self::Setting { name, value: got, expected }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shortage_tells_what_there_is() {
        let text = |needed_mib, available_mib| {
            let (what, remedy) = ("a picture".to_owned(), "ask for less".to_owned());
            RenderError::OutOfMemory { what, needed_mib, available_mib, remedy }.to_string()
        };
        assert_eq!(
            text(Some(900), Some(700)),
            "a picture needs 900 MiB of GPU memory, but 700 MiB are free (a software driver takes \
             those of the machine); ask for less"
        );
        assert_eq!(
            text(Some(900), None),
            "a picture needs 900 MiB of GPU memory, more than the driver gave; it does not tell how \
             much it has; ask for less"
        );
        assert!(text(None, Some(700)).contains("more GPU memory than the 700 MiB that are free"));
        assert!(text(None, None).contains("more GPU memory than the driver gave, which"));
    }
}
