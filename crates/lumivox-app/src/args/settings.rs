//! Options for settings, made from the table of settings (`lumivox_explorer::parameters`).
//!
//! Each setting is an option of its name, with `-` for `_`. A switch that is off by default needs
//! no value; any other option needs one. Shorthands take none. The settings of a look are given as
//! `--LOOK NAME=VALUE`.

use std::fmt::Write as _;
use std::marker::PhantomData;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser, ValueParser};
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, Error, FromArgMatches};
use lumivox_explorer::parameters::{GROUPS, Group, Kind, PARAMETERS, PRESETS, Parameter, Value};
use lumivox_render::PresetChoice;

use super::Refused;

/// A setting with its value on the command line.
pub type Given = (&'static Parameter, Value);

/// Groups of settings, as one set of options.
pub trait Groups {
    /// Whether a group is among them.
    fn has(group: Group) -> bool;
}

/// The groups of a picture: its frames, exposure, view and overlay.
#[derive(Clone, Debug)]
pub struct PictureGroups;
/// The group of voxels, and where they are stored.
#[derive(Clone, Debug)]
pub struct VolumeGroups;
/// The group of light and shadows.
#[derive(Clone, Debug)]
pub struct LightGroups;
/// The groups of the cones and of looks.
#[derive(Clone, Debug)]
pub struct ConeGroups;

impl Groups for PictureGroups {
    fn has(group: Group) -> bool {
        matches!(group, Group::Picture | Group::View | Group::Overlay)
    }
}

impl Groups for VolumeGroups {
    fn has(group: Group) -> bool {
        group == Group::Volume
    }
}

impl Groups for LightGroups {
    fn has(group: Group) -> bool {
        group == Group::Light
    }
}

impl Groups for ConeGroups {
    fn has(group: Group) -> bool {
        matches!(group, Group::Cones | Group::Look(_))
    }
}

/// The looks among some groups.
fn looks<G: Groups>() -> impl Iterator<Item = &'static str> {
    GROUPS.iter().filter(|group| G::has(**group)).filter_map(|group| match group {
        Group::Look(look) => Some(*look),
        _ => None,
    })
}

/// The options of some groups of settings.
#[derive(Clone, Debug)]
pub struct SettingArgs<G> {
    given: Vec<Given>,
    groups: PhantomData<G>,
}

impl<G> SettingArgs<G> {
    /// The settings given on the command line: in the order of the table, then those of looks.
    pub fn given(&self) -> &[Given] {
        &self.given
    }
}

impl<G: Groups> Args for SettingArgs<G> {
    fn augment_args(command: Command) -> Command {
        let of_groups = PARAMETERS.iter().filter(|p| G::has(p.group) && look_of(p).is_none());
        command.args(of_groups.flat_map(options)).args(looks::<G>().map(look_option))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<G: Groups> FromArgMatches for SettingArgs<G> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, Error> {
        let mut given = Vec::new();
        for parameter in PARAMETERS.iter().filter(|p| G::has(p.group) && look_of(p).is_none()) {
            if matches.value_source(parameter.name) == Some(ValueSource::CommandLine)
                && let Some(value) = matches.get_one::<Value>(parameter.name)
            {
                given.push((parameter, *value));
            }
            for (name, value) in parameter.shorthands {
                if matches.get_flag(name) {
                    given.push((parameter, *value));
                }
            }
        }
        for look in looks::<G>() {
            given.extend(matches.get_many::<Given>(look).into_iter().flatten().copied());
        }
        Ok(Self { given, groups: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// The look that a setting belongs to; it is given by `--LOOK NAME=VALUE`.
fn look_of(parameter: &Parameter) -> Option<&'static str> {
    match parameter.needs {
        Some(("look", look)) => Some(look),
        _ => None,
    }
}

/// The option of a setting, with its shorthands.
fn options(parameter: &'static Parameter) -> Vec<Arg> {
    let heading = match parameter.group {
        Group::Picture | Group::View => "Picture",
        Group::Overlay => "Overlay",
        Group::Volume => "Voxels",
        Group::Light => "Light",
        Group::Cones | Group::Look(_) => "Cones",
    };
    let names = [parameter.name].into_iter().chain(parameter.shorthands.iter().map(|(n, _)| *n));
    let names: Vec<&str> = names.collect();
    let others = |name: &str| names.iter().copied().filter(|n| *n != name).collect::<Vec<_>>();
    let argument = |name: &'static str| {
        Arg::new(name)
            .long(name.replace('_', "-"))
            .help_heading(heading)
            .conflicts_with_all(others(name))
            // Options of octrees and cascades are only in the long help.
            .hide_short_help(parameter.needs.is_some())
    };
    let is_flag = parameter.kind == Kind::Switch && !is_on_by_default(parameter);
    let mut option = argument(parameter.name)
        .help(short_help(parameter))
        .value_name(value_name(parameter))
        .value_parser(value_parser(parameter));
    option = if is_flag {
        option.num_args(0..=1).require_equals(true).default_missing_value("on")
    } else {
        option.num_args(1).allow_hyphen_values(value_parser(parameter).possible_values().is_none())
    };
    if !parameter.help.is_empty() {
        option = option.long_help(format!("{}\n\n{}", short_help(parameter), parameter.help));
    }
    let shorthands = parameter.shorthands.iter().map(|(name, value)| {
        let same = parameter.name.replace('_', "-");
        argument(name)
            .action(ArgAction::SetTrue)
            .help(format!("The same as --{same} {} [default: off]", rounded(*value)))
    });
    [option].into_iter().chain(shorthands).collect()
}

fn is_on_by_default(parameter: &Parameter) -> bool {
    parameter.default(PresetChoice::default()).is_on()
}

/// The option for all settings of a look.
fn look_option(look: &'static str) -> Arg {
    let short = format!(
        "A setting of the look {look}, by its name in the console; may be repeated [default: depends on the resolution]"
    );
    let more = format!(
        "`lumivox run -c 'parameters {look}'` lists them with their ranges. Only with --preset {look}."
    );
    Arg::new(look)
        .long(look)
        .help_heading("Cones")
        .value_name("NAME=VALUE")
        .action(ArgAction::Append)
        .value_parser(move |text: &str| look_setting(look, text))
        .long_help(format!("{short}\n\n{more}"))
        .help(short)
}

fn look_setting(look: &str, text: &str) -> Result<Given, String> {
    let of_look = || PARAMETERS.iter().filter(|parameter| look_of(parameter) == Some(look));
    let (name, value) = text.split_once('=').unwrap_or((text, ""));
    let Some(parameter) = of_look().find(|parameter| parameter.names().any(|known| known == name))
    else {
        let names: Vec<&str> = of_look().map(|parameter| parameter.name).collect();
        return Err(format!("it must be one of {}, with its value after =", names.join(", ")));
    };
    let value = parameter.parse(value).map_err(|error| error.to_string())?;
    Ok((parameter, value))
}

/// The summary with range, unit and the presets' values.
fn short_help(parameter: &'static Parameter) -> String {
    let mut text = parameter.summary.to_owned();
    if value_parser(parameter).possible_values().is_none() {
        let _ = write!(text, ": {}", parameter.kind.in_words());
        if !parameter.unit.is_empty() {
            let _ = write!(text, " ({})", parameter.unit);
        }
    }
    text + &defaults(parameter)
}

/// The default value, and those of presets that differ: ` [default: 6; preset high: 12]`.
fn defaults(parameter: &Parameter) -> String {
    let usual = parameter.default(PresetChoice::default());
    let mut others: Vec<(Value, Vec<&str>)> = Vec::new();
    for preset in PRESETS.iter().copied() {
        let value = parameter.default(preset);
        if value == usual {
            continue;
        }
        match others.iter_mut().find(|(other, _)| *other == value) {
            Some((_, presets)) => presets.push(preset.name()),
            None => others.push((value, vec![preset.name()])),
        }
    }
    let mut text = format!(" [default: {}", rounded(usual));
    for (value, presets) in others {
        let presets = match presets.as_slice() {
            [one] => format!("preset {one}"),
            several => format!("presets {}", several.join(" and ")),
        };
        let _ = write!(text, "; {presets}: {}", rounded(value));
    }
    text + "]"
}

/// A value to four decimals, for help texts.
fn rounded(value: Value) -> String {
    match value {
        Value::Number(number) => ((f64::from(number) * 1e4).round() / 1e4).to_string(),
        value => value.to_string().replace('_', "-"),
    }
}

fn value_name(parameter: &'static Parameter) -> String {
    match parameter.kind {
        Kind::Switch => "on|off".to_owned(),
        Kind::Choice(_) if value_parser(parameter).possible_values().is_some() => "NAME".to_owned(),
        Kind::Choice(_) => "NUMBER".to_owned(),
        Kind::Vector { .. } => "X,Y,Z".to_owned(),
        Kind::Whole { .. } | Kind::Number { .. } => {
            let number = if parameter.unit.is_empty() {
                "NUMBER".to_owned()
            } else {
                parameter.unit.to_uppercase()
            };
            let words = parameter.kind.words();
            words.into_iter().fold(number, |text, word| text + "|" + word)
        }
    }
}

fn value_parser(parameter: &'static Parameter) -> ValueParser {
    let named = |names: Vec<PossibleValue>| {
        ValueParser::new(PossibleValuesParser::new(names).try_map(|name| parameter.parse(&name)))
    };
    match parameter.kind {
        Kind::Switch => {
            named(vec![PossibleValue::new("on").help("yes"), PossibleValue::new("off").help("no")])
        }
        // A numeric choice can be out of range, too.
        Kind::Choice(choices) if choices.iter().all(|c| c.name.parse::<u32>().is_ok()) => {
            ValueParser::new(move |text: &str| number(parameter, text))
        }
        Kind::Choice(choices) => {
            let value = |name: &'static str, help: &'static str| {
                let plain = name.replace('_', "-");
                let value = PossibleValue::new(plain.clone()).help(help);
                if plain == name { value } else { value.alias(name) }
            };
            named(choices.iter().map(|choice| value(choice.name, choice.help)).collect())
        }
        Kind::Whole { .. } | Kind::Number { .. } | Kind::Vector { .. } => {
            ValueParser::new(move |text: &str| number(parameter, text))
        }
    }
}

/// Parses a number; malformed text and a number out of range give different errors.
fn number(parameter: &Parameter, text: &str) -> Result<Value, Refused> {
    let read = parameter.kind.parse(text, parameter.unit);
    if let Some(value) = read.filter(|value| parameter.kind.allows(*value)) {
        return Ok(value);
    }
    let expected = format!("expected {}", parameter.kind.in_words());
    let is_number = |text: &str| text.trim().parse::<f64>().is_ok();
    let has_form = read.is_some()
        || match parameter.kind {
            Kind::Whole { .. } => is_number(text) && !text.contains(['.', 'e', 'E']),
            Kind::Vector { .. } => text.split(',').count() == 3 && text.split(',').all(is_number),
            _ => is_number(text),
        };
    Err(if has_form { Refused::OutOfRange(expected) } else { Refused::Malformed(expected) })
}

#[cfg(test)]
mod tests {
    use clap::{CommandFactory, Parser};
    use lumivox_explorer::parameters::find_parameter;

    use super::*;

    #[derive(Parser)]
    struct Line {
        #[command(flatten)]
        picture: SettingArgs<PictureGroups>,
        #[command(flatten)]
        volume: SettingArgs<VolumeGroups>,
        #[command(flatten)]
        light: SettingArgs<LightGroups>,
        #[command(flatten)]
        cones: SettingArgs<ConeGroups>,
    }

    fn given(line: &str) -> Vec<(&'static str, String)> {
        let words = ["test"].into_iter().chain(line.split_whitespace());
        let line = Line::try_parse_from(words).unwrap();
        let all =
            [line.picture.given(), line.volume.given(), line.light.given(), line.cones.given()];
        all.concat().into_iter().map(|(row, value)| (row.name, value.to_string())).collect()
    }

    #[test]
    fn every_setting_has_a_command_line_option() {
        for parameter in PARAMETERS.iter() {
            let value = parameter.default(PresetChoice::default());
            let line = match look_of(parameter) {
                Some(look) => format!("--{look}={}={value}", parameter.name),
                None => format!("--{}={value}", parameter.name.replace('_', "-")),
            };
            assert_eq!(given(&line), [(parameter.name, value.to_string())], "{line}");
        }
        assert!(given("").is_empty());
    }

    #[test]
    fn switches_and_shorthands_need_no_value() {
        assert_eq!(given("--show-grid"), [("show_grid", "on".to_owned())]);
        assert_eq!(given("--show-grid=off"), [("show_grid", "off".to_owned())]);
        assert_eq!(given("--jitter off"), [("jitter", "off".to_owned())]);
        assert_eq!(given("--half"), [("trace_resolution", "half".to_owned())]);
        assert_eq!(given("--no-specular"), [("specular", "off".to_owned())]);
        assert_eq!(given("--isotropic"), [("directionality", "isotropic".to_owned())]);
        assert!(Line::try_parse_from(["test", "--half", "--full"]).is_err());
    }

    #[test]
    fn help_shows_the_values_that_presets_set() {
        let command = Line::command();
        let help = |id: &str| {
            let argument = command.get_arguments().find(|a| a.get_id() == id).unwrap();
            argument.get_help().unwrap().to_string()
        };
        let cones = "[default: 9; preset high: 12; preset report: 6]";
        assert!(help("cones").ends_with(cones), "{}", help("cones"));
        let clearance = "a number from 0.1 to 1, or 0 (ratio) [default: 0.3333; presets fast and realtime: 0.5; \
                         presets high and report: 0]";
        assert!(help("clearance").ends_with(clearance), "{}", help("clearance"));
        assert!(help("frames").ends_with("[default: 16]"), "{}", help("frames"));
    }

    #[test]
    fn out_of_range_and_malformed_numbers_are_distinguished() {
        let refused = |name, text| number(find_parameter(name).unwrap(), text).unwrap_err();
        for (name, text) in
            [("frames", "-1"), ("exposure", "nan"), ("resolution", "130"), ("grid_offset", "0,1,0")]
        {
            assert!(matches!(refused(name, text), Refused::OutOfRange(_)), "{name} {text}");
        }
        for (name, text) in [
            ("frames", "1.5"),
            ("exposure", "bright"),
            ("grid_offset", "0,0"),
            ("volume_memory", "2 G"),
        ] {
            assert!(matches!(refused(name, text), Refused::Malformed(_)), "{name} {text}");
        }
    }
}
