//! `lumivox run`: commands from a file, from stdin, from the command line, or from a prompt.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::{Arc, Mutex};

use lumivox_console::{
    Console, Effect, Failure, LineInfo, Queue, SceneRequest, help, page, script, script_of_bytes,
};
use lumivox_explorer::Explorer;
use lumivox_render::RenderProgress as Step;

use crate::cli::RunArgs;
use crate::disk::{self, Disk};
use crate::exit::{Located, Told};
use crate::host::Host;
use crate::opening;
use crate::progress::{ProgressDisplay, words};
use crate::prompt::Prompt;

/// The scene's time per frame of a script, s.
const FRAME_S: f32 = 1.0 / 30.0;

/// Runs commands.
///
/// # Errors
/// The first error of a command; with `--keep-going` a summary of all errors.
pub fn run(args: &RunArgs, host: &Host) -> anyhow::Result<()> {
    let is_terminal = host.has_terminal_for_input();
    let is_stdin = args.script.as_deref() == Some(Path::new("-"));
    let is_prompt = args.script.is_none() && args.commands.is_empty() && is_terminal;
    let mut queue = Queue::default();
    if let Some(file) = args.script.as_ref().filter(|_| !is_stdin) {
        queue.extend(script_of_bytes(&disk::read(file)?, &file.display().to_string())?);
    } else if !args.commands.is_empty() {
        for (index, commands) in args.commands.iter().enumerate() {
            queue.extend(script(commands, &format!("-c {}", index + 1))?);
        }
    } else if !is_prompt {
        // A pipe is read to its end first, so that a malformed line is reported before anything
        // runs.
        queue.extend(script(&read_stdin(host)?, "stdin")?);
    }
    let mut runner = Runner::new(args, host)?;
    if let Some(opening) = opening::of_args(&args.explore) {
        runner.open(opening)?;
    }
    if is_prompt { runner.prompt() } else { runner.run(queue, args.keep_going) }
}

/// `lumivox commands`
///
/// # Errors
/// When stdout cannot be written.
pub fn list(is_markdown: bool, host: &Host) -> anyhow::Result<()> {
    if is_markdown {
        return host.print(&page::markdown());
    }
    host.print(&format!("{}\n", help::list(None)))
}

fn read_stdin(host: &Host) -> Result<String, Failure> {
    let bytes = host.read_input();
    let bytes = bytes.map_err(|error| Failure::input(format!("stdin cannot be read: {error}")))?;
    String::from_utf8(bytes)
        .map_err(|_| Failure::input("stdin is not text in UTF-8; give commands"))
}

/// The progress display of the running command, if there is one.
type Shown = Mutex<Option<ProgressDisplay>>;

/// Shows the progress of a command.
fn tell(shown: &Shown, step: Step) {
    if let Ok(shown) = shown.lock()
        && let Some(progress) = shown.as_ref()
    {
        progress.set(words(step.stage), step.done, step.total);
    }
}

/// A console without a window.
struct Runner {
    console: Console,
    host: Host,
    progress: Arc<Shown>,
    is_over: bool,
}

impl Runner {
    fn new(args: &RunArgs, host: &Host) -> anyhow::Result<Self> {
        let explore = &args.explore;
        let settings = explore.settings()?;
        let gpu = host.open_gpu(&explore.gpu.options())?;
        let explorer = Explorer::new(gpu, settings.clone(), explore.cones.preset());
        let mut console = Console::new(explorer, Box::new(Disk))
            .with_defaults(explore.load.clone(), explore.light.sources.clone());
        console.explorer.set_settings(settings)?;
        let progress = Arc::new(Shown::new(None));
        let shown = progress.clone();
        console.on_progress(Box::new(move |step| {
            tell(&shown, step);
            ControlFlow::Continue(())
        }));
        Ok(Self { console, host: host.clone(), progress, is_over: false })
    }

    /// Runs all lines, including those that lines add.
    fn run(&mut self, mut queue: Queue, keeps_going: bool) -> anyhow::Result<()> {
        let mut first = None;
        let mut failed = 0_u32;
        while let Some(line) = queue.take() {
            let Err(error) = self.line(&line.text, &mut queue) else {
                if self.is_over {
                    break;
                }
                continue;
            };
            let error = Located::new(line.place, error);
            if !keeps_going {
                return Err(error.into());
            }
            failed += 1;
            let code = self.host.report(&error.into());
            first.get_or_insert(code);
        }
        let Some(code) = first else { return Ok(()) };
        let commands =
            if failed == 1 { "1 command".to_owned() } else { format!("{failed} commands") };
        let message = format!("{commands} failed; the first one gives the exit code");
        Err(Told { exit: code, message }.into())
    }

    /// Runs a line, and the effect of its reply.
    fn line(&mut self, line: &str, queue: &mut Queue) -> anyhow::Result<()> {
        if let Some(name) = LineInfo::of(line).window_command {
            tracing::warn!("`{name}` is a command of the window; it is skipped");
            return Ok(());
        }
        self.show(Some(ProgressDisplay::start(&self.host, "working")));
        let reply = pollster::block_on(self.console.run(line));
        let done = reply.and_then(|reply| {
            if !reply.text.is_empty() {
                self.host.print(&format!("{}\n", reply.text))?;
            }
            match reply.effect {
                Effect::Nothing => Ok(()),
                Effect::Quit => {
                    self.is_over = true;
                    Ok(())
                }
                Effect::Run(lines) => Ok(queue.interpose(lines)?),
                Effect::Wait(frames) => self.wait(frames),
                Effect::Open(opening) => {
                    self.show(None);
                    self.open(*opening)
                }
            }
        });
        self.show(None);
        done
    }

    fn show(&self, progress: Option<ProgressDisplay>) {
        // Drop the previous display outside the lock: dropping waits for its thread.
        let before = self
            .progress
            .lock()
            .ok()
            .and_then(|mut shown| std::mem::replace(&mut *shown, progress));
        drop(before);
    }

    fn open(&mut self, opening: SceneRequest) -> anyhow::Result<()> {
        let progress = ProgressDisplay::start(&self.host, "loading");
        let scene = opening::load(opening, &progress)?;
        drop(progress);
        self.console.open(scene);
        Ok(())
    }

    fn wait(&mut self, frames: u32) -> anyhow::Result<()> {
        let shown = self.progress.clone();
        for done in 0..frames {
            self.console.explorer.tick(FRAME_S)?;
            pollster::block_on(self.console.explorer.frame(&mut |step| tell(&shown, step)))?;
            tell(&shown, Step { stage: "render", done: done + 1, total: frames });
        }
        Ok(())
    }

    /// Reads and runs lines until the end of the input.
    fn prompt(&mut self) -> anyhow::Result<()> {
        let mut terminal = Prompt::new(&self.host)?;
        while !self.is_over {
            terminal.set_names(self.console.names());
            let Some(line) = terminal.read()? else { break };
            let mut queue = Queue::default();
            queue.add(line, "");
            while let Some(line) = queue.take() {
                if let Err(error) = self.line(&line.text, &mut queue) {
                    self.host.report(&Located::new(line.place, error).into());
                    queue.abandon();
                }
                if self.is_over {
                    break;
                }
            }
        }
        Ok(())
    }
}
