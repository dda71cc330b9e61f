//! The texts of the help.

use lumivox_explorer::parameters::{
    GROUPS, Kind, OTHER_CONSOLES, PARAMETERS, Parameter, find_parameter,
};

use super::arguments::in_words;
use super::{COMMANDS, Command, Group, Reply, suggest};
use crate::Failure;

/// The width of the overview in characters.
const WIDTH: usize = 100;

/// The command `help [NAME]`.
pub(crate) fn tell(name: Option<&str>) -> anyhow::Result<Reply> {
    let Some(name) = name else { return Ok(Reply::say(overview())) };
    let command = Command::find(name);
    let parameter = find_parameter(name);
    let parts: Vec<String> =
        command.map(of_command).into_iter().chain(parameter.map(of_parameter)).collect();
    if parts.is_empty() {
        let commands = COMMANDS.iter().flat_map(Command::names);
        let known = commands.chain(PARAMETERS.iter().flat_map(Parameter::names));
        let remedy = suggest::remedy(name, known, "help");
        return Err(Failure::input(format!("there is no command \"{name}\"{remedy}")).into());
    }
    Ok(Reply::say(parts.join("\n")))
}

/// The help of a command.
fn of_command(command: &Command) -> String {
    let mut text = format!("{}\n  {}.", command.form(), command.summary);
    let details = command.details();
    if !details.is_empty() {
        text += &format!("\n  {details}");
    }
    if !command.aliases.is_empty() {
        text += &format!("\n  Also: {}.", command.aliases.join(", "));
    }
    for other in OTHER_CONSOLES {
        if let Some((_, difference)) = other.commands.iter().find(|(name, _)| *name == command.name)
        {
            let same = if difference.is_empty() { "the same" } else { difference };
            text += &format!("\n  In {}: {same}.", other.program);
        }
    }
    text + &format!("\n  Example: {}", command.example)
}

/// The help of a setting.
fn of_parameter(parameter: &Parameter) -> String {
    let Parameter { name, unit, summary, kind, help, .. } = parameter;
    let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    let mut text = format!("{name} [VALUE]\n  {summary}: {}{unit}.", kind.in_words());
    if !help.is_empty() {
        text += &format!("\n  {help}");
    }
    if let Kind::Choice(choices) = kind {
        for choice in *choices {
            text += &format!("\n  {}: {}", choice.name, choice.help);
        }
    }
    if !parameter.aliases.is_empty() {
        text += &format!("\n  Also: {}.", parameter.aliases.join(", "));
    }
    text
}

/// The names of all commands and settings.
fn overview() -> String {
    let mut text = String::new();
    for group in Group::ALL {
        let names =
            COMMANDS.iter().filter(|command| command.group == group).map(|command| command.name);
        text += &wrapped(group.title(), names);
    }
    for group in GROUPS.iter().copied() {
        let names = PARAMETERS.iter().filter(|p| p.group == group).map(|parameter| parameter.name);
        text += &wrapped(&format!("Settings: {}", group.name()), names);
    }
    text + "`help NAME` explains one, `commands` lists all with a line on each. TAB completes."
}

/// Names below a heading.
fn wrapped<'a>(heading: &str, names: impl Iterator<Item = &'a str>) -> String {
    let mut text = format!("{heading}\n ");
    let mut length = 1;
    for name in names {
        if length + 1 + name.len() > WIDTH {
            text += "\n ";
            length = 1;
        }
        text += " ";
        text += name;
        length += 1 + name.len();
    }
    text + "\n"
}

/// The commands and settings with a line on each; with a text, only those that contain it.
pub fn list(text: Option<&str>) -> String {
    let wanted = text.map(str::to_lowercase);
    let line = |form: String, aliases: &[&str], summary: &str| {
        let aliases = match aliases {
            [] => String::new(),
            aliases => format!(" ({})", in_words(aliases)),
        };
        format!("{form}{aliases}: {summary}")
    };
    let commands = COMMANDS.iter().map(|c| line(c.form(), c.aliases, c.summary));
    let settings = PARAMETERS.iter().filter(|parameter| Command::find(parameter.name).is_none());
    let settings = settings.map(|p| line(format!("{} [VALUE]", p.name), p.aliases, p.summary));
    let fits = |line: &String| wanted.as_ref().is_none_or(|w| line.to_lowercase().contains(w));
    let lines: Vec<String> = commands.chain(settings).filter(fits).collect();
    match lines.as_slice() {
        [] => format!("no command or setting contains \"{}\"", text.unwrap_or_default()),
        _ => lines.join("\n"),
    }
}
