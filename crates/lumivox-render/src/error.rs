//! Typed errors of rendering; the messages include the remedy.

use std::path::PathBuf;

use lumivox::GiError;
use lumivox::gpu::ShaderError;
use lumivox::settings::SettingError;
use lumivox_scene::Scene;

/// An error of the renderer. Every message names the request, the obstacle and a remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// There is no adapter, or none of the requested name.
    #[error("{problem}; {remedy}")]
    Adapter {
        /// The requested adapter, and the available ones.
        problem: String,
        /// The remedy.
        remedy: String,
    },
    /// The adapter has no device with WebGPU's default limits.
    #[error(
        "{adapter} offers no device with WebGPU's default limits: {reason}; choose another adapter"
    )]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// The driver's message.
        reason: String,
    },
    /// The device was lost, ran out of memory, or refused a command.
    #[error("the GPU failed while {doing}: {reason}")]
    Device {
        /// The work that failed.
        doing: &'static str,
        /// The driver's message.
        reason: String,
    },
    /// A resource is larger than the device allows.
    #[error(
        "{what} needs {needed} {unit}, but this device's limit `{limit}` is {available}; {remedy}"
    )]
    Limit {
        /// The resource that does not fit.
        what: String,
        /// The needed amount.
        needed: u64,
        /// The unit of `needed` and `available`.
        unit: &'static str,
        /// The name of the limit.
        limit: &'static str,
        /// The limit's value on this device.
        available: u64,
        /// The size that would fit, or another remedy.
        remedy: String,
    },
    /// The device has too little memory.
    #[error("{what} needs {}; {remedy}", shortage(*needed_mib, *available_mib))]
    OutOfMemory {
        /// The resource that does not fit.
        what: String,
        /// The needed memory in MiB; `None` if it is unknown because the resource grows.
        needed_mib: Option<u64>,
        /// The free memory in MiB; `None` if the driver does not report it (GPU drivers never do).
        available_mib: Option<u64>,
        /// The remedy.
        remedy: String,
    },
    /// None of a scene's triangles becomes a voxel.
    #[error(
        "the scene \"{scene}\" has no triangle that is large enough to be seen in a grid around all {triangles}; {remedy}"
    )]
    NothingToVoxelize {
        /// The scene's name.
        scene: String,
        /// The number of its triangles.
        triangles: u64,
        /// The cause and the remedy.
        remedy: String,
    },
    /// A setting is outside its range.
    #[error("{name} is {value}, but must be {expected}")]
    Setting {
        /// The name of the setting.
        name: &'static str,
        /// Its value.
        value: String,
        /// The allowed values.
        expected: String,
    },
    /// The extension of a picture's file is not that of a supported format.
    #[error(
        "{}: cannot tell the picture's format from the extension \"{extension}\"; end the name \
         with .png (8 bits a channel, tone mapped) or .exr (linear, full range)",
        file.display()
    )]
    UnknownFormat {
        /// The file.
        file: PathBuf,
        /// Its extension; may be empty.
        extension: String,
    },
    /// A picture cannot be written.
    #[error("{}: cannot write the picture: {reason}; check the folder and its permissions", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// The system's message.
        reason: String,
    },
    /// A reference cannot be read.
    #[error("{}: cannot read the reference: {reason}; trace it again", file.display())]
    Reference {
        /// The file.
        file: PathBuf,
        /// The fault.
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
    /// Converts an error of the library; the scene is needed to explain why nothing could be
    /// voxelized.
    pub fn of_scene(error: GiError, scene: &Scene) -> Self {
        let GiError::NothingToVoxelize { triangles, .. } = error else { return Self::Gi(error) };
        let remedy = match scene.outlier() {
            Some(outlier) => format!("{outlier}: move or remove it"),
            None => "check the units and scales of the export".to_owned(),
        };
        Self::NothingToVoxelize { scene: scene.name.clone(), triangles, remedy }
    }
}

/// Describes the needed and the free memory.
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
            format!("{needed}, more than the driver gave; it does not report how much it has")
        }
        (None, None) => {
            format!("{needed} than the driver gave, which does not report how much it has")
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
    fn out_of_memory_errors_state_needed_and_free_memory() {
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
            "a picture needs 900 MiB of GPU memory, more than the driver gave; it does not report \
             how much it has; ask for less"
        );
        assert!(text(None, Some(700)).contains("more GPU memory than the 700 MiB that are free"));
        assert!(text(None, None).contains("more GPU memory than the driver gave, which"));
    }
}
