//! Light, cones, the look: VXCT's switches and numbers.
//!
//! Its numbers belong only to the look `vxct`. Switches that mean something in the physical look,
//! too, do that there.

use lumivox_render::parameters::Parameter;
use lumivox_render::{Look, RenderSettings, ShadowMethod, View, VxctSettings};

use crate::arguments::{on_or_off, toggled};
use crate::command::Run::Now;
use crate::command::{Command, Group, PLAIN, Takes};
use crate::{Console, Failure, Reply};

const LOOK: Command = Command {
    group: Group::Look,
    usage: "[on|off]",
    count: (0, 1),
    takes: &[Takes::Switch],
    ..PLAIN
};

/// A switch of the look `vxct`.
macro_rules! switch {
    ($name:literal, $aliases:expr, $summary:literal, $($field:ident).+) => {
        Command {
            name: $name,
            aliases: &$aliases,
            summary: $summary,
            details: "Of the look vxct. Without a value it toggles, and prints what it is.",
            example: concat!($name, " on"),
            vxct: Some(""),
            run: Now(|console, arguments| {
                vxct_switch(console, arguments, $name, |settings| &mut settings.$($field).+)
            }),
            ..LOOK
        }
    };
}

/// A number of the look `vxct`.
macro_rules! number {
    ($name:literal, $aliases:expr, $summary:literal, $details:literal, $example:literal, $vxct:literal) => {
        Command {
            name: $name,
            aliases: &$aliases,
            usage: "[NUMBER]",
            takes: &[Takes::Anything],
            summary: $summary,
            details: concat!($details, " Of the look vxct. Prints it without a value."),
            example: $example,
            vxct: Some($vxct),
            run: Now(|console, arguments| super::parameters::run(console, $name, arguments)),
            ..LOOK
        }
    };
}

/// A component of light by itself.
macro_rules! only {
    ($name:literal, $summary:literal, $details:literal, $view:expr, $on:expr) => {
        Command {
            name: $name,
            usage: "",
            count: (0, 0),
            takes: &[],
            summary: $summary,
            details: concat!("Look vxct: it sets the switches phong, vox_diffuse, vox_specular and vox_shadows. ", $details),
            example: $name,
            vxct: Some("in the physical look a view"),
            run: Now(|console, _| only(console, $view, $on)),
            ..LOOK
        }
    };
}
pub const TABLE: &[Command] = &[
    Command {
        name: "phong",
        summary: "Show direct light, or leave it out",
        details: "Look vxct: Phong's terms altogether. Physical look: off shows the view `indirect`, on `final`. Without a value \
                  it toggles, and prints what it is.",
        example: "phong off",
        vxct: Some("in the physical look a choice of views"),
        run: Now(phong),
        ..LOOK
    },
    switch!("phong_ambient", [], "Add Phong's ambient term, or leave it out", phong_ambient),
    switch!("phong_diffuse", [], "Add Phong's diffuse term, or leave it out", phong_diffuse),
    switch!("phong_specular", [], "Add Phong's highlights, or leave them out", phong_specular),
    switch!("front_cone", [], "Trace the diffuse cone along the normal, or not", front_cone),
    switch!("side_cones", [], "Trace the four diffuse cones along the surface, or not", side_cones),
    switch!(
        "intermediate_cones",
        [],
        "Trace the four diffuse cones half-way between normal and sides, or not",
        intermediate_cones
    ),
    Command {
        name: "vox_diffuse",
        aliases: &["vdiff"],
        summary: "Add diffuse indirect light, or leave it out",
        details: "Physical look: off sets `bounces` to 0, which ends glossy reflections as well; on brings the former number \
                  back. Without a value it toggles, and prints what it is.",
        example: "vdiff off",
        vxct: Some("in the physical look it sets `bounces`"),
        run: Now(diffuse),
        ..LOOK
    },
    Command {
        name: "vox_specular",
        aliases: &["vspec"],
        summary: "Add glossy reflections, or leave them out",
        details: "Physical look: the setting `specular`. Without a value it toggles, and prints what it is.",
        example: "vspec off",
        vxct: Some("in the physical look it sets `specular`"),
        run: Now(specular),
        ..LOOK
    },
    Command {
        name: "vox_shadows",
        aliases: &["vshad"],
        summary: "Trace shadows through the voxels, or not",
        details: "Look vxct: off is without shadows. Physical look: on is `shadows cone`, off `shadows map`. Without a value it \
                  toggles, and prints what it is.",
        example: "vshad on",
        vxct: Some("in the physical look there are always shadows, by cones or by maps"),
        run: Now(shadows),
        ..LOOK
    },
    number!(
        "diffuse_offset",
        ["do"],
        "Set where diffuse cones start",
        "Along the cone, 0 to 4, in half edges of the scene.",
        "do 0.19",
        ""
    ),
    number!(
        "specular_offset",
        ["so"],
        "Set where specular cones start",
        "Along the cone, 0 to 4, in half edges of the scene.",
        "so 0.15",
        ""
    ),
    number!(
        "occlusion_offset",
        ["oo"],
        "Set where shadow cones start",
        "Along the cone, 0 to 4, in half edges of the scene.",
        "oo 0.08",
        ""
    ),
    number!(
        "diffuse_origin_offset",
        ["doo"],
        "Set how far above the surface diffuse cones begin",
        "Along the normal, 0 to 1, in half edges of the scene.",
        "doo 0.05",
        "prints it, too; VXCT's only sets it"
    ),
    number!(
        "diffuse_dist_factor",
        ["ddf"],
        "Set the step of diffuse cones",
        "As a share of the cone's diameter, 0.001 to 4.",
        "ddf 0.1",
        ""
    ),
    number!(
        "occlusion_dist_factor",
        ["odf"],
        "Set the step of shadow cones",
        "As a share of the cone's diameter, 0.001 to 4. Finer steps are darker: opacity is not corrected for them.",
        "odf 0.35",
        "VXCT's documentation calls it `ddf` by mistake"
    ),
    number!(
        "specular_dist_factor",
        ["sdf"],
        "Set the step of specular cones",
        "As a share of the cone's diameter, 0.001 to 4. Finer steps are darker: opacity is not corrected for them.",
        "sdf 0.3",
        "VXCT's documentation calls it `ddf` by mistake"
    ),
    number!(
        "diffuse_aperture",
        ["da"],
        "Set the angle of diffuse cones",
        "The whole angle in radians, 0.001 to 2.",
        "da 0.55",
        ""
    ),
    number!(
        "occlusion_aperture",
        ["oa"],
        "Set the angle of shadow cones",
        "The whole angle in radians, 0.001 to 2.",
        "oa 0.4",
        ""
    ),
    number!(
        "specular_aperture",
        ["sa"],
        "Set the angle of specular cones",
        "The whole angle in radians, 0.001 to 2.",
        "sa 0.02",
        ""
    ),
    number!(
        "shadow_str",
        ["ss"],
        "Set how fast what is in the way of light becomes a full shadow",
        "From 0, no shadows, to 16.",
        "ss 1.5",
        ""
    ),
    number!(
        "shininess_falloff",
        [],
        "Set how fast reflections fade where a light stands off the mirrored direction",
        "From 0, not at all, to 16. `sf NUMBER` is the same.",
        "shininess_falloff 3",
        "`sf` is a name of its own here: alone it renders a frame"
    ),
    only!("all", "Show all light", "Physical look: the view `final`.", View::Final, [true; 4]),
    only!(
        "phong_only",
        "Show direct light alone",
        "Physical look: the view `direct`.",
        View::Direct,
        [true, false, false, false]
    ),
    only!(
        "shadows_only",
        "Show shadows alone",
        "Physical look: the view `shadow`.",
        View::Shadow,
        [false, false, false, true]
    ),
    only!(
        "specular_only",
        "Show glossy reflections alone",
        "Physical look: the view `specular`.",
        View::Specular,
        [false, false, true, false]
    ),
    only!(
        "diffuse_only",
        "Show diffuse indirect light alone",
        "Physical look: the view `diffuse`.",
        View::Diffuse,
        [false, true, false, false]
    ),
];

/// Refuses commands that the physical look does not have.
///
/// # Errors
/// When the look is not VXCT's.
pub fn check(settings: &RenderSettings, name: &str) -> Result<(), Failure> {
    match settings.look {
        Look::Vxct(_) => Ok(()),
        Look::Physical => Err(Failure::input(format!(
            "{name} belongs to the look vxct, and the look is physical; `preset vxct` takes it with its settings"
        ))),
    }
}

fn vxct_of(settings: &mut RenderSettings) -> Option<&mut VxctSettings> {
    if let Look::Vxct(vxct) = &mut settings.look { Some(vxct) } else { None }
}

fn vxct_switch(
    console: &mut Console,
    arguments: &[&str],
    name: &str,
    field: fn(&mut VxctSettings) -> &mut bool,
) -> anyhow::Result<Reply> {
    let mut settings = console.explorer.settings().clone();
    check(&settings, name)?;
    let Some(vxct) = vxct_of(&mut settings) else { return Ok(Reply::default()) };
    let is_on = toggled(arguments, name, *field(vxct))?;
    *field(vxct) = is_on;
    console.change(|now| *now = settings)?;
    Ok(Reply::say(format!("{name} {}", on_or_off(is_on))))
}

fn is_vxct(console: &Console) -> bool {
    matches!(console.explorer.settings().look, Look::Vxct(_))
}

fn phong(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if is_vxct(console) {
        return vxct_switch(console, arguments, "phong", |settings| &mut settings.phong);
    }
    let was_on = super::view::base(console) != View::Indirect;
    let is_on = toggled(arguments, "phong", was_on)?;
    super::view::show(console, if is_on { View::Final } else { View::Indirect })?;
    Ok(Reply::say(format!("phong {}", on_or_off(is_on))))
}

fn diffuse(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if is_vxct(console) {
        return vxct_switch(console, arguments, "vox_diffuse", |settings| &mut settings.diffuse);
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
    if is_vxct(console) {
        return vxct_switch(console, arguments, "vox_specular", |settings| &mut settings.specular);
    }
    let is_on = toggled(arguments, "vox_specular", console.explorer.settings().trace.specular)?;
    console.change(|settings| settings.trace.specular = is_on)?;
    Ok(Reply::say(format!("vox_specular {}", on_or_off(is_on))))
}

fn shadows(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if is_vxct(console) {
        return vxct_switch(console, arguments, "vox_shadows", |settings| &mut settings.shadows);
    }
    let was_on = console.explorer.settings().shadows == ShadowMethod::Cone;
    let is_on = toggled(arguments, "vox_shadows", was_on)?;
    let shadows = if is_on { ShadowMethod::Cone } else { ShadowMethod::Map };
    console.change(|settings| settings.shadows = shadows)?;
    let how = if is_on { "cone" } else { "map" };
    Ok(Reply::say(format!("vox_shadows {}: shadows {how}", on_or_off(is_on))))
}

/// `shininess_falloff [NUMBER]`
pub fn shininess_falloff(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    super::parameters::run(console, "shininess_falloff", arguments)
}

/// Shows a part of light. `on` is the new state of VXCT's switches: phong, diffuse, specular,
/// shadows.
fn only(console: &mut Console, view: View, on: [bool; 4]) -> anyhow::Result<Reply> {
    if !is_vxct(console) {
        super::view::show(console, view)?;
        return Ok(Reply::default());
    }
    console.change(|settings| {
        if let Some(vxct) = vxct_of(settings) {
            [vxct.phong, vxct.diffuse, vxct.specular, vxct.shadows] = on;
        }
    })?;
    super::view::show(console, View::Final)?;
    Ok(Reply::default())
}

/// Whether a setting belongs only to VXCT's look.
pub fn is_of_vxct(parameter: &Parameter) -> bool {
    parameter.group == lumivox_render::parameters::Group::Vxct && parameter.name != "look"
}
