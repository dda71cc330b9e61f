//! What is shown: surfaces, voxels, wires.

use lumivox_render::parameters::Parameter;
use lumivox_render::{Components, Look, View, Wireframe};

use crate::console::arguments::{on_or_off, toggled};
use crate::console::command::{Command, Group, PLAIN, Takes};
use crate::console::{Console, Reply};

const VIEW: Command = Command {
    group: Group::View,
    usage: "[on|off]",
    count: (0, 1),
    takes: &[Takes::Switch],
    ..PLAIN
};

pub const TABLE: &[Command] = &[
    Command {
        name: "objs",
        summary: "Show the objects' surfaces, or leave them out",
        details: "Left out, a plain background stands in for the picture, and overlays are seen alone. On also ends `objsW`. \
                  Without a value it toggles, and prints what it is.",
        example: "objs off",
        vxct: Some(""),
        run: surfaces,
        ..VIEW
    },
    Command {
        name: "objsW",
        aliases: &["objsw"],
        summary: "Show the objects as wires instead of surfaces, or as surfaces again",
        details: "All edges of all triangles. Without a value it toggles, and prints what it is.",
        example: "objsW on",
        vxct: Some(""),
        run: wires,
        ..VIEW
    },
    Command {
        name: "overlayW",
        aliases: &["overlayw"],
        summary: "Draw the edges of triangles over the shaded surfaces, or no more",
        details: "Hidden edges are left out; `wireframe through` shows those, too. Without a value it toggles, and prints what \
                  it is.",
        example: "overlayW on",
        vxct: Some(""),
        run: |console, arguments| {
            let was_on = console.explorer.settings().overlay.wireframe == Wireframe::Over;
            let is_on = toggled(arguments, "overlayW", was_on)?;
            console.change(|settings| {
                settings.overlay.wireframe = if is_on { Wireframe::Over } else { Wireframe::Off };
            })?;
            Ok(Reply::say(format!("overlayW {}", on_or_off(is_on))))
        },
        ..VIEW
    },
    Command {
        name: "voxs",
        summary: "Show the voxels as cubes, or what was shown before",
        details: "Of the level that `lod` sets. The view `voxels`. Without a value it toggles, and prints what it is.",
        example: "voxs on",
        vxct: Some(""),
        run: |console, arguments| view(console, arguments, "voxs", View::Voxels),
        ..VIEW
    },
    Command {
        name: "voxsW",
        aliases: &["voxsw"],
        summary: "Show the voxels as wire cubes, or what was shown before",
        details: "Of the level that `lod` sets. The view `wire-voxels`; `wire_voxels over` draws them over surfaces. Without a \
                  value it toggles, and prints what it is.",
        example: "voxsW on",
        vxct: Some(""),
        run: |console, arguments| view(console, arguments, "voxsW", View::WireVoxels),
        ..VIEW
    },
    Command {
        name: "loclod",
        summary: "Show what the voxels of a level hold on the surfaces, or what was shown before",
        details: "Of the level that `lod` sets. The view `lod`; it overrides `iLight`. Without a value it toggles, and prints \
                  what it is.",
        example: "loclod on",
        vxct: Some(""),
        run: |console, arguments| view(console, arguments, "loclod", View::Lod),
        ..VIEW
    },
    Command {
        name: "lod",
        usage: "[LEVEL]",
        takes: &[Takes::Anything],
        summary: "Set the level of the voxels that are shown, or print it",
        details: "0 is the finest; the setting `level`.",
        example: "lod 2",
        vxct: Some("levels beyond the last are errors"),
        run: |console, arguments| super::parameters::run(console, "level", arguments),
        ..VIEW
    },
    Command {
        name: "iLight",
        aliases: &["ilight"],
        summary: "Show indirect light, or direct light alone",
        details: "Physical look: off is the view `direct`, on `final`. Look vxct: off shows Phong's terms alone. Without a value \
                  it toggles, and prints what it is.",
        example: "iLight off",
        vxct: Some(""),
        run: indirect,
        ..VIEW
    },
    Command {
        name: "views",
        usage: "",
        count: (0, 0),
        takes: &[],
        summary: "List what the setting `view` can show",
        example: "views",
        run: |_, _| {
            let kind = Parameter::find("view").map(|parameter| parameter.kind.in_words());
            Ok(Reply::say(format!("view is {}", kind.unwrap_or_default())))
        },
        ..VIEW
    },
];

fn surfaces(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let is_on = toggled(arguments, "objs", !console.explorer.settings().overlay.hides_surfaces)?;
    console.change(|settings| {
        let overlay = &mut settings.overlay;
        if is_on && overlay.hides_surfaces && overlay.wireframe == Wireframe::Through {
            overlay.wireframe = Wireframe::Off;
        }
        overlay.hides_surfaces = !is_on;
    })?;
    Ok(Reply::say(format!("objs {}", on_or_off(is_on))))
}

fn wires(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let overlay = &console.explorer.settings().overlay;
    let was_on = overlay.hides_surfaces && overlay.wireframe == Wireframe::Through;
    let is_on = toggled(arguments, "objsW", was_on)?;
    if is_on != was_on {
        console.change(|settings| {
            settings.overlay.hides_surfaces = is_on;
            settings.overlay.wireframe = if is_on { Wireframe::Through } else { Wireframe::Off };
        })?;
    }
    Ok(Reply::say(format!("objsW {}", on_or_off(is_on))))
}

/// Shows a view, or what was shown before.
fn view(
    console: &mut Console,
    arguments: &[&str],
    name: &str,
    view: View,
) -> anyhow::Result<Reply> {
    let now = console.explorer.settings().view;
    let is_on = toggled(arguments, name, now == view)?;
    if is_on != (now == view) {
        let before = console.view.unwrap_or_default();
        console.change(|settings| settings.view = if is_on { view } else { before })?;
        let is_special = matches!(now, View::Voxels | View::WireVoxels | View::Lod);
        if is_on && !is_special {
            console.view = Some(now);
        }
    }
    Ok(Reply::say(format!("{name} {}", on_or_off(is_on))))
}

fn indirect(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let settings = console.explorer.settings();
    let was_on = match &settings.look {
        Look::Vxct(vxct) => vxct.components != Components::Phong,
        Look::Physical => settings.view != View::Direct,
    };
    let is_on = toggled(arguments, "iLight", was_on)?;
    if is_on != was_on {
        let (view, components) =
            if is_on { (View::Final, Components::All) } else { (View::Direct, Components::Phong) };
        super::look::only(console, view, components)?;
    }
    Ok(Reply::say(format!("iLight {}", on_or_off(is_on))))
}
