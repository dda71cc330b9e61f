//! The console: commands in words that look at and change everything at run time.
//!
//! A line is a command's name and its arguments, separated by white space; double or single quotes keep white space
//! together, and what follows a `#` is a comment. All commands are in one table ([`command::COMMANDS`]), from which
//! the help, the completion and the page in the docs are made as well. Each setting of
//! [`lumivox_render::parameters`] is a command besides: alone it prints its value, with a value it sets it.
//!
//! The window, the terminal and scripts all give lines to a [`Console`]; what takes long, or is not the console's to
//! do, it asks of them by an [`Effect`].

mod command;
mod commands;
mod line;
pub mod suggest;

use crate::explorer::{Explorer, Opening};
pub use command::{COMMANDS, Command, Group};
pub use line::{LineError, split};

/// What is left to do after a command, by whoever gave the line.
#[derive(Debug, Default)]
pub enum Effect {
    /// Nothing.
    #[default]
    Nothing,
    /// Read a scene and give it to [`Explorer::open`].
    Open(Box<Opening>),
    /// Render this number of frames before the next command.
    Wait(u32),
    /// End the program.
    Quit,
}

/// What came of a command.
#[derive(Debug, Default)]
pub struct Reply {
    /// For the user, without a line feed at its end; may be empty.
    pub text: String,
    /// What is left to do.
    pub effect: Effect,
}

impl Reply {
    /// Words for the user.
    pub fn say(text: impl Into<String>) -> Self {
        Self { text: text.into(), effect: Effect::Nothing }
    }

    /// Something left to do.
    pub fn ask(effect: Effect) -> Self {
        Self { text: String::new(), effect }
    }
}

/// The console of an explorer.
#[derive(Debug)]
pub struct Console {
    /// What the commands work on.
    pub explorer: Explorer,
}

impl Console {
    /// The console of an explorer.
    pub fn new(explorer: Explorer) -> Self {
        Self { explorer }
    }

    /// Does what a line says; an empty one, or a comment, does nothing.
    ///
    /// # Errors
    /// When there is no such command, an argument is wrong, or it cannot be done. The message says what would have been
    /// right. Nothing has changed then.
    pub fn run(&mut self, line: &str) -> anyhow::Result<Reply> {
        let words = line::split(line)?;
        let Some((name, arguments)) = words.split_first() else { return Ok(Reply::default()) };
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let Some(command) = Command::find(name) else {
            return commands::parameters::run(self, name, &arguments);
        };
        (command.run)(self, &arguments)
    }
}

#[cfg(test)]
mod tests;
