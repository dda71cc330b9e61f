//! Keyboard shortcuts.

use egui::{Key, Modifiers, Ui};

use super::app::App;
use super::gizmo;
use super::lines::quoted;
use super::model::{Model, Selected};
use super::orders::Order;
use super::panels::{self, console};

impl App {
    /// Handles keys: some always, others only while no text field has the focus.
    pub fn keys(&mut self, ui: &Ui, model: &Model) {
        let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
        let command = Modifiers::COMMAND;
        if pressed(Modifiers::NONE, Key::F1) {
            self.has_help = !self.has_help;
        }
        if pressed(Modifiers::NONE, Key::F2) {
            self.config.console = !self.config.console;
            if self.config.console {
                // Focus the console's input line.
                ui.memory_mut(|memory| memory.request_focus(console::line()));
            }
        }
        if pressed(Modifiers::NONE, Key::F11) {
            self.line("fullscreen");
        }
        if pressed(command, Key::O) {
            self.dialogs.open();
        }
        if pressed(command | Modifiers::SHIFT, Key::C) {
            self.order(Order::CommandLine);
        }
        if pressed(command, Key::S) {
            self.dialogs.save();
        }
        if pressed(command, Key::Q) {
            ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
        }
        if ui.ctx().egui_wants_keyboard_input() {
            return;
        }
        if pressed(command | Modifiers::SHIFT, Key::Z) || pressed(command, Key::Y) {
            self.line("redo");
        } else if pressed(command, Key::Z) {
            self.line("undo");
        }
        for (key, number) in [(Key::Num1, 1), (Key::Num2, 2)] {
            if pressed(command, key) {
                self.line(format!("store {number}"));
            } else if pressed(Modifiers::NONE, key) {
                self.line(format!("pos{number}"));
            }
        }
        if pressed(Modifiers::NONE, Key::Space) {
            self.line(if model.playback.is_playing { "pause" } else { "play" });
        }
        if !model.jobs.is_empty() && pressed(Modifiers::NONE, Key::Escape) {
            // The first Esc cancels jobs; without jobs, it closes the help and clears the
            // selection.
            self.order(Order::Cancel(None));
        }
        if pressed(Modifiers::NONE, Key::Escape) {
            self.has_help = false;
            self.select(None);
        }
        for (key, mode) in
            [(Key::T, gizmo::Mode::Move), (Key::R, gizmo::Mode::Turn), (Key::Z, gizmo::Mode::Size)]
        {
            if pressed(Modifiers::NONE, key) {
                self.gizmo = mode;
            }
        }
        if pressed(Modifiers::NONE, Key::F) {
            panels::picture::frame_selection(self, model);
        }
        let Some(selected) = self.selected.clone() else { return };
        match &selected {
            Selected::Object(name) => {
                if pressed(Modifiers::NONE, Key::H) {
                    let object =
                        model.scene.iter().flat_map(|s| &s.objects).find(|o| o.name == *name);
                    let is_hidden = object.is_some_and(|object| object.is_hidden);
                    let verb = if is_hidden { "show" } else { "hide" };
                    self.line(format!("{verb} {}", quoted(name)));
                }
            }
            Selected::Light(name) => {
                if pressed(Modifiers::NONE, Key::Delete) {
                    self.line(format!("remove_light {}", quoted(name)));
                }
            }
        }
    }
}
