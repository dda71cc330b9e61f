//! Lines from the terminal that the window was started from, or from what is piped into it.

use std::io::BufRead as _;
use std::sync::mpsc::Sender;

use super::lines::{Line, Origin};
use super::worker::Order;

/// Reads lines on a thread of its own, until there are no more. The end of them is not the end of the window.
pub fn read(orders: Sender<Order>) {
    std::thread::spawn(move || {
        for text in std::io::stdin().lock().lines() {
            let Ok(text) = text else { return };
            let line = Line { text, origin: Origin::Terminal, serial: 0 };
            if orders.send(Order::Line(line)).is_err() {
                return;
            }
        }
    });
}
