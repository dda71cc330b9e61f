use std::sync::Arc;

use clap::{Arg, ArgAction, Command as Definition, CommandFactory, Parser as _};
use glam::{UVec2, Vec3};
use lumivox::{Directionality, VolumeKind};
use lumivox_classics::photons::photons;
use lumivox_classics::raster::Raster;
use lumivox_classics::report::ReportCones;
use lumivox_render::{
    Exposure, Overlay, RenderSettings, ShadowMethod, ToneMap, View, Wireframe, Wires,
};
use lumivox_vxct::VxctSettings;

use super::*;
use crate::Exit;
use crate::settings::expose_for_look;

fn commands() -> Vec<Definition> {
    let mut root = Cli::command();
    root.build();
    let commands: Vec<Definition> = root.get_subcommands().cloned().collect();
    commands.into_iter().filter(|command| command.get_name() != "help").chain([root]).collect()
}

fn settings(args: &RenderArgs) -> RenderSettings {
    args.settings().unwrap()
}

/// The arguments without `--help`, `--version` and `--verbose`.
fn arguments(command: &Definition) -> impl Iterator<Item = &Arg> {
    command
        .get_arguments()
        .filter(|argument| !matches!(argument.get_id().as_str(), "help" | "version" | "verbose"))
}

#[test]
fn the_definition_is_sound() {
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

/// Values out of range have one exit code, even negative ones, which look like options.
#[test]
fn numbers_out_of_range_are_bad_input_everywhere() {
    // Built once: that takes longer than to parse a line.
    let mut root = Cli::command();
    root.build();
    let mut told = |command: &Definition, option: &str, value: &str| {
        let words = ["lumivox", command.get_name(), option, value];
        // clap checks values before it looks for missing arguments.
        let error = root.try_get_matches_from_mut(words).err()?;
        let is_of_value = matches!(
            error.kind(),
            clap::error::ErrorKind::ValueValidation
                | clap::error::ErrorKind::InvalidValue
                | clap::error::ErrorKind::UnknownArgument
        );
        is_of_value.then(|| exit::of_clap(&error))
    };
    let (mut numbers, mut wrong) = (0, Vec::new());
    for command in commands() {
        for argument in arguments(&command).filter(|a| a.get_action().takes_values()) {
            let Some(option) = argument.get_long().map(|long| format!("--{long}")) else {
                continue;
            };
            let is_number = told(&command, &option, "8") != Some(Exit::Usage)
                && told(&command, &option, "x") == Some(Exit::Usage);
            if !is_number {
                continue;
            }
            numbers += 1;
            for value in ["-99999999999999999999", "99999999999999999999"] {
                if told(&command, &option, value) == Some(Exit::Usage) {
                    wrong.push(format!("{} {option} {value}", command.get_name()));
                }
            }
        }
    }
    assert!(numbers > 100, "{numbers}");
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn the_exit_codes_are_told() {
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

#[test]
fn no_argument_gives_the_renderers_defaults() {
    let line = ["lumivox", "render", "builtin:cornell", "-o", "a.png"];
    let Some(Command::Render(args)) = Cli::try_parse_from(line).unwrap().command else {
        panic!("a render command")
    };
    assert_eq!(settings(&args), RenderSettings::default());
}

#[test]
fn arguments_reach_the_settings() {
    let line = "lumivox render a.glb -o a.png --size 8x9 --resolution 64 --grid-offset 0,0.5,0 \
                --isotropic --voxelizer three-plane --volume octree --volume-memory 1GiB --bounces 2 \
                --frames 3 --view voxels --level 2 --exposure -1.5 --tone-map aces --shadows cone \
                --shadow-resolution 64 --injection photons --preset fast --wireframe over \
                --wire-voxels through --show-grid --hide-surfaces";
    let Some(Command::Render(args)) = Cli::try_parse_from(line.split_whitespace()).unwrap().command
    else {
        panic!("a render command")
    };
    let expected = RenderSettings {
        size: UVec2::new(8, 9),
        resolution: 64,
        grid_offset: Vec3::new(0.0, 0.5, 0.0),
        directionality: Directionality::Isotropic,
        voxelizer: Some(Arc::new(Raster::ThreePlane)),
        volume: VolumeKind::Octree,
        volume_memory: Some(1 << 30),
        trace: lumivox::TraceSettings::preset(lumivox::Preset::Fast),
        bounces: 2,
        frames: 3,
        view: View::Voxels,
        voxel_level: 2,
        overlay: Overlay {
            wireframe: Wireframe::Over,
            wire_voxels: Wires::Through,
            hides_surfaces: true,
            grid_box: true,
            lines: Vec::new(),
        },
        exposure: Exposure::Stops(-1.5),
        tone_map: ToneMap::Aces,
        shadows: ShadowMethod::Cone,
        shadow_resolution: 64,
        injection: Some(photons()),
        ..RenderSettings::default()
    };
    assert_eq!(settings(&args), expected);
}

#[test]
fn a_preset_brings_its_companions_unless_told_otherwise() {
    let settings_of = |options: &str| {
        let line = format!("lumivox render a.glb -o a.png --preset report {options}");
        let parsed = Cli::try_parse_from(line.split_whitespace()).unwrap().command;
        let Some(Command::Render(args)) = parsed else { panic!("a render command") };
        settings(&args)
    };
    let report = RenderSettings {
        directionality: Directionality::Isotropic,
        volume: VolumeKind::Octree,
        injection: Some(photons()),
        trace: ReportCones::trace_settings(),
        cone_model: ReportCones::REPORT.model(),
        bounces: 1,
        ..RenderSettings::default()
    };
    assert_eq!(settings_of(""), report);
    let explicit = RenderSettings {
        directionality: Directionality::SixLobes,
        volume: VolumeKind::Dense,
        injection: None,
        bounces: 3,
        ..report
    };
    assert_eq!(settings_of("--six-lobes --volume dense --injection direct --bounces 3"), explicit);
}

#[test]
fn the_look_of_vxct_brings_its_companions() {
    let args_of = |options: &str| {
        let line = format!("lumivox render a.glb -o a.png --preset vxct {options}");
        let parsed = Cli::try_parse_from(line.split_whitespace()).unwrap().command;
        let Some(Command::Render(args)) = parsed else { panic!("a render command") };
        args
    };
    let look = RenderSettings {
        look: Some(Arc::new(VxctSettings::for_resolution(256))),
        resolution: 256,
        directionality: Directionality::Isotropic,
        bounces: 1,
        exposure: Exposure::Stops(0.0),
        tone_map: ToneMap::Raw,
        ..RenderSettings::default()
    };
    assert_eq!(settings(&args_of("--resolution 256")), look);
    let told = "--resolution 256 --six-lobes --bounces 3 --exposure auto --tone-map aces";
    let explicit = RenderSettings {
        directionality: Directionality::SixLobes,
        bounces: 3,
        exposure: Exposure::Auto,
        tone_map: ToneMap::Aces,
        ..look.clone()
    };
    assert_eq!(settings(&args_of(told)), explicit);

    // For a scene in physical units the look chooses exposure and curve, unless they are given.
    let scene = lumivox_scene::builtin::scene("cornell").unwrap();
    let shown = |options: &str, scene: &lumivox_scene::Scene| {
        let args = args_of(options);
        let mut settings = settings(&args);
        expose_for_look(&mut settings, &args.given(), scene);
        (settings.exposure, settings.tone_map)
    };
    let display = lumivox_vxct::vxct_display(&scene);
    assert_ne!(display.exposure, Exposure::Stops(0.0));
    assert_eq!(shown("", &scene), (display.exposure, ToneMap::Linear));
    assert_eq!(
        shown("--exposure 1 --tone-map aces", &scene),
        (Exposure::Stops(1.0), ToneMap::Aces)
    );
    let mut display_values = scene.clone();
    display_values.lights[0].attenuation = Some(lumivox_scene::Attenuation::default());
    assert_eq!(shown("", &display_values), (Exposure::Stops(0.0), ToneMap::Raw));
}

#[test]
fn the_ends_of_the_ranges_are_the_renderers() {
    let limits = wgpu::Limits::default();
    let valid = |option: &str, value: &str| {
        let line = ["lumivox", "render", "a.glb", "-o", "a.png", option, value];
        let parsed = Cli::try_parse_from(line).ok()?.command?;
        let Command::Render(args) = parsed else { return None };
        Some(settings(&args).validate(&limits).is_ok())
    };
    for (option, low, high) in [
        ("--bounces", "0", "64"),
        ("--frames", "1", "65536"),
        ("--exposure", "-64", "64"),
        ("--shadow-resolution", "16", "8192"),
    ] {
        assert_eq!(valid(option, low), Some(true), "{option} {low}");
        assert_eq!(valid(option, high), Some(true), "{option} {high}");
    }
    for (option, value) in [
        ("--bounces", "65"),
        ("--frames", "0"),
        ("--frames", "65537"),
        ("--exposure", "65"),
        ("--shadow-resolution", "15"),
    ] {
        assert_eq!(valid(option, value), None, "{option} {value}");
    }
    // The parser accepts these; the check against the GPU's limits does not.
    assert_eq!(valid("--shadow-resolution", "16384"), Some(false));
    assert_eq!(valid("--size", "16384x1"), Some(false));
}
