//! Recording of GPU work, optionally with the time of every pass.
//!
//! GPU timestamps are used where they are reliable. On software adapters they are not (lavapipe
//! takes them when it parses commands, not when it runs them), so every pass is submitted
//! separately and timed by the wall clock there: slower in total, but correct for each pass.
//!
//! An engine can pass its own encoder ([`Recorder::on`]). Then nothing is submitted here, and the
//! encoder keeps the recorded resources until it is submitted.

use std::time::{Duration, Instant};

use crate::GiError;
use crate::gpu::buffers::map_and_copy;
use crate::gpu::held::Held;
use crate::gpu::passes::{ComputePass, RenderPass};
use crate::gpu::{Buffer, BufferHandle, Kept, Texture, note_wait};

/// How a [`Recorder`] measures times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Timing {
    /// No times; everything goes into one command buffer.
    #[default]
    Off,
    /// By timestamps at the boundaries of passes; needs `wgpu::Features::TIMESTAMP_QUERY`.
    Timestamps,
    /// By submitting each pass separately and waiting for it. Not possible in browsers, where
    /// nothing may block.
    SubmitAndWait,
}

impl Timing {
    /// A method that gives correct times on a device.
    pub fn for_device(device: &wgpu::Device) -> Self {
        let is_software = device.adapter_info().device_type == wgpu::DeviceType::Cpu;
        if !is_software && device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            Self::Timestamps
        } else if cfg!(target_arch = "wasm32") {
            Self::Off
        } else {
            Self::SubmitAndWait
        }
    }
}

/// The time that one pass took on the GPU.
#[derive(Clone, Debug, PartialEq)]
pub struct StageTime {
    /// The stage that the pass belongs to, such as `voxelize`.
    pub stage: &'static str,
    /// The pass, such as `voxelize::mark::main`.
    pub pass: String,
    /// The time that it took.
    pub duration: Duration,
}

/// Capacity of one timestamp query set, in passes; later passes are not timed.
const MAX_TIMED_PASSES: u32 = 2048;

/// Records compute and render passes, either into its own command buffers, which it submits, or
/// into a caller's encoder.
///
/// The caller may submit its encoder ([`Self::on`]) at any later time. Until then the encoder keeps
/// all resources that the recorded work uses; dropping the encoder releases them. No times are
/// measured: [`Timing::SubmitAndWait`] would have to submit, and timestamps can only be read after
/// the caller has submitted. An engine can write its own timestamps around the calls.
///
/// ```
/// # let (device, queue) = pollster::block_on(lumivox::gpu::open_device()).expect("a GPU");
/// use lumivox::gpu::{Recorder, storage_buffer};
///
/// let buffer = storage_buffer(&device, "work", 64);
/// let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
/// // The engine's own passes, then Lumivox's, then the engine's again.
/// Recorder::on(&device, &queue, &mut encoder).clear(&buffer);
/// drop(buffer);
/// queue.submit([encoder.finish()]);
/// ```
#[derive(Debug)]
pub struct Recorder<'a> {
    device: wgpu::Device,
    queue: wgpu::Queue,
    target: Target<'a>,
    timing: Timing,
    stage: &'static str,
    queries: Option<wgpu::QuerySet>,
    times: Vec<StageTime>,
}

/// The encoder that work is recorded into.
#[derive(Debug)]
enum Target<'a> {
    Own { encoder: wgpu::CommandEncoder, held: Held },
    Lent(Lent<'a>),
}

/// A caller's encoder.
#[derive(Debug)]
struct Lent<'a> {
    encoder: &'a mut wgpu::CommandEncoder,
    held: Held,
}

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        std::mem::take(&mut self.held).hand_to(self.encoder);
    }
}

impl Target<'_> {
    fn parts(&mut self) -> (&mut wgpu::CommandEncoder, &mut Held) {
        match self {
            Self::Own { encoder, held } => (encoder, held),
            Self::Lent(Lent { encoder, held }) => (encoder, held),
        }
    }

    /// Submits its own encoder; does nothing for a caller's encoder.
    fn submit(self, queue: &wgpu::Queue) {
        if let Self::Own { encoder, held } = self {
            queue.submit([encoder.finish()]);
            drop(held);
        }
    }
}

impl Recorder<'static> {
    /// A recorder without timing.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self::with_timing(device, queue, Timing::Off)
    }

    /// A recorder with this kind of timing; [`Timing::for_device`] chooses one for a device.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// use lumivox::gpu::{Recorder, Timing};
    ///
    /// let mut recorder = Recorder::with_timing(&device, &queue, Timing::SubmitAndWait);
    /// recorder.stage("clouds");
    /// recorder.compute("shape", |_pass| ());
    /// recorder.compute("light", |_pass| ());
    /// let times = recorder.finish().await?;
    /// assert_eq!((times[1].stage, times[1].pass.as_str()), ("clouds", "light"));
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    pub fn with_timing(device: &wgpu::Device, queue: &wgpu::Queue, timing: Timing) -> Self {
        let queries = (timing == Timing::Timestamps).then(|| {
            device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("stage times"),
                ty: wgpu::QueryType::Timestamp,
                count: 2 * MAX_TIMED_PASSES,
            })
        });
        let target = Target::Own { encoder: new_encoder(device), held: Held::default() };
        Self { timing, queries, ..Self::into_target(device, queue, target) }
    }
}

impl<'a> Recorder<'a> {
    /// A recorder into a caller's encoder, which the caller submits. It measures no times.
    pub fn on(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &'a mut wgpu::CommandEncoder,
    ) -> Self {
        let lent = Lent { encoder, held: Held::default() };
        Self::into_target(device, queue, Target::Lent(lent))
    }

    fn into_target(device: &wgpu::Device, queue: &wgpu::Queue, target: Target<'a>) -> Self {
        Self {
            device: device.clone(),
            queue: queue.clone(),
            target,
            timing: Timing::Off,
            stage: "other",
            queries: None,
            times: Vec::new(),
        }
    }

    /// The device of the recorded work.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The queue of the recorded work.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// Copies bytes from one buffer to another.
    pub fn copy(
        &mut self,
        (from, from_byte): (&impl BufferHandle, u64),
        (to, to_byte): (&impl BufferHandle, u64),
        bytes: u64,
    ) {
        let (encoder, held) = self.target.parts();
        encoder.copy_buffer_to_buffer(from.raw(), from_byte, to.raw(), to_byte, bytes);
        held.keep(from.kept().into_iter().chain(to.kept()));
    }

    /// Copies a 2D texture to the rows from `row` on of another of the same width and format.
    pub(crate) fn copy_rows(&mut self, from: &Texture, (to, row): (&Texture, u32)) {
        let (encoder, held) = self.target.parts();
        let origin = wgpu::Origin3d { x: 0, y: row, z: 0 };
        let target = wgpu::TexelCopyTextureInfo { origin, ..to.as_image_copy() };
        encoder.copy_texture_to_texture(from.as_image_copy(), target, from.size());
        held.keep([from, to].map(|texture| Kept::Texture(texture.clone())));
    }

    /// Copies a 2D texture to another of the same size and format.
    pub fn copy_texture(&mut self, from: &Texture, to: &Texture) {
        let (encoder, held) = self.target.parts();
        encoder.copy_texture_to_texture(from.as_image_copy(), to.as_image_copy(), from.size());
        held.keep([from, to].map(|texture| Kept::Texture(texture.clone())));
    }

    /// Fills a buffer with zeros.
    pub fn clear(&mut self, buffer: &impl BufferHandle) {
        let (encoder, held) = self.target.parts();
        encoder.clear_buffer(buffer.raw(), 0, None);
        held.keep(buffer.kept());
    }

    /// Keeps a resource from being destroyed before submission, for commands that were not recorded
    /// through this object and its passes.
    pub fn keep(&mut self, kept: Kept) {
        self.target.parts().1.keep([kept]);
    }

    /// The encoder, for commands without timing: copies, clears, an engine's own passes. Their
    /// resources must be kept until submission ([`Self::keep`]).
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        self.target.parts().0
    }

    /// Assigns the following passes to the stage `name`.
    pub fn stage(&mut self, name: &'static str) {
        self.stage = name;
    }

    /// Records a compute pass.
    pub fn compute(&mut self, label: &str, record: impl FnOnce(&mut ComputePass<'_>)) {
        let start = self.begin_pass();
        let slot = self.timestamp_slot();
        {
            let timestamp_writes = self.queries.as_ref().zip(slot).map(|(query_set, slot)| {
                wgpu::ComputePassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: Some(slot),
                    end_of_pass_write_index: Some(slot + 1),
                }
            });
            let (encoder, held) = self.target.parts();
            let pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(label),
                timestamp_writes,
            });
            record(&mut ComputePass { pass, held });
        }
        self.end_pass(label, start);
    }

    /// Records a render pass.
    pub fn render(
        &mut self,
        label: &str,
        colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
        depth: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
        record: impl FnOnce(&mut RenderPass<'_>),
    ) {
        let start = self.begin_pass();
        let slot = self.timestamp_slot();
        {
            let timestamp_writes = self.queries.as_ref().zip(slot).map(|(query_set, slot)| {
                wgpu::RenderPassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: Some(slot),
                    end_of_pass_write_index: Some(slot + 1),
                }
            });
            let (encoder, held) = self.target.parts();
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(label),
                color_attachments: colors,
                depth_stencil_attachment: depth,
                timestamp_writes,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            record(&mut RenderPass { pass, held });
        }
        self.end_pass(label, start);
    }

    /// Submits the recorded work and continues recording. Does nothing on a caller's encoder.
    pub fn flush(&mut self) {
        if let Target::Own { encoder, held } = &mut self.target {
            let encoder = std::mem::replace(encoder, new_encoder(&self.device));
            self.queue.submit([encoder.finish()]);
            held.clear();
        }
    }

    /// Submits the recorded work; times are discarded. Does nothing on a caller's encoder, which
    /// the caller submits.
    pub fn submit(self) {
        self.target.submit(&self.queue);
    }

    /// Submits the recorded work; if times are measured, waits for it and returns them in order. On
    /// a caller's encoder there are no times, and the caller submits.
    ///
    /// # Errors
    /// [`GiError::Device`] if the device is lost.
    pub async fn finish(mut self) -> Result<Vec<StageTime>, GiError> {
        let Some(queries) = self.queries.take().filter(|_| !self.times.is_empty()) else {
            self.target.submit(&self.queue);
            return Ok(self.times);
        };
        let count = 2 * self.times.len() as u32;
        let bytes = u64::from(count) * size_of::<u64>() as u64;
        let buffer = |usage| {
            let label = Some("stage times");
            let mapped_at_creation = false;
            let descriptor =
                wgpu::BufferDescriptor { label, size: bytes, usage, mapped_at_creation };
            Buffer::new(&self.device, &descriptor)
        };
        let resolved = buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
        let staging = buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        let (encoder, _) = self.target.parts();
        encoder.resolve_query_set(&queries, 0..count, &resolved, 0);
        encoder.copy_buffer_to_buffer(&resolved, 0, &staging, 0, bytes);
        self.target.submit(&self.queue);
        let ticks: Vec<u64> = map_and_copy(&self.device, &staging).await?;
        let nanos_per_tick = f64::from(self.queue.get_timestamp_period());
        for (time, pair) in self.times.iter_mut().zip(ticks.chunks_exact(2)) {
            let nanos = pair[1].saturating_sub(pair[0]) as f64 * nanos_per_tick;
            time.duration = Duration::from_nanos(nanos as u64);
        }
        Ok(self.times)
    }

    fn begin_pass(&mut self) -> Option<Instant> {
        (self.timing == Timing::SubmitAndWait).then(|| {
            self.flush();
            self.wait();
            Instant::now()
        })
    }

    fn end_pass(&mut self, label: &str, start: Option<Instant>) {
        let duration = match self.timing {
            Timing::Off => return,
            Timing::Timestamps if self.times.len() as u32 >= MAX_TIMED_PASSES => return,
            Timing::Timestamps => Duration::ZERO,
            Timing::SubmitAndWait => {
                self.flush();
                self.wait();
                start.map_or(Duration::ZERO, |start| start.elapsed())
            }
        };
        self.times.push(StageTime { stage: self.stage, pass: label.to_owned(), duration });
    }

    fn timestamp_slot(&self) -> Option<u32> {
        let index = self.times.len() as u32;
        (self.queries.is_some() && index < MAX_TIMED_PASSES).then_some(2 * index)
    }

    fn wait(&self) {
        note_wait();
        if let Err(error) = self.device.poll(wgpu::PollType::wait_indefinitely()) {
            tracing::warn!("a stage's time is wrong: waiting for the device failed: {error}");
        }
    }
}

fn new_encoder(device: &wgpu::Device) -> wgpu::CommandEncoder {
    device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("lumivox") })
}
