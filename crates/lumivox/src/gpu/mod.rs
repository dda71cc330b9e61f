//! Helpers shared by all stages: linked shaders, pipelines created once per device, kernels, prefix
//! sums, recording with timings.

mod bindings;
mod buffers;
mod held;
mod indirect;
mod kernel;
mod late;
mod memory;
mod open;
mod passes;
pub mod pipelines;
mod recorder;
mod resources;
mod scan;
mod slots;

pub use bindings::{BindGroupBuilder, LayoutBuilder};
pub(crate) use buffers::{Staged, counted_buffer};
pub use buffers::{
    filled_buffer, read_buffer, storage_buffer, submitted_work_done, uniform_buffer, upload,
};
pub use indirect::{BoundIndirect, Indirect, Run};
pub(crate) use kernel::MAX_WORKGROUPS;
pub use kernel::{Kernel, LINEAR_WORKGROUP_SIZE};
pub(crate) use late::{LastRead, LateReads, OverflowReads, Overflowed};
pub use lumivox_wgsl::{ShaderError, ShaderLibrary};
pub use memory::{Memory, Remedy};
pub use open::open_device;
pub use passes::{ComputePass, RenderPass};
pub use pipelines::Pipelines;
pub use recorder::{Recorder, StageTime, Timing};
pub use resources::{
    BindGroup, Buffer, BufferHandle, Kept, LiveResources, MadeResources, Texture, TextureView,
    ViewHandle, note_wait, waits,
};
pub use scan::{BoundScan, Scan};
pub(crate) use scan::{SCAN_ITEMS, SCAN_WORKGROUP_SIZE};
pub(crate) use slots::{Slot, Slots};
