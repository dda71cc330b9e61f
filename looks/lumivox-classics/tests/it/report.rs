//! The report's cones against Lumivox's own, and their radiance against its definition.

#![allow(clippy::float_cmp)] // Equal to the bit is the claim.

use std::sync::Arc;

use glam::{Vec3, Vec4};

use lumivox::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Recorder, Timing, storage_buffer, upload,
};
use lumivox::hooks::ConeModel;
use lumivox::{Gi, GiConfig, Grid, Light, LightSource, Shadow, TraceSettings};
use lumivox_classics::report::ReportCones;

use crate::testing::{SceneBuilder, device, lambert, read};

/// The radiance of a room's faces, with the values of the model and then with other values. A lamp
/// lights the room, not an emissive surface: Lumivox samples emitters, a model's cones find them.
fn radiance(cones: Option<Arc<dyn ConeModel>>, others: Option<ReportCones>) -> Vec<[f32; 4]> {
    let (device, queue) = device();
    let (low, high) = (Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9));
    let grid = Grid::fit(low, high, 32, Vec3::ZERO).expect("the grid fits");
    let config = GiConfig { cones, ..GiConfig::new(grid) };
    let mut gi = Gi::with_pipelines(&device, &queue, config).expect("the device is large enough");
    let room = SceneBuilder::default().room(low, high, &lambert(0.5, 0.0));
    let plate = lambert(0.8, 0.0);
    let scene = room.quad(Vec3::splat(0.3), 0.3 * Vec3::X, Vec3::new(0.0, 0.2, 0.3), plate);
    let geometry = scene.build(&device);
    pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let source = LightSource::Point {
        position: Vec3::new(0.6, 0.5, 0.4),
        intensity: Vec3::ONE,
        radius_m: 0.0,
        range_m: None,
    };
    let lamp = Light { source, shadow: Shadow::Cone };
    let lights = gi.bind_lights(&[lamp], Vec3::ZERO, None);
    let mut recorder = Recorder::new(&device, &queue);
    gi.light(&mut recorder, &lights, 3, &TraceSettings::default()).expect("valid settings");
    if let Some(cones) = others {
        gi.set_cone_values(cones.values());
        gi.light(&mut recorder, &lights, 3, &TraceSettings::default()).expect("valid settings");
    }
    recorder.submit();
    let count = gi.voxels().expect("there are voxels").face_count as usize;
    read(&device, &queue, gi.face_radiance().expect("there is light"), count)
}

/// Cones that march, and show all light of their samples.
#[derive(Debug)]
struct Plain;

impl ConeModel for Plain {
    fn name(&self) -> &'static str {
        "plain"
    }

    fn module(&self) -> &'static str {
        "
import package::cones::start::clear_of_walls;
fn place_in_cell(drawn: vec2f, cell: u32, cell_count: u32, values: vec4f) -> vec2f { return drawn; }
fn glossy_half_vector(drawn: vec3f, values: vec4f) -> vec3f { return drawn; }
fn start_of_cones(above: vec3f, normal: vec3f, level: u32, values: vec4f) -> vec3f {
    return clear_of_walls(above, normal, level);
}
fn shown_share(taken: f32, transmittance: f32, level: u32, width: f32, values: vec4f) -> f32 {
    return taken;
}"
    }
}

#[test]
fn neutral_report_cones_equal_plain_cones_bit_exactly() {
    assert!(ReportCones::default().model().is_none());
    let neutral: Arc<dyn ConeModel> = Arc::new(ReportCones::default());
    assert!(radiance(Some(neutral), None) == radiance(Some(Arc::new(Plain)), None));
}

#[test]
fn changed_report_values_match_a_fresh_model() {
    let report = radiance(ReportCones::REPORT.model(), None);
    let neutral: Arc<dyn ConeModel> = Arc::new(ReportCones::default());
    assert!(radiance(Some(neutral), Some(ReportCones::REPORT)) == report);
    let plain = radiance(Some(Arc::new(Plain)), None);
    assert!(report != plain);
    let measures = [
        ReportCones { jitter: false, ..ReportCones::default() },
        ReportCones { clear_of_walls: false, ..ReportCones::default() },
        ReportCones { width_attenuation: 1.0, ..ReportCones::default() },
        ReportCones { level_gain: 8.0, ..ReportCones::default() },
    ];
    for cones in measures {
        assert!(cones.model() != ReportCones::REPORT.model());
        assert!(radiance(cones.model(), None) != plain, "{cones:?} does nothing");
    }
}

const SHARES_WGSL: &str = "
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::cones::model::shown_share;
@group(0) @binding(0) var<storage, read> samples: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> shares: array<f32>;
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&shares) { return; }
    let sample = samples[id.x];
    shares[id.x] =
        shown_share(sample.x, sample.y, u32(sample.z), sample.w, vec4f(VALUES));
}";

/// The level amplifies a share, up to the remaining one; the width dims it; a surplus is returned
/// without gain.
#[test]
fn shares_are_amplified_by_level_and_dimmed_by_width() {
    let cones = ReportCones { width_attenuation: 0.5, level_gain: 4.0, ..ReportCones::default() };
    let [x, y, z, w] = cones.values();
    let mut shaders = lumivox::shaders::library_with_volume(
        lumivox::VolumeKind::Dense,
        lumivox::Directionality::SixLobes,
    );
    let source = SHARES_WGSL.replace("VALUES", &format!("{x:?}, {y:?}, {z:?}, {w:?}"));
    shaders.add("cones::model", cones.module()).add("test::shares", source);

    let mut samples = Vec::new();
    for taken in [-0.1_f32, 0.0, 0.001, 0.03, 0.4, 1.0] {
        for left in [0.02, 0.5, 1.0] {
            for level in [0.0, 1.0, 4.0] {
                samples
                    .extend([0.0, 0.3, 1.9, 2.5].map(|width| Vec4::new(taken, left, level, width)));
            }
        }
    }
    let (device, queue) = device();
    let layout = LayoutBuilder::compute().storage().storage_mut().build(&device, "shares");
    let kernel = Kernel::new(&device, &shaders, "test::shares", "main", &[&layout]).expect("links");
    let input = upload(&device, "samples", &samples);
    let output = storage_buffer(&device, "shares", samples.len() as u64 * 4);
    let group =
        BindGroupBuilder::new(&layout).buffer(&input).buffer(&output).build(&device, "shares");
    let mut recorder = Recorder::new(&device, &queue);
    kernel.run_linear(&mut recorder, &[&group], samples.len() as u64);
    recorder.submit();
    let shares: Vec<f32> = read(&device, &queue, &output, samples.len());
    for (sample, share) in samples.iter().zip(shares) {
        let [taken, left, level, width] = sample.to_array();
        let gained = (taken * 4.0_f32.powf(level)).min(left.max(taken));
        let shown = if taken > 0.0 { gained } else { taken };
        let expected = shown * (1.0 - 0.5 * width).max(0.0);
        assert!((share - expected).abs() < 1e-5, "{sample}: {share}, not {expected}");
    }
}
