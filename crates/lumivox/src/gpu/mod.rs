//! Helpers shared by all stages: linked shaders, pipelines created once per device, kernels, prefix
//! sums, recording with timings.

mod bindings;
pub(crate) mod buffers;
mod held;
pub(crate) mod indirect;
mod kernel;
mod late;
pub(crate) mod memory;
mod modules;
mod open;
mod passes;
pub mod pipelines;
mod recorder;
pub(crate) mod resources;
pub(crate) mod scan;
mod slots;
mod texels;
pub(crate) mod variants;

pub use bindings::{BindGroupBuilder, LayoutBuilder};
pub(crate) use buffers::{Staged, counted_buffer};
pub use buffers::{read_buffer, storage_buffer, uniform_buffer, upload};
pub(crate) use indirect::{BoundIndirect, Indirect, Run};
pub use kernel::{Kernel, LINEAR_WORKGROUP_SIZE};
pub(crate) use late::{LastRead, LateReads, OverflowReads, Overflowed};
pub use lumivox_wgsl::{ShaderError, ShaderLibrary};
pub(crate) use memory::{Memory, Remedy};
pub(crate) use modules::{MODULES, implementation};
pub use open::open_device;
pub use passes::{ComputePass, RenderPass};
pub use pipelines::Pipelines;
pub use recorder::{Recorder, StageTime, Timing};
pub use resources::{BindGroup, Buffer, LiveResources, MadeResources, Texture, TextureView};
pub(crate) use resources::{BufferHandle, Kept, ViewHandle, note_wait};
pub(crate) use scan::{BoundScan, Scan};
pub(crate) use slots::{Slot, Slots};
pub(crate) use texels::{TEXEL_COLUMNS, texel_bytes, texels};
pub(crate) use variants::KernelVariants;

/// Defines constants of number formats, and those that Rust and this folder's shaders share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_f32("PI", std::f32::consts::PI)
        .constant_f32("LARGEST_HALF", half::f16::MAX.to_f32())
        .constant_u32("LINEAR_WORKGROUP_SIZE", LINEAR_WORKGROUP_SIZE)
        .constant_u32("MAX_WORKGROUPS", kernel::MAX_WORKGROUPS)
        .constant_u32("TEXEL_COLUMNS", TEXEL_COLUMNS)
        .constant_u32("SCAN_WORKGROUP_SIZE", scan::SCAN_WORKGROUP_SIZE)
        .constant_u32("SCAN_ITEMS", scan::SCAN_ITEMS);
}
