//! The scene's lights and surroundings.

use egui::{DragValue, RichText, Ui, vec2};
use glam::Vec3;
use lumivox_console::quote;
use lumivox_scene::{Light, LightKind};

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
            if label.on_hover_text(kind_name(light)).clicked() {
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
        for (kind, tip) in [
            ("point", "A lamp that shines to all sides"),
            ("spot", "A lamp that shines into a cone"),
            ("sun", "Parallel light from far away"),
        ] {
            if ui.button(kind).on_hover_text(tip).clicked() {
                outbox.line(format!("add_light {kind}"));
            }
        }
    });
    surroundings(ui, scene, outbox);
}

fn chosen(ui: &mut Ui, name: &str, light: &Light, outbox: &mut Outbox) {
    let quoted_name = quote(name);
    let set = |property: &str| format!("light {quoted_name} {property}");
    row(ui, "Colour", "Linear red, green and blue; the strength is apart", |ui| {
        let key = set("color");
        let mut color = outbox.numbers(&key, light.color.to_array());
        if ui.color_edit_button_rgb(&mut color).changed() {
            let [r, g, b] = color;
            outbox.set_numbers(&key, color, format!("{key} {r} {g} {b}"));
        }
    });
    let (strength, unit) = match light.kind {
        LightKind::Directional { illuminance_lux, .. } => (illuminance_lux, "lux"),
        LightKind::Point { intensity_cd, .. } | LightKind::Spot { intensity_cd, .. } => {
            (intensity_cd, "cd")
        }
    };
    number(ui, outbox, "Strength", &set("strength"), strength, unit, (0.0, f32::MAX));
    let is_sun = matches!(light.kind, LightKind::Directional { .. });
    if !is_sun {
        three(ui, outbox, "Position, m", &set("position"), light.position, 0.01);
        number(ui, outbox, "Radius", &set("radius"), light.radius_m, "m", (0.0, f32::MAX));
    }
    if !matches!(light.kind, LightKind::Point { .. }) {
        three(ui, outbox, "Direction", &set("direction"), light.direction, 0.01);
    }
}

fn number(
    ui: &mut Ui,
    outbox: &mut Outbox,
    title: &str,
    key: &str,
    now: f32,
    unit: &str,
    (low, high): (f32, f32),
) {
    row(ui, title, "", |ui| {
        let [mut value] = outbox.numbers(key, [now]);
        let speed = f64::from(value.abs().max(0.01)) * 0.01;
        let drag = DragValue::new(&mut value).range(low..=high).speed(speed).max_decimals(4);
        let width = ui.available_width();
        if ui
            .add_sized([width, 18.0], drag.suffix(format!(" {unit}")))
            .accessible_name(title)
            .changed()
        {
            outbox.set_numbers(key, [value], format!("{key} {value}"));
        }
    });
}

fn three(ui: &mut Ui, outbox: &mut Outbox, title: &str, key: &str, now: Vec3, speed: f64) {
    weak(ui, title);
    let mut numbers = outbox.numbers(key, now.to_array());
    let changed = ui.push_id(key, |ui| {
        ui.horizontal(|ui| vector(ui, &mut numbers, speed, 3, ["x", "y", "z"])).inner
    });
    // A direction must not be zero.
    let is_zero = numbers.iter().all(|number| *number == 0.0);
    if changed.inner && !(is_zero && key.ends_with(" direction")) {
        let [x, y, z] = numbers;
        outbox.set_numbers(key, numbers, format!("{key} {x} {y} {z}"));
    }
}

fn surroundings(ui: &mut Ui, scene: &SceneModel, outbox: &mut Outbox) {
    if let Some(panorama) = &scene.panorama {
        weak(ui, format!("Surroundings: {panorama}"));
        return;
    }
    // A colour and a strength, since values in cd/m² exceed a colour button's range.
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

/// The kind of a light.
fn kind_name(light: &Light) -> &'static str {
    match light.kind {
        LightKind::Directional { .. } => "Sun",
        LightKind::Point { .. } => "Point light",
        LightKind::Spot { .. } => "Spot light",
    }
}

/// The screen colour of a linear colour, scaled to full brightness.
pub fn screen_color(color: Vec3) -> egui::Color32 {
    let peak = color.max_element().max(1e-6);
    egui::Rgba::from_rgb(color.x / peak, color.y / peak, color.z / peak).into()
}
