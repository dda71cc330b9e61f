//! The window's panels.

pub mod animation;
pub mod console;
pub mod files;
pub mod help;
pub mod histogram;
pub mod icons;
pub mod lights;
pub mod materials;
pub mod menu;
pub mod objects;
pub mod parameters;
pub mod performance;
pub mod picture;
pub mod status;
pub mod view;
pub mod volume;
pub mod welcome;
pub mod widgets;

use egui::{CollapsingHeader, RichText, ScrollArea, Ui};
use lumivox_explorer::parameters::Group;

use super::config::Config;
use super::gizmo::Mode;
use super::model::Model;
use super::outbox::Outbox;
use super::theme;

/// A collapsible section of a side panel; returns whether it is open.
fn section(ui: &mut Ui, title: &str, is_open: bool, contents: impl FnOnce(&mut Ui)) -> bool {
    let title = RichText::new(title).size(13.0).strong().color(theme::ACCENT);
    let header = CollapsingHeader::new(title).default_open(is_open).show_unindented(ui, |ui| {
        contents(ui);
        ui.add_space(4.0);
    });
    header.openness > 0.0
}

/// Draws a panel's contents without widening the panel: contents one point too wide would widen it
/// in every frame.
fn fixed<T>(ui: &mut Ui, contents: impl FnOnce(&mut Ui) -> T) -> T {
    let rect = ui.available_rect_before_wrap();
    let _ = ui.allocate_rect(rect, egui::Sense::hover());
    let mut inside = ui.new_child(egui::UiBuilder::new().max_rect(rect));
    inside.shrink_clip_rect(rect);
    contents(&mut inside)
}

/// Draws the left panel: objects, lights, materials.
pub fn left(ui: &mut Ui, model: &Model, filter: &mut String, mode: &mut Mode, outbox: &mut Outbox) {
    let contents = |ui: &mut Ui| {
        let Some(scene) = &model.scene else {
            ui.label(
                RichText::new("No scene yet. Open one with File, or drop a file here.")
                    .color(theme::WEAK),
            );
            return;
        };
        let objects = format!("Objects ({})", scene.objects.len());
        section(ui, &objects, true, |ui| objects::show(ui, scene, filter, mode, outbox));
        let lights = format!("Lights ({})", scene.lights.len());
        section(ui, &lights, true, |ui| lights::show(ui, scene, outbox));
        let materials = format!("Materials ({})", scene.materials.len());
        section(ui, &materials, false, |ui| materials::show(ui, scene, outbox));
    };
    fixed(ui, |ui| ScrollArea::vertical().auto_shrink(false).show(ui, contents));
}

/// Draws the right panel: settings; returns whether to measure stage times.
pub fn right(
    ui: &mut Ui,
    model: &Model,
    config: &mut Config,
    camera_name: &mut String,
    outbox: &mut Outbox,
) -> bool {
    let Config { speed, half_size, .. } = config;
    let contents = |ui: &mut Ui| {
        section(ui, "View", true, |ui| view::show(ui, model, camera_name, speed, outbox));
        section(ui, "Light", true, |ui| parameters::group(ui, Group::Light, model, outbox));
        section(ui, "Picture", true, |ui| view::picture(ui, model, half_size, outbox));
        section(ui, "Volume", false, |ui| volume::show(ui, model, outbox));
        section(ui, "Cones", false, |ui| view::cones(ui, model, outbox));
        section(ui, "Performance", false, |ui| performance::show(ui, model))
    };
    fixed(ui, |ui| ScrollArea::vertical().auto_shrink(false).show(ui, contents).inner)
}
