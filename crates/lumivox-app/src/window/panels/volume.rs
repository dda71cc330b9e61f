//! The voxels: their settings, figures, and memory.

use egui::{ComboBox, Ui};
use lumivox_explorer::Revoxelize;
use lumivox_explorer::parameters::Group;

use super::parameters;
use super::widgets::{bytes, count, rest_width, row, weak};
use crate::window::model::Model;
use crate::window::outbox::Outbox;
use crate::window::theme;

/// Draws the settings, figures and memory.
pub fn show(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    parameters::group(ui, Group::Volume, model, outbox);
    // The light settings also show this setting, hence the id.
    ui.push_id("volume", |ui| parameters::named(ui, "injection", model, outbox));
    revoxelize(ui, model, outbox);
    let voxels = &model.voxels;
    if voxels.voxels > 0 {
        let [x, y, z] = voxels.dimensions;
        let what = match voxels.cascades {
            0 => "Grid".to_owned(),
            count => format!("{count} cascades of"),
        };
        let (levels, edge_m) = (voxels.levels, voxels.edge_m);
        weak(ui, format!("{what} {x} x {y} x {z}, {levels} levels, edge {edge_m:.3} m"));
        let (voxel_count, faces) = (count(voxels.voxels.into()), count(voxels.faces.into()));
        weak(ui, format!("{voxel_count} voxels, {faces} faces"));
    }
    if voxels.are_stale {
        ui.colored_label(theme::ACCENT, "Voxels stand where objects no longer are");
    }
    memory(ui, model);
}

fn revoxelize(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let name = match model.revoxelize {
        Revoxelize::WhenMoved => "when moved".to_owned(),
        Revoxelize::WhenAsked => "when asked".to_owned(),
        Revoxelize::Every(seconds) => format!("every {seconds} s"),
        Revoxelize::EveryFrame => "every frame".to_owned(),
    };
    row(ui, "Make anew", "When triangles that have moved become voxels again", |ui| {
        let width = rest_width(ui);
        let combo = ComboBox::from_id_salt("revoxelize").width(width).selected_text(name);
        combo
            .show_ui(ui, |ui| {
                for (words, command) in [
                    ("when moved", "when_moved"),
                    ("when asked", "when_asked"),
                    ("every 0.5 s", "every 0.5"),
                    ("every frame", "every_frame"),
                ] {
                    if ui.selectable_label(false, words).clicked() {
                        outbox.line(format!("revoxelize {command}"));
                    }
                }
            })
            .response
            .accessible_name("When voxels are made anew");
    });
}

/// Draws a bar for each use of memory, the largest first.
fn memory(ui: &mut Ui, model: &Model) {
    let mut uses: Vec<_> = model.memory.iter().filter(|usage| usage.bytes > 0).collect();
    uses.sort_by_key(|usage| std::cmp::Reverse(usage.bytes));
    let total: u64 = uses.iter().map(|usage| usage.bytes).sum();
    if total == 0 {
        return;
    }
    ui.add_space(2.0);
    ui.label(format!("GPU memory: {}", bytes(total)));
    let most = uses.first().map_or(1, |usage| usage.bytes) as f32;
    for usage in uses {
        let text =
            egui::RichText::new(format!("{}  {}", usage.name, bytes(usage.bytes))).size(11.0);
        let bar = egui::ProgressBar::new(usage.bytes as f32 / most)
            .fill(theme::ACCENT_DARK)
            .corner_radius(2)
            .desired_height(15.0)
            .desired_width(ui.available_width() - 2.0);
        ui.add(bar.text(text));
    }
}
