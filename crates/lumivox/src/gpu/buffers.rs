//! Buffers: creation, upload, and read-back (without blocking in browsers).

use bytemuck::Pod;

use crate::GiError;
#[cfg(not(target_arch = "wasm32"))]
use crate::gpu::note_wait;
use crate::gpu::{Buffer, Recorder};

/// A zeroed storage buffer for at least one element, since WebGPU does not allow empty bindings. It
/// supports copies in both directions, and arguments of indirect dispatches.
pub fn storage_buffer(device: &wgpu::Device, label: &str, bytes: u64) -> Buffer {
    let descriptor = wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.max(16).next_multiple_of(4),
        usage: wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::COPY_SRC
            | wgpu::BufferUsages::COPY_DST
            | wgpu::BufferUsages::INDIRECT,
        mapped_at_creation: false,
    };
    Buffer::new(device, &descriptor)
}

/// A zeroed buffer for counts that the GPU writes and then reads as uniforms and arguments of
/// dispatches.
pub(crate) fn counted_buffer(device: &wgpu::Device, label: &str, bytes: u64) -> Buffer {
    let descriptor = wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes,
        usage: wgpu::BufferUsages::STORAGE
            | wgpu::BufferUsages::UNIFORM
            | wgpu::BufferUsages::INDIRECT
            | wgpu::BufferUsages::COPY_SRC
            | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    };
    Buffer::new(device, &descriptor)
}

/// Number of recordings whose content a [`Staged`] buffer stores separately; must exceed the number
/// of recordings before one of them is submitted.
const STAGES: u64 = 4;

/// A storage or uniform buffer that each recording sets; recordings that are not submitted yet keep
/// their own content.
#[derive(Debug)]
pub(crate) struct Staged {
    buffer: Buffer,
    stages: Buffer,
    next: u64,
    /// `false` if the device was already lost: `Queue::write_buffer` would panic then.
    exists: bool,
}

impl Staged {
    /// Creates a buffer of `bytes` bytes.
    pub fn new(device: &wgpu::Device, label: &str, bytes: u64) -> Self {
        let buffer = counted_buffer(device, label, bytes.max(16));
        let descriptor = wgpu::BufferDescriptor {
            label: Some("stages of a buffer"),
            size: STAGES * buffer.size(),
            usage: wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: true,
        };
        let stages = Buffer::new(device, &descriptor);
        let exists = stages.get_mapped_range_mut(..).is_ok();
        if exists {
            stages.unmap();
        }
        Self { stages, buffer, next: 0, exists }
    }

    /// The buffer that shaders read.
    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// Sets the first bytes for later commands.
    pub fn set(&mut self, recorder: &mut Recorder<'_>, bytes: &[u8]) {
        if !self.exists {
            return;
        }
        let place = self.next * self.buffer.size();
        recorder.queue().write_buffer(&self.stages, place, bytes);
        recorder.copy((&self.stages, place), (&self.buffer, 0), bytes.len() as u64);
        self.next = (self.next + 1) % STAGES;
    }
}

/// A uniform buffer with the given content, which `Queue::write_buffer` can change.
pub fn uniform_buffer<T: Pod>(device: &wgpu::Device, label: &str, content: &T) -> Buffer {
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
    filled_buffer(device, label, bytemuck::bytes_of(content), usage)
}

/// A buffer with the given content, which must not be empty. On a lost device it has no content,
/// whereas wgpu's own `create_buffer_init` panics.
pub fn filled_buffer(
    device: &wgpu::Device,
    label: &str,
    content: &[u8],
    usage: wgpu::BufferUsages,
) -> Buffer {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: (content.len() as u64).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT),
        usage,
        mapped_at_creation: true,
    });
    if let Ok(mut mapped) = buffer.get_mapped_range_mut(..) {
        mapped.slice(..content.len()).copy_from_slice(content);
        drop(mapped);
        buffer.unmap();
    }
    Buffer::own(buffer)
}

/// A storage buffer with the given content; an empty slice creates a buffer of 16 zero bytes.
pub fn upload<T: Pod>(device: &wgpu::Device, label: &str, content: &[T]) -> Buffer {
    if content.is_empty() {
        return storage_buffer(device, label, 16);
    }
    let usage =
        wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
    filled_buffer(device, label, bytemuck::cast_slice(content), usage)
}

/// Reads the content of `buffer` (which needs `COPY_SRC`) as values of `T`, after all work
/// submitted so far is done.
///
/// On the web the browser's event loop completes the future; elsewhere the future polls the device
/// itself.
///
/// ```
/// # pollster::block_on(async {
/// # let (device, queue) = lumivox::gpu::open_device().await?;
/// use lumivox::gpu::{read_buffer, upload};
///
/// let buffer = upload(&device, "numbers", &[1_u32, 2, 3, 4]);
/// let read: Vec<u32> = read_buffer(&device, &queue, &buffer, 4..12).await?;
/// assert_eq!(read, [2, 3]);
/// # Ok::<(), lumivox::GiError>(())
/// # }).unwrap();
/// ```
///
/// # Errors
/// [`GiError::Device`] if the device is lost.
pub async fn read_buffer<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
    bytes: std::ops::Range<u64>,
) -> Result<Vec<T>, GiError> {
    let size = bytes.end - bytes.start;
    let descriptor = wgpu::BufferDescriptor {
        label: Some("readback"),
        size,
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    };
    let staging = Buffer::new(device, &descriptor);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(buffer, bytes.start, &staging, 0, size);
    queue.submit([encoder.finish()]);
    map_and_copy(device, &staging).await
}

/// Maps a whole staging buffer and copies its content.
pub(crate) async fn map_and_copy<T: Pod>(
    device: &wgpu::Device,
    staging: &wgpu::Buffer,
) -> Result<Vec<T>, GiError> {
    let fail = |reason: String| GiError::Device { doing: "reading a buffer back", reason };
    let (sender, receiver) = oneshot();
    staging.map_async(wgpu::MapMode::Read, .., move |result| sender.send(result));
    #[cfg(not(target_arch = "wasm32"))]
    {
        note_wait();
        device.poll(wgpu::PollType::wait_indefinitely()).map_err(|e| fail(e.to_string()))?;
    }
    #[cfg(target_arch = "wasm32")]
    let _ = device;
    receiver.await.map_err(|e| fail(e.to_string()))?;
    let mapped = staging.get_mapped_range(..).map_err(|e| fail(e.to_string()))?;
    let mut values = vec![T::zeroed(); mapped.len() / size_of::<T>()];
    bytemuck::cast_slice_mut(&mut values).copy_from_slice(&mapped);
    drop(mapped);
    staging.unmap();
    Ok(values)
}

/// Waits until a queue has finished all submitted work. Except in browsers, the device must be
/// polled.
pub async fn submitted_work_done(queue: &wgpu::Queue) {
    let (sender, receiver) = oneshot();
    queue.on_submitted_work_done(move || sender.send(()));
    receiver.await;
}

/// A channel by which a callback delivers one value to a future.
fn oneshot<T: Send + 'static>() -> (Sender<T>, Receiver<T>) {
    let shared = std::sync::Arc::new(std::sync::Mutex::new(Slot { value: None, waker: None }));
    (Sender(shared.clone()), Receiver(shared))
}

struct Slot<T> {
    value: Option<T>,
    waker: Option<std::task::Waker>,
}

struct Sender<T>(std::sync::Arc<std::sync::Mutex<Slot<T>>>);

impl<T> Sender<T> {
    fn send(self, value: T) {
        let mut slot = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        slot.value = Some(value);
        if let Some(waker) = slot.waker.take() {
            waker.wake();
        }
    }
}

struct Receiver<T>(std::sync::Arc<std::sync::Mutex<Slot<T>>>);

impl<T> Future for Receiver<T> {
    type Output = T;

    fn poll(
        self: std::pin::Pin<&mut Self>,
        context: &mut std::task::Context<'_>,
    ) -> std::task::Poll<T> {
        let mut slot = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(value) = slot.value.take() {
            return std::task::Poll::Ready(value);
        }
        slot.waker = Some(context.waker().clone());
        std::task::Poll::Pending
    }
}
