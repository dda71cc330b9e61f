//! Tests that sampled directions have the returned density, and that `scatter` is the BRDF.

use bytemuck::{Pod, Zeroable};
use glam::{DVec3, UVec2, Vec3};
use lumivox::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Recorder, read_buffer, storage_buffer, upload,
};
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, VolumeKind};
use lumivox_scene::EnvironmentMap;

use super::brdf::{Lobes, at_cosine};
use super::*;
use crate::picture::tone_map::luminance;
use crate::reference::upload::layout;

const DRAWS: u32 = 1 << 16;

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Case {
    toward: [f32; 3],
    alpha: f32,
    geometric: [f32; 3],
    coat_alpha: f32,
    diffuse: f32,
    f0: f32,
    phong_exponent: f32,
    coat_strength: f32,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Drawn {
    direction: [f32; 3],
    density: f32,
    value: [f32; 3],
    padding: f32,
}

/// A surface, the cosine at which it is seen, and the angle between its geometric and shading
/// normals.
struct Seen {
    what: &'static str,
    lobes: Lobes,
    cosine: f64,
    tilt_rad: f64,
}

impl Seen {
    fn geometric(&self) -> DVec3 {
        DVec3::new(-self.tilt_rad.sin(), 0.0, self.tilt_rad.cos())
    }

    fn is_above(&self, direction: DVec3) -> bool {
        direction.z > 0.0 && direction.dot(self.geometric()) > 0.0
    }

    /// The alpha of the narrowest lobe.
    fn least_alpha(&self) -> f64 {
        let coat = if self.lobes.coat_strength > 0.0 { self.lobes.coat_alpha } else { 1.0 };
        let gloss = if self.lobes.f0 > 0.0 { self.lobes.alpha } else { 1.0 };
        coat.min(gloss)
    }
}

fn surfaces() -> Vec<Seen> {
    let seen = |what, lobes, cosine| Seen { what, lobes, cosine, tilt_rad: 0.0 };
    let diffuse = Lobes { diffuse: 0.7, ..Lobes::default() };
    let metal = |alpha| Lobes { f0: 0.9, alpha, ..Lobes::default() };
    let phong = |exponent| Lobes { f0: 0.5, phong_exponent: exponent, ..Lobes::default() };
    let plastic = Lobes { f0: 0.04, alpha: 0.1, ..diffuse };
    let varnished = Lobes { coat_strength: 1.0, coat_alpha: 0.05, alpha: 0.6, f0: 0.3, ..diffuse };
    vec![
        seen("diffuse", diffuse, 0.5),
        seen("a mirror", metal(0.001), 0.7),
        seen("smooth metal", metal(0.04), 0.8),
        seen("metal", metal(0.25), 0.6),
        seen("rough metal", metal(1.0), 0.9),
        seen("metal, grazing", metal(0.25), 0.06),
        seen("rough metal, grazing", metal(0.8), 0.02),
        seen("wide Phong", phong(3.0), 0.5),
        seen("narrow Phong", phong(200.0), 0.7),
        seen("Phong, grazing", phong(20.0), 0.1),
        seen("Phong over diffuse", Lobes { diffuse: 0.4, ..phong(40.0) }, 0.4),
        seen("plastic", plastic, 0.7),
        seen("plastic, grazing", plastic, 0.2),
        seen("varnish", varnished, 0.5),
        seen("half varnish", Lobes { coat_strength: 0.5, ..varnished }, 0.4),
        Seen { what: "bent normal", lobes: plastic, cosine: 0.4, tilt_rad: 0.6 },
        Seen { what: "bent metal", lobes: metal(0.5), cosine: 0.3, tilt_rad: 0.4 },
    ]
}

fn draw(surfaces: &[Seen]) -> Vec<Drawn> {
    let gpu = gpu();
    let mut shaders = crate::shaders::library(&library_with_volume(
        VolumeKind::default(),
        Directionality::default(),
    ));
    shaders.add("render::reference::sampling_test", include_str!("sampling.wgsl"));
    let layout = LayoutBuilder::compute().storage().storage_mut().build(&gpu.pipelines, "sampling");
    let module = "render::reference::sampling_test";
    let kernel =
        Kernel::new(&gpu.pipelines, &shaders, module, "main", &[&layout]).expect("a shader");
    let case = |seen: &Seen| Case {
        toward: at_cosine(seen.cosine).as_vec3().to_array(),
        alpha: seen.lobes.alpha as f32,
        geometric: seen.geometric().as_vec3().to_array(),
        coat_alpha: seen.lobes.coat_alpha as f32,
        diffuse: seen.lobes.diffuse as f32,
        f0: seen.lobes.f0 as f32,
        phong_exponent: seen.lobes.phong_exponent as f32,
        coat_strength: seen.lobes.coat_strength as f32,
    };
    let cases: Vec<Case> = surfaces.iter().map(case).collect();
    let cases = upload(&gpu.device, "cases", &cases);
    let bytes = surfaces.len() as u64 * u64::from(DRAWS) * size_of::<Drawn>() as u64;
    let drawn = storage_buffer(&gpu.device, "drawn", bytes);
    let group =
        BindGroupBuilder::new(&layout).buffer(&cases).buffer(&drawn).build(&gpu.device, "draw");
    let mut recorder = Recorder::new(&gpu.device, &gpu.queue);
    kernel.run(&mut recorder, &[&group], [DRAWS, surfaces.len() as u32, 1]);
    recorder.submit();
    pollster::block_on(read_buffer(&gpu.device, &gpu.queue, &drawn, 0..bytes)).expect("directions")
}

/// Cells of equal solid angle over the hemisphere; one more is for all directions below the
/// surface.
const ROWS: usize = 24;
const COLUMNS: usize = 24;
/// Points along each edge of a cell at which the density is evaluated.
const FINE: usize = 24;

fn cell(direction: DVec3) -> usize {
    let row = ((direction.z * ROWS as f64) as usize).min(ROWS - 1);
    let turn = direction.y.atan2(direction.x) / std::f64::consts::TAU + 0.5;
    row * COLUMNS + ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1)
}

/// The expected number of draws in each cell.
fn expected_counts(seen: &Seen) -> Vec<f64> {
    let view = at_cosine(seen.cosine);
    let point_sr = std::f64::consts::TAU / (ROWS * COLUMNS * FINE * FINE) as f64;
    let mut counts = vec![0.0; ROWS * COLUMNS + 1];
    for row in 0..ROWS * FINE {
        let z = (row as f64 + 0.5) / (ROWS * FINE) as f64;
        for column in 0..COLUMNS * FINE {
            let turn = (column as f64 + 0.5) / (COLUMNS * FINE) as f64 - 0.5;
            let (sine, cosine) = (turn * std::f64::consts::TAU).sin_cos();
            let flat = (1.0 - z * z).sqrt();
            let direction = DVec3::new(flat * cosine, flat * sine, z);
            if seen.is_above(direction) {
                counts[cell(direction)] +=
                    seen.lobes.density(view, direction) * point_sr * f64::from(DRAWS);
            }
        }
    }
    // All other directions are below the surface, where nothing is scattered.
    counts[ROWS * COLUMNS] = f64::from(DRAWS) - counts.iter().sum::<f64>();
    counts
}

/// Pearson's statistic in standard deviations from its mean; cells with fewer than ten draws are
/// merged.
fn chi_squared_sigmas(counts: &[f64], expected: &[f64]) -> f64 {
    let (mut statistic, mut freedom) = (0.0, -1.0);
    let (mut count, mut wanted) = (0.0, 0.0);
    let mut all: Vec<_> = counts.iter().zip(expected).collect();
    all.sort_by(|a, b| a.1.total_cmp(b.1));
    for (actual, expected) in all {
        count += actual;
        wanted += expected;
        if wanted >= 10.0 {
            statistic += (count - wanted) * (count - wanted) / wanted;
            freedom += 1.0;
            (count, wanted) = (0.0, 0.0);
        }
    }
    if freedom < 1.0 { 0.0 } else { (statistic - freedom) / f64::sqrt(2.0 * freedom) }
}

#[test]
fn sampled_directions_match_their_reported_density() {
    let surfaces = surfaces();
    let all = draw(&surfaces);
    for (seen, drawn) in surfaces.iter().zip(all.chunks_exact(DRAWS as usize)) {
        let what = seen.what;
        let view = at_cosine(seen.cosine);
        // In f32, n.h has an error of a few 2^-24, and D divides by alpha^2.
        let tolerance = 1e-3 + 1e-6 / seen.least_alpha().powi(2);
        let mut counts = vec![0.0; ROWS * COLUMNS + 1];
        let (mut sum, mut squares, mut worst) = (0.0_f64, 0.0_f64, 0.0_f64);
        for one in drawn {
            let direction = Vec3::from(one.direction).as_dvec3();
            assert!(
                (direction.length() - 1.0).abs() < 1e-5,
                "{what}: {direction} is not of length 1"
            );
            let (value, density) = (f64::from(one.value[0]), f64::from(one.density));
            if !seen.is_above(direction) {
                assert!(value <= 0.0, "{what}: {value} from below");
                counts[ROWS * COLUMNS] += 1.0;
                continue;
            }
            counts[cell(direction)] += 1.0;
            assert!(density > 0.0 && value.is_finite(), "{what}: {value} of {density}");
            sum += value / density;
            squares += (value / density).powi(2);
            // Near the horizon, the cosine is imprecise in f32.
            if direction.z > 1e-3 {
                let differs = |actual: f64, twin: f64| (actual / twin - 1.0).abs();
                worst = worst.max(differs(value, seen.lobes.value(view, direction)));
                worst = worst.max(differs(density, seen.lobes.density(view, direction)));
            }
        }
        assert!(tolerance > 0.1 || worst < tolerance, "{what}: off its twin by {worst}");
        // Cells are coarser than a mirror's lobe.
        let sigmas = if seen.least_alpha() < 0.02 {
            0.0
        } else {
            chi_squared_sigmas(&counts, &expected_counts(seen))
        };
        let below = counts[ROWS * COLUMNS] / f64::from(DRAWS);
        println!("{what}: {sigmas:+.1} sigma, {below:.4} below, off its twin by {worst:.1e}");
        // Chi squared has a longer tail than the normal distribution.
        assert!(sigmas < 5.0, "{what}: chi squared is {sigmas} sigma above its mean");
        if seen.tilt_rad <= 0.0 {
            let n = f64::from(DRAWS);
            let error = ((squares / n - (sum / n).powi(2)).max(0.0) / n).sqrt();
            let albedo = seen.lobes.albedo(seen.cosine);
            assert!(albedo <= 1.0, "{what} reflects {albedo}");
            Estimate { mean: sum / n, error }.assert_is(what, albedo);
        }
    }
}

#[test]
fn the_panorama_is_drawn_in_proportion_to_its_light() {
    let (width, height) = (16, 8);
    let mut map = EnvironmentMap { width, height, ..EnvironmentMap::default() };
    let texel = |index: u32| [1.0, 0.3, 0.0].map(|x| x * (index * 7 % 13) as f32);
    map.rgb = (0..width * height).map(texel).collect();
    // A black row, and a bright pole.
    map.rgb[48..64].fill([0.0; 3]);
    map.rgb[..16].fill([30.0; 3]);
    let mut scene = builtin("panel");
    scene.environment.map = Some(map.clone().into());
    scene.environment.radiance = Vec3::ONE;
    scene.environment.rotation_rad = 0.7;
    let size = UVec2::new(64, 32);
    let tracer = tracer(&scene, &ReferenceSettings { size, ..settings(1, 1) });

    // The kernel writes into the film, the output buffer of this layout.
    let mut shaders = crate::shaders::library(&library_with_volume(
        VolumeKind::default(),
        Directionality::default(),
    ));
    let module = "render::reference::panorama_test";
    shaders.add(module, include_str!("panorama.wgsl"));
    let (device, queue) = (&tracer.gpu.device, &tracer.gpu.queue);
    let pipelines = &tracer.gpu.pipelines;
    let kernel =
        Kernel::new(pipelines, &shaders, module, "main", &[&layout(pipelines)]).expect("a shader");
    let film = &tracer.uploaded.film;
    let draws = film.size() / size_of::<Drawn>() as u64;
    let mut recorder = Recorder::new(device, queue);
    kernel.run(&mut recorder, &[&tracer.uploaded.group], [draws as u32, 1, 1]);
    recorder.submit();
    let read = read_buffer(device, queue, film, 0..draws * size_of::<Drawn>() as u64);
    let drawn: Vec<[f32; 8]> = pollster::block_on(read).expect("directions");

    let texel_sr = |row: u32| {
        let cosine = |edge: u32| (std::f64::consts::PI * f64::from(edge) / f64::from(height)).cos();
        (cosine(row) - cosine(row + 1)) * std::f64::consts::TAU / f64::from(width)
    };
    let power = |index: u32| luminance(map.rgb[index as usize]) * texel_sr(index / width);
    let whole: f64 = (0..width * height).map(power).sum();
    let expected: Vec<f64> =
        (0..width * height).map(|index| power(index) / whole * drawn.len() as f64).collect();
    let mut counts = vec![0.0; expected.len()];
    for [x, y, z, density, r, g, b, _] in drawn.into_iter().map(|one| one.map(f64::from)) {
        // As in the renderer, the map is turned about y by the angle.
        let (sine, cosine) = f64::sin_cos(f64::from(scene.environment.rotation_rad));
        let (x, z) = (cosine * x - sine * z, sine * x + cosine * z);
        let across = 0.5 + x.atan2(-z) / std::f64::consts::TAU;
        let down = y.clamp(-1.0, 1.0).acos() / std::f64::consts::PI;
        let at = |share: f64, count: u32| ((share * f64::from(count)) as u32).min(count - 1);
        let (row, column) = (at(down, height), at(across, width));
        let index = row * width + column;
        counts[index as usize] += 1.0;
        // At a texel's edge, f64 and f32 may select different texels.
        let is_inside = |share: f64, count: u32| {
            let fraction = (share * f64::from(count)).fract();
            (1e-4..1.0 - 1e-4).contains(&fraction)
        };
        if is_inside(down, height) && is_inside(across, width) {
            let told = power(index) / whole / texel_sr(row);
            assert!((density / told - 1.0).abs() < 1e-3, "{density}, not {told}");
            let unit = f64::from(tracer.uploaded.radiance_unit);
            let seen = luminance(map.rgb[index as usize]) / unit;
            assert!((luminance([r, g, b].map(|x| x as f32)) - seen).abs() < 1e-3 * seen);
        }
    }
    let sigmas = chi_squared_sigmas(&counts, &expected);
    println!("panorama: {sigmas:+.1} sigma");
    assert!(sigmas < 5.0, "chi squared is {sigmas} sigma above its mean");
}
