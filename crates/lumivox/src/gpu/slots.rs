//! Copies of what a recording reads and the next one changes.
//!
//! `Queue::write_buffer` takes effect before all that is submitted next. Two recordings that are submitted together
//! would both see the last content of one buffer, so each takes a slot that no other recording holds. There are as
//! many as recordings were ever under way at once; after that nothing is made.

use std::sync::{Mutex, PoisonError};

/// Something with bind groups that recordings hold.
pub(crate) trait Slot {
    /// Whether no recording holds it that is still to be submitted.
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
    /// Records with a slot that is free, which is made if there is none.
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

    /// Whether no recording holds any.
    #[cfg(test)]
    pub(crate) fn are_free(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).iter().all(Slot::is_free)
    }

    /// How many there are.
    #[cfg(test)]
    pub(crate) fn count(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).len()
    }
}
