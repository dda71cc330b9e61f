//! The scene's materials.

use egui::{CollapsingHeader, Slider, Ui};
use lumivox_console::quote;
use lumivox_scene::{Material, Shading};

use super::widgets::{is_rounded, row, weak};
use crate::window::model::SceneModel;
use crate::window::outbox::Outbox;
use crate::window::selection;

/// Maximum number of listed materials, besides the selected object's.
const MOST: usize = 60;

/// Draws the materials, that of the selected object first.
pub fn show(ui: &mut Ui, scene: &SceneModel, outbox: &mut Outbox) {
    let chosen = selection::object(scene, outbox).map(|object| object.material);
    if let Some((name, material)) = chosen.and_then(|index| scene.materials.get(index)) {
        weak(ui, format!("Of the chosen object: {name}"));
        ui.push_id("chosen", |ui| one(ui, name, material, outbox));
        ui.separator();
    }
    for (index, (name, material)) in scene.materials.iter().enumerate().take(MOST) {
        if Some(index) != chosen {
            CollapsingHeader::new(name)
                .id_salt(index)
                .show(ui, |ui| one(ui, name, material, outbox));
        }
    }
    if scene.materials.len() > MOST {
        weak(ui, format!("and {} more: choose an object", scene.materials.len() - MOST));
    }
}

fn one(ui: &mut Ui, name: &str, material: &Material, outbox: &mut Outbox) {
    let quoted_name = quote(name);
    let key = |property: &str| format!("material {quoted_name} {property}");
    match &material.shading {
        Shading::MetallicRoughness(m) => {
            let tip =
                if m.base_color_texture.is_some() { "Multiplies the texture" } else { "Linear" };
            color(
                ui,
                outbox,
                "Base colour",
                tip,
                &key("base_color"),
                m.base_color.truncate().to_array(),
            );
            slider(ui, outbox, "Metallic", &key("metallic"), m.metallic, 1.0);
            slider(ui, outbox, "Roughness", &key("roughness"), m.roughness, 1.0);
            slider(ui, outbox, "Specular", &key("specular"), m.specular, 1.0);
        }
        Shading::Phong(p) => {
            color(ui, outbox, "Diffuse", "Linear", &key("diffuse"), p.diffuse.to_array());
            color(ui, outbox, "Specular", "Linear", &key("specular_color"), p.specular.to_array());
            slider(ui, outbox, "Shininess", &key("shininess"), p.shininess, 256.0);
        }
        Shading::Unlit(u) => {
            color(ui, outbox, "Colour", "Linear", &key("color"), u.color.truncate().to_array());
        }
    }
    emission(ui, outbox, &key("emission"), material);
}

fn color(ui: &mut Ui, outbox: &mut Outbox, title: &str, tip: &str, key: &str, now: [f32; 3]) {
    row(ui, title, tip, |ui| {
        let mut color = outbox.numbers(key, now);
        if ui.color_edit_button_rgb(&mut color).changed() {
            let [r, g, b] = color;
            outbox.set_numbers(key, color, format!("{key} {r} {g} {b}"));
        }
    });
}

fn slider(ui: &mut Ui, outbox: &mut Outbox, title: &str, key: &str, now: f32, high: f32) {
    row(ui, title, "", |ui| {
        let [before] = outbox.numbers(key, [now]);
        let mut value = before;
        ui.spacing_mut().slider_width = (ui.available_width() - 50.0).max(30.0);
        let slider = Slider::new(&mut value, 0.0..=high).max_decimals(2);
        let is_changed = ui.add(slider).accessible_name(title).changed();
        if is_changed && !is_rounded(value, before, 2) {
            outbox.set_numbers(key, [value], format!("{key} {value}"));
        }
    });
}

/// Draws the emission as a colour and its strength in cd/m².
fn emission(ui: &mut Ui, outbox: &mut Outbox, key: &str, material: &Material) {
    row(ui, "Emission", "Radiance that the surface emits, cd/m\u{b2}", |ui| {
        let now = outbox.numbers(key, material.emissive.to_array());
        let peak = glam::Vec3::from(now).max_element();
        let mut color = if peak > 0.0 { now.map(|c| c / peak) } else { [1.0; 3] };
        let mut strength = peak;
        let mut is_changed = ui.color_edit_button_rgb(&mut color).changed();
        let speed = f64::from(strength.max(1.0)) * 0.01;
        let drag =
            egui::DragValue::new(&mut strength).range(0.0..=1e8).speed(speed).max_decimals(2);
        let width = ui.available_width();
        let strong =
            ui.add_sized([width, 18.0], drag.suffix(" cd/m\u{b2}")).accessible_name("Emission");
        is_changed |= strong.changed();
        if is_changed {
            let [r, g, b] = color.map(|c| c * strength);
            outbox.set_numbers(key, [r, g, b], format!("{key} {r} {g} {b}"));
        }
    });
}
