//! Times of frames and stages.

use egui::{RichText, Ui, vec2};
use egui_plot::{FilledArea, Plot};

use super::widgets::weak;
use crate::window::model::{FrameTime, KEPT_FRAMES, Model, STAGES};
use crate::window::theme;

/// Draws the times of the last frames, as a stacked plot and in numbers.
pub fn show(ui: &mut Ui, model: &Model) {
    let Some(last) = model.frames.last() else {
        weak(ui, "No frame yet.");
        return;
    };
    let shown: Vec<FrameTime> =
        model.frames.iter().rev().take(KEPT_FRAMES).rev().copied().collect();
    let mean = shown.iter().map(|frame| frame.total_ms).sum::<f32>() / shown.len() as f32;
    ui.label(format!(
        "{:.1} ms a frame, {mean:.1} ms in the mean of {}",
        last.total_ms,
        shown.len()
    ));
    ui.label(in_motion(model, mean));
    if let Some(figures) = figures(model) {
        ui.label(figures);
    }
    weak(ui, format!("{} of {} frames in the picture", model.frame_count, model.settings.frames));
    plot(ui, &shown);
    for (stage, name) in STAGES.iter().enumerate() {
        let times = shown.iter().map(|frame| frame.stages_ms[stage]);
        let count = times.clone().filter(|ms| *ms > 0.0).count();
        if count == 0 {
            continue;
        }
        let mean = times.sum::<f32>() / count as f32;
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(10.0, 10.0), egui::Sense::hover());
            ui.painter().rect_filled(rect, 2.0, theme::STAGES[stage]);
            ui.label(*name);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new(format!("{mean:.1} ms")).monospace());
            });
        });
    }
    weak(ui, "Times of stages are taken while this is open; that itself takes some time.");
}

/// The frame budget and the picture's scale, as a line of text.
fn in_motion(model: &Model, mean_ms: f32) -> String {
    let pacing = &model.pacing;
    if pacing.budget_ms <= 0.0 {
        return "no budget: all pixels in motion, too".to_owned();
    }
    format!(
        "{:.0} % of the budget of {} ms, scale {:.0} %",
        100.0 * mean_ms / pacing.budget_ms,
        pacing.budget_ms,
        100.0 * pacing.scale()
    )
}

/// Cone samples and length of the history, as a line of text.
fn figures(model: &Model) -> Option<String> {
    let figures = model.figures?;
    let samples = format!("{:.0} cone samples a pixel", figures.samples_per_pixel);
    Some(match figures.history_frames {
        Some(frames) => format!("{samples}, light of {frames:.1} frames"),
        None => samples,
    })
}

fn plot(ui: &mut Ui, shown: &[FrameTime]) {
    let first = KEPT_FRAMES - shown.len();
    let xs: Vec<f64> = (first..KEPT_FRAMES).map(|x| x as f64).collect();
    let mut low = vec![0.0; shown.len()];
    let mut areas = Vec::new();
    for (stage, name) in STAGES.iter().enumerate() {
        let high: Vec<f64> = low
            .iter()
            .zip(shown)
            .map(|(low, frame)| low + f64::from(frame.stages_ms[stage]))
            .collect();
        if high != low {
            areas.push(FilledArea::new(*name, &xs, &low, &high).fill_color(theme::STAGES[stage]));
        }
        low = high;
    }
    // Time outside of stages; the whole frame's while stages are not timed.
    let total: Vec<f64> =
        low.iter().zip(shown).map(|(low, frame)| f64::from(frame.total_ms).max(*low)).collect();
    areas.push(
        FilledArea::new("rest", &xs, &low, &total).fill_color(egui::Color32::from_gray(0x3a)),
    );
    let plot = Plot::new("times")
        .height(110.0)
        .show_x(false)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_axes([false, true])
        .include_y(0.0)
        .default_x_bounds(0.0, KEPT_FRAMES as f64)
        .y_axis_label("ms");
    plot.show(ui, |plot| {
        for area in areas {
            plot.add(area);
        }
    });
}
