//! Sends lines and orders to the worker, and keeps pending values until their lines are done.

use std::collections::HashMap;
use std::sync::mpsc::Sender;

use glam::UVec2;
use lumivox_console::LineInfo;
use lumivox_explorer::parameters::Value;
use lumivox_render::GpuId;

use super::lines::{Line, Origin};
use super::orders::{Order, Published, Shared};

/// A value that was sent but is not in the model yet; panels show it until then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PendingValue {
    Value(Value),
    Numbers([f32; 9]),
}

/// The window's sender of orders.
pub struct Outbox {
    orders: Sender<Order>,
    shared: Shared,
    lines_sent: u64,
    /// Number of the current gesture; it changes with every frame in which no button is held.
    gesture: u64,
    held: HashMap<String, (PendingValue, u64)>,
    size: UVec2,
    device: Option<GpuId>,
    shown: u64,
    is_timed: bool,
}

impl Outbox {
    pub fn new(orders: Sender<Order>, shared: Shared) -> Self {
        Self {
            orders,
            shared,
            lines_sent: 0,
            gesture: 1,
            held: HashMap::new(),
            size: UVec2::ZERO,
            device: None,
            shown: 0,
            is_timed: false,
        }
    }

    /// The state that the worker has published.
    pub fn published(&self) -> Published {
        self.shared.get()
    }

    /// Whether the worker has ended.
    pub fn has_ended(&self) -> bool {
        self.shared.has_ended()
    }

    /// Sends an order.
    pub fn order(&self, order: Order) {
        if matches!(order, Order::Cancel(_) | Order::Quit) {
            self.shared.stop();
        }
        // If the channel is closed, the worker has ended, and the window will close.
        let _ = self.orders.send(order);
    }

    /// Sends a line. Returns its number and its [`LineInfo`].
    pub fn line(&mut self, text: String, origin: Origin) -> (u64, LineInfo) {
        let info = LineInfo::of(&text);
        if info.urgency.is_some() {
            self.shared.stop();
        }
        self.lines_sent += 1;
        let gesture = if origin == Origin::Panel { self.gesture } else { 0 };
        self.order(Order::Line(Line { text, origin, serial: self.lines_sent, gesture }));
        (self.lines_sent, info)
    }

    /// Ends the gesture: later lines are another step for `undo`.
    pub fn end_gesture(&mut self) {
        self.gesture += 1;
    }

    /// Sends the space for the picture, px, if it has changed.
    pub fn set_size(&mut self, size: UVec2) {
        if size != self.size {
            self.size = size;
            self.order(Order::Size(size));
        }
    }

    /// Sends the device that the window draws with, if it has changed.
    pub fn set_device(&mut self, device: GpuId) {
        if self.device != Some(device) {
            self.device = Some(device);
            self.order(Order::Device(device));
        }
    }

    /// Sends the number of the newest picture that the window shows, if it has changed.
    pub fn set_shown(&mut self, serial: u64) {
        if serial != self.shown {
            self.shown = serial;
            self.order(Order::Shown(serial));
        }
    }

    /// Turns the measurement of stage times on or off.
    pub fn set_timed(&mut self, is_timed: bool) {
        if is_timed != self.is_timed {
            self.is_timed = is_timed;
            self.order(Order::Timed(is_timed));
        }
    }

    /// Keeps a value pending until the line of this number is done.
    pub fn hold(&mut self, key: &str, value: PendingValue, line: u64) {
        self.held.insert(key.to_owned(), (value, line));
    }

    /// The pending value of `key`, if any.
    pub fn held(&self, key: &str) -> Option<PendingValue> {
        self.held.get(key).map(|(held, _)| *held)
    }

    /// Drops pending values of lines up to this number, which are done.
    pub fn done(&mut self, lines: u64) {
        self.held.retain(|_, (_, line)| *line > lines);
    }

    /// Drops all pending values, since another scene was opened.
    pub fn forget_held(&mut self) {
        self.held.clear();
    }
}
