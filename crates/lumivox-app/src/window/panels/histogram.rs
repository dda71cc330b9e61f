//! Luminance histogram of the picture, relative to its exposure.

use egui::{Align2, Color32, FontId, Sense, Stroke, Ui, pos2, vec2};
use lumivox_render::Histogram;

use crate::window::model::Model;
use crate::window::theme;

/// Height of the bars, points.
const HEIGHT: f32 = 64.0;
/// Stops shown below and above middle grey.
const AROUND_GREY: [f32; 2] = [10.0, 7.0];

/// Draws a bar for each quarter of a stop, around middle grey at the current exposure, so that the
/// bars move with the exposure.
pub fn show(ui: &mut Ui, model: &Model) {
    let Some((histogram, stops)) = &model.histogram else { return };
    let size = vec2(ui.available_width() - 8.0, HEIGHT + 14.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let per_stop = Histogram::BINS_PER_STOP as f32;
    let grey = Histogram::middle_grey(*stops);
    let [first, last] = [grey - AROUND_GREY[0] * per_stop, grey + AROUND_GREY[1] * per_stop];
    let x = |bin: f32| rect.left() + rect.width() * (bin - first) / (last - first);
    let bottom = rect.top() + HEIGHT;
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect.with_max_y(bottom), 2.0, theme::DEEP);
    let white = Histogram::white(*stops);
    let most = histogram.bins.iter().max().copied().unwrap_or(0).max(1) as f32;
    for (bin, count) in histogram.bins.iter().enumerate().filter(|(_, count)| **count > 0) {
        // The square root keeps low bars visible beside high ones.
        let height = HEIGHT * (*count as f32 / most).sqrt();
        let (left, right) = (x(bin as f32), x(bin as f32 + 1.0));
        let bar = egui::Rect::from_min_max(pos2(left, bottom - height), pos2(right, bottom));
        let color = if bin as f32 >= white { theme::ERROR } else { theme::ACCENT };
        painter.rect_filled(bar, 0.0, color);
    }
    let font = FontId::proportional(10.0);
    for (bin, name) in [(grey, "grey"), (white, "white")] {
        painter.vline(x(bin), rect.top()..=bottom, Stroke::new(1.0, Color32::from_gray(200)));
        let at = pos2(x(bin), bottom + 1.0);
        painter.text(at, Align2::CENTER_TOP, name, font.clone(), theme::WEAK);
    }
    let above = 100.0 * histogram.share_above_white(*stops);
    response.on_hover_text(format!(
        "Pixels by luminance, four bars a stop, at {stops:+.1} stops: what is a middle grey, and what is white. {above:.1} % \
         are brighter than white."
    ));
}
