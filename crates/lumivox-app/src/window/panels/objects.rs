//! The scene's objects: a list, and the properties of the selected one.

use egui::{RichText, ScrollArea, Ui};
use glam::Vec3;
use lumivox_console::quote;
use lumivox_explorer::Placement;

use super::icons::{self, Icon};
use super::widgets::{count, item, reset, row, vector, weak};
use crate::window::gizmo::Mode;
use crate::window::model::{ObjectModel, SceneModel, Selected};
use crate::window::outbox::Outbox;
use crate::window::{selection, theme};

/// Height of the list, rows.
const ROWS: f32 = 9.0;

/// Draws the list of objects whose names contain `filter`, and the selected one with the mode of
/// its handles.
pub fn show(
    ui: &mut Ui,
    scene: &SceneModel,
    filter: &mut String,
    mode: &mut Mode,
    outbox: &mut Outbox,
) {
    let hint = RichText::new("Filter by name").color(theme::WEAK);
    let width = ui.available_width();
    ui.add(egui::TextEdit::singleline(filter).hint_text(hint).desired_width(width))
        .accessible_name("Filter objects by name");
    let filter = filter.to_lowercase();
    let is_listed = |object: &&ObjectModel| object.name.to_lowercase().contains(&filter);
    let objects: Vec<&ObjectModel> = scene.objects.iter().filter(is_listed).collect();
    if objects.is_empty() {
        weak(ui, "No object has that in its name.");
    }
    let height = 18.0;
    let area = ScrollArea::vertical()
        .id_salt("objects")
        .max_height(ROWS * (height + 2.0))
        .auto_shrink([false, true]);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        area.show_rows(ui, height, objects.len(), |ui, range| {
            for object in &objects[range] {
                listed(ui, object, outbox);
            }
        });
    });
    if let Some(object) = selection::object(scene, outbox) {
        ui.separator();
        chosen(ui, object, scene, mode, outbox);
    }
}

fn listed(ui: &mut Ui, object: &ObjectModel, outbox: &mut Outbox) {
    ui.horizontal(|ui| {
        let name = quote(&object.name);
        let (icon, verb, color) = if object.is_hidden {
            (Icon::Hidden, "show", theme::WEAK)
        } else {
            (Icon::Shown, "hide", theme::ACCENT)
        };
        if icons::button(ui, icon, color, &format!("{verb} {}", object.name)).clicked() {
            outbox.line(format!("{verb} {name}"));
        }
        let is_chosen =
            matches!(outbox.selected(), Some(Selected::Object(other)) if *other == object.name);
        let text = RichText::new(&object.name);
        let text = if object.is_hidden { text.color(theme::WEAK) } else { text };
        if item(ui, is_chosen, text, 0.0).clicked() {
            outbox.select((!is_chosen).then(|| Selected::Object(object.name.clone())));
        }
    });
}

fn chosen(
    ui: &mut Ui,
    object: &ObjectModel,
    scene: &SceneModel,
    mode: &mut Mode,
    outbox: &mut Outbox,
) {
    ui.label(RichText::new(&object.name).strong());
    let material = scene.materials.get(object.material).map_or("", |(name, _)| name.as_str());
    weak(ui, format!("{} triangles, {material}", count(object.triangles as u64)));
    ui.horizontal(|ui| {
        for (choice, name, tip) in [
            (Mode::Move, "Move", "Arrows in the picture (T). CTRL: in steps"),
            (Mode::Turn, "Rotate", "Rings in the picture (R). CTRL: by 15 degrees"),
            (Mode::Size, "Scale", "Boxes in the picture (Z). CTRL: by tenths"),
        ] {
            ui.selectable_value(mode, choice, name).on_hover_text(tip);
        }
    });
    let placement = selection::placement(object, outbox);
    let mut next = placement;
    let axes = |what: &str| ["x", "y", "z"].map(|axis| format!("{what} {axis}"));
    for (what, unit, vector_of, speed, usual) in [
        ("Position", "m", Part::Position, 0.01, None),
        ("Rotation", "degrees", Part::Rotation, 0.5, Some(Vec3::ZERO)),
        ("Scale", "", Part::Scale, 0.01, Some(Vec3::ONE)),
    ] {
        let unit = if unit.is_empty() { String::new() } else { format!(", {unit}") };
        ui.horizontal(|ui| {
            weak(ui, format!("{what}{unit}"));
            let now = vector_of.of(&next);
            if let Some(usual) = usual
                && reset(ui, !now.abs_diff_eq(usual, 1e-5), "Back to none")
            {
                *vector_of.of_mut(&mut next) = usual;
            }
        });
        let mut numbers = vector_of.of(&next).to_array();
        let names = axes(what);
        let names = [names[0].as_str(), names[1].as_str(), names[2].as_str()];
        let changed = ui.push_id(what, |ui| {
            ui.horizontal(|ui| vector(ui, &mut numbers, speed, 3, names)).inner
        });
        if changed.inner {
            *vector_of.of_mut(&mut next) = Vec3::from(numbers);
        }
    }
    if next != placement {
        selection::place(outbox, &object.name, &next);
    }
    row(ui, "Static", "It stays as it is while others move: its voxels are kept", |ui| {
        let mut is_static = object.is_static;
        if ui.checkbox(&mut is_static, "").accessible_name("Static").changed() {
            let on = if is_static { "on" } else { "off" };
            outbox.line(format!("static {} {on}", quote(&object.name)));
        }
    });
}

#[derive(Clone, Copy)]
enum Part {
    Position,
    Rotation,
    Scale,
}

impl Part {
    fn of(self, placement: &Placement) -> Vec3 {
        match self {
            Self::Position => placement.position,
            Self::Rotation => placement.rotation_deg,
            Self::Scale => placement.scale,
        }
    }

    fn of_mut(self, placement: &mut Placement) -> &mut Vec3 {
        match self {
            Self::Position => &mut placement.position,
            Self::Rotation => &mut placement.rotation_deg,
            Self::Scale => &mut placement.scale,
        }
    }
}
