//! Runs of the program: in a separate process, or within this one on a GPU that all tests share.
//!
//! Opening a device and compiling shaders in each process would take longer than most tests. So
//! tests call the program's library; only tests of the process itself (signals, pipes, exit codes)
//! start one.
//!
//! Scenes and pictures are named relative to the working directory, and tests run in parallel. On
//! Linux, `unshare(2)` gives a thread its own working directory (part of what `clone(2)` calls
//! filesystem information) without any privilege; Samba's file server does the same. Threads that
//! it starts share that directory: the workers that decode textures belong to a pool created on it,
//! and the driver's threads use no relative paths. So the program needs no option for a base
//! folder. If this is not possible (other systems, sandboxes), runs are processes.

use std::ffi::OsString;
use std::io::{Cursor, Write};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, Mutex, OnceLock};

use lumivox_app::{Embedded, Exit, Host};
use lumivox_render::{Gpu, GpuOptions, RenderError};

use super::Run;

/// Runs `lumivox` in `folder` with the words of `line`.
pub fn lumivox(folder: &Path, line: &str) -> Run {
    lumivox_with(folder, &line.split_whitespace().collect::<Vec<_>>(), "")
}

/// Runs `lumivox` with words, and a script on stdin.
pub fn lumivox_with(folder: &Path, words: &[&str], stdin: &str) -> Run {
    in_this_process(crate::run, folder, words, stdin)
        .unwrap_or_else(|| process(folder, words, stdin))
}

/// A command that runs the program in a separate process.
pub fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(crate::PROGRAM);
    command
        .current_dir(folder)
        .env_remove("RUST_LOG")
        .env("LUMIVOX_PIPELINE_CACHE", "off")
        .args(words);
    command
}

/// As [`lumivox_with`], in a separate process.
pub fn process(folder: &Path, words: &[&str], stdin: &str) -> Run {
    let mut command = command(folder, words);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // A program that fails at once closes the pipe.
    let _ = child.stdin.take().unwrap().write_all(stdin.as_bytes());
    child.wait_with_output().unwrap().into()
}

impl From<Output> for Run {
    fn from(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: text(output.stdout),
            stderr: text(output.stderr),
        }
    }
}

/// Runs a program's library on a thread whose working directory is `folder`; `None` if threads
/// cannot have their own.
pub fn in_this_process(
    library: fn(Vec<OsString>, &Host) -> Exit,
    folder: &Path,
    words: &[&str],
    stdin: &str,
) -> Option<Run> {
    let args = [crate::PROGRAM].iter().chain(words).map(Into::into).collect();
    let input = Cursor::new(stdin.to_owned());
    let (output, errors) = (Kept::default(), Kept::default());
    let host = Host::embedded(Embedded {
        input: Box::new(input),
        output: Box::new(output.clone()),
        errors: Box::new(errors.clone()),
        open_gpu: Box::new(open_gpu),
    });
    let thread = std::thread::scope(|scope| {
        let run = scope.spawn(|| {
            enter(folder).then(|| {
                let pool = rayon::ThreadPoolBuilder::new().build().unwrap();
                pool.install(|| library(args, &host))
            })
        });
        run.join()
    });
    let exit = match thread {
        Ok(exit) => exit?,
        // Propagate panics of the run.
        Err(panic) => std::panic::resume_unwind(panic),
    };
    Some(Run { code: exit as i32, stdout: output.text(), stderr: errors.text() })
}

/// Gives this thread its own working directory; returns whether that succeeded.
#[cfg(target_os = "linux")]
fn enter(folder: &Path) -> bool {
    use nix::sched::{CloneFlags, unshare};
    let has_own = unshare(CloneFlags::CLONE_FS).is_ok();
    if has_own {
        std::env::set_current_dir(folder).unwrap();
    }
    has_own
}

#[cfg(not(target_os = "linux"))]
fn enter(_: &Path) -> bool {
    false
}

/// Returns a shared device for default runs, another for portable limits, and a new one if a run
/// names an adapter.
fn open_gpu(options: &GpuOptions) -> Result<Gpu, RenderError> {
    static USUAL: OnceLock<Gpu> = OnceLock::new();
    static PORTABLE: OnceLock<Gpu> = OnceLock::new();
    // Tests write nothing outside of their folders.
    let options = &GpuOptions { pipeline_cache: None, ..options.clone() };
    let open = |options| pollster::block_on(Gpu::new(options));
    if options.adapter.is_some() {
        return open(options);
    }
    let shared = if options.portable { &PORTABLE } else { &USUAL };
    // A missing adapter fails all tests.
    Ok(shared.get_or_init(|| open(options).unwrap()).clone())
}

/// Collects what is written.
#[derive(Clone, Default)]
struct Kept(Arc<Mutex<Vec<u8>>>);

impl Kept {
    fn text(&self) -> String {
        String::from_utf8(self.0.lock().unwrap().clone()).unwrap()
    }
}

impl Write for Kept {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().write(bytes)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}
