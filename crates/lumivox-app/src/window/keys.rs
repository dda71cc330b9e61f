//! Keyboard shortcuts.

use egui::{Key, Modifiers, Ui};
use lumivox_console::quote;

use super::config::Config;
use super::gizmo::Mode;
use super::model::{Model, Selected};
use super::orders::Order;
use super::outbox::Outbox;
use super::panels::console;
use super::panels::files::Dialogs;
use super::selection;

/// Handles keys; most of them only while no text field has the focus.
pub fn handle(
    ui: &Ui,
    model: &Model,
    config: &mut Config,
    dialogs: &mut Dialogs,
    has_help: &mut bool,
    mode: &mut Mode,
    outbox: &mut Outbox,
) {
    let pressed = |modifiers, key| ui.input_mut(|input| input.consume_key(modifiers, key));
    let command = Modifiers::COMMAND;
    if pressed(Modifiers::NONE, Key::F1) {
        *has_help = !*has_help;
    }
    if pressed(Modifiers::NONE, Key::F2) {
        config.console = !config.console;
        if config.console {
            ui.memory_mut(|memory| memory.request_focus(console::line()));
        }
    }
    if pressed(Modifiers::NONE, Key::F11) {
        outbox.line("fullscreen");
    }
    if pressed(command, Key::O) {
        dialogs.open();
    }
    if pressed(command | Modifiers::SHIFT, Key::C) {
        outbox.order(Order::CommandLine);
    }
    if pressed(command, Key::S) {
        dialogs.save();
    }
    if pressed(command, Key::Q) {
        ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
    }
    if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    if pressed(command | Modifiers::SHIFT, Key::Z) || pressed(command, Key::Y) {
        outbox.line("redo");
    } else if pressed(command, Key::Z) {
        outbox.line("undo");
    }
    for (key, number) in [(Key::Num1, 1), (Key::Num2, 2)] {
        if pressed(command, key) {
            outbox.line(format!("store {number}"));
        } else if pressed(Modifiers::NONE, key) {
            outbox.line(format!("pos{number}"));
        }
    }
    if pressed(Modifiers::NONE, Key::Space) {
        outbox.line(if model.playback.is_playing { "pause" } else { "play" });
    }
    if !model.jobs.is_empty() && pressed(Modifiers::NONE, Key::Escape) {
        // The first Esc cancels jobs; without jobs, it closes the help and clears the
        // selection.
        outbox.order(Order::Cancel(None));
    }
    if pressed(Modifiers::NONE, Key::Escape) {
        *has_help = false;
        outbox.select(None);
    }
    for (key, choice) in [(Key::T, Mode::Move), (Key::R, Mode::Turn), (Key::Z, Mode::Size)] {
        if pressed(Modifiers::NONE, key) {
            *mode = choice;
        }
    }
    if pressed(Modifiers::NONE, Key::F) {
        selection::frame(model, outbox);
    }
    let Some(selected) = outbox.selected().cloned() else { return };
    match &selected {
        Selected::Object(name) => {
            if pressed(Modifiers::NONE, Key::H) {
                let object = model.scene.iter().flat_map(|s| &s.objects).find(|o| o.name == *name);
                let is_hidden = object.is_some_and(|object| object.is_hidden);
                let verb = if is_hidden { "show" } else { "hide" };
                outbox.line(format!("{verb} {}", quote(name)));
            }
        }
        Selected::Light(name) => {
            if pressed(Modifiers::NONE, Key::Delete) {
                outbox.line(format!("remove_light {}", quote(name)));
            }
        }
    }
}
