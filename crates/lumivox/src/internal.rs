//! Parts that only Lumivox's own crates use. They may change with every version.

pub use crate::gpu::buffers::{filled_buffer, submitted_work_done};
pub use crate::gpu::indirect::{BoundIndirect, Indirect, Run};
pub use crate::gpu::memory::{Memory, Remedy};
pub use crate::gpu::resources::{BufferHandle, Kept, ViewHandle, note_wait, waits};
pub use crate::gpu::scan::{BoundScan, Scan};
pub use crate::gpu::variants::KernelVariants;
pub use crate::light::TRACES_SHADOWS;
