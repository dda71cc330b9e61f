//! Numbers that the GPU has counted, read back without waiting: a frame or more late.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::gpu::{Buffer, Recorder};

/// Reads under way at once. While all of them are, further ones are left out.
const SLOTS: usize = 4;

const PENDING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

/// A buffer that is read back again and again.
#[derive(Debug)]
pub(crate) struct LateReads {
    slots: Vec<Slot>,
    bytes: u64,
    recorded: u64,
}

#[derive(Debug)]
struct Slot {
    buffer: Buffer,
    /// Shared with the callback, which the encoder drops if it is never submitted.
    state: Option<Arc<AtomicU8>>,
    number: u64,
}

impl LateReads {
    /// For so many bytes at a time.
    pub fn new(device: &wgpu::Device, bytes: u64) -> Self {
        let slot = |_| {
            let descriptor = wgpu::BufferDescriptor {
                label: Some("late read"),
                size: bytes,
                usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            };
            Slot { buffer: Buffer::new(device, &descriptor), state: None, number: 0 }
        };
        Self { slots: (0..SLOTS).map(slot).collect(), bytes, recorded: 0 }
    }

    /// Records a read of parts of buffers, one after another: a buffer, a byte and a number of bytes each.
    pub fn record(&mut self, recorder: &mut Recorder<'_>, sources: &[(&Buffer, u64, u64)]) {
        self.recorded += 1;
        // Slots whose encoder was dropped are free again.
        for slot in &mut self.slots {
            let is_lost = |state: &Arc<AtomicU8>| {
                state.load(Ordering::Acquire) == PENDING && Arc::strong_count(state) == 1
            };
            slot.state.take_if(|state| is_lost(state));
        }
        let Some(slot) = self.slots.iter_mut().find(|slot| slot.state.is_none()) else { return };
        let mut place = 0;
        for (buffer, from, bytes) in sources {
            recorder.copy((*buffer, *from), (&slot.buffer, place), *bytes);
            place += bytes;
        }
        debug_assert_eq!(place, self.bytes);
        let state = Arc::new(AtomicU8::new(PENDING));
        slot.state = Some(state.clone());
        slot.number = self.recorded;
        let done = move |result: Result<(), wgpu::BufferAsyncError>| {
            let now = if result.is_ok() { MAPPED } else { FAILED };
            state.store(now, Ordering::Release);
        };
        recorder.encoder().map_buffer_on_submit(&slot.buffer, wgpu::MapMode::Read, .., done);
    }

    /// The numbers of the last read that is done, if one is that was not before.
    pub fn latest(&mut self, device: &wgpu::Device) -> Option<Vec<u32>> {
        // Does not wait. A device that is lost tells elsewhere.
        let _ = device.poll(wgpu::PollType::Poll);
        let mut latest: Option<(u64, Vec<u32>)> = None;
        for slot in &mut self.slots {
            let state = slot.state.as_ref().map_or(PENDING, |state| state.load(Ordering::Acquire));
            if state == PENDING {
                continue;
            }
            slot.state = None;
            if state == FAILED {
                continue;
            }
            if let Ok(mapped) = slot.buffer.get_mapped_range(..)
                && latest.as_ref().is_none_or(|(number, _)| *number < slot.number)
            {
                latest = Some((slot.number, bytemuck::cast_slice(&mapped).to_vec()));
            }
            slot.buffer.unmap();
        }
        latest.map(|(_, words)| words)
    }
}
