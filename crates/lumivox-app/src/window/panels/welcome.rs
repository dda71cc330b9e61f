//! The start page of a window without a scene.

use egui::{Align, Layout, RichText, ScrollArea, Ui, vec2};
use lumivox_scene::builtin;

use super::files::Dialogs;
use super::widgets::weak;
use crate::window::model::Model;
use crate::window::outbox::Outbox;
use crate::window::theme;

/// Draws a button for the dialog, built-in scenes, and recent files.
pub fn show(
    ui: &mut Ui,
    model: &Model,
    recent: &[String],
    dialogs: &mut Dialogs,
    outbox: &mut Outbox,
) {
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.with_layout(Layout::top_down(Align::Center), |ui| {
            ui.set_max_width(ui.available_width().min(460.0));
            ui.add_space((ui.available_height() * 0.12).clamp(8.0, 90.0));
            ui.label(RichText::new("Lumivox").size(30.0).color(theme::ACCENT));
            weak(ui, "Global illumination by voxel cone tracing");
            ui.add_space(14.0);
            if model.jobs.is_empty() {
                let open = egui::Button::new(RichText::new("Open a scene ...").size(14.0));
                if ui.add(open.min_size(vec2(180.0, 28.0))).clicked() {
                    dialogs.open();
                }
                weak(ui, "or drop a file onto this window");
            } else {
                for job in &model.jobs {
                    ui.label(RichText::new(&job.words).size(14.0));
                }
            }
            ui.add_space(12.0);
            ui.label(RichText::new("Built-in scenes").strong());
            ui.horizontal_wrapped(|ui| {
                for name in builtin::names() {
                    if ui.button(*name).clicked() {
                        outbox.open(&format!("builtin:{name}"));
                    }
                }
            });
            if !recent.is_empty() {
                ui.add_space(12.0);
                ui.label(RichText::new("Recent").strong());
                for source in recent {
                    let link = egui::Button::new(source).frame(false).truncate();
                    if ui.add(link).clicked() {
                        outbox.open(source);
                    }
                }
            }
        });
    });
}
