//! Commands for the program itself.

use crate::command::Run::{Now, Waits};
use crate::command::{Command, Edits, Group, MANY, PLAIN, Takes, Urgency};
use crate::{Console, Effect, Failure, Line, Reply, help, script, shown};

pub const TABLE: &[Command] = &[
    Command {
        name: "help",
        aliases: &["?"],
        usage: "[COMMAND|SETTING]",
        count: (0, 1),
        takes: &[Takes::Command],
        summary: "Explain a command or a setting, or list all of them",
        example: "help translate",
        edits: Edits::Nothing,
        run: Now(|_, arguments| help::tell(arguments.first().copied())),
        ..PROGRAM
    },
    Command {
        name: "commands",
        usage: "[TEXT]",
        count: (0, 1),
        takes: &[Takes::Anything],
        summary: "List all commands with a line on each, or only those that contain a text",
        example: "commands cone",
        run: Now(|_, arguments| Ok(Reply::say(help::list(arguments.first().copied())))),
        ..PROGRAM
    },
    Command {
        name: "echo",
        usage: "[TEXT...]",
        count: (0, MANY),
        takes: &[Takes::Anything],
        summary: "Print the arguments",
        example: "echo 'two lamps'",
        edits: Edits::Nothing,
        run: Now(|_, arguments| Ok(Reply::say(arguments.join(" ")))),
        ..PROGRAM
    },
    Command {
        name: "run",
        usage: "FILE",
        count: (1, 1),
        takes: &[Takes::File],
        summary: "Run the commands of a file",
        details: "One or more commands a line, with ; between them; # begins a comment. It stops at the first error. Scripts may \
                  run scripts, 16 deep. A relative path starts at the folder in which the program was started.",
        example: "run evening.txt",
        run: Waits(|console, arguments| Box::pin(run(console, arguments))),
        ..PROGRAM
    },
    Command {
        name: "script",
        usage: "[FILE]",
        count: (0, 1),
        takes: &[Takes::File],
        summary: "Print the commands that lead from a fresh start to the present picture, or write them to a file",
        details: "`lumivox run` with them gives the same picture to the bit: scene, settings that differ from the \
                  preset's, camera, changes of objects, materials and lights. Comments name what is left out.",
        example: "script evening.txt",
        edits: Edits::Nothing,
        run: Now(super::script::run),
        ..PROGRAM
    },
    Command {
        name: "undo",
        summary: "Undo the last change, and print what it was",
        details: "Changes of objects, materials, lights, surroundings and settings; the last 100, until another scene is \
                  opened. A drag in the window is one change. The camera, the animation and `revoxelize` are not affected.",
        example: "undo",
        run: Now(|console, _| {
            let what =
                console.explorer.undo().map_err(|error| Failure::input(error.to_string()))?;
            Ok(Reply::say(format!("undone: {}", shown::line(&what))))
        }),
        ..PROGRAM
    },
    Command {
        name: "redo",
        summary: "Redo the change that `undo` has undone last, and print what it is",
        details: "Only until something else is changed.",
        example: "redo",
        run: Now(|console, _| {
            let what =
                console.explorer.redo().map_err(|error| Failure::input(error.to_string()))?;
            Ok(Reply::say(format!("redone: {}", shown::line(&what))))
        }),
        ..PROGRAM
    },
    Command {
        name: "quit",
        aliases: &["exit", "q"],
        summary: "End the program",
        example: "quit",
        urgency: Some(Urgency::Quit),
        run: Now(|_, _| Ok(Reply::ask(Effect::Quit))),
        ..PROGRAM
    },
];

const PROGRAM: Command = Command { group: Group::Program, ..PLAIN };

/// The command `run FILE`.
async fn run(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let file = arguments.first().copied().unwrap_or_default();
    let bytes = console.outside.read(file).await?;
    Ok(Reply::ask(Effect::Run(read(&bytes, file)?)))
}

/// The commands of a script's file. Error messages use `name`.
///
/// # Errors
/// When the file is not text, or when a quotation mark is open at the end of a line.
pub fn read(bytes: &[u8], name: &str) -> Result<Vec<Line>, Failure> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let before = bytes.get(..error.valid_up_to()).unwrap_or_default();
        let line = before.split(|byte| *byte == b'\n').count();
        Failure::input(format!("{name}:{line}: this is not text in UTF-8; give a file of commands"))
    })?;
    script(text, name)
}
