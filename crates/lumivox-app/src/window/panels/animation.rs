//! The animation bar below the picture.

use egui::{ComboBox, Slider, Ui};
use lumivox_console::quote;
use lumivox_scene::AnimationChoice;

use super::icons::{self, Icon};
use crate::window::model::Model;
use crate::window::outbox::Outbox;
use crate::window::theme;

/// Draws the play button, the choice of animations, and the time.
pub fn show(ui: &mut Ui, model: &Model, outbox: &mut Outbox) {
    let playback = &model.playback;
    let Some(scene) = model.scene.clone() else { return };
    ui.horizontal(|ui| {
        let (icon, command) =
            if playback.is_playing { (Icon::Pause, "pause") } else { (Icon::Play, "play") };
        if icons::button(ui, icon, theme::ACCENT, command).clicked() {
            outbox.line(command);
        }
        if scene.animations.len() > 1 {
            let name = match playback.animation {
                Some(AnimationChoice::One(number)) => {
                    scene.animations.get(number).map_or("", |(name, _)| name)
                }
                _ => "all",
            };
            ComboBox::from_id_salt("animation").width(120.0).selected_text(name).show_ui(
                ui,
                |ui| {
                    for (choice, _) in &scene.animations {
                        if ui.selectable_label(choice == name, choice).clicked() {
                            outbox.line(format!("animation {}", quote(choice)));
                        }
                    }
                    if ui.selectable_label(name == "all", "all at once").clicked() {
                        outbox.line("animation all");
                    }
                },
            );
        }
        let [mut time_s] = outbox.numbers("time", [playback.time_s]);
        if playback.is_playing {
            time_s = playback.time_s;
        }
        ui.spacing_mut().slider_width = (ui.available_width() - 80.0).max(60.0);
        let slider =
            Slider::new(&mut time_s, 0.0..=playback.duration_s).fixed_decimals(2).suffix(" s");
        if ui.add(slider).accessible_name("Time").changed() {
            outbox.set_numbers("time", [time_s], format!("time {time_s}"));
        }
    });
}
