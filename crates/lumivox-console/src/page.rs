//! The page `docs/console.md`, made from the tables.

use lumivox_explorer::parameters::{GROUPS, PARAMETERS, Parameter};

use super::{COMMANDS, Command, Group};

const HEAD: &str = "\
# The console

Commands in words look at and change everything at run time: in the console pane of the window, in the terminal that
started it, in scripts without a window (`lumivox run`), and in the page. There names of files are addresses, and files that
are written are downloads. This page is printed by `lumivox commands --markdown`; a test
holds it to the program.

A line is a command and its arguments, separated by blanks. `'...'` and `\"...\"` keep blanks together; `\\\"` and `\\\\` within
double quotes stand for themselves, and `\\u{1b}` for the character of that number. `;` separates commands, and a `#` at the start of a word begins a comment. In the usages
below, `[...]` may be left out, `|` separates choices, and `...` may be repeated. Words in capitals stand for something
of that kind. A switch without a value toggles; `on`, `true`, `yes` and `1` are the same, and so are `off`, `false`, `no`
and `0`. A wrong name or value is an error that says what would have been right, and changes nothing.

```sh
lumivox run evening.txt --scene builtin:cornell --resolution 64   # a file of commands
lumivox run -c 'load builtin:atrium; sky 20,100' -c 'screenshot atrium.png'
lumivox run                                                       # a prompt, with history and completion by TAB
generate_commands | lumivox run -                                 # from another program
```

What commands print goes to stdout; progress, warnings and errors go to stderr. A script stops at its first error, which is
told with `FILE:LINE` and gives the exit code, unless `--keep-going` is given: then all are told, and the first one's code
is returned. Relative paths are relative to the folder that the program was started in, also in scripts that lie
elsewhere. `script` prints the commands that lead to the present picture, to the bit.
";

const VXCT_HEAD: &str = "
## Commands of VXCT

All commands of the program VXCT (2019) have their names and aliases here. Where VXCT passes over a wrong name or number in
silence, this console says so.

| VXCT | here | what differs |
| --- | --- | --- |
";

const SETTINGS_HEAD: &str = "
## Settings

Each setting is a command of its own: its name alone prints the value, with a value it is set. Those of the look `vxct` that
are among the commands above do as it says there: its switches toggle without a value. `reset NAME` gives a setting the
value of the preset, `parameters` lists all with their values, and `help NAME` says more about one.

| setting | unit | value | is |
| --- | --- | --- | --- |
";

/// The page.
pub fn markdown() -> String {
    let mut text = HEAD.to_owned();
    for group in Group::ALL {
        text += &format!("\n## {}\n", group.title());
        for command in COMMANDS.iter().filter(|command| command.group == group) {
            text += &of_command(command);
        }
    }
    text += SETTINGS_HEAD;
    for group in GROUPS.iter().copied() {
        for parameter in PARAMETERS.iter().filter(|parameter| parameter.group == group) {
            text += &of_parameter(parameter);
        }
    }
    text += VXCT_HEAD;
    for command in COMMANDS.iter() {
        if let Some(difference) = command.vxct {
            let names: Vec<String> = command.names().map(|name| format!("`{name}`")).collect();
            let differs = if difference.is_empty() { "" } else { difference };
            text += &format!(
                "| {} | `{}` | {} |\n",
                names.join(", "),
                escaped(&command.form()),
                escaped(differs)
            );
        }
    }
    let of_vxct = PARAMETERS.iter().filter(|p| p.needs == Some(("look", "vxct")));
    for parameter in of_vxct.filter(|parameter| Command::find(parameter.name).is_none()) {
        let names: Vec<String> = parameter.names().map(|name| format!("`{name}`")).collect();
        let name = parameter.name;
        text += &format!("| {} | `{name} [VALUE]` | {} |\n", names.join(", "), parameter.help);
    }
    text
}

fn of_command(command: &Command) -> String {
    let mut text = format!("\n### `{}`\n\n{}.", command.form(), command.summary);
    if !command.details.is_empty() {
        text += &format!(" {}", command.details);
    }
    if !command.aliases.is_empty() {
        let aliases: Vec<String> =
            command.aliases.iter().map(|alias| format!("`{alias}`")).collect();
        text += &format!(" Also: {}.", aliases.join(", "));
    }
    text + &format!("\n\n    {}\n", command.example)
}

fn of_parameter(parameter: &Parameter) -> String {
    let Parameter { name, aliases, unit, summary, kind, .. } = parameter;
    let names = aliases.iter().fold(format!("`{name}`"), |text, alias| text + ", `" + alias + "`");
    format!("| {names} | {unit} | {} | {summary} |\n", escaped(&kind.in_words()))
}

fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}
