//! Lines and orders on their way to the worker, and what panels show until a line is done.

use std::collections::HashMap;
use std::sync::mpsc::Sender;

use glam::UVec2;
use lumivox_console::LineInfo;
use lumivox_explorer::parameters::Value;
use lumivox_render::GpuId;

use super::lines::{Line, Origin};
use super::orders::{Order, Published, Shared};

/// A value that was sent and that the model does not have yet: what a slider shows in the meantime.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PendingValue {
    Value(Value),
    Numbers([f32; 9]),
}

/// The window's end of the orders.
pub struct Outbox {
    orders: Sender<Order>,
    shared: Shared,
    lines_sent: u64,
    /// Counts gestures: presses of buttons, and keys while none is held.
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
        // The worker has ended when the channel is closed; the window follows.
        let _ = self.orders.send(order);
    }

    /// Sends a line. Returns its number, and what is known of it.
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

    /// Input from now on is a step of its own for `undo`.
    pub fn end_gesture(&mut self) {
        self.gesture += 1;
    }

    /// Says how much room there is for the picture, px.
    pub fn set_size(&mut self, size: UVec2) {
        if size != self.size {
            self.size = size;
            self.order(Order::Size(size));
        }
    }

    /// Says which device the window draws with.
    pub fn set_device(&mut self, device: GpuId) {
        if self.device != Some(device) {
            self.device = Some(device);
            self.order(Order::Device(device));
        }
    }

    /// Says up to which number the window shows pictures.
    pub fn set_shown(&mut self, serial: u64) {
        if serial != self.shown {
            self.shown = serial;
            self.order(Order::Shown(serial));
        }
    }

    /// Takes times of stages, or not.
    pub fn set_timed(&mut self, is_timed: bool) {
        if is_timed != self.is_timed {
            self.is_timed = is_timed;
            self.order(Order::Timed(is_timed));
        }
    }

    /// Shows a value until the line of this number is done.
    pub fn hold(&mut self, key: &str, value: PendingValue, line: u64) {
        self.held.insert(key.to_owned(), (value, line));
    }

    /// The value that is shown until its line is done.
    pub fn held(&self, key: &str) -> Option<PendingValue> {
        self.held.get(key).map(|(held, _)| *held)
    }

    /// Lines up to this number are done.
    pub fn done(&mut self, lines: u64) {
        self.held.retain(|_, (_, line)| *line > lines);
    }

    /// Another scene was opened: no value of the last one is shown.
    pub fn forget_held(&mut self) {
        self.held.clear();
    }
}
