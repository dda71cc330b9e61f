//! The menu bar.

use egui::{Button, MenuBar, RichText, Ui};
use lumivox_explorer::FRAME_BUDGET_MS;
use lumivox_scene::builtin;

use crate::window::app::App;
use crate::window::model::Model;
use crate::window::orders::Order;
use crate::window::theme;

/// Draws the menus, the scene's name, and the panels' switches.
pub fn show(ui: &mut Ui, model: &Model, app: &mut App) {
    MenuBar::new().ui(ui, |ui| {
        ui.menu_button("File", |ui| file(ui, model, app));
        ui.menu_button("Edit", |ui| edit(ui, model, app));
        ui.menu_button("Window", |ui| window(ui, model, app));
        ui.menu_button("Help", |ui| {
            if ui.add(Button::new("Keys and mouse").shortcut_text("F1")).clicked() {
                app.has_help = true;
            }
            if ui.button("List all commands").clicked() {
                app.config.console = true;
                app.typed_line("help");
            }
        });
        ui.separator();
        let name = model.scene.as_ref().map_or("no scene", |scene| scene.name.as_str());
        ui.add(egui::Label::new(RichText::new(name).color(theme::WEAK)).truncate());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.toggle_value(&mut app.config.right, "Settings");
            ui.toggle_value(&mut app.config.console, "Console");
            ui.toggle_value(&mut app.config.left, "Scene");
        });
    });
}

fn file(ui: &mut Ui, model: &Model, app: &mut App) {
    if ui.add(Button::new("Open ...").shortcut_text("Ctrl+O")).clicked() {
        app.dialogs.open();
    }
    ui.menu_button("Open recent", |ui| {
        for source in app.config.recent.clone() {
            if ui.button(&source).clicked() {
                app.open_source(&source);
            }
        }
        if app.config.recent.is_empty() {
            ui.label("none yet");
        }
    });
    ui.menu_button("Built-in scenes", |ui| {
        for name in builtin::names() {
            if ui.button(*name).clicked() {
                app.open_source(&format!("builtin:{name}"));
            }
        }
    });
    let has_scene = model.scene.is_some();
    if ui.add_enabled(has_scene, Button::new("Read again")).clicked() {
        app.line("reload");
    }
    ui.separator();
    if ui.add_enabled(has_scene, Button::new("Save picture ...").shortcut_text("Ctrl+S")).clicked()
    {
        app.dialogs.save();
    }
    let copy = Button::new("Copy command line").shortcut_text("Ctrl+Shift+C");
    let tip = "A command line that makes this picture without a window";
    if ui.add_enabled(has_scene, copy).on_hover_text(tip).clicked() {
        app.order(Order::CommandLine);
    }
    ui.separator();
    if ui.add(Button::new("Quit").shortcut_text("Ctrl+Q")).clicked() {
        ui.ctx().send_viewport_cmd(egui::ViewportCommand::Close);
    }
}

fn edit(ui: &mut Ui, model: &Model, app: &mut App) {
    let [undo, redo] = &model.history;
    for (name, command, keys, step) in
        [("Undo", "undo", "Ctrl+Z", undo), ("Redo", "redo", "Ctrl+Shift+Z", redo)]
    {
        let words = step.as_ref().map_or(name.to_owned(), |step| format!("{name} {step}"));
        if ui.add_enabled(step.is_some(), Button::new(words).shortcut_text(keys)).clicked() {
            app.line(command);
        }
    }
}

fn window(ui: &mut Ui, model: &Model, app: &mut App) {
    ui.checkbox(&mut app.config.left, "Scene");
    ui.checkbox(&mut app.config.right, "Settings");
    ui.horizontal(|ui| {
        ui.checkbox(&mut app.config.console, "Console");
        ui.weak("F2");
    });
    if ui.add(Button::new("Full screen").shortcut_text("F11")).clicked() {
        app.line("fullscreen");
    }
    ui.separator();
    ui.checkbox(&mut app.config.half_size, "Picture of half size");
    let mut is_coarser = model.pacing.budget_ms > 0.0;
    if ui.checkbox(&mut is_coarser, "Coarser while moving").changed() {
        let budget_ms = if is_coarser { FRAME_BUDGET_MS } else { 0.0 };
        app.line(format!("frame_budget {budget_ms}"));
    }
}
