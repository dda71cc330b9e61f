//! Handles of resources used by recorded work, kept until the work is submitted.

use std::sync::Arc;

use crate::gpu::resources::{BindGroup, Kept};

/// Resources that must not be destroyed before submission.
#[derive(Debug, Default)]
pub(super) struct Held(Vec<Handle>);

/// One kept resource. The fields exist only to be dropped.
#[derive(Debug)]
#[expect(dead_code, reason = "kept, not read")]
enum Handle {
    Group(Arc<[Kept]>),
    One(Kept),
}

impl Held {
    /// Adds the resources of a bind group.
    pub(super) fn group(&mut self, group: &BindGroup) {
        self.0.push(Handle::Group(group.kept().clone()));
    }

    /// Adds buffers or textures.
    pub(super) fn keep(&mut self, kept: impl IntoIterator<Item = Kept>) {
        self.0.extend(kept.into_iter().map(Handle::One));
    }

    /// Releases all resources.
    pub(super) fn clear(&mut self) {
        self.0.clear();
    }

    /// Moves everything into the encoder, which releases it when the GPU has finished its work, or
    /// when it is dropped without being submitted.
    pub(super) fn hand_to(self, encoder: &wgpu::CommandEncoder) {
        if self.0.is_empty() {
            return;
        }
        #[cfg(not(target_arch = "wasm32"))]
        encoder.on_submitted_work_done(move || drop(self));
        #[cfg(target_arch = "wasm32")]
        {
            let ticket = here::deposit(self);
            encoder.on_submitted_work_done(move || drop(ticket));
        }
    }
}

/// Stores handles on the thread that recorded them: callbacks must be `Send`, and in browsers
/// handles may not leave their thread.
#[cfg(target_arch = "wasm32")]
mod here {
    use std::cell::RefCell;
    use std::collections::HashMap;

    use super::Held;

    thread_local! {
        static DEPOSITS: RefCell<(u64, HashMap<u64, Held>)> = RefCell::default();
    }

    /// Releases a deposit when it is dropped.
    pub(super) struct Ticket(u64);

    /// Stores handles until their ticket is dropped.
    pub(super) fn deposit(held: Held) -> Ticket {
        DEPOSITS.with_borrow_mut(|(number, deposits)| {
            *number += 1;
            deposits.insert(*number, held);
            Ticket(*number)
        })
    }

    impl Drop for Ticket {
        fn drop(&mut self) {
            // While the thread ends, the deposits may already be dropped.
            let _ = DEPOSITS.try_with(|deposits| deposits.borrow_mut().1.remove(&self.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::gpu::{Recorder, storage_buffer, upload};
    use crate::testing::{device, read};

    fn new_encoder(device: &wgpu::Device) -> wgpu::CommandEncoder {
        device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    #[test]
    fn a_callers_encoder_keeps_recorded_resources_alive() {
        let (device, queue) = device();
        let target = storage_buffer(&device, "target", 16);
        let mut encoder = new_encoder(&device);
        let source = upload(&device, "source", &[7_u32; 4]);
        let mut recorder = Recorder::on(&device, &queue, &mut encoder);
        recorder.copy((&source, 0), (&target, 0), 16);
        // Neither call submits: that would lose the copy with the source, or do it twice.
        recorder.flush();
        recorder.submit();
        drop(source);
        assert_eq!(read::<u32>(&device, &queue, &target, 4), [0; 4], "nothing is submitted");
        queue.submit([encoder.finish()]);
        assert_eq!(read::<u32>(&device, &queue, &target, 4), [7; 4]);
    }

    #[test]
    fn dropping_an_encoder_frees_its_resources() {
        let (device, queue) = device();
        let buffer = storage_buffer(&device, "buffer", 16);
        let plain = wgpu::Buffer::clone(&buffer);
        let mut encoder = new_encoder(&device);
        Recorder::on(&device, &queue, &mut encoder).clear(&buffer);
        drop(buffer);
        let is_alive = || {
            let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
            queue.write_buffer(&plain, 0, &[0; 16]);
            pollster::block_on(scope.pop()).is_none()
        };
        assert!(is_alive(), "the encoder holds it");
        drop(encoder);
        assert!(!is_alive(), "nothing is left but a plain handle");
    }

    #[test]
    fn a_recorder_of_its_own_times_its_passes() {
        let (device, queue) = device();
        let timing = crate::gpu::Timing::SubmitAndWait;
        let mut recorder = Recorder::with_timing(&device, &queue, timing);
        recorder.compute("nothing", |_| {});
        let times = pollster::block_on(recorder.finish()).expect("the device is there");
        assert_eq!(times.len(), 1);
    }
}
