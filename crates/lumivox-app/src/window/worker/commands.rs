//! The window's own commands, and its reactions to the console's.

use anyhow::bail;
use glam::Vec2;
use lumivox_console::{Edits, Failure, LineInfo, quote, suggest, words};
use lumivox_render::{RenderSettings, View};

use super::Worker;
use crate::window::lines;
use crate::window::model::{Comparand, LogKind, Selected};
use crate::window::orders::WindowRequest;

/// Default samples of a reference.
const SAMPLES: u32 = 256;

impl Worker {
    /// Runs a command of the window; `None` if the line is not one.
    pub(super) fn run_own(&mut self, line: &str) -> Option<anyhow::Result<String>> {
        let words = words(line)?;
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let (name, arguments) = words.split_first()?;
        let done = match *name {
            "select" => self.select(arguments),
            "compare_with" => self.compare_with(arguments),
            "times" if !self.pictures.times.totals.is_empty() => {
                self.pictures.times.totals.table(arguments)
            }
            "reload" => {
                self.reload();
                Ok(String::new())
            }
            "cancel" => {
                self.cancel(None);
                Ok(String::new())
            }
            "fullscreen" if arguments.is_empty() => {
                self.publisher
                    .publish(|published| published.request = Some(WindowRequest::FullScreen));
                Ok(String::new())
            }
            "fullscreen" => {
                Err(Failure::input("fullscreen takes nothing; again, it ends it").into())
            }
            // For tests: later lines wait until the window shows the newest picture.
            "wait_shown" => {
                self.lines.wait_for_screen();
                Ok(String::new())
            }
            // For tests of lost devices.
            "lose_device" => {
                if arguments == ["window"] {
                    self.publisher
                        .publish(|published| published.request = Some(WindowRequest::LoseDevice));
                } else {
                    self.console.explorer.gpu().device.destroy();
                }
                Ok(String::new())
            }
            _ => return None,
        };
        Some(done)
    }

    /// `select [[object|light] NAME]`: selects an object or a light; without a name, clears the
    /// selection.
    fn select(&mut self, arguments: &[&str]) -> anyhow::Result<String> {
        let selected = match arguments {
            [] => None,
            [name] => Some(self.find(name, "")?),
            [kind @ ("object" | "light"), name] => Some(self.find(name, kind)?),
            _ => bail!(Failure::input(
                "select takes the name of an object or a light, after the word object or light where both have it; \
                 quote it if it has spaces"
            )),
        };
        // The camera orbits the selection, not an earlier clicked point.
        self.session.selection.choose(selected, None);
        Ok(String::new())
    }

    /// Finds an object or a light by name; `kind` is `object`, `light`, or empty for both.
    fn find(&mut self, name: &str, kind: &str) -> anyhow::Result<Selected> {
        let model = self.session.view.model(&self.console);
        let objects =
            model.iter().flat_map(|scene| &scene.objects).map(|object| object.name.as_str());
        let lights = model.iter().flat_map(|scene| &scene.lights).map(|(name, _)| name.as_str());
        if kind != "light" && objects.clone().any(|other| other == name) {
            return Ok(Selected::Object(name.to_owned()));
        }
        if kind != "object" && lights.clone().any(|other| other == name) {
            return Ok(Selected::Light(name.to_owned()));
        }
        let remedy = match suggest::like(name, objects.chain(lights)) {
            Some(like) => format!("; did you mean \"{like}\"?"),
            None => String::new(),
        };
        bail!(Failure::input(format!("there is no object or light \"{name}\"{remedy}")))
    }

    /// `compare_with nothing|VIEW|reference [SAMPLES]`
    fn compare_with(&mut self, arguments: &[&str]) -> anyhow::Result<String> {
        let expected = || {
            let views: Vec<&str> = View::ALL.iter().map(|view| view.name()).collect();
            format!(
                "compare_with takes nothing, reference [SAMPLES] or a view: {}",
                views.join(", ")
            )
        };
        let comparand = match arguments {
            [] => {
                return Ok(match self.pictures.comparand {
                    Comparand::Nothing => "compare_with nothing".to_owned(),
                    Comparand::View(view) => format!("compare_with {}", view.name()),
                    Comparand::Reference(samples) => format!("compare_with reference {samples}"),
                });
            }
            ["nothing"] => Comparand::Nothing,
            ["reference"] => Comparand::Reference(SAMPLES),
            ["reference", samples] => match samples.parse() {
                Ok(samples) if (1..=65_536).contains(&samples) => Comparand::Reference(samples),
                _ => bail!(Failure::input(format!(
                    "samples are a whole number from 1 to 65536; got \"{samples}\""
                ))),
            },
            [name] => match View::ALL.into_iter().find(|view| view.name() == *name) {
                Some(view) => Comparand::View(view),
                None => bail!(Failure::input(expected())),
            },
            _ => bail!(Failure::input(expected())),
        };
        if let Comparand::View(view) = comparand {
            let explorer = &self.console.explorer;
            let settings = RenderSettings { view, ..explorer.settings().clone() };
            settings.validate(&explorer.gpu().device.limits())?;
        }
        self.compare(comparand);
        Ok(String::new())
    }

    /// Selects the object at a place of the picture.
    pub(super) fn pick(&mut self, at: Vec2) {
        let explorer = &self.console.explorer;
        let Some(scene) = explorer.scene() else { return };
        let picker = self.session.view.picker(scene);
        let size = explorer.settings().size;
        let (origin, direction) = explorer.camera().ray(at * size.as_vec2(), size);
        let pick = picker.pick(origin, direction);
        let names = explorer.object_names();
        let selected =
            pick.and_then(|pick| names.into_iter().nth(pick.instance)).map(Selected::Object);
        let line = match &selected {
            Some(selected) => format!("select {}", quote(selected.name())),
            None => "select".to_owned(),
        };
        self.messages.log.add(LogKind::Command, &line);
        self.session.selection.choose(selected, pick.map(|pick| pick.position));
    }

    /// Invalidates state that depends on what a line has changed.
    pub(super) fn note_edits(&mut self, line: &str) {
        let edits = LineInfo::of(line).edits;
        if edits != Edits::Nothing {
            self.session.view.change();
        }
        self.session.has_edits |= edits == Edits::Look;
    }

    /// Publishes the command line that reproduces the picture, from the console's `script`.
    pub(super) fn tell_command_line(&mut self) {
        self.set_size(self.pictures.full_size());
        let script = match pollster::block_on(self.console.run("script")) {
            Ok(reply) => reply.text,
            Err(error) => return self.messages.fail(&error),
        };
        let mut words = vec!["lumivox".to_owned(), "run".to_owned()];
        for line in
            script.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'))
        {
            words.extend(["-c".to_owned(), lines::shell_quoted(line)]);
        }
        words.extend(["-c".to_owned(), lines::shell_quoted("screenshot picture.png")]);
        self.messages.copy(words.join(" "));
    }
}
