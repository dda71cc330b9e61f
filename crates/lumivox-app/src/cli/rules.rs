//! Rules for the options of `lumivox` and `lumivox-lab`.

use clap::{Arg, ArgAction, Command as Definition, CommandFactory as _};
use lumivox_console::values::Refused;

use super::Cli;

fn commands() -> Vec<Definition> {
    let mut root = Cli::command();
    root.build();
    let commands: Vec<Definition> = root.get_subcommands().cloned().collect();
    commands.into_iter().filter(|command| command.get_name() != "help").chain([root]).collect()
}

/// The arguments without `--help`, `--version` and `--verbose`.
fn arguments(command: &Definition) -> impl Iterator<Item = &Arg> {
    command
        .get_arguments()
        .filter(|argument| !matches!(argument.get_id().as_str(), "help" | "version" | "verbose"))
}

#[test]
fn clap_accepts_the_command_definition() {
    Cli::command().debug_assert();
}

#[test]
fn every_argument_has_help_and_a_default() {
    for command in commands() {
        for argument in arguments(&command) {
            let name = format!("{} of {}", argument.get_id(), command.get_name());
            let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
            assert!(help.len() > 10, "{name} has no help");
            let tells_default = !argument.get_default_values().is_empty()
                || help.contains("[default: ")
                || argument.is_required_set();
            assert!(tells_default, "{name} tells no default: {help}");
        }
    }
}

#[test]
fn every_value_has_a_unit_or_choices() {
    const UNITS: [&str; 23] = [
        "seconds",
        "degrees",
        "mib",
        "json",
        "pixels",
        "texels",
        "voxels",
        "metres",
        "stops",
        "lux",
        "cd/m2",
        "frames",
        "cones",
        "reflections",
        "bounces",
        "factor",
        "share",
        "level",
        "metre",
        "name",
        "file",
        "number",
        "builtin:name",
    ];
    for command in commands() {
        for argument in arguments(&command) {
            let takes_value = matches!(argument.get_action(), ArgAction::Set | ArgAction::Append);
            if !takes_value || !argument.get_possible_values().is_empty() {
                continue;
            }
            let help = argument.get_help().map(ToString::to_string).unwrap_or_default();
            let help = help.to_lowercase();
            assert!(
                UNITS.iter().any(|unit| help.contains(unit)),
                "{} of {} names no unit: {help}",
                argument.get_id(),
                command.get_name()
            );
        }
    }
}

#[test]
fn every_choice_is_explained() {
    for command in commands() {
        for argument in arguments(&command) {
            if argument.get_action().takes_values() && !argument.is_hide_possible_values_set() {
                for choice in argument.get_possible_values() {
                    assert!(choice.get_help().is_some(), "{}", choice.get_name());
                }
            }
        }
    }
}

/// Values out of range are bad input, not mistakes of usage, even negative ones, which look like
/// options.
#[test]
fn numbers_out_of_range_are_bad_input_everywhere() {
    // Built once: building takes longer than parsing a line.
    let mut root = Cli::command();
    root.build();
    let mut is_usage = |command: &Definition, option: &str, value: &str| {
        let words = ["program", command.get_name(), option, value];
        // clap checks values before it looks for missing arguments.
        let error = root.try_get_matches_from_mut(words).err()?;
        let is_of_value = matches!(
            error.kind(),
            clap::error::ErrorKind::ValueValidation
                | clap::error::ErrorKind::InvalidValue
                | clap::error::ErrorKind::UnknownArgument
        );
        let refused = std::error::Error::source(&error).and_then(|e| e.downcast_ref::<Refused>());
        is_of_value.then_some(!matches!(refused, Some(Refused::OutOfRange(_))))
    };
    let (mut numbers, mut wrong) = (0, Vec::new());
    for command in commands() {
        for argument in arguments(&command).filter(|a| a.get_action().takes_values()) {
            let Some(option) = argument.get_long().map(|long| format!("--{long}")) else {
                continue;
            };
            let is_number = is_usage(&command, &option, "8") != Some(true)
                && is_usage(&command, &option, "x") == Some(true);
            if !is_number {
                continue;
            }
            numbers += 1;
            for value in ["-99999999999999999999", "99999999999999999999"] {
                if is_usage(&command, &option, value) == Some(true) {
                    wrong.push(format!("{} {option} {value}", command.get_name()));
                }
            }
        }
    }
    assert!(numbers > 30, "{numbers}");
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn help_lists_all_exit_codes() {
    let codes = [
        "0  all",
        "1  the GPU",
        "2  the command",
        "3  bad",
        "4  no",
        "5  the output",
        "130  stopped",
    ];
    for line in codes {
        assert!(Cli::command().render_long_help().to_string().contains(line), "{line}");
    }
}
