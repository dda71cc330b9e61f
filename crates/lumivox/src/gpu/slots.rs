//! Separate copies of data for recordings, since each recording changes it.
//!
//! `Queue::write_buffer` takes effect before everything in the next submission. Two recordings that
//! are submitted together would both read the last content of one buffer, so each uses a slot that
//! no other recording holds. There are as many slots as recordings were ever in progress at once.

use std::sync::{Mutex, PoisonError};

/// An object with bind groups that recordings hold.
pub(crate) trait Slot {
    /// `true` if all recordings that hold it are submitted or dropped.
    fn is_free(&self) -> bool;
}

/// The slots of one object.
#[derive(Debug)]
pub(crate) struct Slots<S>(Mutex<Vec<S>>);

impl<S> Default for Slots<S> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<S: Slot> Slots<S> {
    /// Records with a free slot; creates one if there is none.
    pub(crate) fn with_free<R>(
        &self,
        make: impl FnOnce() -> S,
        record: impl FnOnce(&mut S) -> R,
    ) -> R {
        let mut slots = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let free = slots.iter().position(Slot::is_free).unwrap_or_else(|| {
            slots.push(make());
            slots.len() - 1
        });
        record(&mut slots[free])
    }

    /// `true` if no recording holds any slot.
    #[cfg(test)]
    pub(crate) fn are_free(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().all(Slot::is_free)
    }

    /// Number of slots.
    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len()
    }
}
