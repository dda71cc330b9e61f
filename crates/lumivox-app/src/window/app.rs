//! The window's state and layout.

use std::sync::mpsc::Sender;
use std::time::Duration;

use egui::{CentralPanel, Frame, Panel, Ui};
use glam::UVec2;

use super::config::Config;
use super::model::LogKind;
use super::orders::{Order, Published, Shared};
use super::outbox::Outbox;
use super::panels::{self, console, files, picture};
use super::{camera, keys, selection, theme};

/// Time without motion after which the camera's line is logged.
const SETTLED: Duration = Duration::from_millis(250);

/// A scene's source with an absolute path, valid in any working folder.
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
    /// The sender of orders.
    pub outbox: Outbox,
    /// State of the picture's panel.
    pub picture: picture::State,
    /// The worker's published state.
    published: Published,
    /// Filter of the object list: names must contain it.
    filter: String,
    /// The name under which to store a camera.
    camera_name: String,
    console: console::State,
    /// `true` while the help is open.
    has_help: bool,
    /// The system's file dialogs.
    dialogs: files::Dialogs,
    /// The number of the last command line that was copied.
    copied: u64,
    /// The source of the last scene that was opened.
    source: String,
}

impl App {
    /// The initial state.
    pub fn new(config: Config, orders: Sender<Order>, shared: Shared) -> Self {
        if let Some(warning) = &config.warning {
            let _ = orders.send(Order::Say(LogKind::Error, warning.clone()));
        }
        Self {
            config,
            outbox: Outbox::new(orders, shared),
            picture: picture::State::default(),
            published: Published::default(),
            filter: String::new(),
            camera_name: String::new(),
            console: console::State::default(),
            has_help: false,
            dialogs: files::Dialogs::default(),
            copied: 0,
            source: String::new(),
        }
    }

    /// Fetches the published state, and handles its changes.
    pub fn look(&mut self) -> Published {
        self.published = self.outbox.look();
        let model = &self.published.model;
        self.picture.look(model, &mut self.outbox);
        let source = model.scene.as_ref().map(|scene| scene.source.as_str()).unwrap_or_default();
        if !source.is_empty() && source != self.source {
            self.config.note_recent(&absolute(source));
            source.clone_into(&mut self.source);
        }
        self.published.clone()
    }

    /// Saves the configuration.
    pub fn save(&mut self) {
        // Include changes since the last frame. Without a model, keep the saved settings.
        self.look();
        if self.published.has_model {
            self.config.keep_settings(&self.published.model);
        }
        if let Err(error) = self.config.save() {
            tracing::warn!("the window's settings cannot be kept: {error:#}");
        }
    }

    /// Logs the camera's line once the camera rests.
    fn log_camera(&mut self, ui: &Ui) {
        let Some(moved) = self.outbox.camera_moved() else { return };
        if moved.elapsed() < SETTLED || ui.input(|input| input.pointer.any_down()) {
            ui.ctx().request_repaint_after(SETTLED);
            return;
        }
        let model = &self.published.model;
        let camera = self.outbox.camera(model);
        let pivot = selection::pivot(model, &self.outbox);
        let distance_m = (pivot - camera.position).dot(camera.forward).max(1.0);
        self.outbox.log_camera(camera::command(&camera, distance_m));
    }

    /// Lays out the window.
    pub fn show(&mut self, ui: &mut Ui) {
        let model = self.published.model.clone();
        if let Some((number, line)) = &model.command_line
            && *number != self.copied
        {
            self.copied = *number;
            ui.ctx().copy_text(line.clone());
        }
        let is_held = |input: &egui::InputState| {
            let pointer = &input.pointer;
            (pointer.any_down() || pointer.any_released()) && !pointer.any_pressed()
        };
        if !ui.input(is_held) {
            self.outbox.end_gesture();
        }
        let Self { config, outbox, picture, dialogs, has_help, .. } = self;
        keys::handle(ui, &model, config, dialogs, has_help, &mut picture.mode, outbox);
        let bar = Frame::new().fill(theme::PANEL).inner_margin(egui::Margin::symmetric(8, 4));
        let menu = Panel::top("menu").frame(bar);
        *has_help |=
            menu.show(ui, |ui| panels::menu::show(ui, &model, config, dialogs, outbox)).inner;
        let light = picture.light_under_pointer(&self.published);
        Panel::bottom("status")
            .frame(bar)
            .show(ui, |ui| panels::status::show(ui, &self.published, light, outbox));
        let side = Frame::new().fill(theme::PANEL).inner_margin(egui::Margin::symmetric(6, 4));
        if config.left {
            let panel =
                Panel::left("left").frame(side).default_size(256.0).size_range(200.0..=420.0);
            let (filter, mode) = (&mut self.filter, &mut picture.mode);
            panel.show(ui, |ui| panels::left(ui, &model, filter, mode, outbox));
        }
        let mut is_timed = false;
        if config.right {
            let panel =
                Panel::right("right").frame(side).default_size(296.0).size_range(260.0..=460.0);
            let name = &mut self.camera_name;
            is_timed = panel.show(ui, |ui| panels::right(ui, &model, config, name, outbox)).inner;
        }
        // Measure stage times only while they are shown.
        outbox.set_timed(is_timed);
        if config.console {
            let deep = Frame::new().fill(theme::DEEP).inner_margin(egui::Margin::symmetric(8, 4));
            let panel = Panel::bottom("console").frame(deep).resizable(true);
            let panel = panel.default_size(120.0).size_range(70.0..=400.0);
            panel.show(ui, |ui| console::show(ui, &model, &mut self.console, outbox));
        }
        if model.playback.animation.is_some() {
            let panel = Panel::bottom("animation").frame(bar);
            panel.show(ui, |ui| panels::animation::show(ui, &model, outbox));
        }
        let deep = Frame::new().fill(theme::DEEP);
        CentralPanel::no_frame().frame(deep).show(ui, |ui| {
            // Do this even without a scene: its first picture will have this size.
            let room = ui.available_rect_before_wrap().size() * ui.ctx().pixels_per_point();
            if room.x >= 1.0 && room.y >= 1.0 {
                let size = UVec2::new(room.x as u32, room.y as u32);
                let size = if config.half_size { size / 2 } else { size };
                outbox.set_size(size.max(UVec2::ONE));
            }
            match &model.scene {
                Some(scene) => {
                    let (published, speed) = (&self.published, &mut config.speed);
                    picture::show(ui, published, scene, picture, speed, outbox);
                }
                None => panels::welcome::show(ui, &model, &config.recent, dialogs, outbox),
            }
        });
        if *has_help && panels::help::show(ui) {
            *has_help = false;
        }
        self.log_camera(ui);
        if let Some(line) = self.dialogs.chosen() {
            self.outbox.typed_line(line);
        }
        if self.dialogs.are_open() {
            ui.ctx().request_repaint_after(Duration::from_millis(200));
        }
    }
}
