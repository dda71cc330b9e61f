//! Scripts for the console, with expectations about their output and pictures.

use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::common::{Run, folder, lumivox_with};

/// Options of a small, quick picture.
pub const SMALL: &str = "--size 48x36 --resolution 32 --frames 1";

thread_local! {
    /// In a rehearsal, the script of this thread's sessions; else `None`.
    static REHEARSED: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// The lines that a test gives to its sessions, without running them. The test may fail after a
/// session, as a rehearsal has no results.
pub fn rehearse(test: fn()) -> String {
    REHEARSED.set(Some(String::new()));
    let _ = std::panic::catch_unwind(test);
    REHEARSED.take().unwrap_or_default()
}

/// Runs a script with options; `None` in a rehearsal.
pub fn run_script(folder: &Path, script: &str, options: &str) -> Option<Run> {
    let is_rehearsal = REHEARSED.with_borrow_mut(|lines| {
        lines.as_mut().map(|lines| lines.extend([script, "\n"])).is_some()
    });
    let words: Vec<&str> = ["run", "-"].into_iter().chain(options.split_whitespace()).collect();
    (!is_rehearsal).then(|| lumivox_with(folder, &words, script))
}

/// An expectation.
enum Check {
    /// The line's output contains these words.
    Says(Vec<String>),
    /// The line's picture differs from the picture of this number.
    Differs(usize),
    /// The line's picture equals the picture of this number, to the bit.
    Equals(usize),
    /// Two pictures differ.
    Differ(usize, usize),
}

/// One run, and the expectations on its lines.
pub struct Session {
    pub folder: TempDir,
    options: String,
    script: String,
    checks: Vec<(String, Check)>,
    pictures: usize,
}

/// A file of the project.
pub fn project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path).canonicalize().unwrap()
}

impl Session {
    pub fn new(options: &str) -> Self {
        Self {
            folder: folder(),
            options: format!("{SMALL} {options}"),
            script: String::new(),
            checks: Vec::new(),
            pictures: 0,
        }
    }

    /// Adds a line that must succeed.
    pub fn does(&mut self, line: &str) {
        self.script.extend([line, "\n"]);
    }

    /// Adds a line that must print all of `needles`.
    pub fn says(&mut self, line: &str, needles: &[&str]) {
        let number = self.checks.len();
        for line in [&format!("echo '<<{number}'"), line, &format!("echo '>>{number}'")] {
            self.does(line);
        }
        let needles = needles.iter().map(|needle| (*needle).to_owned()).collect();
        self.checks.push((line.to_owned(), Check::Says(needles)));
    }

    /// Adds a screenshot; returns its number.
    pub fn picture(&mut self) -> usize {
        self.does(&format!("screenshot {}.png", self.pictures));
        self.pictures += 1;
        self.pictures - 1
    }

    /// Adds a line that must change the picture; returns the new picture's number.
    pub fn changes(&mut self, line: &str) -> usize {
        let before = self.pictures - 1;
        self.does(line);
        let after = self.picture();
        self.checks.push((line.to_owned(), Check::Differs(before)));
        self.checks.last_mut().unwrap().0 = format!("{after}|{line}");
        after
    }

    /// Adds a line after which the picture must equal the picture of this number, to the bit.
    pub fn equals(&mut self, line: &str, picture: usize) {
        self.does(line);
        let after = self.picture();
        self.checks.push((format!("{after}|{line}"), Check::Equals(picture)));
    }

    /// Expects that two pictures differ.
    pub fn differs(&mut self, one: usize, other: usize) {
        self.checks.push((format!("pictures {one} and {other}"), Check::Differ(one, other)));
    }

    /// Runs the script, and checks all expectations.
    #[track_caller]
    pub fn finish(self) -> Run {
        let Some(run) = run_script(self.folder.path(), &self.script, &self.options) else {
            return Run { code: 0, stdout: String::new(), stderr: String::new() };
        };
        let run = run.expect_ok();
        let read =
            |number: usize| fs::read(self.folder.path().join(format!("{number}.png"))).unwrap();
        let pixels = |number: usize| image::load_from_memory(&read(number)).unwrap().to_rgba8();
        for (number, (line, check)) in self.checks.iter().enumerate() {
            let own = || {
                let (picture, line) = line.split_once('|').unwrap();
                (pixels(picture.parse().unwrap()), line.to_owned())
            };
            match check {
                Check::Says(needles) => {
                    let (_, said) = run.stdout.split_once(&format!("<<{number}\n")).unwrap();
                    let (said, _) = said.split_once(&format!(">>{number}\n")).unwrap();
                    for needle in needles {
                        assert!(said.contains(needle), "{line}: no \"{needle}\" in\n{said}");
                    }
                }
                Check::Differs(before) => {
                    let (own, line) = own();
                    assert!(own != pixels(*before), "{line}: the picture has not changed");
                }
                Check::Differ(one, other) => {
                    assert!(pixels(*one) != pixels(*other), "{line} are the same");
                }
                Check::Equals(other) => {
                    let (own, line) = own();
                    assert!(own == pixels(*other), "{line}: the picture is not number {other}");
                }
            }
        }
        run
    }
}
