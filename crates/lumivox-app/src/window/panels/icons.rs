//! Small icons, drawn because not every font has them.

use egui::{Color32, Pos2, Response, Sense, Shape, Stroke, Ui, pos2, vec2};

use crate::window::theme;

/// An icon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Icon {
    /// Something is shown.
    Shown,
    /// Something is hidden.
    Hidden,
    /// Close or remove.
    Cross,
    /// Reset.
    Back,
    /// Start the animation.
    Play,
    /// Stop the animation.
    Pause,
}

/// A button with an icon; `name` is its tooltip, and its name for screen readers.
pub fn button(ui: &mut Ui, icon: Icon, color: Color32, name: &str) -> Response {
    let (rect, response) = ui.allocate_exact_size(vec2(16.0, 16.0), Sense::click());
    let color = if response.hovered() { Color32::WHITE } else { color };
    let at = |x: f32, y: f32| rect.center() + vec2(x, y);
    let line = Stroke::new(1.6, color);
    let painter = ui.painter();
    if response.has_focus() {
        painter.rect_stroke(rect, 3.0, Stroke::new(1.0, theme::ACCENT), egui::StrokeKind::Inside);
    }
    match icon {
        Icon::Shown => _ = painter.circle_filled(rect.center(), 4.0, color),
        Icon::Hidden => _ = painter.circle_stroke(rect.center(), 3.6, Stroke::new(1.2, color)),
        Icon::Cross => {
            painter.line_segment([at(-3.5, -3.5), at(3.5, 3.5)], line);
            painter.line_segment([at(-3.5, 3.5), at(3.5, -3.5)], line);
        }
        Icon::Back => {
            // Three quarters of a circle, with an arrowhead at its start.
            let angle = |step: usize| -2.2 + step as f32 * 0.42;
            let arc: Vec<Pos2> =
                (0..=11).map(|step| at(4.4 * angle(step).cos(), 4.4 * angle(step).sin())).collect();
            let tip = arc[0];
            painter.line(arc, line);
            let head = vec![tip + vec2(-3.2, -1.2), tip + vec2(1.6, -3.4), tip + vec2(1.4, 2.4)];
            painter.add(Shape::convex_polygon(head, color, Stroke::NONE));
        }
        Icon::Play => {
            let triangle = vec![at(-3.5, -5.0), at(5.0, 0.0), at(-3.5, 5.0)];
            painter.add(Shape::convex_polygon(triangle, color, Stroke::NONE));
        }
        Icon::Pause => {
            for x in [-3.0, 3.0] {
                let bar = egui::Rect::from_center_size(
                    pos2(rect.center().x + x, rect.center().y),
                    vec2(2.6, 9.0),
                );
                painter.rect_filled(bar, 0.0, color);
            }
        }
    }
    response.on_hover_text(name).accessible_name(name)
}
