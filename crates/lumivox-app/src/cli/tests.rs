use std::sync::Arc;

use clap::Parser as _;
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
use crate::settings::expose_for_look;

fn settings(args: &RenderArgs) -> RenderSettings {
    args.settings().unwrap()
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
fn the_report_preset_sets_related_settings_unless_overridden() {
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
fn the_vxct_preset_sets_related_settings_unless_overridden() {
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

    // In physical units, the look sets exposure and curve unless they are given.
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
fn option_ranges_match_those_of_the_renderer() {
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
    // The parser accepts these; the check against the GPU's limits rejects them.
    assert_eq!(valid("--shadow-resolution", "16384"), Some(false));
    assert_eq!(valid("--size", "16384x1"), Some(false));
}
