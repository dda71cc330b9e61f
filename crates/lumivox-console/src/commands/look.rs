//! Commands that show components of light: a setting of the look if it has one of that name, else
//! views and settings of the physical look.

use lumivox_explorer::parameters::{Parameter, Value, find_parameter};
use lumivox_render::{RenderSettings, ShadowMethod, View};

use crate::arguments::{on_or_off, toggled};
use crate::command::Run::Now;
use crate::command::{Command, Group, PLAIN, Takes};
use crate::{Console, Reply};

const LOOK: Command = Command {
    group: Group::Look,
    usage: "[on|off]",
    count: (0, 1),
    takes: &[Takes::Switch],
    ..PLAIN
};

/// A command that shows one component of light.
macro_rules! only {
    ($name:literal, $summary:literal, $details:literal, $view:expr, $on:expr) => {
        Command {
            name: $name,
            usage: "",
            count: (0, 0),
            takes: &[],
            summary: $summary,
            details: concat!(
                "Other looks: sets their switches phong, vox_diffuse, vox_specular and vox_shadows. ",
                $details
            ),
            example: $name,
            run: Now(|console, _| only(console, $view, $on)),
            ..LOOK
        }
    };
}
pub const TABLE: &[Command] = &[
    Command {
        name: "phong",
        summary: "Show direct light, or leave it out",
        details: "Physical look: off shows the view `indirect`, on `final`. Without a value \
                  it toggles, and prints the new state.",
        example: "phong off",
        run: Now(phong),
        ..LOOK
    },
    Command {
        name: "vox_diffuse",
        aliases: &["vdiff"],
        summary: "Add diffuse indirect light, or leave it out",
        details: "Physical look: off sets `bounces` to 0, which ends glossy reflections as well; on brings the former number \
                  back. Without a value it toggles, and prints the new state.",
        example: "vdiff off",
        run: Now(diffuse),
        ..LOOK
    },
    Command {
        name: "vox_specular",
        aliases: &["vspec"],
        summary: "Add glossy reflections, or leave them out",
        details: "Physical look: the setting `specular`. Without a value it toggles, and prints the new state.",
        example: "vspec off",
        run: Now(specular),
        ..LOOK
    },
    Command {
        name: "vox_shadows",
        aliases: &["vshad"],
        summary: "Trace shadows through the voxels, or not",
        details: "Physical look: on is `shadows cone`, off `shadows map`. Without a value it \
                  toggles, and prints the new state.",
        example: "vshad on",
        run: Now(shadows),
        ..LOOK
    },
    only!("all", "Show all light", "Physical look: the view `final`.", View::Final, [true; 4]),
    only!(
        "phong_only",
        "Show only direct light",
        "Physical look: the view `direct`.",
        View::Direct,
        [true, false, false, false]
    ),
    only!(
        "shadows_only",
        "Show only shadows",
        "Physical look: the view `shadow`.",
        View::Shadow,
        [false, false, false, true]
    ),
    only!(
        "specular_only",
        "Show only glossy reflections",
        "Physical look: the view `specular`.",
        View::Specular,
        [false, false, true, false]
    ),
    only!(
        "diffuse_only",
        "Show only diffuse indirect light",
        "Physical look: the view `diffuse`.",
        View::Diffuse,
        [false, true, false, false]
    ),
];

/// The setting of the look that has this name, if the look in use has it.
pub fn of_look(console: &Console, name: &str) -> Option<&'static Parameter> {
    let settings = console.explorer.settings();
    find_parameter(name).filter(|parameter| parameter.means_something(settings))
}

fn phong(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if of_look(console, "phong").is_some() {
        return super::parameters::run(console, "phong", arguments);
    }
    let was_on = super::view::base(console) != View::Indirect;
    let is_on = toggled(arguments, "phong", was_on)?;
    super::view::show(console, if is_on { View::Final } else { View::Indirect })?;
    Ok(Reply::say(format!("phong {}", on_or_off(is_on))))
}

fn diffuse(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if of_look(console, "vox_diffuse").is_some() {
        return super::parameters::run(console, "vox_diffuse", arguments);
    }
    let now = console.explorer.settings().bounces;
    let is_on = toggled(arguments, "vox_diffuse", now > 0)?;
    let bounces = match (is_on, now) {
        (false, _) => 0,
        (true, 0) => console.bounces.unwrap_or(RenderSettings::default().bounces),
        (true, now) => now,
    };
    console.change(|settings| settings.bounces = bounces)?;
    if now > 0 {
        console.bounces = Some(now);
    }
    Ok(Reply::say(format!("vox_diffuse {}: bounces {bounces}", on_or_off(is_on))))
}

fn specular(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if of_look(console, "vox_specular").is_some() {
        return super::parameters::run(console, "vox_specular", arguments);
    }
    let is_on = toggled(arguments, "vox_specular", console.explorer.settings().trace.specular)?;
    console.change(|settings| settings.trace.specular = is_on)?;
    Ok(Reply::say(format!("vox_specular {}", on_or_off(is_on))))
}

fn shadows(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if of_look(console, "vox_shadows").is_some() {
        return super::parameters::run(console, "vox_shadows", arguments);
    }
    let was_on = console.explorer.settings().shadows == ShadowMethod::Cone;
    let is_on = toggled(arguments, "vox_shadows", was_on)?;
    let shadows = if is_on { ShadowMethod::Cone } else { ShadowMethod::Map };
    console.change(|settings| settings.shadows = shadows)?;
    let how = if is_on { "cone" } else { "map" };
    Ok(Reply::say(format!("vox_shadows {}: shadows {how}", on_or_off(is_on))))
}

/// A look's switches of the components of light.
const SWITCHES: [&str; 4] = ["phong", "vox_diffuse", "vox_specular", "vox_shadows"];

/// Shows one component of light. `on` are the new states of [`SWITCHES`].
fn only(console: &mut Console, view: View, on: [bool; 4]) -> anyhow::Result<Reply> {
    let [Some(phong), Some(diffuse), Some(specular), Some(shadows)] =
        SWITCHES.map(|name| of_look(console, name))
    else {
        super::view::show(console, view)?;
        return Ok(Reply::default());
    };
    console.change(|settings| {
        for (switch, is_on) in [phong, diffuse, specular, shadows].into_iter().zip(on) {
            let _ = switch.set(settings, Value::Switch(is_on));
        }
    })?;
    super::view::show(console, View::Final)?;
    Ok(Reply::default())
}
