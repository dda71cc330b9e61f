//! The console: its lines, and an input line.

use egui::{Event, EventFilter, Id, Key, Modifiers, RichText, ScrollArea, TextEdit, Ui};
use lumivox_console::complete::complete;

use crate::window::model::{LogKind, Model};
use crate::window::outbox::Outbox;
use crate::window::theme;

/// Maximum lines of the history that the arrow keys show.
const HISTORY: usize = 500;

/// State of the input line.
#[derive(Debug, Default)]
pub struct State {
    text: String,
    history: Vec<String>,
    /// Index of the shown history line, and the text typed before; `None` if none is shown.
    at: Option<(usize, String)>,
    candidates: Vec<String>,
}

impl State {
    fn submit(&mut self) -> Option<String> {
        let text = std::mem::take(&mut self.text).trim().to_owned();
        (self.at, self.candidates) = (None, Vec::new());
        if text.is_empty() {
            return None;
        }
        if self.history.last() != Some(&text) {
            self.history.push(text.clone());
            let surplus = self.history.len().saturating_sub(HISTORY);
            self.history.drain(..surplus);
        }
        Some(text)
    }

    fn earlier(&mut self) {
        let (at, typed) = match self.at.take() {
            Some((at, typed)) => (at.saturating_sub(1), typed),
            None if self.history.is_empty() => return,
            None => (self.history.len() - 1, self.text.clone()),
        };
        self.text.clone_from(&self.history[at]);
        self.at = Some((at, typed));
    }

    fn later(&mut self) {
        let Some((at, typed)) = self.at.take() else { return };
        if at + 1 < self.history.len() {
            self.text.clone_from(&self.history[at + 1]);
            self.at = Some((at + 1, typed));
        } else {
            self.text = typed;
        }
    }

    /// Completes the last word to the candidates' common prefix; lists several candidates.
    fn complete(&mut self, start: usize, candidates: Vec<String>) {
        if let Some(first) = candidates.first() {
            let common = candidates.iter().skip(1).fold(first.as_str(), |common, other| {
                let same =
                    common.char_indices().zip(other.chars()).take_while(|((_, a), b)| a == b);
                let end = same.last().map_or(0, |((at, letter), _)| at + letter.len_utf8());
                &common[..end]
            });
            if common.len() > self.text.len() - start {
                self.text.replace_range(start.., common);
            }
            if candidates.len() == 1 && !self.text.ends_with(' ') {
                self.text.push(' ');
            }
        }
        self.candidates = if candidates.len() > 1 { candidates } else { Vec::new() };
    }
}

/// The id of the input line.
pub fn line() -> Id {
    Id::unique("console line")
}

/// Draws the lines and the input line.
pub fn show(ui: &mut Ui, model: &Model, state: &mut State, outbox: &mut Outbox) {
    let id = line();
    let mut focus = false;
    if ui.memory(|memory| memory.has_focus(id)) {
        let pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        if pressed(Key::ArrowUp) {
            state.earlier();
            focus = true;
        }
        if pressed(Key::ArrowDown) {
            state.later();
            focus = true;
        }
        if pressed(Key::Tab) {
            let text = &state.text;
            let found = complete(&model.names, &crate::disk::files, text, text.len());
            state.complete(found.start, found.candidates);
            focus = true;
        }
    }
    let line_height = 22.0;
    let listed = state.candidates.join("  ");
    let below = if listed.is_empty() { line_height } else { line_height + 16.0 };
    let height = (ui.available_height() - below).max(20.0);
    let area = ScrollArea::vertical().id_salt("log").max_height(height).min_scrolled_height(height);
    area.auto_shrink(false).stick_to_bottom(true).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        for line in model.log.iter() {
            let (mark, color) = match line.kind {
                LogKind::Command => ("> ", theme::ACCENT),
                LogKind::Reply => ("", theme::TEXT),
                LogKind::Error => ("", theme::ERROR),
                LogKind::Note => ("", theme::WEAK),
            };
            ui.label(RichText::new(format!("{mark}{}", line.text)).monospace().color(color));
        }
    });
    if !listed.is_empty() {
        ui.add(egui::Label::new(RichText::new(listed).monospace().color(theme::WEAK)).truncate());
    }
    let hint = RichText::new("Type a command; Tab completes, help lists them").color(theme::WEAK);
    let edit = TextEdit::singleline(&mut state.text)
        .id(id)
        .font(egui::TextStyle::Monospace)
        .hint_text(hint)
        .desired_width(f32::INFINITY)
        .event_filter(EventFilter { tab: true, vertical_arrows: true, ..Default::default() });
    let output = edit.show(ui);
    let response = output.response.response.accessible_name("Command");
    if response.changed() {
        state.candidates.clear();
    }
    if focus {
        // Move the cursor to the end of the new text.
        let mut cursor = output.state;
        let end = egui::text::CCursor::new(state.text.chars().count());
        cursor.cursor.set_char_range(Some(egui::text::CCursorRange::one(end)));
        cursor.store(ui.ctx(), id);
    }
    let is_entered =
        response.lost_focus() && ui.input(|input| has_pressed(&input.events, Key::Enter));
    if is_entered {
        if let Some(line) = state.submit() {
            outbox.typed_line(line);
        }
        response.request_focus();
    }
}

fn has_pressed(events: &[Event], wanted: Key) -> bool {
    events
        .iter()
        .any(|event| matches!(event, Event::Key { key, pressed: true, .. } if *key == wanted))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrow_keys_step_through_the_history() {
        let mut state = State::default();
        for line in ["one", "two", "two", " three "] {
            state.text = line.to_owned();
            assert_eq!(state.submit().as_deref(), Some(line.trim()));
        }
        state.text = "unfinished".to_owned();
        let mut seen = Vec::new();
        for _ in 0..4 {
            state.earlier();
            seen.push(state.text.clone());
        }
        assert_eq!(seen, ["three", "two", "one", "one"]);
        for _ in 0..3 {
            state.later();
        }
        assert_eq!(state.text, "unfinished");
        state.text = "  ".to_owned();
        assert_eq!(state.submit(), None);
    }

    #[test]
    fn tab_completes_the_unambiguous_part() {
        let list = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        let mut state = State { text: "bou".to_owned(), ..State::default() };
        state.complete(0, list(&["bounces"]));
        assert_eq!(state.text, "bounces ");
        let mut state = State { text: "view d".to_owned(), ..State::default() };
        state.complete(5, list(&["diffuse", "direct"]));
        assert_eq!((state.text.as_str(), state.candidates.len()), ("view di", 2));
        state.complete(5, Vec::new());
        assert_eq!((state.text.as_str(), state.candidates.len()), ("view di", 0));
    }
}
