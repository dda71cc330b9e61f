//! A queue of changes that arrive faster than they can be applied: a later one supersedes a waiting
//! one of the same target.

use std::collections::VecDeque;

/// Waiting changes, in their order.
///
/// A change with a target only sets that target, so it supersedes a waiting change of the same
/// target. A change without a target may do more, so no change is moved past it.
#[derive(Clone, Debug)]
pub struct ChangeQueue<T> {
    waiting: VecDeque<Waiting<T>>,
    last: u64,
}

#[derive(Clone, Debug)]
struct Waiting<T> {
    ticket: Ticket,
    target: Option<String>,
    change: T,
}

/// Identifies a change of a [`ChangeQueue`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ticket(u64);

impl<T> Default for ChangeQueue<T> {
    fn default() -> Self {
        Self { waiting: VecDeque::new(), last: 0 }
    }
}

impl<T> ChangeQueue<T> {
    /// Adds a change at the end.
    pub fn push(&mut self, target: Option<String>, change: T) -> Ticket {
        if target.is_some() {
            let is_barrier = |waiting: &Waiting<T>| waiting.target.is_none();
            let start = self.waiting.iter().rposition(is_barrier).map_or(0, |at| at + 1);
            let is_same = |waiting: &Waiting<T>| waiting.target == target;
            if let Some(same) = self.waiting.iter().skip(start).position(is_same) {
                self.waiting.remove(start + same);
            }
        }
        self.last += 1;
        let ticket = Ticket(self.last);
        self.waiting.push_back(Waiting { ticket, target, change });
        ticket
    }

    /// Takes a change out; `None` if a later one has superseded it.
    pub fn take(&mut self, ticket: Ticket) -> Option<T> {
        let at = self.waiting.iter().position(|waiting| waiting.ticket == ticket)?;
        self.waiting.remove(at).map(|waiting| waiting.change)
    }

    /// Takes out the first change that fits.
    pub fn take_first(&mut self, fits: impl Fn(&T) -> bool) -> Option<T> {
        let at = self.waiting.iter().position(|waiting| fits(&waiting.change))?;
        self.waiting.remove(at).map(|waiting| waiting.change)
    }

    /// Whether nothing waits.
    pub fn is_empty(&self) -> bool {
        self.waiting.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn queue(changes: &[(&str, u32)]) -> (ChangeQueue<u32>, Vec<Ticket>) {
        let mut queue = ChangeQueue::default();
        let target = |target: &str| (!target.is_empty()).then(|| target.to_owned());
        let push = |(name, value): &(&str, u32)| queue.push(target(name), *value);
        let tickets = changes.iter().map(push).collect();
        (queue, tickets)
    }

    fn all(mut queue: ChangeQueue<u32>) -> Vec<u32> {
        std::iter::from_fn(|| queue.take_first(|_| true)).collect()
    }

    #[test]
    fn only_the_last_change_per_target_is_kept() {
        let changes = [("size", 1), ("split", 2), ("size", 3), ("size", 4)];
        assert_eq!(all(queue(&changes).0), [2, 4]);
    }

    #[test]
    fn changes_are_not_merged_across_other_changes() {
        assert_eq!(all(queue(&[("size", 1), ("", 2), ("size", 3), ("", 4)]).0), [1, 2, 3, 4]);
    }

    #[test]
    fn tickets_reveal_superseded_changes() {
        let (mut queue, tickets) = queue(&[("size", 1), ("split", 2), ("size", 3)]);
        let taken: Vec<_> = tickets.into_iter().map(|ticket| queue.take(ticket)).collect();
        assert_eq!(taken, [None, Some(2), Some(3)]);
        assert!(queue.is_empty());
        // A change that was taken out cannot be superseded.
        let first = queue.push(Some("size".to_owned()), 1);
        assert_eq!(queue.take(first), Some(1));
        let second = queue.push(Some("size".to_owned()), 2);
        assert_eq!(queue.take(second), Some(2));
    }
}
