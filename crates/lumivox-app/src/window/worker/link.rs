//! The worker's side of the communication: its inbox and its publisher.

use std::collections::VecDeque;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

use crate::window::model::Doing;
use crate::window::orders::{Order, Published, Shared, Wake};

/// The inbox of orders.
#[derive(Debug)]
pub struct Inbox {
    sender: Sender<Order>,
    orders: Receiver<Order>,
    waiting: VecDeque<Order>,
}

/// The result of a wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Waited {
    /// There are orders.
    Orders,
    /// The time has passed.
    Timeout,
    /// All senders are dropped.
    Closed,
}

impl Inbox {
    pub fn new() -> Self {
        let (sender, orders) = mpsc::channel();
        Self { sender, orders, waiting: VecDeque::new() }
    }

    /// A sender of orders.
    pub fn sender(&self) -> Sender<Order> {
        self.sender.clone()
    }

    /// Fetches the orders that have arrived.
    pub fn fetch(&mut self) {
        self.waiting.extend(self.orders.try_iter());
    }

    /// Sleeps until there is an order, at most for `timeout`.
    pub fn sleep(&mut self, timeout: Option<Duration>) -> Waited {
        if !self.waiting.is_empty() {
            return Waited::Orders;
        }
        let order = match timeout {
            None => self.orders.recv().map_err(|_| RecvTimeoutError::Disconnected),
            Some(timeout) => self.orders.recv_timeout(timeout),
        };
        match order {
            Ok(order) => {
                self.waiting.push_back(order);
                Waited::Orders
            }
            Err(RecvTimeoutError::Timeout) => Waited::Timeout,
            Err(RecvTimeoutError::Disconnected) => Waited::Closed,
        }
    }

    /// The next order.
    pub fn take(&mut self) -> Option<Order> {
        self.waiting.pop_front()
    }

    /// Whether there are orders that change what the panels show.
    pub fn has_changes(&self) -> bool {
        self.waiting.iter().any(|order| !matches!(order, Order::Probe(_) | Order::Shown(_)))
    }
}

/// Publishes state for the window, and wakes it.
#[derive(Clone)]
pub struct Publisher {
    shared: Shared,
    wake: Wake,
}

impl Publisher {
    pub fn new(shared: Shared, wake: Wake) -> Self {
        Self { shared, wake }
    }

    /// Changes the published state without waking the window.
    pub fn change(&self, change: impl FnOnce(&mut Published)) {
        self.shared.change(change);
    }

    /// Changes the published state, and wakes the window.
    pub fn publish(&self, change: impl FnOnce(&mut Published)) {
        self.change(change);
        (self.wake)();
    }

    /// Publishes the worker's activity if it has changed.
    pub fn begin(&self, words: String) {
        let mut is_new = false;
        self.change(|published| {
            is_new = published.doing.as_ref().is_none_or(|doing| doing.words != words);
            if is_new {
                published.doing = Some(Doing { words, since: Instant::now() });
            }
        });
        if is_new {
            (self.wake)();
        }
    }

    /// Publishes that the worker is idle.
    pub fn rest(&self) {
        let mut was_busy = false;
        self.change(|published| was_busy = published.doing.take().is_some());
        if was_busy {
            (self.wake)();
        }
    }

    /// The state that is shared with the window.
    pub fn shared(&self) -> &Shared {
        &self.shared
    }
}
