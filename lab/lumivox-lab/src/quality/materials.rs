//! Errors of materials by light and angle: a ball of each material in each light, against the path
//! tracer.

use std::f32::consts::{PI, TAU};
use std::fmt::Write as _;
use std::sync::Arc;

use glam::{UVec2, Vec2, Vec3};
use lumivox_app::parts::{Kept, ProgressDisplay, check_wish};
use lumivox_render::compare::LinearPicture;
use lumivox_render::reference::{PathTracer, ReferenceProgress, ReferenceSettings};
use lumivox_render::{Gpu, RenderProgress, RenderSettings, Renderer};
use lumivox_scene::builtin::shapes;
use lumivox_scene::{
    Camera, Clearcoat, Environment, EnvironmentMap, Filter, Instance, Light, LightKind, Material,
    Mesh, MetallicRoughness, Sampler, Scene, Shading, Sheen, Texture, TextureRef, Transmission,
};
use serde::{Deserialize, Serialize};

use crate::cli::QualityArgs;

/// The edge of a picture, px.
const SIZE: u32 = 48;
const VOXELS: u32 = 64;
const FRAMES: u32 = 16;
/// The path tracer's samples of a pixel.
const SAMPLES: u32 = 256;
/// The camera's distance from the centre of the ball, whose radius is 1; and its field of view.
const DISTANCE_M: f32 = 7.2;
const FOV_RAD: f32 = 0.3;
/// Ranges of the angle between the direction to the eye and the normal, in degrees. At larger
/// angles, pixels are partly beside the ball.
const ANGLES: [[f32; 2]; 3] = [[0.0, 60.0], [60.0, 75.0], [75.0, 83.0]];

/// Errors are relative to the mean of their range of angles, but at least to this share of the
/// ball's mean.
const DARK: f64 = 0.1;

/// The errors of a material in a light, in percent of the path tracer's picture.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Cell {
    /// The error of the mean over frames in each of [`ANGLES`].
    bias: [f64; 3],
    /// The error of the first frame, mean over all angles.
    first_bias: f64,
    /// The root mean square of the first frame's difference from the mean over frames, relative to
    /// it.
    noise: f64,
}

/// A row for each material, with a cell for each light.
pub type Rows = Vec<(&'static str, Vec<Option<Cell>>)>;

fn dielectric(roughness: f32) -> MetallicRoughness {
    MetallicRoughness { base_color: Vec3::splat(0.5).extend(1.0), roughness, ..Default::default() }
}

fn metal(roughness: f32) -> MetallicRoughness {
    MetallicRoughness {
        base_color: Vec3::splat(0.9).extend(1.0),
        metallic: 1.0,
        roughness,
        ..Default::default()
    }
}

fn plain(shading: MetallicRoughness) -> Material {
    Material { shading: Shading::MetallicRoughness(shading), ..Material::default() }
}

/// A material, and its texture if it has one.
type Made = (Material, Option<Texture>);

type Make = fn() -> Made;
type Shine = fn(&mut Scene);

// No roughness below 0.2: the path tracer's noise would hide errors.
const MATERIALS: [(&str, Make); 16] = [
    ("matt", || (Material::diffuse("matt", Vec3::splat(0.5)), None)),
    ("dielectric, roughness 0.2", || (plain(dielectric(0.2)), None)),
    ("dielectric, 0.3", || (plain(dielectric(0.3)), None)),
    ("dielectric, 0.5", || (plain(dielectric(0.5)), None)),
    ("dielectric, 1", || (plain(dielectric(1.0)), None)),
    ("ior 2.4, 0.3", || (plain(MetallicRoughness { ior: 2.4, ..dielectric(0.3) }), None)),
    ("specular 0.5, 0.3", || (plain(MetallicRoughness { specular: 0.5, ..dielectric(0.3) }), None)),
    ("metal, 0.2", || (plain(metal(0.2)), None)),
    ("metal, 0.3", || (plain(metal(0.3)), None)),
    ("metal, 0.6", || (plain(metal(0.6)), None)),
    ("metal, 1", || (plain(metal(1.0)), None)),
    ("half metal, 0.4", || (plain(MetallicRoughness { metallic: 0.5, ..metal(0.4) }), None)),
    ("coat 0.2 on dielectric 0.6", || {
        let clearcoat = Clearcoat { strength: 1.0, roughness: 0.2, ..Clearcoat::default() };
        (Material { clearcoat, ..plain(dielectric(0.6)) }, None)
    }),
    ("sheen 0.5 on dielectric 1", || {
        let sheen = Sheen { color: Vec3::ONE, roughness: 0.5, ..Sheen::default() };
        (Material { sheen, ..plain(dielectric(1.0)) }, None)
    }),
    ("pane, transmission 0.8", || {
        let transmission = Transmission { factor: 0.8, ..Transmission::default() };
        (Material { transmission, double_sided: true, ..plain(dielectric(0.2)) }, None)
    }),
    ("textured roughness and metal", || {
        let metallic_roughness_texture = Some(TextureRef::new(0));
        let shading = MetallicRoughness { metallic_roughness_texture, ..metal(1.0) };
        // Green is roughness, blue is metal.
        let texels = [[0, 64, 0, 255], [0, 160, 255, 255], [0, 160, 255, 255], [0, 255, 0, 255]];
        let (name, rgba8) = ("checkers".to_owned(), texels.concat());
        let sampler = Sampler { magnify: Filter::Nearest, ..Sampler::default() };
        let texture = Texture { name, width: 2, height: 2, rgba8, sampler };
        (plain(shading), Some(texture))
    }),
];

const LIGHTS: [(&str, Shine); 8] =
    [
        ("even sky", |scene| scene.environment.radiance = Vec3::ONE),
        ("gradient", |scene| {
            // Bright above, dark below.
            scene.environment = surroundings(|direction| 1.0 + 0.8 * direction.y);
        }),
        ("panorama with a sun", |scene| {
            let sun = Vec3::new(0.5, 0.7, 0.5).normalize();
            scene.environment = surroundings(|direction| {
                if direction.dot(sun) > 0.999 { 2000.0 } else { 0.5 + 0.3 * direction.y }
            });
        }),
        ("sun", |scene| {
            let direction = -Vec3::new(0.5, 0.7, 0.5).normalize();
            let sun = Light::typical(LightKind::Directional);
            scene.lights.push(Light { intensity: 3.0, direction, ..sun });
        }),
        ("point lamp", |scene| {
            let (intensity, position) = (30.0, Vec3::new(1.5, 2.0, 3.0));
            scene.lights.push(Light { intensity, position, radius_m: 0.1, ..Light::default() });
        }),
        ("panel", |scene| {
            glow(scene, Vec3::new(0.0, 2.5, 1.0), [Vec3::X, Vec3::new(0.0, 0.6, -0.8)], 3.0);
        }),
        ("tube", |scene| {
            glow(
                scene,
                Vec3::new(1.5, 1.5, 1.5),
                [Vec3::X * 1.5, Vec3::new(0.0, 0.014, -0.014)],
                100.0,
            );
        }),
        ("lit room", |scene| {
            let white = add(scene, Material::diffuse("room", Vec3::splat(0.73)));
            let half = Vec3::new(2.5, 2.5, 8.0);
            place(scene, shapes::interior(-half, half), white);
            glow(scene, Vec3::new(0.0, 2.45, 1.0), [Vec3::X, Vec3::NEG_Z], 3.0);
        }),
    ];

/// Surroundings with this radiance in each direction.
fn surroundings(radiance: impl Fn(Vec3) -> f32) -> Environment {
    let (width, height) = (256_u32, 128_u32);
    let texel = |index: u32| {
        let polar = PI * ((index / width) as f32 + 0.5) / height as f32;
        let turn = TAU * ((index % width) as f32 + 0.5) / width as f32;
        let (sine, y) = polar.sin_cos();
        [radiance(Vec3::new(-sine * turn.sin(), y, sine * turn.cos())); 3]
    };
    let rgb = (0..width * height).map(texel).collect();
    let map = EnvironmentMap { name: "made".to_owned(), width, height, rgb, warnings: Vec::new() };
    Environment { radiance: Vec3::ONE, map: Some(Arc::new(map)), ..Environment::default() }
}

fn add(scene: &mut Scene, material: Material) -> usize {
    scene.materials.push(material);
    scene.materials.len() - 1
}

fn place(scene: &mut Scene, mesh: Mesh, material: usize) {
    scene.meshes.push(mesh);
    let mesh = scene.meshes.len() - 1;
    scene.instances.push(Instance { mesh, material, ..Instance::default() });
}

/// A rectangle that emits light towards `v` cross `u`: downwards for x and -z.
fn glow(scene: &mut Scene, center: Vec3, [u, v]: [Vec3; 2], radiance: f32) {
    let mut black = Material::diffuse("lamp", Vec3::ZERO);
    black.emissive = Vec3::splat(radiance);
    let black = add(scene, black);
    place(scene, shapes::quad(center, v, u), black);
}

fn scene((material, texture): Made, light: Shine) -> Scene {
    let mut scene = Scene::default();
    scene.textures.extend(texture);
    let material = add(&mut scene, material);
    place(&mut scene, shapes::sphere(1.0, 128), material);
    light(&mut scene);
    scene.cameras.push(Camera::look_at(Vec3::Z * DISTANCE_M, Vec3::ZERO, FOV_RAD));
    scene
}

/// The sine of the angle between the eye's direction and the ball's normal in each pixel; above 1
/// beside the ball.
fn sines() -> Vec<f32> {
    let scale = (0.5 * FOV_RAD).tan() / (0.5 * SIZE as f32);
    let at = |index: u32| (index as f32 + 0.5 - 0.5 * SIZE as f32) * scale;
    let pixel = |index: u32| {
        let (x, y) = (at(index % SIZE), at(index / SIZE));
        let across = Vec2::new(x, y).length();
        DISTANCE_M * across / (1.0 + across * across).sqrt()
    };
    (0..SIZE * SIZE).map(pixel).collect()
}

/// The mean over the pixels of a range of angles, in degrees.
fn mean(picture: &[[f32; 3]], sines: &[f32], [low, high]: [f32; 2]) -> f64 {
    let range = low.to_radians().sin()..high.to_radians().sin();
    let seen = picture.iter().zip(sines).filter(|(_, sine)| range.contains(sine));
    let (count, sum) = seen.fold((0_u32, 0.0), |(count, sum), (rgb, _)| {
        (count + 1, sum + f64::from(rgb.iter().sum::<f32>() / 3.0))
    });
    sum / f64::from(count.max(1))
}

fn measure_cell(
    gpu: &Gpu,
    progress: &ProgressDisplay,
    made: Made,
    light: Shine,
) -> anyhow::Result<Cell> {
    let mut scene = scene(made, light);
    scene.validate()?;
    let size = UVec2::splat(SIZE);
    let camera = Some(&scene.cameras[0]);
    let settings = ReferenceSettings { size, samples: SAMPLES, ..ReferenceSettings::default() };
    let mut tracer = pollster::block_on(PathTracer::new(gpu, &scene, camera, settings))?;
    pollster::block_on(tracer.render(&mut |_: ReferenceProgress| progress.goes_on()))?;
    check_wish(progress)?;
    let layers = tracer.layers();
    let truth: LinearPicture = layers.layer(&layers.radiance);
    let settings =
        RenderSettings { size, frames: FRAMES, resolution: VOXELS, ..RenderSettings::default() };
    let mut tell = |_: RenderProgress| {};
    let mut renderer = pollster::block_on(Renderer::new(gpu, &scene, camera, settings, &mut tell))?;
    let mut pictures = Vec::new();
    for frame in 1..=FRAMES {
        pollster::block_on(renderer.render_frame())?;
        if frame == 1 || frame == FRAMES {
            let mean = pollster::block_on(renderer.read_mean())?;
            pictures.push(mean.iter().map(|&[r, g, b, _]| [r, g, b]).collect::<Vec<_>>());
        }
    }
    let sines = sines();
    let whole = [ANGLES[0][0], ANGLES[2][1]];
    let truth_of = |range| mean(&truth.rgb, &sines, range);
    let least = (DARK * truth_of(whole)).max(1e-9);
    let off = |ours: &[[f32; 3]], range: [f32; 2]| {
        let truth = truth_of(range);
        100.0 * (mean(ours, &sines, range) - truth) / truth.max(least)
    };
    let inside = whole[1].to_radians().sin();
    let squares: Vec<f64> = pictures[0]
        .iter()
        .zip(&pictures[1])
        .zip(&sines)
        .filter(|(_, sine)| **sine < inside)
        .map(|((first, last), _)| {
            f64::from((first.iter().sum::<f32>() - last.iter().sum::<f32>()) / 3.0).powi(2)
        })
        .collect();
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    Ok(Cell {
        bias: ANGLES.map(|range| off(&pictures[1], range)),
        first_bias: off(&pictures[0], whole),
        noise: 100.0 * rms / mean(&pictures[1], &sines, whole).max(1e-9),
    })
}

/// Measures all cells, or reads them from the cache.
///
/// # Errors
/// When rendering fails, the cache cannot be used, or the user stops it.
pub fn measure(args: &QualityArgs, gpu: &Gpu, progress: &ProgressDisplay) -> anyhow::Result<Rows> {
    let folder = args.cache.as_ref().map(|cache| cache.join("materials"));
    let words =
        format!("{SAMPLES} samples, {FRAMES} frames, version {}", env!("CARGO_PKG_VERSION"));
    let mut store: Kept<Cell> = Kept::open(folder.as_deref(), words)?;
    let mut rows = Rows::new();
    for (index, (name, make)) in (0..).zip(MATERIALS) {
        progress.set("material", index, MATERIALS.len() as u32);
        let mut cells = Vec::new();
        for (light, shine) in LIGHTS {
            let key = format!("{name} in {light}");
            if store.get(&key).is_none() && !args.kept {
                store.put(key.clone(), measure_cell(gpu, progress, make(), shine)?)?;
            }
            cells.push(store.get(&key).copied());
        }
        rows.push((name, cells));
    }
    Ok(rows)
}

/// The section of the page.
pub fn section(rows: &Rows) -> String {
    let [near, middle, far] = ANGLES.map(|[low, high]| format!("{low} to {high}"));
    let head = LIGHTS.map(|(name, _)| name).join(" | ");
    let line = " --- |".repeat(LIGHTS.len() + 1);
    let mut text = format!(
        "## Materials by light and angle\n\nA ball of each material in each light, `balanced`, {VOXELS} voxels, {SIZE} x {SIZE} \
         pixels, {FRAMES} frames; against {SAMPLES} paths a pixel. The bias in per cent where the eye sees the surface at \
         {near} / {middle} / {far} degrees from its normal; ranges darker than a tenth \
         of the ball's mean count as that bright:\n\n| material | {head} |\n|{line}\n"
    );
    let table = |shown: &dyn Fn(&Cell) -> String, text: &mut String| {
        for (name, cells) in rows {
            let cell = |cell: &Option<Cell>| cell.as_ref().map_or("-".to_owned(), shown);
            let cells: Vec<String> = cells.iter().map(cell).collect();
            let _ = writeln!(text, "| {name} | {} |", cells.join(" | "));
        }
    };
    // Not "-0.0".
    let rounded = |value: f64| (10.0 * value).round() / 10.0 + 0.0;
    table(&|cell| cell.bias.map(|bias| format!("{:+.1}", rounded(bias))).join(" / "), &mut text);
    let _ = write!(
        text,
        "\nThe first frame's bias over all angles, and its root mean square difference from the mean of {FRAMES}, as a share of the mean, in per \
         cent:\n\n| material | {head} |\n|{line}\n"
    );
    table(&|cell| format!("{:+.1}; {:.1}", rounded(cell.first_bias), cell.noise), &mut text);
    text + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_of_the_grid_is_valid() {
        for (_, make) in MATERIALS {
            for (light, shine) in LIGHTS {
                scene(make(), shine).validate().expect(light);
            }
        }
    }

    /// In a distant view of a sphere, the sine of a normal's angle is the distance from the centre.
    #[test]
    fn sines_match_the_outline_of_the_sphere() {
        let sines = sines();
        let middle = sines[(SIZE / 2 * SIZE + SIZE / 2) as usize];
        assert!(middle < 0.05, "{middle}");
        assert!(sines[0] > 1.0);
        let inside = sines.iter().filter(|sine| **sine < 1.0).count() as f32;
        let tangent = 1.0 / (DISTANCE_M * DISTANCE_M - 1.0).sqrt();
        let radius = 0.5 * SIZE as f32 * tangent / (0.5 * FOV_RAD).tan();
        assert!((inside / (PI * radius * radius) - 1.0).abs() < 0.02, "{inside}");
    }
}
