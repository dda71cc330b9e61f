//! Non-blocking read-backs of numbers counted by the GPU: a frame or more late.

use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

use crate::gpu::{Buffer, Recorder};

/// Maximum number of reads in progress. While all slots are in use, further reads are skipped.
const SLOTS: usize = 4;

const PENDING: u8 = 0;
const MAPPED: u8 = 1;
const FAILED: u8 = 2;

/// Repeated read-backs of the same number of bytes.
#[derive(Debug, Default)]
pub(crate) struct LateReads {
    /// Created by the first read.
    slots: Vec<Slot>,
    /// The number of the last recorded read.
    recorded: u64,
    /// The number of the newest read that [`Self::latest`] has returned.
    returned: u64,
}

/// State of the last recorded read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LastRead {
    /// In progress, or skipped while earlier reads are still in progress.
    Pending,
    /// The read will not arrive: it was skipped, its encoder was dropped, or it has failed.
    Lost,
    /// The numbers have arrived.
    Done,
}

#[derive(Debug)]
struct Slot {
    buffer: Buffer,
    /// State shared with the callback, which is dropped with an encoder that is never submitted.
    state: Option<Arc<AtomicU8>>,
    number: u64,
}

impl Slot {
    /// `None` if the device is lost: mapping the buffer would be an error.
    fn new(device: &wgpu::Device, bytes: u64) -> Option<Self> {
        let descriptor = wgpu::BufferDescriptor {
            label: Some("late read"),
            size: bytes,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: true,
        };
        let buffer = Buffer::new(device, &descriptor);
        buffer.get_mapped_range_mut(..).ok()?;
        buffer.unmap();
        Some(Self { buffer, state: None, number: 0 })
    }

    fn is_mapped(&self) -> bool {
        self.state.as_ref().is_some_and(|state| state.load(Ordering::Acquire) == MAPPED)
    }

    /// Whether the callback is pending and its encoder was not dropped.
    fn is_under_way(&self) -> bool {
        self.state.as_ref().is_some_and(|state| {
            state.load(Ordering::Acquire) == PENDING && Arc::strong_count(state) > 1
        })
    }
}

impl LateReads {
    /// Records a read of parts of buffers, concatenated: a buffer, an offset and a size in bytes
    /// for each part.
    pub fn record(&mut self, recorder: &mut Recorder<'_>, sources: &[(&Buffer, u64, u64)]) {
        self.recorded += 1;
        let bytes = sources.iter().map(|source| source.2).sum();
        if self.slots.is_empty() {
            let slots = (0..SLOTS).filter_map(|_| Slot::new(recorder.device(), bytes));
            self.slots.extend(slots);
        }
        // Slots with dropped encoders are free again.
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
        debug_assert_eq!(place, slot.buffer.size());
        let state = Arc::new(AtomicU8::new(PENDING));
        slot.state = Some(state.clone());
        slot.number = self.recorded;
        let done = move |result: Result<(), wgpu::BufferAsyncError>| {
            let now = if result.is_ok() { MAPPED } else { FAILED };
            state.store(now, Ordering::Release);
        };
        recorder.encoder().map_buffer_on_submit(&slot.buffer, wgpu::MapMode::Read, .., done);
    }

    /// The numbers of the newest finished read, unless a newer read was returned before.
    ///
    /// Reads can finish out of order: a thread that polls the device calls the callbacks after it
    /// has released the device's locks, so another thread may call the callbacks of a later
    /// submission first.
    pub fn latest(&mut self, device: &wgpu::Device) -> Option<Vec<u32>> {
        // Does not wait. A lost device is reported elsewhere.
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
            // If the device is lost meanwhile, the buffer is destroyed, and unmapping it would be
            // an error.
            let Ok(mapped) = slot.buffer.get_mapped_range(..) else { continue };
            let newest = latest.as_ref().map_or(self.returned, |(number, _)| *number);
            if slot.number > newest {
                latest = Some((slot.number, bytemuck::cast_slice(&mapped).to_vec()));
            }
            drop(mapped);
            slot.buffer.unmap();
        }
        latest.map(|(number, words)| {
            self.returned = number;
            words
        })
    }

    /// State of the last recorded read, and the numbers that [`Self::latest`] would return now. The
    /// caller must poll the device first.
    pub fn peek(&self) -> (LastRead, Option<Vec<u32>>) {
        let mapped = self.slots.iter().filter(|slot| slot.is_mapped());
        let newest =
            mapped.max_by_key(|slot| slot.number).filter(|slot| slot.number > self.returned);
        let last = if newest.map_or(self.returned, |slot| slot.number) == self.recorded {
            LastRead::Done
        } else if self.slots.iter().any(Slot::is_under_way) {
            LastRead::Pending
        } else {
            LastRead::Lost
        };
        let words = newest.and_then(|slot| {
            let mapped = slot.buffer.get_mapped_range(..).ok()?;
            Some(bytemuck::cast_slice(&mapped).to_vec())
        });
        (last, words)
    }
}

/// Read-backs of the counts of passes that do nothing on overflow. The first word is nonzero then.
#[derive(Debug, Default)]
pub(crate) struct OverflowReads {
    reads: LateReads,
    /// `true` if the last counts from [`Self::latest`] show no overflow.
    fits: bool,
}

/// Whether the passes of [`OverflowReads`] have overflowed, by the finished read-backs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Overflowed {
    /// `true` after an overflow, and until a read has finished.
    pub is_late: bool,
    /// `true` if the last read has not arrived; `is_late` then describes an earlier one.
    pub is_pending: bool,
}

impl OverflowReads {
    /// Records a read, as [`LateReads::record`].
    pub fn record(&mut self, recorder: &mut Recorder<'_>, sources: &[(&Buffer, u64, u64)]) {
        self.reads.record(recorder, sources);
    }

    /// The newest counts, as [`LateReads::latest`].
    pub fn latest(&mut self, device: &wgpu::Device) -> Option<Vec<u32>> {
        let words = self.reads.latest(device)?;
        self.fits = words[0] == 0;
        Some(words)
    }

    /// `true` if the last counts from [`Self::latest`] show an overflow, or there are none.
    pub fn is_late(&self) -> bool {
        !self.fits
    }

    /// The state by the finished reads, and the counts that [`Self::latest`] would return. The
    /// caller must poll the device first.
    pub fn peek(&self) -> (Overflowed, Option<Vec<u32>>) {
        let (last, words) = self.reads.peek();
        let is_late = match (last, &words) {
            (LastRead::Lost, _) => true,
            (_, Some(words)) => words[0] != 0,
            (_, None) => self.is_late(),
        };
        (Overflowed { is_late, is_pending: last == LastRead::Pending }, words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{open_device, storage_buffer};
    use crate::testing::device;

    /// A buffer with one word, which is read back.
    struct Word {
        device: crate::gpu::Pipelines,
        queue: wgpu::Queue,
        buffer: Buffer,
        reads: LateReads,
    }

    impl Word {
        fn new() -> Self {
            Self::on(device())
        }

        fn on((device, queue): (crate::gpu::Pipelines, wgpu::Queue)) -> Self {
            let buffer = storage_buffer(&device, "word", 4);
            let reads = LateReads::default();
            Self { device, queue, buffer, reads }
        }

        /// An encoder with a read of the word.
        fn record(&mut self) -> wgpu::CommandEncoder {
            let mut encoder =
                self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut recorder = Recorder::on(&self.device, &self.queue, &mut encoder);
            self.reads.record(&mut recorder, &[(&self.buffer, 0, 4)]);
            drop(recorder);
            encoder
        }

        /// Writes a value, submits a read, and waits until the read of this number is done.
        fn submit(&mut self, value: u32, encoder: wgpu::CommandEncoder, number: u64) {
            self.queue.write_buffer(&self.buffer, 0, bytemuck::bytes_of(&value));
            self.queue.submit([encoder.finish()]);
            let is_mapped = |slot: &Slot| slot.number == number && slot.is_mapped();
            while !self.reads.slots.iter().any(is_mapped) {
                self.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
                // Another test's thread may be about to call the callback.
                std::thread::yield_now();
            }
        }

        fn latest(&mut self) -> Option<Vec<u32>> {
            self.reads.latest(&self.device)
        }
    }

    /// Two threads that poll the device may call two submissions' callbacks in either order.
    #[test]
    fn a_read_back_older_than_the_latest_is_ignored() {
        let mut word = Word::new();
        let (first, second) = (word.record(), word.record());
        word.submit(20, second, 2);
        assert_eq!(word.latest(), Some(vec![20]));
        word.submit(10, first, 1);
        assert_eq!(word.latest(), None, "the last result is newer");
        let third = word.record();
        word.submit(30, third, 3);
        assert_eq!(word.latest(), Some(vec![30]), "and so is the next one");
    }

    #[test]
    fn reads_of_a_lost_device_are_dropped() {
        let (device, queue) = pollster::block_on(open_device()).expect("a device of its own");
        let mut word = Word::on((crate::gpu::Pipelines::new(&device), queue));
        let first = word.record();
        word.submit(10, first, 1);
        word.device.destroy();
        assert_eq!(word.latest(), None);
        // Slots of later reads cannot be created.
        word.reads = LateReads::default();
        drop(word.record());
        assert_eq!(word.reads.peek(), (LastRead::Lost, None));
    }

    #[test]
    fn peek_returns_the_state_of_the_last_read() {
        let mut word = Word::new();
        let first = word.record();
        assert_eq!(word.reads.peek(), (LastRead::Pending, None));
        word.submit(10, first, 1);
        assert_eq!(word.reads.peek(), (LastRead::Done, Some(vec![10])));
        let second = word.record();
        assert_eq!(word.reads.peek(), (LastRead::Pending, Some(vec![10])));
        drop(second);
        assert_eq!(word.reads.peek(), (LastRead::Lost, Some(vec![10])));
        assert_eq!(word.latest(), Some(vec![10]));
        assert_eq!(word.reads.peek(), (LastRead::Lost, None));
        // While all slots are in use, a read is skipped; it is lost once the others are done.
        let encoders: Vec<_> = (0..=SLOTS).map(|_| word.record()).collect();
        assert_eq!(word.reads.peek(), (LastRead::Pending, None));
        for (encoder, number) in encoders.into_iter().take(SLOTS).zip(3..) {
            word.submit(number as u32, encoder, number);
        }
        assert_eq!(word.reads.peek(), (LastRead::Lost, Some(vec![2 + SLOTS as u32])));
    }
}
