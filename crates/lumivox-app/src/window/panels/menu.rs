//! The menu bar.

use egui::{Button, MenuBar, RichText, Ui};
use lumivox_explorer::FRAME_BUDGET_MS;
use lumivox_scene::builtin;

use super::files::Dialogs;
use crate::window::config::Config;
use crate::window::model::Model;
use crate::window::orders::Order;
use crate::window::outbox::Outbox;
use crate::window::theme;

/// Draws the menus, the scene's name, and the panels' switches; returns whether to open the help.
pub fn show(
    ui: &mut Ui,
    model: &Model,
    config: &mut Config,
    dialogs: &mut Dialogs,
    outbox: &mut Outbox,
) -> bool {
    let mut has_help = false;
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file(ui, model, &config.recent, dialogs, outbox));
        ui.menu_button("Edit", |ui| edit(ui, model, outbox));
        ui.menu_button("Window", |ui| window(ui, model, config, outbox));
        ui.menu_button("Help", |ui| {
            if ui.add(Button::new("Keys and mouse").shortcut_text("F1")).clicked() {
                has_help = true;
            }
            if ui.button("List all commands").clicked() {
                config.console = true;
                outbox.typed_line("help");
            }
        });
        ui.separator();
        let name = model.scene.as_ref().map_or("no scene", |scene| scene.name.as_str());
        ui.add(egui::Label::new(RichText::new(name).color(theme::WEAK)).truncate());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.toggle_value(&mut config.right, "Settings");
            ui.toggle_value(&mut config.console, "Console");
            ui.toggle_value(&mut config.left, "Scene");
        });
    });
    has_help
}

fn file(ui: &mut Ui, model: &Model, recent: &[String], dialogs: &mut Dialogs, outbox: &mut Outbox) {
    if ui.add(Button::new("Open ...").shortcut_text("Ctrl+O")).clicked() {
        dialogs.open();
    }
    ui.menu_button("Open recent", |ui| {
        for source in recent {
            if ui.button(source).clicked() {
                outbox.open(source);
            }
        }
        if recent.is_empty() {
            ui.label("none yet");
        }
    });
    ui.menu_button("Built-in scenes", |ui| {
        for name in builtin::names() {
            if ui.button(*name).clicked() {
                outbox.open(&format!("builtin:{name}"));
            }
        }
    });
    let has_scene = model.scene.is_some();
    if ui.add_enabled(has_scene, Button::new("Read again")).clicked() {
        outbox.line("reload");
    }
    ui.separator();
    if ui.add_enabled(has_scene, Button::new("Save picture ...").shortcut_text("Ctrl+S")).clicked()
    {
        dialogs.save();
    }
    let copy = Button::new("Copy command line").shortcut_text("Ctrl+Shift+C");
    let tip = "A command line that makes this picture without a window";
    if ui.add_enabled(has_scene, copy).on_hover_text(tip).clicked() {
        outbox.order(Order::CommandLine);
    }
    ui.separator();
    if ui.add(Button::new("Quit").shortcut_text("Ctrl+Q")).clicked() {
        ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
    }
}

fn edit(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let [undo, redo] = &model.history;
    for (name, command, keys, step) in
        [("Undo", "undo", "Ctrl+Z", undo), ("Redo", "redo", "Ctrl+Shift+Z", redo)]
    {
        let words = step.as_ref().map_or(name.to_owned(), |step| format!("{name} {step}"));
        if ui.add_enabled(step.is_some(), Button::new(words).shortcut_text(keys)).clicked() {
            outbox.line(command);
        }
    }
}

fn window(ui: &mut Ui, model: &Model, config: &mut Config, outbox: &mut Outbox) {
    ui.checkbox(&mut config.left, "Scene");
    ui.checkbox(&mut config.right, "Settings");
    ui.horizontal(|ui| {
        ui.checkbox(&mut config.console, "Console");
        ui.weak("F2");
    });
    if ui.add(Button::new("Full screen").shortcut_text("F11")).clicked() {
        outbox.line("fullscreen");
    }
    ui.separator();
    ui.checkbox(&mut config.half_size, "Picture of half size");
    let mut is_coarser = model.pacing.budget_ms > 0.0;
    if ui.checkbox(&mut is_coarser, "Coarser while moving").changed() {
        let budget_ms = if is_coarser { FRAME_BUDGET_MS } else { 0.0 };
        outbox.line(format!("frame_budget {budget_ms}"));
    }
}
