//! The page `docs/generated/console.md`, made from the tables.

use lumivox_explorer::parameters::{GROUPS, OTHER_CONSOLES, OtherConsole, PARAMETERS, Parameter};

use super::{COMMANDS, Command, Group};

const HEAD: &str = "\
# The console

The console has a command for everything that can be shown or changed at run time. It is in the window, in the terminal that
started the window, in scripts without a window (`lumivox run`), and in the page. In the page, names of files are addresses, and
written files are downloads. `lumivox commands --markdown` prints this document, and a test keeps it up to date.

A line is a command and its arguments, separated by blanks. `'...'` and `\"...\"` keep blanks together; within double quotes
`\\\"` and `\\\\` mean the mark and the backslash, and `\\u{1b}` the character of that number. `;` separates commands, and a `#`
at the start of a word begins a comment. In the usages below, `[...]` may be left out, `|` separates choices, `...` may be
repeated, and words in capitals are placeholders. A switch without a value toggles; `on`, `true`, `yes` and `1` are the same,
and so are `off`, `false`, `no` and `0`. A wrong name or value changes nothing; the error names the allowed ones.

```sh
lumivox run evening.txt --scene builtin:cornell --resolution 64   # a file of commands
lumivox run -c 'load builtin:atrium; sky 20,100' -c 'screenshot atrium.png'
lumivox run                                                       # a prompt, with history and completion by TAB
generate_commands | lumivox run -                                 # from another program
```

Commands print to stdout; progress, warnings and errors go to stderr. A script stops at its first error, which is reported as
`FILE:LINE` and decides the exit code. With `--keep-going` all errors are reported, and the first one decides. Relative
paths start at the folder in which the program was started, wherever the script is. `script` prints the commands that lead to
the present picture, to the bit.
";

const SETTINGS_HEAD: &str = "
## Settings

Each setting is a command: without a value it prints the setting, with one it sets it. Settings of a look that are also
commands above behave as described there: their switches toggle without a value. `reset NAME` resets a setting to the
preset's value, `parameters` lists all with their values, and `help NAME` explains one.

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
    text + &OTHER_CONSOLES.iter().map(of_other).collect::<String>()
}

/// The commands of another program.
fn of_other(other: &OtherConsole) -> String {
    let program = other.program;
    let mut text = format!(
        "\n## Commands of {program}\n\nAll commands of {program} exist here with their names and aliases; wrong names and numbers \
         are errors.\n\n| {program} | here | what differs |\n| --- | --- | --- |\n"
    );
    let row = |names: Vec<&str>, form: &str, differs: &str| {
        let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        format!("| {} | `{}` | {} |\n", names.join(", "), escaped(form), escaped(differs))
    };
    for (name, difference) in other.commands {
        if let Some(command) = Command::find(name) {
            text += &row(command.names().collect(), &command.form(), difference);
        }
    }
    let of_look = PARAMETERS.iter().filter(|p| p.needs == Some(("look", other.look)));
    for parameter in of_look.filter(|parameter| Command::find(parameter.name).is_none()) {
        let form = format!("{} [VALUE]", parameter.name);
        text += &row(parameter.names().collect(), &form, parameter.help);
    }
    text
}

fn of_command(command: &Command) -> String {
    let mut text = format!("\n### `{}`\n\n{}.", command.form(), command.summary);
    let details = command.details();
    if !details.is_empty() {
        text += &format!(" {details}");
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
