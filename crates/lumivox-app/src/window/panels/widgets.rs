//! Rows of a panel: a name on the left, a control on the right.

use egui::{Align, Layout, Response, RichText, Ui, vec2};

use super::icons::{self, Icon};
use crate::window::theme;

/// Width of the names, points.
const NAME_WIDTH: f32 = 104.0;
/// Width reserved on the right for the reset arrow.
const RESET_WIDTH: f32 = 20.0;

/// A row with a name, a tooltip and a control.
pub fn row<T>(ui: &mut Ui, name: &str, tip: &str, contents: impl FnOnce(&mut Ui) -> T) -> T {
    ui.horizontal(|ui| {
        let size = vec2(NAME_WIDTH, ui.spacing().interact_size.y);
        let layout = Layout::left_to_right(Align::Center);
        ui.allocate_ui_with_layout(size, layout, |ui| {
            ui.set_min_width(NAME_WIDTH);
            let label = ui.add(egui::Label::new(name).truncate());
            if !tip.is_empty() {
                label.on_hover_text(tip);
            }
        });
        contents(ui)
    })
    .inner
}

/// The width of a control that fills the row up to the reset arrow.
pub fn rest_width(ui: &Ui) -> f32 {
    (ui.available_width() - RESET_WIDTH).max(40.0)
}

/// A reset arrow, shown only if `is_changed`; returns whether it was clicked.
pub fn reset(ui: &mut Ui, is_changed: bool, tip: &str) -> bool {
    if !is_changed {
        return false;
    }
    icons::button(ui, Icon::Back, theme::ACCENT, tip).clicked()
}

/// Three numbers in a row; returns whether one has changed.
pub fn vector(
    ui: &mut Ui,
    numbers: &mut [f32; 3],
    speed: f64,
    decimals: usize,
    names: [&str; 3],
) -> bool {
    let width = ((ui.available_width() - 2.0 * 4.0) / 3.0).max(30.0);
    let mut is_changed = false;
    ui.spacing_mut().item_spacing.x = 4.0;
    for (number, (color, name)) in numbers.iter_mut().zip(theme::AXES.into_iter().zip(names)) {
        let response = ui
            .scope(|ui| {
                ui.visuals_mut().widgets.inactive.fg_stroke.color =
                    color.lerp_to_gamma(theme::TEXT, 0.55);
                let drag = egui::DragValue::new(number).speed(speed).max_decimals(decimals);
                ui.add_sized([width, 18.0], drag)
            })
            .inner;
        is_changed |= response.on_hover_text(name).accessible_name(name).changed();
    }
    is_changed
}

/// A line of a list, as wide as the remaining width minus `spare`.
pub fn item(ui: &mut Ui, is_chosen: bool, text: RichText, spare: f32) -> Response {
    let size = vec2((ui.available_width() - spare).max(20.0), 18.0);
    let layout =
        Layout::left_to_right(Align::Center).with_main_justify(true).with_main_align(Align::LEFT);
    ui.allocate_ui_with_layout(size, layout, |ui| {
        ui.set_max_size(size);
        ui.add(egui::Button::selectable(is_chosen, text).truncate())
    })
    .inner
}

/// Whether the slider has only rounded the previous value to its number of decimals.
pub fn is_rounded(now: f32, before: f32, decimals: i32) -> bool {
    (now - before).abs() <= 0.5001 * 10.0_f32.powi(-decimals)
}

/// Explanatory text.
pub fn weak(ui: &mut Ui, text: impl Into<String>) -> Response {
    ui.label(RichText::new(text).color(theme::WEAK))
}

/// A number of bytes, as text.
pub fn bytes(bytes: u64) -> String {
    match bytes {
        0..1024 => format!("{bytes} B"),
        1024..0x10_0000 => format!("{:.0} KiB", bytes as f64 / 1024.0),
        0x10_0000..0x4000_0000 => format!("{:.1} MiB", bytes as f64 / 1_048_576.0),
        _ => format!("{:.2} GiB", bytes as f64 / 1_073_741_824.0),
    }
}

/// A count with groups of three digits.
pub fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_bytes_are_formatted_for_reading() {
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(1_234_567), "1\u{2009}234\u{2009}567");
        assert_eq!([bytes(5), bytes(2048), bytes(5 << 20)], ["5 B", "2 KiB", "5.0 MiB"]);
    }
}
