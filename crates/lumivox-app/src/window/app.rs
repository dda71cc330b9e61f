//! The window's state, and where everything is.

use std::path::Path;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use egui::{CentralPanel, Frame, Panel, TextureId, Ui};
use glam::{UVec2, Vec2};
use lumivox_explorer::REST;
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

/// The line that puts the camera where it has come to rest is sent a moment before pictures become sharp, which would
/// start again otherwise.
const SETTLED: Duration = REST.saturating_sub(Duration::from_millis(50));

/// A camera in somebody's hand.
#[derive(Clone, Debug)]
struct Motion {
    camera: Camera,
    moved: Instant,
    /// The line that tells where it came to rest, once it was sent.
    told: Option<u64>,
}

/// The changes of the model that the window has followed, by the model's counts.
#[derive(Clone, Debug, Default)]
struct Seen {
    opened: u64,
    camera_moves: u64,
    selections: u64,
    command_lines: u64,
    source: String,
}

/// A scene's name that holds in other folders, too.
fn absolute(source: &str) -> String {
    if source.starts_with("builtin:") {
        return source.to_owned();
    }
    let path = std::path::absolute(source);
    path.map_or_else(|_| source.to_owned(), |path| path.display().to_string())
}

/// The window's state.
pub struct App {
    /// What is kept between runs.
    pub config: Config,
    /// The pictures' textures.
    pub textures: [Option<TextureId>; PICTURES],
    /// What the worker has published.
    pub published: Published,
    outbox: Outbox,
    motion: Option<Motion>,
    /// The selected object or light.
    pub selected: Option<Selected>,
    /// What the handles do.
    pub gizmo: gizmo::Mode,
    /// A handle in somebody's hand.
    pub drag: Option<gizmo::Drag>,
    /// Where the split is, as a share of the picture's width.
    pub split: f32,
    /// Objects whose names have this in them are listed.
    pub filter: String,
    /// The console.
    pub console: console::State,
    /// Whether the help is open.
    pub has_help: bool,
    /// Dialogs of the system.
    pub dialogs: files::Dialogs,
    seen: Seen,
    /// What is chosen after this one of the worker's selections is shown whole.
    frames_after: Option<u64>,
    /// Where light was asked for, of which picture, and when.
    pub probed: Option<(Vec2, u64, Instant)>,
    /// The name that a camera is stored under.
    pub camera_name: String,
    /// The scene whose hint was closed.
    pub closed_hint: u64,
}

impl App {
    /// The state at the start.
    pub fn new(config: Config, orders: Sender<Order>, shared: Shared) -> Self {
        if let Some(warning) = &config.warning {
            let _ = orders.send(Order::Say(LogKind::Error, warning.clone()));
        }
        Self {
            config,
            textures: [None; PICTURES],
            published: Published::default(),
            outbox: Outbox::new(orders, shared),
            motion: None,
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

    /// Fetches what was published.
    pub fn look(&mut self) -> Published {
        self.published = self.outbox.published();
        let model = self.published.model.clone();
        if model.opened != self.seen.opened {
            // What is in somebody's hand is of the last scene.
            self.seen.opened = model.opened;
            self.motion = None;
            self.drag = None;
            self.outbox.forget_held();
        }
        if model.camera_moves != self.seen.camera_moves {
            self.seen.camera_moves = model.camera_moves;
            // A command goes before a hand that was there before it.
            if self.motion.as_ref().is_some_and(|motion| motion.told.is_none()) {
                self.motion = None;
            }
        }
        self.outbox.done(model.lines_done);
        if model.selections != self.seen.selections {
            self.seen.selections = model.selections;
            self.selected.clone_from(&model.selected);
            if self.frames_after.take().is_some() && self.selected.is_some() {
                panels::picture::frame_selection(self, &model);
            }
        }
        if self.motion.as_ref().and_then(|m| m.told).is_some_and(|line| line <= model.lines_done) {
            self.motion = None;
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

    /// Keeps what is kept between runs.
    pub fn save(&mut self) {
        // What came since the last frame counts, too; where nothing has come, what was kept stays.
        self.look();
        if self.published.has_model {
            let model = self.published.model.clone();
            self.config.keep_settings(&model);
        }
        if let Err(error) = self.config.save() {
            tracing::warn!("the window's settings cannot be kept: {error:#}");
        }
    }

    /// Tells the worker something.
    pub fn order(&self, order: Order) {
        self.outbox.order(order);
    }

    /// Sends a line that a button, a slider or a key stands for.
    pub fn line(&mut self, text: impl Into<String>) -> u64 {
        self.send(text.into(), Origin::Panel)
    }

    /// Sends a line that somebody typed.
    pub fn typed_line(&mut self, text: impl Into<String>) {
        self.send(text.into(), Origin::Pane);
    }

    fn send(&mut self, text: String, origin: Origin) -> u64 {
        let (line, info) = self.outbox.line(text, origin);
        if info.moves_camera {
            // It is elsewhere after that.
            self.motion = None;
        }
        line
    }

    /// Opens a scene's file.
    pub fn open_file(&mut self, file: &Path) {
        self.open_source(&file.display().to_string());
    }

    /// Opens a scene, named as on the command line.
    pub fn open_source(&mut self, source: &str) {
        self.typed_line(format!("load {}", quoted(source)));
    }

    /// A parameter's value, or what it will be.
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

    /// Numbers of something, or what they will be.
    pub fn numbers<const N: usize>(&self, key: &str, now: [f32; N]) -> [f32; N] {
        match self.outbox.held(key) {
            Some(PendingValue::Numbers(held)) => {
                std::array::from_fn(|i| held.get(i).copied().unwrap_or(now[i]))
            }
            _ => now,
        }
    }

    /// Sets numbers by a command; at most nine of them are shown until it is done.
    pub fn set_numbers<const N: usize>(&mut self, key: &str, numbers: [f32; N], command: String) {
        let line = self.line(command);
        let held = std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0));
        self.outbox.hold(key, PendingValue::Numbers(held), line);
    }

    /// Chooses something.
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

    /// The light where the pointer is, once it was measured.
    pub fn light_under_pointer(&self) -> Option<lumivox_render::Photometry> {
        let (at, ..) = self.probed?;
        // That of a place nearby is shown until the pointer's own is there.
        let near = |light: &&super::model::LightAt| light.at.distance(at) < 0.02;
        self.published.light.as_ref().filter(near)?.light
    }

    /// Shows all of what is chosen next.
    pub fn frame_next_choice(&mut self) {
        self.frames_after = Some(self.seen.selections);
    }

    /// The camera, as it is or as it is being moved.
    pub fn camera(&self) -> Camera {
        match &self.motion {
            Some(motion) => motion.camera.clone(),
            None => self.published.model.camera.clone(),
        }
    }

    /// Moves the camera by hand.
    pub fn move_camera(&mut self, camera: Camera) {
        self.order(Order::Camera(camera.clone(), self.seen.opened));
        self.motion = Some(Motion { camera, moved: Instant::now(), told: None });
    }

    /// Writes down where the camera has come to rest.
    fn settle_camera(&mut self, ui: &Ui) {
        let Some(motion) = &self.motion else { return };
        if motion.told.is_some() {
            return;
        }
        if motion.moved.elapsed() < SETTLED || ui.input(|input| input.pointer.any_down()) {
            ui.ctx().request_repaint_after(SETTLED);
            return;
        }
        let camera = motion.camera.clone();
        let pivot = panels::picture::pivot(self);
        let distance_m = (pivot - camera.position).dot(camera.forward).max(1.0);
        let (moved, told) = (motion.moved, self.line(camera::command(&camera, distance_m)));
        self.motion = Some(Motion { camera, moved, told: Some(told) });
    }

    /// Says how much room there is for the picture, px.
    pub fn set_room(&mut self, size: UVec2) {
        let size = if self.config.half_size { size / 2 } else { size };
        self.outbox.set_size(size.max(UVec2::ONE));
    }

    /// Says which device the window draws with.
    pub fn set_device(&mut self, device: GpuId) {
        self.outbox.set_device(device);
    }

    /// Says up to which number the window shows pictures.
    pub fn set_shown(&mut self, serial: u64) {
        self.outbox.set_shown(serial);
    }

    /// All of the window.
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
        // Times of stages are taken where they are shown.
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
            // A scene's first picture is as large as the others will be.
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
        self.settle_camera(ui);
        if let Some(line) = self.dialogs.chosen() {
            self.typed_line(line);
        }
        if self.dialogs.are_open() {
            ui.ctx().request_repaint_after(Duration::from_millis(200));
        }
    }
}
