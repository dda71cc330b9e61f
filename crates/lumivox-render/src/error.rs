//! What can go wrong in rendering, typed, with the remedy in the message.

use std::path::PathBuf;

use lumivox::GiError;
use lumivox::gpu::ShaderError;

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
    #[error(
        "{what} needs {needed_mib} MiB of GPU memory, which the device does not have; {remedy}"
    )]
    OutOfMemory {
        /// The thing that does not fit.
        what: String,
        /// How much it needs, in MiB.
        needed_mib: u64,
        /// What would help.
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
