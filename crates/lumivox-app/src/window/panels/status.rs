//! The line at the bottom: how things are, what is under way, what went wrong.

use egui::{Align, Layout, RichText, Ui};

use super::icons::{self, Icon};
use super::widgets::count;
use crate::window::app::App;
use crate::window::model::Model;
use crate::window::theme;
use crate::window::worker::Order;

/// The line.
pub fn show(ui: &mut Ui, model: &Model, app: &mut App) {
    if let Some((number, text)) = &model.error {
        ui.horizontal(|ui| {
            if icons::button(ui, Icon::Cross, theme::ERROR, "Close the error").clicked() {
                app.order(Order::CloseError(*number));
            }
            ui.add(egui::Label::new(RichText::new(text).color(theme::ERROR)).wrap());
        });
    }
    ui.horizontal(|ui| {
        for job in &model.jobs {
            ui.add(egui::Spinner::new().size(12.0));
            if let Some(share) = job.share {
                ui.add(
                    egui::ProgressBar::new(share)
                        .desired_width(90.0)
                        .desired_height(10.0)
                        .corner_radius(2),
                );
            }
            ui.label(&job.words);
            if job.cancel.is_some() && ui.small_button("Cancel").clicked() {
                app.order(Order::Cancel(job.cancel));
            }
            ui.separator();
        }
        if let Some(scene) = &model.scene {
            if let Some(frame) = model.frames.last() {
                ui.label(format!("{:.0} ms", frame.total_ms))
                    .on_hover_text("Time of the last frame");
                ui.separator();
            }
            let (done, all) = (model.frame_count, model.settings.frames);
            ui.label(format!("{done}/{all} frames"))
                .on_hover_text("Frames in the mean that is shown");
            ui.separator();
            ui.label(format!("{} voxels", count(model.voxels.voxels.into())));
            ui.separator();
            ui.label(format!("{} triangles", count(scene.triangles as u64)));
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            // The kind and the version of the driver are in the tooltip.
            let name = model.gpu.split(" (").next().unwrap_or_default();
            let label = egui::Label::new(RichText::new(name).color(theme::WEAK)).truncate();
            ui.add(label).on_hover_text(&model.gpu);
        });
    });
}
