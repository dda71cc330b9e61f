//! Sends lines and orders to the worker; keeps sent values until the model has them.

use std::collections::HashMap;
use std::sync::mpsc::Sender;
use std::time::Instant;

use glam::UVec2;
use lumivox_console::{LineInfo, quote};
use lumivox_explorer::parameters::{Parameter, Value};
use lumivox_render::GpuId;
use lumivox_scene::Camera;

use super::lines::{Line, Origin};
use super::model::{Model, Selected};
use super::orders::{Order, Published, Shared};

/// A value that was sent but is not in the model yet; panels show it instead of the model's.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PendingValue {
    Value(Value),
    Numbers([f32; 9]),
}

/// The window's sender of orders.
pub struct Outbox {
    orders: Sender<Order>,
    shared: Shared,
    lines_sent: u64,
    /// Number of the current gesture; changes in every frame in which no button is held.
    gesture: u64,
    held: HashMap<String, (PendingValue, u64)>,
    /// [`Model::opened`] of the scene that the pending values belong to.
    scene: u64,
    selected: Option<Selected>,
    /// [`Model::selections`] of the last model.
    selections: u64,
    cameras_sent: u64,
    /// The camera that was sent last, and its number.
    camera: Option<(Camera, u64)>,
    /// When the user last moved the camera; `None` once its line is logged.
    moved: Option<Instant>,
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
            scene: 0,
            selected: None,
            selections: 0,
            cameras_sent: 0,
            camera: None,
            moved: None,
            size: UVec2::ZERO,
            device: None,
            shown: 0,
            is_timed: false,
        }
    }

    /// Returns the state that the worker has published. Drops pending values that are in it.
    pub fn look(&mut self) -> Published {
        let published = self.shared.get();
        let model = &published.model;
        if model.opened != self.scene {
            self.scene = model.opened;
            self.held.clear();
            (self.camera, self.moved) = (None, None);
        }
        self.held.retain(|_, (_, line)| *line > model.lines_done);
        self.camera.take_if(|(_, number)| *number <= model.cameras_done);
        if model.selections != self.selections {
            self.selections = model.selections;
            self.selected.clone_from(&model.selected);
        }
        published
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

    /// Sends the line of a button, a slider or a key.
    pub fn line(&mut self, text: impl Into<String>) {
        self.send(text.into(), Origin::Panel);
    }

    /// Sends a line as if typed into the console.
    pub fn typed_line(&mut self, text: impl Into<String>) {
        self.send(text.into(), Origin::Pane);
    }

    /// Opens a scene, named as on the command line.
    pub fn open(&mut self, source: &str) {
        self.typed_line(format!("load {}", quote(source)));
    }

    /// Sends a line, and returns its number.
    fn send(&mut self, text: String, origin: Origin) -> u64 {
        let info = LineInfo::of(&text);
        if info.urgency.is_some() {
            self.shared.stop();
        }
        self.lines_sent += 1;
        let gesture = if origin == Origin::Panel { self.gesture } else { 0 };
        self.order(Order::Line(Line { text, origin, serial: self.lines_sent, gesture }));
        if info.moves_camera {
            self.moved = None;
        }
        self.lines_sent
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

    /// A parameter's pending value, or else its current one.
    pub fn value(&self, parameter: &Parameter, model: &Model) -> Value {
        match self.held.get(parameter.name) {
            Some((PendingValue::Value(value), _)) => *value,
            _ => parameter.get(&model.settings),
        }
    }

    /// Sets a parameter.
    pub fn set_value(&mut self, parameter: &Parameter, value: Value) {
        let line = self.send(format!("{} {value}", parameter.name), Origin::Panel);
        self.held.insert(parameter.name.to_owned(), (PendingValue::Value(value), line));
    }

    /// The pending numbers for `key`, else `now`.
    pub fn numbers<const N: usize>(&self, key: &str, now: [f32; N]) -> [f32; N] {
        match self.held.get(key) {
            Some((PendingValue::Numbers(held), _)) => {
                std::array::from_fn(|i| held.get(i).copied().unwrap_or(now[i]))
            }
            _ => now,
        }
    }

    /// Sets up to nine numbers by a command; they are pending until it is done.
    pub fn set_numbers<const N: usize>(&mut self, key: &str, numbers: [f32; N], command: String) {
        let line = self.send(command, Origin::Panel);
        let held = std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0));
        self.held.insert(key.to_owned(), (PendingValue::Numbers(held), line));
    }

    /// The pending selection, or else the published one.
    pub fn selected(&self) -> Option<&Selected> {
        self.selected.as_ref()
    }

    /// Sets the selection.
    pub fn select(&mut self, selected: Option<Selected>) {
        if selected != self.selected {
            self.line(match &selected {
                Some(Selected::Object(name)) => format!("select {}", quote(name)),
                Some(Selected::Light(name)) => format!("select light {}", quote(name)),
                None => "select".to_owned(),
            });
            self.selected = selected;
        }
    }

    /// The pending camera, or else the model's.
    pub fn camera(&self, model: &Model) -> Camera {
        self.camera.as_ref().map_or(&model.camera, |(camera, _)| camera).clone()
    }

    /// Moves the camera interactively.
    pub fn move_camera(&mut self, mut camera: Camera) {
        "window".clone_into(&mut camera.name);
        self.cameras_sent += 1;
        let (scene, number) = (self.scene, self.cameras_sent);
        self.order(Order::Camera { camera: camera.clone(), scene, number });
        self.camera = Some((camera, number));
        self.moved = Some(Instant::now());
    }

    /// When the user last moved the camera; `None` once its line is logged.
    pub fn camera_moved(&self) -> Option<Instant> {
        self.moved
    }

    /// Logs the line that sets the camera to where the user has moved it.
    pub fn log_camera(&mut self, line: String) {
        self.moved = None;
        self.order(Order::CameraLine(line));
    }
}
