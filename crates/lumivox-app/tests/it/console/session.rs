//! A script with expectations: what is printed, and what becomes of the picture.

use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

use crate::common::{Run, folder, lumivox_with};

/// A small picture, quickly made.
pub const SMALL: &str = "--size 48x36 --resolution 32 --frames 1";

thread_local! {
    /// What this thread's sessions would run, while it rehearses them.
    static REHEARSED: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// The lines that a test gives to its sessions, none of which is run. What the test looks at after a session is not there,
/// so that it may fail from there on.
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

/// What is expected of a line.
enum Check {
    /// Its words are among what it prints.
    Says(Vec<String>),
    /// Its picture differs from another one, by its number.
    Differs(usize),
    /// Its picture is another one, to the bit.
    Equals(usize),
    /// Two pictures are not the same.
    Differ(usize, usize),
}

/// One run, and what is expected of its lines.
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

    /// A line of which nothing is expected but that it works.
    pub fn does(&mut self, line: &str) {
        self.script.extend([line, "\n"]);
    }

    /// A line that prints all of `needles`.
    pub fn says(&mut self, line: &str, needles: &[&str]) {
        let number = self.checks.len();
        for line in [&format!("echo '<<{number}'"), line, &format!("echo '>>{number}'")] {
            self.does(line);
        }
        let needles = needles.iter().map(|needle| (*needle).to_owned()).collect();
        self.checks.push((line.to_owned(), Check::Says(needles)));
    }

    /// Takes a picture; its number.
    pub fn picture(&mut self) -> usize {
        self.does(&format!("screenshot {}.png", self.pictures));
        self.pictures += 1;
        self.pictures - 1
    }

    /// A line after which the picture is another; its number.
    pub fn changes(&mut self, line: &str) -> usize {
        let before = self.pictures - 1;
        self.does(line);
        let after = self.picture();
        self.checks.push((line.to_owned(), Check::Differs(before)));
        self.checks.last_mut().unwrap().0 = format!("{after}|{line}");
        after
    }

    /// A line after which the picture is that of a number, to the bit.
    pub fn equals(&mut self, line: &str, picture: usize) {
        self.does(line);
        let after = self.picture();
        self.checks.push((format!("{after}|{line}"), Check::Equals(picture)));
    }

    /// Two pictures differ.
    pub fn differs(&mut self, one: usize, other: usize) {
        self.checks.push((format!("pictures {one} and {other}"), Check::Differ(one, other)));
    }

    /// Runs it all, and checks.
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
