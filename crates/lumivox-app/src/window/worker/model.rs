//! Publishing the model, and the console's lines.

use std::collections::VecDeque;
use std::io::Write as _;
use std::sync::Arc;
use std::sync::mpsc::{self, Sender};
use std::thread::JoinHandle;
use std::time::Duration;

use lumivox_console::Names;

use super::Worker;
use crate::window::lines::{self, Line, Origin};
use crate::window::model::{
    LogKind, LogLine, Model, SceneModel, Selected, scene_model, voxel_model,
};
use crate::window::terminal::Terminal;

/// Lines that are kept.
const KEPT: usize = 2000;

/// The console's lines. They go to stdout, too, so that what is done with the mouse can be read there.
#[derive(Debug, Default)]
pub struct Log {
    lines: VecDeque<LogLine>,
    snapshot: Option<Arc<Vec<LogLine>>>,
    /// What the last line sets, if it is a panel's command; and whether stdout has it already.
    last: Option<(Option<String>, bool)>,
    /// The thread that writes them besides.
    printer: Option<(Sender<Printed>, JoinHandle<()>)>,
}

/// For the thread that writes.
enum Printed {
    Text(String),
    Names(Names),
}

/// At the end, a reader that has stopped reading is waited for this long.
const PATIENCE: Duration = Duration::from_secs(2);

impl Log {
    /// Lines go to a terminal from now on, on a thread of its own: nobody has to read them.
    pub fn print_to(&mut self, mut terminal: Terminal) {
        let (sender, lines) = mpsc::channel();
        let thread = std::thread::spawn(move || {
            for line in lines {
                match line {
                    Printed::Text(text) => terminal.print(&text),
                    Printed::Names(names) => terminal.set_names(names),
                }
            }
            let _ = std::io::stdout().flush();
        });
        self.printer = Some((sender, thread));
    }

    /// What can be completed from now on.
    pub fn set_names(&self, names: &Names) {
        if let Some((printer, _)) = &self.printer {
            // It ends with this.
            let _ = printer.send(Printed::Names(names.clone()));
        }
    }

    /// A line that is run. Of a panel's lines that set the same thing, the last stays.
    pub fn add_command(&mut self, line: &Line) {
        let target = if line.origin == Origin::Panel { lines::target(&line.text) } else { None };
        let replaces =
            target.is_some() && self.last.as_ref().is_some_and(|(last, _)| *last == target);
        if replaces {
            self.lines.pop_back();
        } else {
            self.settle();
        }
        let is_final = target.is_none();
        self.push(LogKind::Command, &line.text);
        self.last = Some((target, false));
        if is_final {
            self.settle();
        }
    }

    /// Other words; none for an empty text.
    pub fn add(&mut self, kind: LogKind, text: &str) {
        if text.is_empty() {
            return;
        }
        self.settle();
        self.push(kind, text);
        self.last = Some((None, false));
        self.settle();
    }

    /// A command waits for others like it before stdout hears of it.
    pub fn is_pending(&self) -> bool {
        self.last.as_ref().is_some_and(|(_, is_written)| !is_written)
    }

    /// Writes what waits, and lets nothing replace it.
    pub fn settle(&mut self) {
        let Some((_, is_written)) = self.last.take() else { return };
        if let (false, Some(line)) = (is_written, self.lines.back()) {
            let mark = match line.kind {
                LogKind::Command => "> ",
                LogKind::Error => "error: ",
                LogKind::Reply | LogKind::Note => "",
            };
            let text = format!("{mark}{}", line.text);
            if let Some((printer, _)) = &self.printer {
                // It ends with this.
                let _ = printer.send(Printed::Text(text));
            }
        }
    }

    /// The same at the end.
    pub fn flush(&mut self) {
        self.settle();
        let Some((printer, thread)) = self.printer.take() else { return };
        drop(printer);
        crate::window::join(thread, PATIENCE);
    }

    fn push(&mut self, kind: LogKind, text: &str) {
        if self.lines.len() == KEPT {
            self.lines.pop_front();
        }
        self.lines.push_back(LogLine { kind, text: text.into() });
        self.snapshot = None;
    }

    fn snapshot(&mut self) -> Arc<Vec<LogLine>> {
        let lines = &self.lines;
        self.snapshot.get_or_insert_with(|| Arc::new(lines.iter().cloned().collect())).clone()
    }
}

impl Worker {
    /// The scene as the panels see it.
    pub(super) fn scene(&mut self) -> Option<Arc<SceneModel>> {
        if self.scene_model.is_none() {
            self.scene_model = scene_model(&self.console, &self.mesh_bounds).map(Arc::new);
        }
        self.scene_model.clone()
    }

    /// Lets the window know how things are.
    pub(super) fn publish(&mut self) {
        let scene = self.scene();
        // Objects and lights may be gone.
        let is_there = |selected: &Selected| {
            scene.as_ref().is_some_and(|scene| match selected {
                Selected::Object(name) => scene.objects.iter().any(|object| object.name == *name),
                Selected::Light(name) => scene.lights.iter().any(|(light, _)| light == name),
            })
        };
        if self.selected.as_ref().is_some_and(|selected| !is_there(selected)) {
            self.selected = None;
            self.selections += 1;
        }
        if std::mem::take(&mut self.names_are_old) {
            self.names = self.console.names();
            self.log.set_names(&self.names);
        }
        let log = self.log.snapshot();
        let explorer = &self.console.explorer;
        let settings =
            lumivox_render::RenderSettings { size: self.full_size, ..explorer.settings().clone() };
        let resolution = explorer.settings().resolution;
        let defaults = lumivox_render::RenderSettings { resolution, ..Default::default() };
        let usual = defaults.with_preset(explorer.preset(), explorer.scene());
        let resolution = lumivox_render::RenderSettings::default().resolution;
        let usual = lumivox_render::RenderSettings { resolution, ..usual };
        let model = Model {
            history: [explorer.undoable(), explorer.redoable()].map(|step| step.map(str::to_owned)),
            histogram: self.pace.histogram(),
            scene,
            settings,
            usual,
            preset: explorer.preset(),
            camera: explorer.camera().clone(),
            has_position: [0, 1].map(|number| explorer.position(number).is_some()),
            playback: explorer.playback(),
            revoxelize: explorer.revoxelize,
            selected: self.selected.clone(),
            opened: self.opened,
            camera_moves: self.camera_moves,
            selections: self.selections,
            picked_at: self.picked_at,
            comparand: self.comparand,
            voxels: voxel_model(explorer),
            memory: explorer.renderer().map(lumivox_render::Renderer::memory).unwrap_or_default(),
            frames: Arc::new(self.frame_times.iter().copied().collect()),
            frame_count: explorer.renderer().map_or(0, lumivox_render::Renderer::frame_count),
            jobs: self.jobs(),
            error: self.error.clone(),
            log,
            gpu: lumivox_render::describe(&explorer.gpu().adapter_info),
            names: self.names.clone(),
            lines_done: self.lines_done,
            command_line: self.command_line.clone(),
        };
        self.shared.change(|published| {
            published.model = Arc::new(model);
            published.has_model = true;
        });
        (self.wake)();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(log: &mut Log, text: &str, origin: Origin) {
        log.add_command(&Line { text: text.to_owned(), origin, serial: 0, gesture: 0 });
    }

    fn texts(log: &mut Log) -> Vec<String> {
        log.snapshot().iter().map(|line| line.text.to_string()).collect()
    }

    #[test]
    fn a_drag_is_one_line() {
        let mut log = Log::default();
        for value in ["1", "2", "3"] {
            command(&mut log, &format!("bounces {value}"), Origin::Panel);
        }
        assert_eq!(texts(&mut log), ["bounces 3"]);
        log.settle();
        command(&mut log, "bounces 4", Origin::Panel);
        command(&mut log, "bounces 5", Origin::Pane);
        command(&mut log, "bounces 6", Origin::Pane);
        assert_eq!(texts(&mut log), ["bounces 3", "bounces 4", "bounces 5", "bounces 6"]);
    }

    #[test]
    fn errors_stay_below_their_commands() {
        let mut log = Log::default();
        command(&mut log, "bounces 99", Origin::Panel);
        log.add(LogKind::Error, "too many");
        log.add(LogKind::Reply, "");
        command(&mut log, "bounces 3", Origin::Panel);
        assert_eq!(texts(&mut log), ["bounces 99", "too many", "bounces 3"]);
    }

    #[test]
    fn old_lines_go() {
        let mut log = Log::default();
        for number in 0..KEPT + 5 {
            log.push(LogKind::Note, &number.to_string());
        }
        let texts = texts(&mut log);
        assert_eq!((texts.len(), texts[0].as_str()), (KEPT, "5"));
    }
}
