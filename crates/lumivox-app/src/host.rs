//! The environment of a run of the program: streams, progress bars, the GPU.
//!
//! Commands write all output through their [`Host`]. The program has one for its process; tests
//! give each run streams of its own, and share one GPU ([`Host::embedded`]).

use std::fmt;
use std::io::{self, BufRead, IsTerminal as _, Read as _, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use indicatif::{MultiProgress, ProgressDrawTarget};
use lumivox_console::{Failure, shown};
use lumivox_render::{Gpu, GpuOptions, RenderError};
use serde::Serialize;

use crate::exit::{self, Exit};

/// The streams, bars and GPU of a run. Clones share them.
#[derive(Clone)]
pub struct Host {
    bars: MultiProgress,
    embedded: Option<Arc<Shared>>,
}

/// Opens a GPU with these options.
pub type OpenGpu = Box<dyn Fn(&GpuOptions) -> Result<Gpu, RenderError> + Send + Sync>;

/// The streams and the GPU of a run inside another program.
pub struct Embedded {
    /// The run's stdin, which is not a terminal.
    pub input: Box<dyn BufRead + Send>,
    /// Receives what the run writes to stdout.
    pub output: Box<dyn Write + Send>,
    /// Receives what the run writes to stderr: errors and the log.
    pub errors: Box<dyn Write + Send>,
    /// Opens the GPU.
    pub open_gpu: OpenGpu,
}

struct Shared {
    input: Mutex<Box<dyn BufRead + Send>>,
    output: Mutex<Box<dyn Write + Send>>,
    errors: Mutex<Box<dyn Write + Send>>,
    open_gpu: OpenGpu,
}

impl fmt::Debug for Host {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Host").field("is_embedded", &self.is_embedded()).finish_non_exhaustive()
    }
}

impl fmt::Debug for Embedded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Embedded").finish_non_exhaustive()
    }
}

fn lock<T: ?Sized>(stream: &Mutex<T>) -> MutexGuard<'_, T> {
    stream.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Host {
    /// The host of the process.
    pub fn of_process() -> Self {
        Self { bars: MultiProgress::new(), embedded: None }
    }

    /// A host inside another program. It logs only on the thread that runs it, ignores `RUST_LOG`,
    /// and is not stopped by Ctrl-C.
    pub fn embedded(embedded: Embedded) -> Self {
        let Embedded { input, output, errors, open_gpu } = embedded;
        let bars = MultiProgress::with_draw_target(ProgressDrawTarget::hidden());
        let shared = Shared {
            input: Mutex::new(input),
            output: Mutex::new(output),
            errors: Mutex::new(errors),
            open_gpu,
        };
        Self { bars, embedded: Some(Arc::new(shared)) }
    }

    /// Whether the run shares its process with others.
    pub(crate) fn is_embedded(&self) -> bool {
        self.embedded.is_some()
    }

    /// The display of progress bars.
    pub(crate) fn bars(&self) -> &MultiProgress {
        &self.bars
    }

    /// Writes a command's whole output to stdout, with control characters escaped.
    ///
    /// # Errors
    /// A [`Failure`] of output. A reader that has closed the pipe early is not an error.
    pub fn print(&self, text: &str) -> anyhow::Result<()> {
        self.print_as_it_is(&shown::text(text))
    }

    fn print_as_it_is(&self, text: &str) -> anyhow::Result<()> {
        match self.bars.suspend(|| self.write(text)) {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
                Err(Failure::output(format!("cannot write to stdout: {error}")).into())
            }
            _ => Ok(()),
        }
    }

    /// Writes a report to stdout as one JSON object.
    ///
    /// # Errors
    /// As [`Self::print`].
    pub fn print_json(&self, report: &impl Serialize) -> anyhow::Result<()> {
        let text = serde_json::to_string_pretty(report)?;
        self.print_as_it_is(&format!("{}\n", shown::json(&text)))
    }

    fn write(&self, text: &str) -> io::Result<()> {
        let write = |out: &mut dyn Write| out.write_all(text.as_bytes()).and_then(|()| out.flush());
        match &self.embedded {
            Some(shared) => write(&mut *lock(&shared.output)),
            None => write(&mut io::stdout().lock()),
        }
    }

    /// Writes to stderr, with control characters escaped. Errors are ignored: there is no other
    /// place to report them.
    pub(crate) fn complain(&self, text: &str) {
        let text = shown::text(text);
        let _ = match &self.embedded {
            Some(shared) => lock(&shared.errors).write_all(text.as_bytes()),
            None => io::stderr().write_all(text.as_bytes()),
        };
    }

    /// Writes to stderr as `complain` does, above the progress bars.
    pub fn complain_above_bars(&self, text: &str) {
        self.bars.suspend(|| self.complain(text));
    }

    /// Whether stdin is a terminal.
    pub(crate) fn has_terminal_for_input(&self) -> bool {
        !self.is_embedded() && io::stdin().is_terminal()
    }

    /// Whether stderr is a terminal.
    pub(crate) fn has_terminal_for_errors(&self) -> bool {
        !self.is_embedded() && io::stderr().is_terminal()
    }

    /// Reads all of stdin.
    ///
    /// # Errors
    /// When it cannot be read.
    pub(crate) fn read_input(&self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        match &self.embedded {
            Some(shared) => lock(&shared.input).read_to_end(&mut bytes)?,
            None => io::stdin().lock().read_to_end(&mut bytes)?,
        };
        Ok(bytes)
    }

    /// Reads the next line of stdin, with its line feed; empty at the end.
    ///
    /// # Errors
    /// When it cannot be read.
    #[allow(dead_code, reason = "a prompt with line editing reads by itself")]
    pub(crate) fn read_line(&self) -> io::Result<String> {
        let mut line = String::new();
        match &self.embedded {
            Some(shared) => lock(&shared.input).read_line(&mut line)?,
            None => io::stdin().read_line(&mut line)?,
        };
        Ok(line)
    }

    /// Prints an error and its causes; returns the exit code.
    pub(crate) fn report(&self, error: &anyhow::Error) -> Exit {
        self.complain(&exit::message(error));
        exit::of_error(error)
    }

    /// Prints an error of the command line, or the requested help; returns the exit code.
    pub(crate) fn report_usage(&self, error: &clap::Error) -> Exit {
        // Help into a closed pipe is not worth a message.
        let _ = match (self.is_embedded(), error.use_stderr()) {
            // With colours if the terminal has them.
            (false, _) => error.print().map_err(Into::into),
            (true, true) => {
                self.complain(&error.render().to_string());
                Ok(())
            }
            (true, false) => self.print(&error.render().to_string()),
        };
        exit::of_clap(error)
    }

    /// Opens a GPU.
    ///
    /// # Errors
    /// As [`Gpu::new`].
    pub fn open_gpu(&self, options: &GpuOptions) -> Result<Gpu, RenderError> {
        let gpu = match &self.embedded {
            Some(shared) => (shared.open_gpu)(options)?,
            None => pollster::block_on(Gpu::new(options))?,
        };
        tracing::info!("running on {}", lumivox_render::describe(&gpu.adapter_info));
        Ok(gpu)
    }

    /// The first Ctrl-C sets the returned flag, the second ends the program. The caller polls the
    /// flag and, once it is set, fails with [`Failure::stopped`].
    ///
    /// # Errors
    /// When no signal handler can be installed.
    pub(crate) fn stop_on_interrupt(&self) -> anyhow::Result<Arc<AtomicBool>> {
        let is_stopped = Arc::new(AtomicBool::new(false));
        // Signals belong to the process.
        if !self.is_embedded() {
            let seen = is_stopped.clone();
            ctrlc::set_handler(move || {
                if seen.swap(true, Ordering::Relaxed) {
                    std::process::exit(Exit::Stopped as i32);
                }
            })?;
        }
        Ok(is_stopped)
    }
}
