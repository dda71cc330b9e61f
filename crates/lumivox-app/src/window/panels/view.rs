//! Settings of the view: level, comparison, cameras; presets, cones, and the picture.

use egui::{ComboBox, Ui};
use lumivox_console::quote;
use lumivox_explorer::FRAME_BUDGET_MS;
use lumivox_explorer::parameters::{Group, PRESETS};
use lumivox_render::View;

use super::widgets::{rest_width, row, weak};
use super::{histogram, parameters};
use crate::window::model::{Comparand, Model};
use crate::window::outbox::Outbox;

/// Draws the view, the comparison and the camera, with the name to store it under and its flying
/// speed.
pub fn show(
    ui: &mut Ui,
    model: &Model,
    camera_name: &mut String,
    speed: &mut f32,
    outbox: &mut Outbox,
) {
    parameters::named(ui, "view", model, outbox);
    parameters::named(ui, "level", model, outbox);
    compare(ui, model, outbox);
    parameters::group(ui, Group::Overlay, model, outbox);
    let Some(scene) = &model.scene else { return };
    row(ui, "Camera", "One of the scene's cameras, or one that was stored under a name", |ui| {
        let width = rest_width(ui);
        let combo = ComboBox::from_id_salt("camera").width(width).selected_text("Choose");
        combo
            .show_ui(ui, |ui| {
                let stored = model.names.stored.iter();
                for name in
                    scene.cameras.iter().chain(stored).map(String::as_str).chain(["framing"])
                {
                    if ui.selectable_label(false, name).clicked() {
                        outbox.line(format!("camera {}", quote(name)));
                    }
                }
            })
            .response
            .accessible_name("Camera");
    });
    row(ui, "Positions", "Two places to come back to: keys 1 and 2; CTRL stores", |ui| {
        for number in [1, 2] {
            let go = egui::Button::new(format!("Go {number}"));
            if ui.add_enabled(model.has_position[number - 1], go).clicked() {
                outbox.line(format!("pos{number}"));
            }
            if ui.button("Set").on_hover_text(format!("Keep this view as {number}")).clicked() {
                outbox.line(format!("store {number}"));
            }
        }
    });
    row(ui, "Store as", "Keeps this view under a name, among the cameras above", |ui| {
        let field = egui::TextEdit::singleline(camera_name).hint_text("name");
        let field = ui.add(field.desired_width((rest_width(ui) - 46.0).max(40.0)));
        let field = field.accessible_name("Name to store the camera under");
        let is_typed = field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let has_name = !camera_name.trim().is_empty();
        let is_stored = ui.add_enabled(has_name, egui::Button::new("Store")).clicked();
        if has_name && (is_typed || is_stored) {
            let name = std::mem::take(camera_name);
            outbox.line(format!("store {}", quote(name.trim())));
        }
    });
    row(ui, "Speed", "How fast W, A, S, D fly; the wheel changes it in flight", |ui| {
        ui.spacing_mut().slider_width = (rest_width(ui) - 54.0).max(30.0);
        let slider = egui::Slider::new(speed, 0.05..=20.0).logarithmic(true).max_decimals(2);
        ui.add(slider.suffix("x")).accessible_name("Speed of flight");
    });
}

/// Draws the choice of the picture behind the split slider.
fn compare(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let name = match model.comparand {
        Comparand::Nothing => "nothing",
        Comparand::View(view) => view.name(),
        Comparand::Reference(_) => "reference",
    };
    let tip = "What the right half of the picture shows, beside the view on the left: another view (direct is the light \
               without indirect light), or the path-traced truth, which comes while one looks";
    row(ui, "Compare with", tip, |ui| {
        let width = rest_width(ui);
        let combo = ComboBox::from_id_salt("compare").width(width).selected_text(name);
        combo
            .show_ui(ui, |ui| {
                let views = View::ALL.iter().map(|view| view.name());
                for choice in ["nothing", "reference"].into_iter().chain(views) {
                    if ui.selectable_label(choice == name, choice).clicked() {
                        outbox.line(format!("compare_with {choice}"));
                    }
                }
            })
            .response
            .accessible_name("Compare with");
    });
}

/// Draws the presets and cones.
pub fn cones(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let name = model.preset.name();
    row(ui, "Preset", "Cones, and what goes with them", |ui| {
        let width = rest_width(ui);
        let combo = ComboBox::from_id_salt("preset").width(width).selected_text(name);
        combo
            .show_ui(ui, |ui| {
                for preset in PRESETS.iter().map(|preset| preset.name()) {
                    if ui.selectable_label(preset == name, preset).clicked() {
                        outbox.line(format!("preset {preset}"));
                    }
                }
            })
            .response
            .accessible_name("Preset");
    });
    // Each look has its own cone settings.
    let look = model.settings.look.as_ref();
    let group = look.map_or(Group::Cones, |look| Group::Look(look.name()));
    parameters::group(ui, group, model, outbox);
}

/// Draws frames, exposure, tone curve and size.
pub fn picture(ui: &mut Ui, model: &Model, is_half_size: &mut bool, outbox: &mut Outbox) {
    histogram::show(ui, model);
    parameters::group(ui, Group::Picture, model, outbox);
    row(ui, "Half size", "Half as many pixels along each edge", |ui| {
        ui.checkbox(is_half_size, "").accessible_name("Half size");
    });
    let tip = "The time that a frame may take while something moves: pictures have fewer pixels if it takes longer, and all \
               of them again at rest";
    row(ui, "Frame budget", tip, |ui| {
        let now_ms = model.pacing.budget_ms;
        let words = |ms: f32| if ms > 0.0 { format!("{ms} ms") } else { "none".to_owned() };
        let combo = ComboBox::from_id_salt("frame budget").width(rest_width(ui));
        let shown = combo.selected_text(words(now_ms)).show_ui(ui, |ui| {
            for ms in [0.0, 8.0, 16.0, FRAME_BUDGET_MS, 50.0, 100.0] {
                if ui.selectable_label(ms.to_bits() == now_ms.to_bits(), words(ms)).clicked() {
                    outbox.line(format!("frame_budget {ms}"));
                }
            }
        });
        shown.response.accessible_name("Frame budget");
    });
    weak(ui, format!("{} x {} pixels", model.settings.size.x, model.settings.size.y));
}
