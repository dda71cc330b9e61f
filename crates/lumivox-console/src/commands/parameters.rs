//! Commands for settings.

use lumivox_explorer::parameters::{
    GROUPS, Kind, PARAMETERS, PRESETS, Parameter, Value, find_parameter, find_preset,
};
use lumivox_render::RenderSettings;

use crate::arguments::{choice, in_words, on_or_off, refused, toggled};
use crate::command::Run::Now;
use crate::command::{Command, Group, PLAIN, Takes};
use crate::report::Table;
use crate::{COMMANDS, Console, Failure, Reply, suggest};

pub const TABLE: &[Command] = &[
    Command {
        name: "parameters",
        group: Group::Program,
        usage: "[GROUP]",
        count: (0, 1),
        takes: &[Takes::Word(&GROUP_NAMES)],
        summary: "List the settings with their values and ranges",
        details: "Each setting is a command, too: without a value it prints the setting, with one it sets it; switches of a look toggle \
                  without one.",
        example: "parameters cones",
        run: Now(list),
        ..PLAIN
    },
    Command {
        name: "reset",
        group: Group::Program,
        usage: "[SETTING|all]",
        count: (0, 1),
        takes: &[Takes::Parameter],
        summary: "Reset a setting, or all of them, to the preset's value",
        details: "Without an argument it lists the settings that differ from the preset. The size of the picture stays.",
        example: "reset bounces",
        run: Now(reset),
        ..PLAIN
    },
    Command {
        name: "preset",
        group: Group::Look,
        usage: "[NAME]",
        count: (0, 1),
        takes: &[Takes::Word(&PRESET_NAMES)],
        summary: "Take the settings of a preset, or print its name",
        details: "As `--preset` on the command line; picture, view and resolution stay.",
        example: "preset high",
        run: Now(preset),
        ..PLAIN
    },
];

const GROUP_NAMES: [&str; GROUPS.len()] = {
    let mut names = [""; GROUPS.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = GROUPS[index].name();
        index += 1;
    }
    names
};

const PRESET_NAMES: [&str; PRESETS.len()] = {
    let mut names = [""; PRESETS.len()];
    let mut index = 0;
    while index < names.len() {
        names[index] = PRESETS[index].name();
        index += 1;
    }
    names
};

/// `SETTING [VALUE]`: prints or sets a setting.
pub fn run(console: &mut Console, name: &str, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some(parameter) = find_parameter(name) else { return Err(unknown(name).into()) };
    let settings = console.explorer.settings();
    let name = parameter.name;
    let look = parameter.needs.and_then(|(needed, look)| (needed == "look").then_some(look));
    if let Some(look) = look.filter(|_| !parameter.means_something(settings)) {
        return Err(Failure::input(format!(
            "{name} is a setting of the look {look}, but the look is physical; `preset {look}` sets that look and its settings"
        ))
        .into());
    }
    match arguments {
        // A look's switches toggle, and print the new state.
        [] | [_] if look.is_some() && parameter.kind == Kind::Switch => {
            let is_on = toggled(arguments, name, parameter.get(settings).is_on())?;
            console.change(|settings| {
                let _ = parameter.set(settings, Value::Switch(is_on));
            })?;
            Ok(Reply::say(format!("{name} {}", on_or_off(is_on))))
        }
        [] => Ok(Reply::say(format!("{name} {}", parameter.get(settings)))),
        words => {
            // Vectors may also be separated by blanks.
            let text = words.join(",");
            let value = parameter.parse(&text).map_err(|error| {
                let like = suggest::like(&text, parameter.kind.words());
                let like = like.map(|like| format!("; did you mean \"{like}\"?"));
                Failure::input(format!("{error}{}", like.unwrap_or_default()))
            })?;
            console.change(|settings| {
                let _ = parameter.set(settings, value);
            })?;
            Ok(Reply::default())
        }
    }
}

/// The settings of the present preset, or else the defaults.
pub fn of_preset(console: &Console) -> RenderSettings {
    of_preset_at(console, console.explorer.settings().resolution)
}

/// As [`of_preset`], with the cones for `resolution`; the setting `resolution` has its default.
fn of_preset_at(console: &Console, resolution: u32) -> RenderSettings {
    let preset = console.explorer.preset();
    let defaults = RenderSettings { resolution, ..RenderSettings::default() };
    let scene = console.explorer.scene();
    let settings = defaults.with_preset(preset, scene);
    RenderSettings { resolution: RenderSettings::default().resolution, ..settings }
}

/// The settings that have an effect and whose values differ.
pub fn differing<'a>(
    settings: &'a RenderSettings,
    from: &'a RenderSettings,
) -> impl Iterator<Item = &'static Parameter> + 'a {
    PARAMETERS.iter().filter(|parameter| {
        parameter.means_something(settings) && parameter.get(settings) != parameter.get(from)
    })
}

fn unknown(name: &str) -> Failure {
    let commands = COMMANDS.iter().flat_map(Command::names);
    let known = commands.chain(PARAMETERS.iter().flat_map(Parameter::names));
    let remedy = suggest::remedy(name, known, "help");
    Failure::input(format!("there is no command \"{name}\"{remedy}"))
}

/// The command `parameters [GROUP]`.
fn list(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let group =
        arguments.first().map(|name| choice(name, "the group", &GROUP_NAMES)).transpose()?;
    let mut table = Table::left(&["setting", "value", "is"]);
    for parameter in PARAMETERS.iter() {
        if group.is_none_or(|group| group == parameter.group.name()) {
            let value = parameter.get(console.explorer.settings()).to_string();
            let unit = if parameter.unit.is_empty() {
                String::new()
            } else {
                format!(" ({})", parameter.unit)
            };
            table.row([parameter.name.to_owned(), value, parameter.kind.in_words() + &unit]);
        }
    }
    Ok(Reply::say(table.text().trim_end()))
}

/// The command `reset [SETTING|all]`.
fn reset(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let preset = of_preset(console);
    match arguments {
        [] => {
            let settings = console.explorer.settings();
            let differs = differing(settings, &preset);
            let lines: Vec<String> = differs
                .map(|p| format!("{} {} (preset: {})", p.name, p.get(settings), p.get(&preset)))
                .collect();
            let name = console.explorer.preset().name();
            Ok(Reply::say(match lines.as_slice() {
                [] => format!("all settings are those of the preset {name}"),
                _ => lines.join("\n"),
            }))
        }
        ["all"] => {
            // The resolution is reset as well, and with it the cones of a look.
            let preset = of_preset_at(console, RenderSettings::default().resolution);
            console.change(|settings| set_all(settings, &preset))?;
            Ok(Reply::default())
        }
        [name, ..] => {
            let Some(parameter) = find_parameter(name) else {
                let known = PARAMETERS.iter().flat_map(Parameter::names).chain(["all"]);
                let remedy = suggest::remedy(name, known, "parameters");
                return Err(
                    Failure::input(format!("there is no setting \"{name}\"{remedy}")).into()
                );
            };
            let value = parameter.get(&preset);
            console.change(|settings| {
                if is_free(parameter, settings, &preset) {
                    let _ = parameter.set(settings, value);
                }
            })?;
            Ok(Reply::say(format!("{name} {}", parameter.get(console.explorer.settings()))))
        }
    }
}

/// `true` if copying the setting changes no other: options of an octree or a look require that
/// octree or look.
fn is_free(parameter: &Parameter, settings: &RenderSettings, from: &RenderSettings) -> bool {
    parameter.means_something(settings) && parameter.means_something(from)
}

/// Copies the volume, the look, and all settings of the table that have an effect.
fn set_all(settings: &mut RenderSettings, from: &RenderSettings) {
    (settings.volume, settings.look) = (from.volume, from.look.clone());
    for parameter in PARAMETERS.iter() {
        if is_free(parameter, settings, from) {
            let _ = parameter.set(settings, parameter.get(from));
        }
    }
}

/// The command `preset [NAME]`.
fn preset(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some(name) = arguments.first() else {
        return Ok(Reply::say(format!("preset {}", console.explorer.preset().name())));
    };
    let preset = find_preset(name);
    let Some(preset) = preset else {
        let like = suggest::remedy(name, PRESET_NAMES, "help preset");
        let known = in_words(&PRESET_NAMES);
        return Err(Failure::input(format!("a preset is {known}; got \"{name}\"{like}")).into());
    };
    console.set(console.explorer.settings_of(preset), preset)?;
    Ok(Reply::default())
}

/// The command `size [WIDTHxHEIGHT]`.
pub fn size(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some(text) = arguments.first() else {
        let size = console.explorer.settings().size;
        return Ok(Reply::say(format!("size {}x{}", size.x, size.y)));
    };
    let size = crate::values::size::size(text).map_err(refused("size", text))?;
    console.change(|settings| settings.size = size)?;
    Ok(Reply::default())
}
