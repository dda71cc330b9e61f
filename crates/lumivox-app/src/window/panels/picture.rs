//! The picture: the rendering, its comparison, handles, and mouse input.

use std::time::{Duration, Instant};

use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Key, PointerButton, Pos2, Rect, Response, Sense,
    Stroke, TextureId, Ui,
};
use egui::{pos2, vec2};
use glam::{Vec2, Vec3};
use lumivox_render::Photometry;
use lumivox_scene::Camera;

use crate::window::gizmo::{self, Handle, Mode, Projection};
use crate::window::model::{Comparand, Model, ObjectModel, SceneModel, Selected};
use crate::window::orders::{Order, Published};
use crate::window::outbox::Outbox;
use crate::window::screen::PICTURES;
use crate::window::{camera, selection, theme};

/// Rotation by a drag over the picture's height, rad.
const TURN_RAD: f32 = std::f32::consts::PI;
/// Factor on the distance per notch of the wheel.
const DOLLY: f32 = 0.88;
/// Flying speed, in radii of the scene per second.
const FLIGHT: f32 = 0.6;
/// Factor on the speed while Shift is held.
const FAST: f32 = 4.0;
/// Maximum distance of the pointer to a light or the split, points.
const REACH: f32 = 9.0;

/// State of the picture's panel.
#[derive(Debug)]
pub struct State {
    /// The pictures' textures.
    pub textures: [Option<TextureId>; PICTURES],
    /// The mode of the handles.
    pub mode: Mode,
    /// The handle that is being dragged.
    drag: Option<gizmo::Drag>,
    /// Position of the split slider, as a share of the picture's width.
    split: f32,
    /// The last light probe: place, number of the picture, and time.
    probed: Option<(Vec2, u64, Instant)>,
    /// [`Model::opened`] of the last model, and of the scene whose hint was closed.
    opened: u64,
    closed_hint: u64,
    /// `Some` if the next selection is to be framed; holds [`Model::selections`] at the request.
    frames_after: Option<u64>,
}

impl Default for State {
    fn default() -> Self {
        Self {
            textures: [None; PICTURES],
            mode: Mode::default(),
            drag: None,
            split: 0.5,
            probed: None,
            opened: 0,
            closed_hint: 0,
            frames_after: None,
        }
    }
}

impl State {
    /// Handles changes of the model: ends a drag if the scene was replaced, and frames what a
    /// double click has selected.
    pub fn look(&mut self, model: &Model, outbox: &mut Outbox) {
        if model.opened != self.opened {
            self.opened = model.opened;
            self.drag = None;
        }
        let is_made = self.frames_after.take_if(|before| *before != model.selections).is_some();
        if is_made && outbox.selected().is_some() {
            selection::frame(model, outbox);
        }
    }

    /// The light under the pointer; `None` until it is measured.
    pub fn light_under_pointer(&self, published: &Published) -> Option<Photometry> {
        let (at, ..) = self.probed?;
        // Meanwhile, show the light of a nearby place.
        published.light.as_ref().filter(|light| light.at.distance(at) < 0.02)?.light
    }
}

/// The data that the picture's panel shows, and the state that mouse and keys change.
struct Panel<'a> {
    published: &'a Published,
    model: &'a Model,
    scene: &'a SceneModel,
    state: &'a mut State,
    /// Flying speed, as a multiple of the default.
    speed: &'a mut f32,
    outbox: &'a mut Outbox,
}

impl Panel<'_> {
    fn move_camera(&mut self, move_it: impl FnOnce(&Camera) -> Camera) {
        self.outbox.move_camera(move_it(&self.outbox.camera(self.model)));
    }
}

/// Draws the picture and its overlays, and handles its input.
pub fn show(
    ui: &mut Ui,
    published: &Published,
    scene: &SceneModel,
    state: &mut State,
    speed: &mut f32,
    outbox: &mut Outbox,
) {
    let model = &*published.model;
    let panel = &mut Panel { published, model, scene, state, speed, outbox };
    let area = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(area, Sense::click_and_drag());
    let response = response.accessible_name("Picture");
    let rect = fitted(area, published);
    let split = images(ui, rect, panel);
    let view = Projection::new(&panel.outbox.camera(model), rect);
    decorate(ui, &view, rect, panel);
    let on_split = split.filter(|_| panel.state.drag.is_none());
    mouse(ui, &response, &view, (rect, on_split), panel);
    keys(ui, panel);
    probe(ui, &response, rect, panel);
    if scene.is_emission_alone && panel.state.closed_hint != model.opened {
        explain(ui, rect, panel);
    }
    if scene.objects.iter().all(|object| object.is_hidden) {
        hint(ui, rect, "Nothing is shown: all objects are hidden.");
    } else if published.picture.is_none() && model.jobs.is_empty() && model.error.is_none() {
        hint(ui, rect, "Preparing the scene ...");
    }
}

/// The largest rectangle in `area` with the picture's aspect ratio.
fn fitted(area: Rect, published: &Published) -> Rect {
    let Some(shown) = &published.picture else { return area };
    let size = vec2(shown.size.x as f32, shown.size.y as f32);
    let scale = (area.width() / size.x).min(area.height() / size.y);
    let fitted = Rect::from_center_size(area.center(), size * scale);
    // Fill the whole area if the sizes differ only by rounding.
    if (fitted.width() - area.width()).abs() < 6.0 && (fitted.height() - area.height()).abs() < 6.0
    {
        area
    } else {
        fitted
    }
}

/// Draws one picture or two; returns the split's x coordinate.
fn images(ui: &Ui, rect: Rect, panel: &Panel<'_>) -> Option<f32> {
    let Panel { published, model, state, .. } = panel;
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    let [first, other] = state.textures;
    if let Some(texture) = first {
        ui.painter().image(texture, rect, whole, Color32::WHITE);
    }
    if model.comparand == Comparand::Nothing {
        return None;
    }
    let x = rect.left() + rect.width() * state.split;
    if let Some(texture) = other {
        let right = Rect::from_min_max(pos2(x, rect.top()), rect.max);
        let shown = Rect::from_min_max(pos2(state.split, 0.0), pos2(1.0, 1.0));
        ui.painter().image(texture, right, shown, Color32::WHITE);
    }
    ui.painter().vline(x, rect.y_range(), Stroke::new(2.0, Color32::from_black_alpha(140)));
    ui.painter().vline(x, rect.y_range(), Stroke::new(1.0, Color32::WHITE));
    let grip = pos2(x, rect.center().y);
    ui.painter().circle(grip, 7.0, theme::PANEL, Stroke::new(1.5, Color32::WHITE));
    let samples = published.other.as_ref().map(|other| other.frames);
    let right = match (model.comparand, samples) {
        (Comparand::View(view), _) => view.name().to_owned(),
        (Comparand::Reference(_), Some(samples)) => format!("reference, {samples} samples"),
        (Comparand::Reference(_), None) => "reference: tracing ...".to_owned(),
        (Comparand::Nothing, _) => String::new(),
    };
    label(
        ui,
        pos2(rect.left() + 8.0, rect.top() + 8.0),
        Align2::LEFT_TOP,
        model.settings.view.name(),
    );
    label(ui, pos2(rect.right() - 8.0, rect.top() + 8.0), Align2::RIGHT_TOP, &right);
    Some(x)
}

fn label(ui: &Ui, at: Pos2, align: Align2, text: &str) {
    let galley =
        ui.painter().layout_no_wrap(text.to_owned(), FontId::proportional(12.0), Color32::WHITE);
    let rect = align.anchor_size(at, galley.size());
    ui.painter().rect_filled(rect.expand(4.0), 3.0, Color32::from_black_alpha(150));
    ui.painter().galley(rect.min, galley, Color32::WHITE);
}

fn hint(ui: &Ui, rect: Rect, text: &str) {
    let font = FontId::proportional(15.0);
    ui.painter().text(rect.center(), Align2::CENTER_CENTER, text, font, theme::WEAK);
}

/// Minimum time between two light probes while the pointer moves.
const PROBE_EVERY: Duration = Duration::from_millis(100);
/// Minimum time between two light probes while the pointer rests and the picture converges.
const PROBE_AGAIN: Duration = Duration::from_millis(500);

/// Probes the light under the pointer at intervals, while no button is held.
fn probe(ui: &Ui, response: &Response, rect: Rect, panel: &mut Panel<'_>) {
    let Panel { published, state, outbox, .. } = panel;
    let is_held = ui.input(|input| input.pointer.any_down());
    let at = response.hover_pos().filter(|at| rect.contains(*at) && !is_held);
    let (Some(at), Some(shown)) = (at, &published.picture) else {
        state.probed = None;
        return;
    };
    let (share, serial) = ((at - rect.min) / rect.size(), shown.serial);
    let share = Vec2::new(share.x, share.y);
    let wait = match state.probed {
        Some((last, seen, _)) if last == share && seen == serial => return,
        Some((last, _, asked)) => {
            let pause = if last == share { PROBE_AGAIN } else { PROBE_EVERY };
            pause.saturating_sub(asked.elapsed())
        }
        None => Duration::ZERO,
    };
    if wait.is_zero() {
        outbox.order(Order::Probe(share));
        state.probed = Some((share, serial, Instant::now()));
    } else {
        ui.ctx().request_repaint_after(wait);
    }
}

/// Draws a note at the picture's lower edge, with buttons for a remedy and to close it.
fn explain(ui: &Ui, rect: Rect, panel: &mut Panel<'_>) {
    let frame = egui::Frame::new().fill(theme::PANEL).corner_radius(4).inner_margin(8);
    let area = egui::Area::new(Id::unique("hint"))
        .pivot(Align2::CENTER_BOTTOM)
        .fixed_pos(pos2(rect.center().x, rect.bottom() - 8.0))
        .constrain_to(rect);
    area.show(ui.ctx(), |ui| {
        frame.show(ui, |ui| {
            ui.set_max_width((rect.width() - 40.0).clamp(120.0, 420.0));
            ui.label(EMISSION_ALONE);
            ui.horizontal_wrapped(|ui| {
                let sky = ui.button("Add sun and sky").on_hover_text(SKY);
                if sky.clicked() {
                    panel.outbox.line(SKY);
                }
                if ui.button("Close").clicked() {
                    panel.state.closed_hint = panel.model.opened;
                }
            });
        });
    });
}

/// The note that explains why a scene may look dark.
const EMISSION_ALONE: &str =
    "Lit by its own emission alone: if that is too little, add a light or choose surroundings.";

/// The remedy's command: a sky with a sun of medium height.
const SKY: &str = "sky 40,120";

/// Draws lights, the selected object's box, and the handles.
fn decorate(ui: &Ui, view: &Projection, rect: Rect, panel: &Panel<'_>) {
    let Panel { scene, state, outbox, .. } = panel;
    let painter = ui.painter().with_clip_rect(rect);
    for (name, light) in &scene.lights {
        let is_chosen = matches!(outbox.selected(), Some(Selected::Light(other)) if other == name);
        if selection::is_lamp(light)
            && let Some(at) = view.project(light.position)
        {
            let color = super::lights::screen_color(light.color);
            let rim = if is_chosen { theme::ACCENT } else { Color32::from_black_alpha(180) };
            painter.circle(at, if is_chosen { 6.0 } else { 4.5 }, color, Stroke::new(1.5, rim));
        }
    }
    if let Some(object) = selection::object(scene, outbox) {
        outline(&painter, view, object);
    }
    let Some((placement, mode)) = selection::handles(scene, state.mode, outbox) else { return };
    let Some(middle) = view.project(placement.position) else { return };
    let length = view.handle_length(placement.position);
    let hovered = match &state.drag {
        Some(drag) => Some(drag.handle),
        None => ui.ctx().pointer_hover_pos().and_then(|at| gizmo::hit(view, mode, &placement, at)),
    };
    for (axis, direction) in gizmo::axes(mode, &placement).into_iter().enumerate() {
        let is_active = hovered == Some(Handle::Axis(axis));
        let color = if is_active { Color32::WHITE } else { theme::AXES[axis] };
        let stroke = Stroke::new(if is_active { 3.0 } else { 2.0 }, color);
        if mode == Mode::Turn {
            let points = gizmo::ring(placement.position, direction, length);
            for pair in points.windows(2) {
                if let Some(segment) = view.segment(pair[0], pair[1]) {
                    painter.line_segment(segment, stroke);
                }
            }
            continue;
        }
        let Some([from, to]) =
            view.segment(placement.position, placement.position + direction * length)
        else {
            continue;
        };
        if mode == Mode::Move {
            painter.arrow(from, to - from, stroke);
        } else {
            painter.line_segment([from, to], stroke);
            painter.rect_filled(Rect::from_center_size(to, vec2(9.0, 9.0)), 1.0, color);
        }
    }
    if mode == Mode::Size {
        let color = if hovered == Some(Handle::Middle) { Color32::WHITE } else { theme::ACCENT };
        painter.rect_filled(Rect::from_center_size(middle, vec2(10.0, 10.0)), 1.0, color);
    }
}

/// Draws the edges of an object's box.
fn outline(painter: &egui::Painter, view: &Projection, object: &ObjectModel) {
    if object.local_bounds.is_empty() {
        return;
    }
    let corners = object
        .local_bounds
        .corners()
        .map(|corner| object.world_from_local.transform_point3(corner));
    for from in 0..8_usize {
        for bit in [1, 2, 4] {
            if from & bit == 0
                && let Some(segment) = view.segment(corners[from], corners[from | bit])
            {
                painter.line_segment(segment, Stroke::new(2.5, Color32::from_black_alpha(110)));
                painter.line_segment(segment, Stroke::new(1.2, theme::ACCENT));
            }
        }
    }
}

/// Handles the mouse: orbit, look, pan, dolly, the split, handles, clicks.
fn mouse(
    ui: &Ui,
    response: &Response,
    view: &Projection,
    (rect, split): (Rect, Option<f32>),
    panel: &mut Panel<'_>,
) {
    let grip = ui.scope_id().with("split");
    let at = response.interact_pointer_pos().or_else(|| response.hover_pos());
    let Some(at) = at else {
        if panel.state.drag.take().is_some() {
            ui.ctx().request_repaint();
        }
        return;
    };
    let pressed_at = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
    let near_split = |at: Pos2| split.is_some_and(|x| (at.x - x).abs() < REACH);
    if response.hovered() && near_split(at) && !response.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if response.drag_started_by(PointerButton::Primary) {
        let is_split = near_split(pressed_at);
        ui.data_mut(|data| data.insert_temp(grip, is_split));
        if !is_split
            && let Some((placement, mode)) =
                selection::handles(panel.scene, panel.state.mode, panel.outbox)
        {
            let handle = gizmo::hit(view, mode, &placement, pressed_at);
            panel.state.drag =
                handle.map(|handle| gizmo::Drag::new(mode, handle, placement, pressed_at));
        }
    }
    let delta = response.drag_delta();
    let turn = Vec2::new(delta.x, delta.y) * (TURN_RAD / rect.height().max(1.0));
    let shift = ui.input(|input| input.modifiers.shift);
    if response.dragged_by(PointerButton::Primary) {
        let is_split = ui.data(|data| data.get_temp::<bool>(grip)).unwrap_or(false);
        if is_split {
            panel.state.split = ((at.x - rect.left()) / rect.width().max(1.0)).clamp(0.0, 1.0);
        } else if let Some(drag) = panel.state.drag.clone() {
            let snaps = ui.input(|input| input.modifiers.command);
            selection::put(panel.outbox, &drag.placement(view, at, snaps));
        } else if shift {
            pan(panel, delta, rect);
        } else if delta != egui::Vec2::ZERO {
            let pivot = selection::pivot(panel.model, panel.outbox);
            panel.move_camera(|camera| camera::orbit(camera, pivot, turn));
        }
    } else if response.dragged_by(PointerButton::Secondary) && delta != egui::Vec2::ZERO {
        // At half the angle, the picture follows the pointer.
        panel.move_camera(|camera| camera::look(camera, turn * 0.5));
    } else if response.dragged_by(PointerButton::Middle) && delta != egui::Vec2::ZERO {
        pan(panel, delta, rect);
    }
    if response.drag_stopped() {
        panel.state.drag = None;
        ui.data_mut(|data| data.insert_temp(grip, false));
    }
    if response.clicked() && !near_split(at) {
        let is_chosen = click(view, at, rect, panel);
        if response.double_clicked() && is_chosen {
            selection::frame(panel.model, panel.outbox);
        } else if response.double_clicked() {
            panel.state.frames_after = Some(panel.model.selections);
        }
    }
    if response.hovered() {
        wheel(ui, panel);
    }
}

fn pan(panel: &mut Panel<'_>, delta: egui::Vec2, rect: Rect) {
    let shares = Vec2::new(delta.x, delta.y) / rect.height().max(1.0);
    if shares != Vec2::ZERO {
        let pivot = selection::pivot(panel.model, panel.outbox);
        panel.move_camera(|camera| camera::pan(camera, pivot, shares));
    }
}

/// Selects a light at `at` and returns `true`, or else asks the worker to pick an object.
fn click(view: &Projection, at: Pos2, rect: Rect, panel: &mut Panel<'_>) -> bool {
    let lamp = panel.scene.lights.iter().filter(|(_, light)| selection::is_lamp(light)).find(
        |(_, light)| view.project(light.position).is_some_and(|there| there.distance(at) < REACH),
    );
    if let Some((name, _)) = lamp {
        panel.outbox.select(Some(Selected::Light(name.clone())));
        return true;
    }
    let share = (at - rect.min) / rect.size();
    if (0.0..=1.0).contains(&share.x) && (0.0..=1.0).contains(&share.y) {
        panel.outbox.order(Order::Pick(Vec2::new(share.x, share.y)));
    }
    false
}

fn is_flying(ui: &Ui) -> bool {
    ui.input(|input| {
        input.pointer.secondary_down()
            || [Key::W, Key::A, Key::S, Key::D, Key::Q, Key::E]
                .into_iter()
                .any(|key| input.key_down(key))
    })
}

fn wheel(ui: &Ui, panel: &mut Panel<'_>) {
    let notches = ui.input(|input| input.smooth_scroll_delta().y) / 40.0;
    if notches == 0.0 {
        return;
    }
    if is_flying(ui) {
        *panel.speed = (*panel.speed * 1.15_f32.powf(notches)).clamp(0.05, 20.0);
    } else {
        let pivot = selection::pivot(panel.model, panel.outbox);
        panel.move_camera(|camera| camera::dolly(camera, pivot, DOLLY.powf(notches)));
    }
}

/// Handles the keys for flying.
fn keys(ui: &Ui, panel: &mut Panel<'_>) {
    if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    let (way, is_fast, seconds) = ui.input(|input| {
        if input.modifiers.command || input.modifiers.alt {
            return (Vec3::ZERO, false, 0.0);
        }
        let along = |to: Key, fro: Key| {
            f32::from(u8::from(input.key_down(to))) - f32::from(u8::from(input.key_down(fro)))
        };
        let way = Vec3::new(along(Key::D, Key::A), along(Key::E, Key::Q), along(Key::W, Key::S));
        (way, input.modifiers.shift, input.stable_dt.min(0.1))
    });
    if way == Vec3::ZERO {
        return;
    }
    let fast = if is_fast { FAST } else { 1.0 };
    let speed = panel.scene.bounds.radius_m().max(1e-3) * FLIGHT * *panel.speed * fast;
    let way_m = way.normalize_or_zero() * speed * seconds;
    panel.move_camera(|camera| camera::fly(camera, way_m));
    ui.ctx().request_repaint();
}
