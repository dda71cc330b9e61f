//! The scene's lights and surroundings.

use egui::{DragValue, RichText, Ui, vec2};
use glam::Vec3;
use lumivox_console::quote;
use lumivox_scene::{Light, LightField, LightForm, LightKind, LightValue};

use super::icons::{self, Icon};
use super::widgets::{item, row, vector, weak};
use crate::window::model::{SceneModel, Selected};
use crate::window::outbox::Outbox;
use crate::window::theme;

/// Draws all lights, the properties of the selected one, and the surroundings.
pub fn show(ui: &mut Ui, scene: &SceneModel, outbox: &mut Outbox) {
    for (name, light) in &scene.lights {
        let is_chosen = matches!(outbox.selected(), Some(Selected::Light(other)) if other == name);
        ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), egui::Sense::hover());
            ui.painter().circle_filled(rect.center(), 5.0, screen_color(light.color));
            let label = item(ui, is_chosen, RichText::new(name), 22.0);
            if label.on_hover_text(light.kind.word()).clicked() {
                outbox.select((!is_chosen).then(|| Selected::Light(name.clone())));
            }
            if icons::button(ui, Icon::Cross, theme::WEAK, &format!("Remove {name}")).clicked() {
                outbox.line(format!("remove_light {}", quote(name)));
            }
        });
        if is_chosen {
            chosen(ui, name, light, outbox);
            ui.separator();
        }
    }
    if scene.lights.is_empty() {
        weak(ui, "No lamps; what emits and the surroundings shine.");
    }
    ui.horizontal(|ui| {
        weak(ui, "Add");
        for kind in LightKind::ALL {
            if ui.button(kind.word()).on_hover_text(kind.summary()).clicked() {
                outbox.line(format!("add_light {}", kind.word()));
            }
        }
    });
    surroundings(ui, scene, outbox);
}

fn chosen(ui: &mut Ui, name: &str, light: &Light, outbox: &mut Outbox) {
    for field in light.kind.fields() {
        let key = format!("light {} {}", quote(name), field.name);
        let now = match field.value(light) {
            LightValue::Number(number) => [number as f32, 0.0, 0.0],
            LightValue::Vector(vector) => vector.map(|number| number as f32),
            LightValue::None | LightValue::Text(_) => [0.0; 3],
        };
        match field.form.parts() {
            None => number(ui, outbox, (field, light), &key, now[0]),
            Some(_) if field.form == LightForm::Color => {
                row(ui, field.title, field.summary, |ui| {
                    let mut color = outbox.numbers(&key, now);
                    if ui.color_edit_button_rgb(&mut color).changed() {
                        outbox.set_numbers(&key, color, line(&key, &color, false));
                    }
                });
            }
            Some(names) => {
                let unit = field.unit(light.kind);
                let comma = if unit.is_empty() { "" } else { ", " };
                weak(ui, format!("{}{comma}{unit}", field.title));
                let mut numbers = outbox.numbers(&key, now);
                let changed = ui.push_id(&key, |ui| {
                    ui.horizontal(|ui| vector(ui, &mut numbers, 0.01, 3, names)).inner
                });
                let low = field.range(light).0 as f32;
                let numbers = numbers.map(|number| number.max(low));
                // A direction must not be zero; an optional vector of zeros means none.
                let is_zero = numbers.iter().all(|number| *number == 0.0);
                if changed.inner && !(is_zero && field.form == LightForm::Direction) {
                    outbox.set_numbers(&key, numbers, line(&key, &numbers, field.is_optional()));
                }
            }
        }
    }
}

/// Draws a number; 0 means none if it is optional.
fn number(ui: &mut Ui, outbox: &mut Outbox, of: (&LightField, &Light), key: &str, now: f32) {
    let (field, light) = of;
    let (is_optional, unit) = (field.is_optional(), field.unit(light.kind));
    row(ui, field.title, field.summary, |ui| {
        let [mut value] = outbox.numbers(key, [now]);
        let speed = f64::from(value.abs().max(0.01)) * 0.01;
        let (low, high) = field.range(light);
        // Smaller values would be rounded to 0.
        let low = if low > 0.0 && !is_optional { 0.01 } else { low as f32 };
        let is_none = is_optional && value == 0.0;
        // Rounding the greatest value up would exceed the range.
        let greatest = (high as f32).min(f32::MAX);
        let high = if f64::from(greatest) > high { greatest.next_down() } else { greatest };
        let drag = DragValue::new(&mut value).range(low..=high).clamp_existing_to_range(false);
        let drag = drag.speed(speed).max_decimals(4);
        let drag = if is_none {
            drag.custom_formatter(|_, _| "none".to_owned())
        } else {
            drag.suffix(format!(" {unit}"))
        };
        let width = ui.available_width();
        if ui.add_sized([width, 18.0], drag).accessible_name(field.title).changed() {
            outbox.set_numbers(key, [value], line(key, &[value], is_optional));
        }
    });
}

/// The console's line that sets a field.
fn line(key: &str, numbers: &[f32], is_optional: bool) -> String {
    if is_optional && numbers.iter().all(|number| *number == 0.0) {
        return format!("{key} none");
    }
    numbers.iter().fold(key.to_owned(), |line, number| line + &format!(" {number}"))
}

fn surroundings(ui: &mut Ui, scene: &SceneModel, outbox: &mut Outbox) {
    if let Some(panorama) = &scene.panorama {
        weak(ui, format!("Surroundings: {panorama}"));
        return;
    }
    // Edit a colour and a strength: values in cd/m² exceed a colour button's range.
    row(ui, "Surroundings", "Radiance from all around, cd/m\u{b2}", |ui| {
        let now = outbox.numbers("environment", scene.environment.to_array());
        let peak = Vec3::from(now).max_element();
        let mut color = if peak > 0.0 { now.map(|c| c / peak) } else { [1.0; 3] };
        let mut strength = peak;
        let mut is_changed = ui.color_edit_button_rgb(&mut color).changed();
        let speed = f64::from(strength.max(1.0)) * 0.01;
        let drag = DragValue::new(&mut strength).range(0.0..=1e7).speed(speed).max_decimals(2);
        let width = ui.available_width();
        let strong = ui
            .add_sized([width, 18.0], drag.suffix(" cd/m\u{b2}"))
            .accessible_name("Radiance of the surroundings");
        is_changed |= strong.changed();
        if is_changed {
            let [r, g, b] = color.map(|c| c * strength);
            outbox.set_numbers("environment", [r, g, b], format!("environment {r},{g},{b}"));
        }
    });
}

/// The screen colour of a linear colour, scaled to full brightness.
pub fn screen_color(color: Vec3) -> egui::Color32 {
    let peak = color.max_element().max(1e-6);
    egui::Rgba::from_rgb(color.x / peak, color.y / peak, color.z / peak).into()
}
