//! The window's state and layout.

use std::path::Path;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use egui::{CentralPanel, Frame, Panel, TextureId, Ui};
use glam::{UVec2, Vec2};
use lumivox_explorer::parameters::{Parameter, Value};
use lumivox_render::GpuId;
use lumivox_scene::Camera;

use super::config::Config;
use super::gizmo;
use super::lines::{Origin, quoted};
use super::model::{LogKind, Model, Selected};
use super::orders::{Order, Published, Shared};
use super::outbox::{Outbox, PendingValue};
use super::panels::{self, console, files};
use super::screen::PICTURES;
use super::{camera, theme};

/// Time without motion until the camera's line is logged.
const SETTLED: Duration = Duration::from_millis(250);

/// The model's counts of changes that the window has handled.
#[derive(Clone, Debug, Default)]
struct Seen {
    opened: u64,
    selections: u64,
    command_lines: u64,
    source: String,
}

/// A scene's source with an absolute path, which is valid in any working folder.
fn absolute(source: &str) -> String {
    if source.starts_with("builtin:") {
        return source.to_owned();
    }
    let path = std::path::absolute(source);
    path.map_or_else(|_| source.to_owned(), |path| path.display().to_string())
}

/// The window's state.
pub struct App {
    /// State that is saved between runs.
    pub config: Config,
    /// The pictures' textures.
    pub textures: [Option<TextureId>; PICTURES],
    /// The worker's published state.
    pub published: Published,
    outbox: Outbox,
    /// The selected object or light.
    pub selected: Option<Selected>,
    /// The mode of the handles.
    pub gizmo: gizmo::Mode,
    /// The handle that is being dragged.
    pub drag: Option<gizmo::Drag>,
    /// Position of the split, as a share of the picture's width.
    pub split: f32,
    /// Filter of the object list: names must contain it.
    pub filter: String,
    /// The console.
    pub console: console::State,
    /// `true` while the help is open.
    pub has_help: bool,
    /// The system's file dialogs.
    pub dialogs: files::Dialogs,
    seen: Seen,
    /// `Some` if the next selection is to be framed: the count of selections at the request.
    frames_after: Option<u64>,
    /// The last light probe: place, number of the picture, and time.
    pub probed: Option<(Vec2, u64, Instant)>,
    /// The name to store a camera under.
    pub camera_name: String,
    /// [`Model::opened`] of the scene whose hint was closed.
    pub closed_hint: u64,
}

impl App {
    /// The initial state.
    pub fn new(config: Config, orders: Sender<Order>, shared: Shared) -> Self {
        if let Some(warning) = &config.warning {
            let _ = orders.send(Order::Say(LogKind::Error, warning.clone()));
        }
        Self {
            config,
            textures: [None; PICTURES],
            published: Published::default(),
            outbox: Outbox::new(orders, shared),
            selected: None,
            gizmo: gizmo::Mode::default(),
            drag: None,
            split: 0.5,
            filter: String::new(),
            console: console::State::default(),
            has_help: false,
            dialogs: files::Dialogs::default(),
            seen: Seen::default(),
            frames_after: None,
            probed: None,
            camera_name: String::new(),
            closed_hint: 0,
        }
    }

    /// Fetches the published state, and handles its changes.
    pub fn look(&mut self) -> Published {
        self.published = self.outbox.look();
        let model = self.published.model.clone();
        if model.opened != self.seen.opened {
            // Drags belong to the last scene.
            self.seen.opened = model.opened;
            self.drag = None;
        }
        if model.selections != self.seen.selections {
            self.seen.selections = model.selections;
            self.selected.clone_from(&model.selected);
            if self.frames_after.take().is_some() && self.selected.is_some() {
                panels::picture::frame_selection(self, &model);
            }
        }
        let source = model.scene.as_ref().map(|scene| scene.source.clone()).unwrap_or_default();
        if !source.is_empty() && source != self.seen.source {
            self.config.note_recent(&absolute(&source));
            self.seen.source = source;
        }
        self.published.clone()
    }

    /// Whether the worker has ended.
    pub fn has_ended(&self) -> bool {
        self.outbox.has_ended()
    }

    /// Saves the state that is kept between runs.
    pub fn save(&mut self) {
        // Include changes since the last frame; without a model, the saved settings stay.
        self.look();
        if self.published.has_model {
            let model = self.published.model.clone();
            self.config.keep_settings(&model);
        }
        if let Err(error) = self.config.save() {
            tracing::warn!("the window's settings cannot be kept: {error:#}");
        }
    }

    /// Sends the worker an order.
    pub fn order(&self, order: Order) {
        self.outbox.order(order);
    }

    /// Sends the line of a button, a slider or a key; returns its number.
    pub fn line(&mut self, text: impl Into<String>) -> u64 {
        self.outbox.line(text.into(), Origin::Panel)
    }

    /// Sends a line as if typed into the console.
    pub fn typed_line(&mut self, text: impl Into<String>) {
        self.outbox.line(text.into(), Origin::Pane);
    }

    /// Opens a scene's file.
    pub fn open_file(&mut self, file: &Path) {
        self.open_source(&file.display().to_string());
    }

    /// Opens a scene, named as on the command line.
    pub fn open_source(&mut self, source: &str) {
        self.typed_line(format!("load {}", quoted(source)));
    }

    /// A parameter's pending value, or else its current one.
    pub fn value(&self, parameter: &Parameter, model: &Model) -> Value {
        match self.outbox.held(parameter.name) {
            Some(PendingValue::Value(value)) => value,
            _ => parameter.get(&model.settings),
        }
    }

    /// Sets a parameter.
    pub fn set_value(&mut self, parameter: &Parameter, value: Value) {
        let line = self.line(format!("{} {value}", parameter.name));
        self.outbox.hold(parameter.name, PendingValue::Value(value), line);
    }

    /// The pending numbers of `key`, or else `now`.
    pub fn numbers<const N: usize>(&self, key: &str, now: [f32; N]) -> [f32; N] {
        match self.outbox.held(key) {
            Some(PendingValue::Numbers(held)) => {
                std::array::from_fn(|i| held.get(i).copied().unwrap_or(now[i]))
            }
            _ => now,
        }
    }

    /// Sets numbers by a command; up to nine of them are pending until it is done.
    pub fn set_numbers<const N: usize>(&mut self, key: &str, numbers: [f32; N], command: String) {
        let line = self.line(command);
        let held = std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0));
        self.outbox.hold(key, PendingValue::Numbers(held), line);
    }

    /// Sets the selection.
    pub fn select(&mut self, selected: Option<Selected>) {
        if selected != self.selected {
            self.line(match &selected {
                Some(Selected::Object(name)) => format!("select {}", quoted(name)),
                Some(Selected::Light(name)) => format!("select light {}", quoted(name)),
                None => "select".to_owned(),
            });
            self.selected = selected;
        }
    }

    /// The light under the pointer; `None` until it is measured.
    pub fn light_under_pointer(&self) -> Option<lumivox_render::Photometry> {
        let (at, ..) = self.probed?;
        // Until then, show the light of a place nearby.
        let near = |light: &&super::model::LightAt| light.at.distance(at) < 0.02;
        self.published.light.as_ref().filter(near)?.light
    }

    /// Frames the next selection.
    pub fn frame_next_choice(&mut self) {
        self.frames_after = Some(self.seen.selections);
    }

    /// The camera, as the user is moving it or else as published.
    pub fn camera(&self) -> Camera {
        self.outbox.camera(&self.published.model)
    }

    /// Moves the camera interactively.
    pub fn move_camera(&mut self, camera: Camera) {
        self.outbox.move_camera(camera);
    }

    /// Logs the camera's line once it has come to rest.
    fn log_camera(&mut self, ui: &Ui) {
        let Some(moved) = self.outbox.camera_moved() else { return };
        if moved.elapsed() < SETTLED || ui.input(|input| input.pointer.any_down()) {
            ui.ctx().request_repaint_after(SETTLED);
            return;
        }
        let (camera, pivot) = (self.camera(), panels::picture::pivot(self));
        let distance_m = (pivot - camera.position).dot(camera.forward).max(1.0);
        self.outbox.log_camera(camera::command(&camera, distance_m));
    }

    /// Sets the space for the picture, px.
    pub fn set_room(&mut self, size: UVec2) {
        let size = if self.config.half_size { size / 2 } else { size };
        self.outbox.set_size(size.max(UVec2::ONE));
    }

    /// Sets the device that the window draws with.
    pub fn set_device(&mut self, device: GpuId) {
        self.outbox.set_device(device);
    }

    /// Sets the number of the newest picture that the window shows.
    pub fn set_shown(&mut self, serial: u64) {
        self.outbox.set_shown(serial);
    }

    /// Lays out the window.
    pub fn show(&mut self, ui: &mut Ui) {
        let model = self.published.model.clone();
        if let Some((number, line)) = &model.command_line
            && *number != self.seen.command_lines
        {
            self.seen.command_lines = *number;
            ui.ctx().copy_text(line.clone());
        }
        let is_held = |input: &egui::InputState| {
            let pointer = &input.pointer;
            (pointer.any_down() || pointer.any_released()) && !pointer.any_pressed()
        };
        if !ui.input(is_held) {
            self.outbox.end_gesture();
        }
        self.keys(ui, &model);
        let bar = Frame::new().fill(theme::PANEL).inner_margin(egui::Margin::symmetric(8, 4));
        Panel::top("menu").frame(bar).show(ui, |ui| panels::menu::show(ui, &model, self));
        Panel::bottom("status").frame(bar).show(ui, |ui| panels::status::show(ui, &model, self));
        let side = Frame::new().fill(theme::PANEL).inner_margin(egui::Margin::symmetric(6, 4));
        if self.config.left {
            let panel =
                Panel::left("left").frame(side).default_size(256.0).size_range(200.0..=420.0);
            panel.show(ui, |ui| panels::left(ui, &model, self));
        }
        let mut is_timed = false;
        if self.config.right {
            let panel =
                Panel::right("right").frame(side).default_size(296.0).size_range(260.0..=460.0);
            panel.show(ui, |ui| is_timed = panels::right(ui, &model, self));
        }
        // Measure stage times only while they are shown.
        self.outbox.set_timed(is_timed);
        if self.config.console {
            let deep = Frame::new().fill(theme::DEEP).inner_margin(egui::Margin::symmetric(8, 4));
            let panel = Panel::bottom("console").frame(deep).resizable(true);
            let panel = panel.default_size(120.0).size_range(70.0..=400.0);
            panel.show(ui, |ui| console::show(ui, &model, self));
        }
        if model.playback.animation.is_some() {
            Panel::bottom("animation")
                .frame(bar)
                .show(ui, |ui| panels::animation::show(ui, &model, self));
        }
        let deep = Frame::new().fill(theme::DEEP);
        CentralPanel::no_frame().frame(deep).show(ui, |ui| {
            // Also without a scene, so that its first picture has this size.
            let room = ui.available_rect_before_wrap().size() * ui.ctx().pixels_per_point();
            if room.x >= 1.0 && room.y >= 1.0 {
                self.set_room(UVec2::new(room.x as u32, room.y as u32));
            }
            match &model.scene {
                Some(scene) => panels::picture::show(ui, &model, scene, self),
                None => panels::welcome::show(ui, &model, self),
            }
        });
        if self.has_help {
            panels::help::show(ui, self);
        }
        self.log_camera(ui);
        if let Some(line) = self.dialogs.chosen() {
            self.typed_line(line);
        }
        if self.dialogs.are_open() {
            ui.ctx().request_repaint_after(Duration::from_millis(200));
        }
    }
}
