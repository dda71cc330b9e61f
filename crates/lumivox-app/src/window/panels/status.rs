//! The status bar: errors, jobs, and figures.

use std::time::{Duration, Instant};

use egui::{Align, Layout, RichText, Ui};
use lumivox_render::Photometry;

use super::icons::{self, Icon};
use super::widgets::count;
use crate::window::model::{Doing, Model, RENDERING};
use crate::window::orders::{Order, Published};
use crate::window::outbox::Outbox;
use crate::window::theme;

/// Interval at which times are updated. A spinner would repaint constantly, and take CPU time from
/// the renderer.
const TICK: Duration = Duration::from_millis(250);
/// Activities shorter than this are not shown.
const SOON: Duration = Duration::from_millis(400);

/// Draws the status bar, with the light under the pointer.
pub fn show(ui: &mut Ui, published: &Published, light: Option<Photometry>, outbox: &mut Outbox) {
    let model = &*published.model;
    if let Some((number, text)) = &model.error {
        ui.horizontal(|ui| {
            if icons::button(ui, Icon::Cross, theme::ERROR, "Close the error").clicked() {
                outbox.order(Order::CloseError(*number));
            }
            ui.add(egui::Label::new(RichText::new(text).color(theme::ERROR)).wrap());
        });
    }
    if !model.jobs.is_empty() {
        ui.ctx().request_repaint_after(TICK);
    }
    ui.horizontal(|ui| {
        for job in &model.jobs {
            if let Some(share) = job.share {
                ui.add(
                    egui::ProgressBar::new(share)
                        .desired_width(90.0)
                        .desired_height(10.0)
                        .corner_radius(2),
                );
            }
            ui.label(with_time(&job.words, job.since));
            if job.cancel.is_some() && ui.small_button("Cancel").clicked() {
                outbox.order(Order::Cancel(job.cancel));
            }
            ui.separator();
        }
        if let Some(activity) = &published.doing {
            doing(ui, model, activity);
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
            if let Some(light) = light {
                ui.label(light_words(light)).on_hover_text(
                    "Light under the pointer: what arrives there, and what a camera sees",
                );
                ui.separator();
            }
            // The kind and the version of the driver are in the tooltip.
            let name = model.gpu.split(" (").next().unwrap_or_default();
            let label = egui::Label::new(RichText::new(name).color(theme::WEAK)).truncate();
            ui.add(label).on_hover_text(&model.gpu);
        });
    });
}

/// Draws the worker's activity, its duration, and its progress.
fn doing(ui: &mut Ui, model: &Model, doing: &Doing) {
    // The shown time changes without a new model.
    ui.ctx().request_repaint_after(TICK);
    // Jobs show their own progress.
    if doing.since.elapsed() < SOON || !model.jobs.is_empty() {
        return;
    }
    let (done, all) = (model.frame_count, model.settings.frames);
    if doing.words == RENDERING && done > 0 {
        let bar = egui::ProgressBar::new(done as f32 / all.max(1) as f32);
        ui.add(bar.desired_width(60.0).desired_height(10.0).corner_radius(2));
    }
    ui.label(with_time(&doing.words, Some(doing.since)))
        .on_hover_text("What is waited for, and for how long");
    ui.separator();
}

/// `words` with the time since `since`.
fn with_time(words: &str, since: Option<Instant>) -> String {
    match since.map(|since| since.elapsed().as_secs()) {
        None | Some(0) => words.to_owned(),
        Some(seconds @ 1..60) => format!("{words}, {seconds} s"),
        Some(seconds) => format!("{words}, {}:{:02} min", seconds / 60, seconds % 60),
    }
}

/// Lux, if known, and cd/m².
fn light_words(light: Photometry) -> String {
    let luminance = format!("{} cd/m²", digits(light.luminance_cd_m2));
    match light.illuminance_lux {
        Some(lux) => format!("{} lx, {luminance}", digits(lux)),
        None => luminance,
    }
}

/// A number with three digits: the mean over a picture's frames is not more precise.
fn digits(value: f32) -> String {
    match value {
        value if value <= 0.0 => "0".to_owned(),
        value if value >= 100.0 => {
            let step = 10.0_f32.powf(value.log10().floor() - 2.0);
            count(((value / step).round() * step) as u64)
        }
        value if value >= 1e-4 => {
            format!("{value:.*}", (2.0 - value.log10().floor()).clamp(0.0, 7.0) as usize)
        }
        value => format!("{value:.2e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_shown_with_three_digits() {
        let words = |luminance_cd_m2, illuminance_lux| {
            light_words(Photometry { luminance_cd_m2, illuminance_lux })
        };
        assert_eq!(words(12.345, Some(101_234.0)), "101\u{2009}000 lx, 12.3 cd/m²");
        assert_eq!(words(0.001_234, None), "0.00123 cd/m²");
        assert_eq!(words(0.0, Some(0.0)), "0 lx, 0 cd/m²");
        assert_eq!(words(1.5e-6, Some(999.6)), "1\u{2009}000 lx, 1.50e-6 cd/m²");
    }

    #[test]
    fn activities_show_elapsed_time_after_some_seconds() {
        let ago = |seconds| Instant::now().checked_sub(Duration::from_secs(seconds));
        assert_eq!(with_time("lighting", ago(0)), "lighting");
        assert_eq!(with_time("lighting", ago(12)), "lighting, 12 s");
        assert_eq!(with_time("lighting", ago(125)), "lighting, 2:05 min");
        assert_eq!(with_time("reading, 0:07", None), "reading, 0:07");
    }
}
