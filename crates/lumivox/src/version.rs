//! Version numbers, to detect changes.

use std::sync::atomic::{AtomicU64, Ordering};

/// A number that was never returned before in this process.
pub(crate) fn next() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}
