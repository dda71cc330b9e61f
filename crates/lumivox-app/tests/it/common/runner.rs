//! Runs of the program: in a process of its own, or within this one on a GPU that all tests share.
//!
//! A process opens a device and compiles its shaders, which takes longer than most of what is tested. So tests call the
//! program's library; what is about the process itself (signals, pipes, exit codes) starts it.
//!
//! Scenes and pictures are named relative to the working directory, and tests run side by side. On Linux the working
//! directory belongs to what `clone(2)` calls the filesystem information of a thread, which `unshare(2)` makes a thread's
//! own without any privilege; Samba's file server works so. Threads that the thread starts share it: the workers that
//! decode textures are those of a pool made in it, and whatever the driver starts there looks for no relative paths. The
//! program itself need not know of any of this, as it would if it took a folder to resolve all paths against. Where there
//! is no such thing (other systems, sandboxes that forbid it), the runs are processes.

use std::ffi::OsString;
use std::io::{Cursor, Write};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::sync::{Arc, Mutex, OnceLock};

use lumivox_app::{Embedded, Host};
use lumivox_render::{Gpu, GpuOptions, RenderError};

use super::Run;

/// Runs `lumivox` in `folder` with the words of `line`.
pub fn lumivox(folder: &Path, line: &str) -> Run {
    lumivox_with(folder, &line.split_whitespace().collect::<Vec<_>>(), "")
}

/// Runs `lumivox` with words, and a script on stdin.
pub fn lumivox_with(folder: &Path, words: &[&str], stdin: &str) -> Run {
    in_this_process(folder, words, stdin).unwrap_or_else(|| process(folder, words, stdin))
}

/// The program in a process of its own.
pub fn command(folder: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lumivox"));
    command
        .current_dir(folder)
        .env_remove("RUST_LOG")
        .env("LUMIVOX_PIPELINE_CACHE", "off")
        .args(words);
    command
}

/// As [`lumivox_with`], in a process of its own.
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

/// The library on a thread whose working directory is `folder`; `None` where threads have none of their own.
fn in_this_process(folder: &Path, words: &[&str], stdin: &str) -> Option<Run> {
    let args: Vec<OsString> = ["lumivox"].iter().chain(words).map(Into::into).collect();
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
                pool.install(|| lumivox_app::run(args, &host))
            })
        });
        run.join()
    });
    let exit = match thread {
        Ok(exit) => exit?,
        // What fails in there fails here.
        Err(panic) => std::panic::resume_unwind(panic),
    };
    Some(Run { code: exit as i32, stdout: output.text(), stderr: errors.text() })
}

/// Gives this thread a working directory of its own; whether it has one now.
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

/// One device for all runs that ask for nothing, and one for those that ask for portable limits.
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

/// What was written, to be read at the end.
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
