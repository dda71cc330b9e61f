//! Commands for the content of the picture: surfaces, voxels, wires.

use lumivox_explorer::parameters::{Value, find_parameter};
use lumivox_render::{Overlay, View, Wireframe};

use crate::arguments::{on_or_off, toggled};
use crate::command::Run::Now;
use crate::command::{Command, Group, PLAIN, Takes};
use crate::{Console, Reply};

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
        summary: "Show or hide the objects' surfaces",
        details: "Without surfaces, only overlays are seen, on a plain background. Without a value it \
                  toggles, and prints the new state.",
        example: "objs off",
        run: Now(|console, arguments| {
            flip_objects(console, arguments, "objs", |now| &mut now.surfaces)
        }),
        ..VIEW
    },
    Command {
        name: "objsW",
        aliases: &["objsw"],
        summary: "Show the objects as wires instead of surfaces, or as surfaces again",
        details: "Draws all edges of all triangles. Without a value it toggles, and prints the new state.",
        example: "objsW on",
        run: Now(|console, arguments| {
            flip_objects(console, arguments, "objsW", |now| &mut now.wires)
        }),
        ..VIEW
    },
    Command {
        name: "overlayW",
        aliases: &["overlayw"],
        summary: "Draw or hide the edges of triangles over the shaded surfaces",
        details: "Hidden edges are left out; `wireframe through` shows those, too. Without a value it toggles, and prints \
                  the new state.",
        example: "overlayW on",
        run: Now(|console, arguments| {
            flip_objects(console, arguments, "overlayW", |now| &mut now.overlay)
        }),
        ..VIEW
    },
    Command {
        name: "voxs",
        summary: "Show the voxels as cubes, or what was shown before",
        details: "`lod` sets their level. It is the view `voxels`, or `wire-voxels` while `voxsW` is on. Without a value it \
                  toggles, and prints the new state.",
        example: "voxs on",
        run: Now(|console, arguments| flip_view(console, arguments, "voxs", |now| &mut now.voxels)),
        ..VIEW
    },
    Command {
        name: "voxsW",
        aliases: &["voxsw"],
        summary: "Choose whether `voxs` shows wire cubes or solid ones",
        details: "While `voxs` is on it changes the picture. `wire_voxels over` draws wire cubes over surfaces. Without a value \
                  it toggles, and prints the new state.",
        example: "voxsW on",
        run: Now(|console, arguments| flip_view(console, arguments, "voxsW", |now| &mut now.wires)),
        ..VIEW
    },
    Command {
        name: "loclod",
        summary: "Show the light of the voxels of a level on the surfaces, or what was shown before",
        details: "`lod` sets the level. It is the view `lod`, which overrides `iLight`; that keeps its state. Without a value it \
                  toggles, and prints the new state.",
        example: "loclod on",
        run: Now(|console, arguments| flip_view(console, arguments, "loclod", |now| &mut now.lod)),
        ..VIEW
    },
    Command {
        name: "lod",
        usage: "[LEVEL]",
        takes: &[Takes::Anything],
        summary: "Set the level of the shown voxels, or print it",
        details: "0 is the finest. It is the setting `level`.",
        example: "lod 2",
        run: Now(|console, arguments| super::parameters::run(console, "level", arguments)),
        ..VIEW
    },
    Command {
        name: "iLight",
        aliases: &["ilight"],
        summary: "Show all light, or only direct light",
        details: "Physical look: off is the view `direct`, on `final`. Without a value it toggles, and prints the new state.",
        example: "iLight off",
        run: Now(indirect),
        ..VIEW
    },
    Command {
        name: "views",
        usage: "",
        count: (0, 0),
        takes: &[],
        summary: "List the values of the setting `view`",
        example: "views",
        run: Now(|_, _| {
            let kind = find_parameter("view").map(|parameter| parameter.kind.in_words());
            Ok(Reply::say(format!("view is {}", kind.unwrap_or_default())))
        }),
        ..VIEW
    },
];

/// The states of VXCT's independent switches of voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// The view when no switch is on.
    base: View,
    /// State of `voxs`.
    voxels: bool,
    /// State of `voxsW`.
    wires: bool,
    /// State of `loclod`.
    lod: bool,
}

impl Shown {
    /// The states that match a view; `before` are the states after the last flip.
    fn of(view: View, before: Self) -> Self {
        match view {
            _ if before.view() == view => before,
            View::Voxels => Self { voxels: true, wires: false, ..before },
            View::WireVoxels => Self { voxels: true, wires: true, ..before },
            View::Lod => Self { voxels: false, lod: true, ..before },
            base => Self { base, voxels: false, lod: false, ..before },
        }
    }

    fn view(self) -> View {
        match self {
            Self { voxels: true, wires: true, .. } => View::WireVoxels,
            Self { voxels: true, .. } => View::Voxels,
            Self { lod: true, .. } => View::Lod,
            Self { base, .. } => base,
        }
    }
}

/// Sets or toggles one of the switches.
fn flip_view(
    console: &mut Console,
    arguments: &[&str],
    name: &str,
    switch: fn(&mut Shown) -> &mut bool,
) -> anyhow::Result<Reply> {
    let mut shown = Shown::of(console.explorer.settings().view, console.shown);
    let is_on = toggled(arguments, name, *switch(&mut shown))?;
    *switch(&mut shown) = is_on;
    console.change(|settings| settings.view = shown.view())?;
    console.shown = shown;
    Ok(Reply::say(format!("{name} {}", on_or_off(is_on))))
}

/// Sets the view that is shown while `voxs` and `loclod` are off.
pub fn show(console: &mut Console, view: View) -> anyhow::Result<()> {
    let shown = Shown { base: view, ..Shown::of(console.explorer.settings().view, console.shown) };
    console.change(|settings| settings.view = shown.view())?;
    console.shown = shown;
    Ok(())
}

/// The view when no switch is on.
pub fn base(console: &Console) -> View {
    Shown::of(console.explorer.settings().view, console.shown).base
}

/// The states of VXCT's switches of objects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Objects {
    /// State of `objs`.
    surfaces: bool,
    /// State of `objsW`.
    wires: bool,
    /// State of `overlayW`.
    overlay: bool,
}

impl Default for Objects {
    fn default() -> Self {
        Self { surfaces: true, wires: false, overlay: false }
    }
}

impl Objects {
    fn set(self, overlay: &mut Overlay) {
        overlay.hides_surfaces = !self.surfaces || self.wires;
        overlay.wireframe = match self {
            Self { surfaces: true, wires: true, .. } => Wireframe::Through,
            Self { overlay: true, .. } => Wireframe::Over,
            _ => Wireframe::Off,
        };
    }
}

/// Sets or toggles one of the switches. If the overlay has changed since the last flip, the states
/// are derived from it.
fn flip_objects(
    console: &mut Console,
    arguments: &[&str],
    name: &str,
    switch: fn(&mut Objects) -> &mut bool,
) -> anyhow::Result<Reply> {
    let now = &console.explorer.settings().overlay;
    let mut made = Overlay::default();
    console.objects.set(&mut made);
    let is_known = (made.hides_surfaces, made.wireframe) == (now.hides_surfaces, now.wireframe);
    let mut objects = if is_known {
        console.objects
    } else {
        let wires = now.hides_surfaces && now.wireframe == Wireframe::Through;
        Objects {
            surfaces: !now.hides_surfaces || wires,
            wires,
            overlay: !wires && now.wireframe != Wireframe::Off,
        }
    };
    let is_on = toggled(arguments, name, *switch(&mut objects))?;
    *switch(&mut objects) = is_on;
    console.change(|settings| objects.set(&mut settings.overlay))?;
    console.objects = objects;
    Ok(Reply::say(format!("{name} {}", on_or_off(is_on))))
}

fn indirect(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let of_look = super::look::of_look(console, "indirect_light");
    let was_on = match of_look {
        Some(parameter) => parameter.get(console.explorer.settings()).is_on(),
        None => base(console) != View::Direct,
    };
    let is_on = toggled(arguments, "iLight", was_on)?;
    if let Some(parameter) = of_look {
        console.change(|settings| {
            let _ = parameter.set(settings, Value::Switch(is_on));
        })?;
    } else if is_on != was_on {
        show(console, if is_on { View::Final } else { View::Direct })?;
    }
    Ok(Reply::say(format!("iLight {}", on_or_off(is_on))))
}
