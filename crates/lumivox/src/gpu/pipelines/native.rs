//! Parallel creation of pipelines, outside of browsers.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

use super::lazy::Pending;

/// Creates pipelines on all cores, and blocks until they are created.
pub(super) fn make(
    _: &wgpu::Device,
    pending: &[Pending],
    progress: &mut dyn FnMut(u32, u32),
) -> std::future::Ready<()> {
    // Longest shaders first, so that all cores finish at about the same time.
    let mut pending = pending.to_vec();
    pending.sort_by_key(|pipeline| std::cmp::Reverse(pipeline.source_bytes()));
    let pending = &pending;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let (made, hear) = mpsc::channel();
    std::thread::scope(|scope| {
        for _ in 0..cores.min(pending.len()) {
            let (made, next) = (made.clone(), &next);
            scope.spawn(move || {
                while let Some(pipeline) = pending.get(next.fetch_add(1, Ordering::Relaxed)) {
                    pipeline.make();
                    // The receiver is dropped if the caller's progress function has panicked.
                    let _ = made.send(());
                }
            });
        }
        drop(made);
        for (done, ()) in (1..).zip(hear) {
            progress(done, pending.len() as u32);
        }
    });
    std::future::ready(())
}
