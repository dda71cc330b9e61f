//! The help on keys and mouse.

use egui::{Grid, Id, Modal, RichText, ScrollArea, Ui};

use crate::window::theme;

/// Keys and their effects, by section.
pub const KEYS: [(&str, &[(&str, &str)]); 4] = [
    (
        "Camera",
        &[
            ("Left drag", "Orbit about what was clicked, or the scene's middle"),
            ("Right drag", "Look around"),
            ("Middle drag, Shift + left drag", "Move sideways"),
            ("Wheel", "Closer, farther; in flight the speed"),
            ("W A S D, Q E", "Fly forwards, left, back, right, down, up; Shift: faster"),
            ("F", "Show all of the chosen object, or of the scene"),
            ("1, 2", "Go to a stored position; Ctrl stores"),
        ],
    ),
    (
        "Objects and lights",
        &[
            ("Click", "Choose; Esc: nothing"),
            ("Double click", "Choose, and show all of it"),
            ("T, R, Z", "Handles to move, rotate, scale; Ctrl: in steps"),
            ("H", "Hide or show the chosen object"),
            ("Delete", "Remove the chosen light"),
        ],
    ),
    (
        "Console",
        &[("Up, Down", "Earlier lines"), ("Tab", "Complete; what else is possible is listed")],
    ),
    (
        "Window",
        &[
            ("Space", "Play or pause"),
            ("F1, F2, F11", "This help; the console; full screen"),
            ("Ctrl + Z", "Undo; with Shift, or Ctrl + Y: redo"),
            ("Ctrl + O, Ctrl + S", "Open a scene; save the picture"),
            ("Ctrl + Shift + C", "Copy a command line that makes this picture"),
            ("Ctrl + Q", "Quit"),
        ],
    ),
];

/// Shows the help in a modal window; returns whether it was closed.
pub fn show(ui: &mut Ui) -> bool {
    let shown = Modal::new(Id::unique("help")).show(ui.ctx(), |ui| {
        ui.set_max_width(ui.ctx().content_rect().width().min(560.0) - 40.0);
        ui.label(RichText::new("Keys and mouse").size(16.0).strong());
        let height = (ui.ctx().content_rect().height() - 130.0).max(120.0);
        ScrollArea::vertical().max_height(height).show(ui, |ui| {
            for (title, keys) in KEYS {
                ui.add_space(6.0);
                ui.label(RichText::new(title).strong().color(theme::ACCENT));
                Grid::new(title).num_columns(2).spacing([16.0, 3.0]).show(ui, |ui| {
                    for (key, does) in keys {
                        ui.label(RichText::new(*key).monospace().size(11.0));
                        ui.add(egui::Label::new(*does).wrap());
                        ui.end_row();
                    }
                });
            }
        });
        ui.add_space(6.0);
        ui.button("Close").clicked()
    });
    shown.inner || shown.should_close()
}
