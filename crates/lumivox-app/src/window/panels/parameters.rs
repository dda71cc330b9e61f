//! Rows for the settings of `lumivox_explorer::parameters`: name, unit, meaning, and reset.

use egui::{ComboBox, DragValue, Slider, Ui};
use glam::Vec3;
use lumivox_explorer::parameters::{Group, Kind, PARAMETERS, Parameter, Value, find_parameter};

use super::widgets::{is_rounded, reset, rest_width, row, vector};
use crate::window::model::Model;
use crate::window::outbox::Outbox;

/// The widest range of numbers that has a slider.
const WIDEST_SLIDER: f32 = 64.0;

/// Draws all settings of a group.
pub fn group(ui: &mut Ui, group: Group, model: &Model, outbox: &mut Outbox) {
    for parameter in PARAMETERS.iter().filter(|parameter| parameter.group == group) {
        show(ui, parameter, model, outbox);
    }
}

/// Draws the setting of this name.
pub fn named(ui: &mut Ui, name: &str, model: &Model, outbox: &mut Outbox) {
    if let Some(parameter) = find_parameter(name) {
        show(ui, parameter, model, outbox);
    }
}

fn show(ui: &mut Ui, parameter: &'static Parameter, model: &Model, outbox: &mut Outbox) {
    let value = outbox.value(parameter, model);
    let usual = parameter.get(&model.usual);
    let title = title(parameter.name);
    let tip = tip(parameter, usual);
    let set = row(ui, &title, &tip, |ui| {
        ui.push_id(parameter.name, |ui| {
            let set = field(ui, parameter, &title, &tip, value);
            if reset(ui, value != usual, &format!("Back to {usual}")) { Some(usual) } else { set }
        })
        .inner
    });
    if let Some(set) = set
        && set != value
    {
        outbox.set_value(parameter, set);
    }
}

/// A setting's name as a title.
fn title(name: &str) -> String {
    let words = name.replace('_', " ");
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn tip(parameter: &Parameter, usual: Value) -> String {
    let unit =
        if parameter.unit.is_empty() { String::new() } else { format!(" {}", parameter.unit) };
    let values = parameter.kind.in_words();
    format!("{}.\n\n{}: {values}{unit}.\nUsually {usual}.", parameter.summary, parameter.name)
}

fn field(
    ui: &mut Ui,
    parameter: &Parameter,
    title: &str,
    tip: &str,
    value: Value,
) -> Option<Value> {
    let width = rest_width(ui);
    match (parameter.kind, value) {
        (Kind::Switch, Value::Switch(mut on)) => {
            let response = ui.checkbox(&mut on, "").on_hover_text(tip).accessible_name(title);
            response.changed().then_some(Value::Switch(on))
        }
        (Kind::Whole { low, high, multiple }, Value::Whole(mut number)) => {
            let response = if high - low <= 32 && multiple == 1 {
                ui.spacing_mut().slider_width = (width - 50.0).max(30.0);
                ui.add(Slider::new(&mut number, low..=high))
            } else {
                let drag = DragValue::new(&mut number)
                    .range(low..=high)
                    .speed(f64::from(multiple).max(0.2));
                ui.add_sized([width, 18.0], drag.suffix(unit_suffix(parameter.unit)))
            };
            number = (number / multiple).max(low / multiple) * multiple;
            response
                .on_hover_text(tip)
                .accessible_name(title)
                .changed()
                .then_some(Value::Whole(number))
        }
        (Kind::Number { low, high, words, off }, value) => number_field(
            ui,
            (title, tip),
            (low, high, words.first().copied(), off),
            unit_suffix(parameter.unit),
            value,
            width,
        ),
        (Kind::Vector { low, below }, Value::Vector(vector_now)) => {
            let mut numbers = vector_now.to_array();
            let inner = egui::vec2(width, 18.0);
            let layout = egui::Layout::left_to_right(egui::Align::Center);
            let response = ui.allocate_ui_with_layout(inner, layout, |ui| {
                vector(ui, &mut numbers, 0.01, 3, ["x", "y", "z"])
            });
            let highest = below - f32::EPSILON * below.abs().max(1.0);
            let numbers = numbers.map(|number| number.clamp(low, highest));
            response.inner.then(|| Value::Vector(Vec3::from(numbers)))
        }
        (Kind::Choice(choices), Value::Choice(mut name)) => {
            let before = name;
            let combo = ComboBox::from_id_salt(parameter.name).width(width).selected_text(before);
            combo
                .show_ui(ui, |ui| {
                    for choice in choices {
                        ui.selectable_value(&mut name, choice.name, choice.name)
                            .on_hover_text(choice.help);
                    }
                })
                .response
                .on_hover_text(tip)
                .accessible_name(title);
            (name != before).then_some(Value::Choice(name))
        }
        // The table's tests rule out values that do not match their kind.
        _ => None,
    }
}

fn unit_suffix(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

fn number_field(
    ui: &mut Ui,
    (title, tip): (&str, &str),
    (low, high, word, off): (f32, f32, Option<&'static str>, Option<f32>),
    unit: String,
    value: Value,
    width: f32,
) -> Option<Value> {
    let mut set = None;
    let mut left = width;
    if let Some(word) = word {
        let mut is_word = matches!(value, Value::Word(_));
        let before = ui.available_width();
        if ui.checkbox(&mut is_word, word).accessible_name(format!("{title}: {word}")).changed() {
            let number = if (low..=high).contains(&0.0) { 0.0 } else { low.max(1.0).min(high) };
            set = Some(if is_word { Value::Word(word) } else { Value::Number(number) });
        }
        left -= before - ui.available_width();
    }
    if let Value::Number(mut number) = value {
        let before = number;
        let low = off.map_or(low, |off| off.min(low));
        let response = if high - low <= WIDEST_SLIDER && word.is_none() {
            ui.spacing_mut().slider_width = (left - 54.0).max(30.0);
            ui.add(Slider::new(&mut number, low..=high).max_decimals(3))
        } else {
            let speed = f64::from((high - low).min(10.0) * 0.005).max(0.001);
            let drag = DragValue::new(&mut number).range(low..=high).speed(speed).max_decimals(3);
            ui.add_sized([left.max(40.0), 18.0], drag.suffix(unit))
        };
        let is_changed = response.on_hover_text(tip).accessible_name(title).changed();
        if is_changed && !is_rounded(number, before, 3) {
            // Values between "off" and the range are invalid.
            let number = match off {
                Some(off) if number < low.max(0.0) => off,
                _ => number,
            };
            set = set.or(Some(Value::Number(number)));
        }
    }
    set
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameter_names_become_readable_titles() {
        assert_eq!(title("voxel_per_diameter"), "Voxel per diameter");
    }

    #[test]
    fn every_parameter_has_a_field_for_each_of_its_values() {
        let context = egui::Context::default();
        let settings = lumivox_render::RenderSettings::default();
        let mut names = 0;
        let output = context.run_ui(egui::RawInput::default(), |ui| {
            for parameter in PARAMETERS.iter() {
                let value = parameter.get(&settings);
                let before = ui.cursor();
                ui.push_id(parameter.name, |ui| {
                    assert_eq!(
                        field(ui, parameter, "title", "tip", value),
                        None,
                        "{}",
                        parameter.name
                    );
                });
                assert_ne!(ui.cursor(), before, "{} shows nothing", parameter.name);
                names += 1;
            }
        });
        output.drop_without_applying_deltas();
        assert!(names >= PARAMETERS.len());
    }
}
