//! The library's errors, with the remedy in the message.

use lumivox_wgsl::ShaderError;

use crate::settings::SettingError;

/// An error of the library. Every message says what was requested, why it failed and what helps.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GiError {
    /// The device cannot hold or bind something of the requested size.
    #[error(
        "{what} needs {needed} {unit}, but this device's limit `{limit}` is {available}; {remedy}"
    )]
    Limit {
        /// The thing that does not fit.
        what: String,
        /// The needed size.
        needed: u64,
        /// The unit of `needed` and `available`.
        unit: &'static str,
        /// The name of the limit in `wgpu::Limits`.
        limit: &'static str,
        /// The device's limit.
        available: u64,
        /// A size that would fit, or another remedy.
        remedy: String,
    },
    /// Something would take more memory than the caller allows
    /// ([`crate::GiConfig::memory_budget`]).
    #[error("{what} needs {needed} bytes, but {budget} are allowed; {remedy}")]
    Budget {
        /// The thing that does not fit.
        what: String,
        /// The needed bytes.
        needed: u64,
        /// The allowed number of bytes.
        budget: u64,
        /// A remedy.
        remedy: String,
    },
    /// A setting lies outside its range.
    #[error("{name} is {value}, but must be {expected}")]
    Setting {
        /// The name of the setting.
        name: &'static str,
        /// The value of the setting.
        value: String,
        /// The allowed values.
        expected: String,
    },
    /// The geometry contradicts its buffers or materials.
    #[error("{place}: {problem}")]
    Geometry {
        /// Which batch, draw or material.
        place: String,
        /// The fault, and how to correct it.
        problem: String,
    },
    /// There is nothing to voxelize: no triangle, or none with an area.
    #[error(
        "the geometry has no triangle with an area inside the grid ({triangles} given, {skipped} of no area at the grid's scale, or not finite); give at least one"
    )]
    NothingToVoxelize {
        /// Triangles that were given.
        triangles: u64,
        /// Triangles without an area, at the precision of the grid, or with non-finite coordinates.
        skipped: u64,
    },
    /// A shader failed to link or to validate: a bug in this crate or in a shader added by the
    /// caller.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// The device was lost, a buffer could not be mapped, or the device returned an impossible
    /// result.
    #[error("the device failed while {doing}: {reason}")]
    Device {
        /// The operation that failed.
        doing: &'static str,
        /// The driver's message.
        reason: String,
    },
}

impl From<SettingError> for GiError {
    fn from(error: SettingError) -> Self {
        let SettingError { name, expected, got } = error;
        Self::Setting { name, value: got, expected }
    }
}
