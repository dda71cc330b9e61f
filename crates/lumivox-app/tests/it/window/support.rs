//! A display without a screen, the program in it, synthetic input, and screenshots.

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use x11rb::connection::Connection as _;
use x11rb::protocol::xproto::{
    AtomEnum, ClientMessageEvent, ConfigureWindowAux, ConnectionExt as _, EventMask, ImageFormat,
    InputFocus, MapState,
};
use x11rb::protocol::xtest::ConnectionExt as _;
use x11rb::rust_connection::RustConnection;

/// Maximum time of a wait: a software GPU shared with other tests is slow.
pub const DEADLINE: Duration = Duration::from_mins(5);
const POLL: Duration = Duration::from_millis(60);

const KEY_PRESS: u8 = 2;
const KEY_RELEASE: u8 = 3;
const BUTTON_PRESS: u8 = 4;
const BUTTON_RELEASE: u8 = 5;
const MOTION: u8 = 6;

/// Keys other than letters, by X's names (`keysymdef.h`).
pub const RETURN: u32 = 0xff0d;
pub const ESCAPE: u32 = 0xff1b;
pub const F2: u32 = 0xffbf;
pub const F11: u32 = 0xffc8;
const SHIFT: u32 = 0xffe1;
const CONTROL: u32 = 0xffe3;

/// An X server without a screen.
pub struct Display {
    server: Child,
    pub name: String,
}

impl Display {
    pub fn start() -> Self {
        let server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-screen",
                "0",
                "1100x800x24",
                "-nolisten",
                "tcp",
                "-noreset",
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = server.unwrap_or_else(|error| {
            panic!("tests of the window need Xvfb ({error}); on Debian and Ubuntu: apt-get install xvfb")
        });
        let mut number = String::new();
        BufReader::new(server.stdout.take().unwrap()).read_line(&mut number).unwrap();
        assert!(!number.trim().is_empty(), "Xvfb has found no free display");
        Self { server, name: format!(":{}", number.trim()) }
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// A screenshot, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<[u8; 3]>,
}

impl Seen {
    /// The part between a top left and a bottom right corner, px.
    pub fn part(&self, (left, top): (usize, usize), (right, bottom): (usize, usize)) -> Self {
        let (right, bottom) = (right.min(self.width), bottom.min(self.height));
        let rows =
            (top..bottom).flat_map(|y| &self.pixels[y * self.width + left..y * self.width + right]);
        Self { width: right - left, height: bottom - top, pixels: rows.copied().collect() }
    }

    /// The share of pixels for which `is_like` is `true`.
    pub fn share(&self, is_like: impl Fn([f32; 3]) -> bool) -> f32 {
        let count = self.pixels.iter().filter(|pixel| is_like(pixel.map(f32::from))).count();
        count as f32 / self.pixels.len() as f32
    }

    /// The mean difference to another picture, 0 to 255; infinite if its size differs.
    pub fn distance(&self, other: &Self) -> f32 {
        if (self.width, self.height) != (other.width, other.height) {
            return f32::INFINITY;
        }
        let of = |(a, b): (&[u8; 3], &[u8; 3])| {
            (0..3).map(|c| f32::from(a[c].abs_diff(b[c]))).sum::<f32>()
        };
        let sum: f32 = self.pixels.iter().zip(&other.pixels).map(of).sum();
        sum / (3 * self.pixels.len()) as f32
    }
}

/// The program in its window.
pub struct Window {
    program: Child,
    stdin: Option<ChildStdin>,
    lines: Arc<Mutex<Vec<String>>>,
    errors: Arc<Mutex<Vec<String>>>,
    x: RustConnection,
    root: u32,
    pub id: u32,
    keys: Vec<(u8, u8, u32)>,
}

fn collect(stream: impl std::io::Read + Send + 'static) -> Arc<Mutex<Vec<String>>> {
    let lines = Arc::new(Mutex::new(Vec::new()));
    let seen = lines.clone();
    std::thread::spawn(move || {
        for line in BufReader::new(stream).lines().map_while(Result::ok) {
            seen.lock().unwrap().push(line);
        }
    });
    lines
}

/// A command for the program, with its files in a folder.
pub fn command(display: &str, home: &Path) -> Command {
    let mut command = crate::common::command(home, &[]);
    command
        .env("DISPLAY", display)
        .env("XDG_CONFIG_HOME", home.join("config"))
        .env("XDG_DATA_HOME", home.join("data"))
        .env_remove("WAYLAND_DISPLAY")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

impl Window {
    /// Starts `lumivox view` with the words of a line, and the device that the environment names.
    pub fn open(display: &Display, home: &Path, line: &str) -> Self {
        let mut command = command(&display.name, home);
        command.arg("view").args(line.split_whitespace());
        if let Some(device) = std::env::var_os("LUMIVOX_TEST_WINDOW_DEVICE")
            && !line.contains("--window-device")
        {
            command.arg("--window-device").arg(device);
        }
        let mut program = command.spawn().unwrap();
        let lines = collect(program.stdout.take().unwrap());
        let errors = collect(program.stderr.take().unwrap());
        let (x, screen) = x11rb::connect(Some(&display.name)).unwrap();
        let root = x.setup().roots[screen].root;
        let (first, last) = (x.setup().min_keycode, x.setup().max_keycode);
        let map = x.get_keyboard_mapping(first, last - first + 1).unwrap().reply().unwrap();
        let columns = usize::from(map.keysyms_per_keycode);
        let keys = map
            .keysyms
            .iter()
            .enumerate()
            .filter(|(index, symbol)| index % columns < 2 && **symbol != 0);
        let keys = keys
            .map(|(index, symbol)| {
                (first + (index / columns) as u8, (index % columns) as u8, *symbol)
            })
            .collect();
        let stdin = program.stdin.take();
        let mut window = Self { program, stdin, lines, errors, x, root, id: 0, keys };
        window.id = window.wait("a window on the display", |window| window.find());
        window.focus();
        window
    }

    fn find(&self) -> Option<u32> {
        let tree = self.x.query_tree(self.root).ok()?.reply().ok()?;
        tree.children.into_iter().find(|id| {
            let named = self.x.get_property(false, *id, AtomEnum::WM_NAME, AtomEnum::ANY, 0, 64);
            let named = named.ok().and_then(|named| named.reply().ok());
            let is_seen = self.x.get_window_attributes(*id).ok().and_then(|a| a.reply().ok());
            named.is_some_and(|named| named.value == b"Lumivox")
                && is_seen.is_some_and(|a| a.map_state == MapState::VIEWABLE)
        })
    }

    /// Gives the window the keyboard focus, as there is no window manager.
    pub fn focus(&self) {
        let _ = self
            .x
            .set_input_focus(InputFocus::PARENT, self.id, x11rb::CURRENT_TIME)
            .unwrap()
            .check();
    }

    /// Calls `look` until it returns `Some`; panics with the program's output on timeout.
    #[track_caller]
    pub fn wait<T>(&mut self, what: &str, mut look: impl FnMut(&mut Self) -> Option<T>) -> T {
        let start = Instant::now();
        loop {
            if let Some(found) = look(self) {
                return found;
            }
            let has_ended = self.program.try_wait().unwrap();
            if start.elapsed() > DEADLINE || has_ended.is_some() {
                let (lines, errors) = (self.lines.lock().unwrap(), self.errors.lock().unwrap());
                panic!(
                    "no {what}; ended: {has_ended:?}\n{}\n{}",
                    lines.join("\n"),
                    errors.join("\n")
                );
            }
            std::thread::sleep(POLL);
        }
    }

    /// Waits for a line on stdout after the first `after`; returns the number of lines up to it.
    #[track_caller]
    pub fn wait_line(&mut self, after: usize, needle: &str) -> usize {
        self.wait(&format!("line with \"{needle}\""), |window| {
            let lines = window.lines.lock().unwrap();
            let found = lines.iter().skip(after).position(|line| line.contains(needle));
            found.map(|at| after + at + 1)
        })
    }

    /// Waits for words on stderr.
    #[track_caller]
    pub fn wait_error(&mut self, needle: &str) {
        self.wait(&format!("warning with \"{needle}\""), |window| {
            let errors = window.errors.lock().unwrap();
            errors.iter().any(|line| line.contains(needle)).then_some(())
        });
    }

    pub fn lines(&self) -> Vec<String> {
        self.lines.lock().unwrap().clone()
    }

    /// Writes a line to the program's stdin.
    pub fn tell(&mut self, line: &str) {
        writeln!(self.stdin.as_mut().unwrap(), "{line}").unwrap();
    }

    /// A screenshot of the window.
    pub fn see(&self) -> Seen {
        let place = self.x.get_geometry(self.id).unwrap().reply().unwrap();
        let (width, height) = (place.width, place.height);
        let image =
            self.x.get_image(ImageFormat::Z_PIXMAP, self.id, 0, 0, width, height, !0).unwrap();
        let image = image.reply().unwrap();
        let pixels = image.data.chunks_exact(4).map(|p| [p[2], p[1], p[0]]).collect();
        Seen { width: width.into(), height: height.into(), pixels }
    }

    /// The picture in the middle, without bars.
    pub fn picture(&self) -> Seen {
        let seen = self.see();
        let (width, height) = (seen.width, seen.height);
        seen.part((10, 40), (width - 10, height - 40))
    }

    /// Waits until the picture differs from `before`.
    #[track_caller]
    pub fn wait_change(&mut self, what: &str, before: &Seen) -> Seen {
        self.wait(what, |window| Some(window.picture()).filter(|now| now.distance(before) > 2.0))
    }

    /// Waits until the picture is complete: all frames are rendered, and the window has drawn the
    /// last one in the worker's size. Then waits until the display shows it.
    #[track_caller]
    pub fn wait_rest(&mut self) -> Seen {
        let before = self.lines().len();
        self.tell("wait 1000");
        self.tell("wait_shown");
        self.tell("echo complete");
        // Match the whole line: "the reference is complete" may come at any time.
        self.wait("end of waiting", |window| {
            window.lines().iter().skip(before).any(|line| line == "complete").then_some(())
        });
        let (mut last, mut same) = (self.picture(), 0);
        self.wait("picture that stays", |window| {
            let now = window.picture();
            same = if now == last { same + 1 } else { 0 };
            last = now;
            (same == 12).then(|| last.clone())
        })
    }

    fn fake(&self, kind: u8, detail: u8, x: i16, y: i16) {
        self.x.xtest_fake_input(kind, detail, x11rb::CURRENT_TIME, self.root, x, y, 0).unwrap();
        self.x.flush().unwrap();
    }

    pub fn point(&self, x: i16, y: i16) {
        self.fake(MOTION, 0, x, y);
    }

    pub fn press(&self) {
        self.fake(BUTTON_PRESS, 1, 0, 0);
    }

    pub fn release(&self) {
        self.fake(BUTTON_RELEASE, 1, 0, 0);
    }

    pub fn click(&self, x: i16, y: i16) {
        self.point(x, y);
        // Pause before the press, as a person does.
        std::thread::sleep(POLL);
        self.press();
        std::thread::sleep(POLL);
        self.release();
    }

    pub fn key(&self, symbol: u32) {
        let (code, column, _) = *self.keys.iter().find(|(_, _, other)| *other == symbol).unwrap();
        let shift = self.keys.iter().find(|(_, _, other)| *other == SHIFT).unwrap().0;
        if column == 1 {
            self.fake(KEY_PRESS, shift, 0, 0);
        }
        self.fake(KEY_PRESS, code, 0, 0);
        self.fake(KEY_RELEASE, code, 0, 0);
        if column == 1 {
            self.fake(KEY_RELEASE, shift, 0, 0);
        }
        std::thread::sleep(POLL);
    }

    /// Presses a key while Ctrl is held.
    pub fn control(&self, symbol: u32) {
        let code = |symbol| self.keys.iter().find(|(_, _, other)| *other == symbol).unwrap().0;
        self.fake(KEY_PRESS, code(CONTROL), 0, 0);
        self.fake(KEY_PRESS, code(symbol), 0, 0);
        self.fake(KEY_RELEASE, code(symbol), 0, 0);
        self.fake(KEY_RELEASE, code(CONTROL), 0, 0);
    }

    /// Types text; characters of Latin 1 are their own key symbols.
    pub fn write(&self, text: &str) {
        for letter in text.chars() {
            self.key(letter as u32);
        }
    }

    pub fn resize(&self, width: u32, height: u32) {
        let size = ConfigureWindowAux::new().width(width).height(height);
        self.x.configure_window(self.id, &size).unwrap().check().unwrap();
    }

    /// Minimizes the window, as a window manager does.
    pub fn unmap(&self) {
        self.x.unmap_window(self.id).unwrap().check().unwrap();
    }

    pub fn map(&self) {
        self.x.map_window(self.id).unwrap().check().unwrap();
    }

    /// Closes the window, as a window manager does. Returns the exit code.
    #[track_caller]
    pub fn close(mut self) -> i32 {
        let atom = |name: &[u8]| self.x.intern_atom(false, name).unwrap().reply().unwrap().atom;
        let (protocols, delete) = (atom(b"WM_PROTOCOLS"), atom(b"WM_DELETE_WINDOW"));
        let message = ClientMessageEvent::new(32, self.id, protocols, [delete, 0, 0, 0, 0]);
        self.x.send_event(false, self.id, EventMask::NO_EVENT, message).unwrap();
        self.x.flush().unwrap();
        self.ended()
    }

    /// Waits until the program ends; returns the exit code.
    #[track_caller]
    pub fn ended(&mut self) -> i32 {
        let start = Instant::now();
        loop {
            if let Some(status) = self.program.try_wait().unwrap() {
                let errors = self.errors.lock().unwrap().join("\n");
                assert!(!errors.contains("panicked") && !errors.contains("defect"), "{errors}");
                return status.code().unwrap_or(-1);
            }
            assert!(start.elapsed() < DEADLINE, "it does not end");
            std::thread::sleep(POLL);
        }
    }
}

impl Drop for Window {
    fn drop(&mut self) {
        let _ = self.program.kill();
        let _ = self.program.wait();
    }
}
