//! A stage for tests of single surfaces: quads and spheres of any material in front of a camera.

use glam::{Mat4, UVec2, Vec3};
use lumivox::{Preset, TraceSettings};
use lumivox_render::{Exposure, Picture, RenderSettings, View};
use lumivox_scene::{
    Camera, Filter, Instance, Material, Mesh, MetallicRoughness, Sampler, Scene, Shading, Texture,
    Wrap,
};

pub use crate::common::zoo::quad;
use crate::common::{gpu, picture, renderer};

pub fn scene() -> Scene {
    let mut scene = Scene { name: "stage".to_owned(), ..Scene::default() };
    scene.cameras.push(Camera::look_at(Vec3::new(0.0, 0.0, 4.0), Vec3::ZERO, 0.3));
    scene
}

/// A square that faces the camera of [`scene`], at `z` along its axis, and fills the picture.
pub fn pane(z: f32) -> Mesh {
    quad(Vec3::Z * z, Vec3::X, Vec3::Y)
}

/// Joins two meshes.
pub fn joined(mut first: Mesh, second: Mesh) -> Mesh {
    let count = first.positions.len() as u32;
    first.positions.extend(second.positions);
    first.normals.extend(second.normals);
    first.uvs.extend(second.uvs);
    first.tangents.extend(second.tangents);
    first.indices.extend(second.indices.iter().map(|index| index + count));
    first
}

pub fn add(scene: &mut Scene, mesh: Mesh, material: Material) {
    let name = material.name.clone();
    scene.meshes.push(mesh);
    scene.materials.push(material);
    scene.instances.push(Instance {
        name,
        mesh: scene.meshes.len() - 1,
        material: scene.materials.len() - 1,
        world_from_local: Mat4::IDENTITY,
        ..Instance::default()
    });
}

/// A material that emits `radiance` and reflects nothing.
pub fn glowing(radiance: Vec3) -> Material {
    Material { emissive: radiance, ..Material::diffuse("glowing", Vec3::ZERO) }
}

pub fn metallic_roughness(shading: MetallicRoughness) -> Material {
    Material { shading: Shading::MetallicRoughness(shading), ..Material::default() }
}

/// Changes the metallic-roughness part of a material.
pub fn with(mut material: Material, change: impl FnOnce(&mut MetallicRoughness)) -> Material {
    if let Shading::MetallicRoughness(shading) = &mut material.shading {
        change(shading);
    }
    material
}

/// A texture without filtering.
pub fn texture(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Texture {
        name: "texels".to_owned(),
        width,
        height,
        rgba8: texels.flat_map(|(x, y)| texel(x, y)).collect(),
        sampler: Sampler {
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            magnify: Filter::Nearest,
            minify: Filter::Linear,
        },
    }
}

pub fn settings(view: View) -> RenderSettings {
    RenderSettings {
        size: UVec2::splat(32),
        resolution: 32,
        bounces: 0,
        frames: 16,
        view,
        exposure: Exposure::Stops(0.0),
        trace: TraceSettings::preset(Preset::Balanced),
        ..RenderSettings::default()
    }
}

pub fn render(scene: &Scene, settings: RenderSettings) -> Picture {
    let mut scene = scene.clone();
    scene.validate().expect("a valid scene");
    picture(&mut renderer(&gpu(), &scene, settings))
}

/// The mean over all pixels.
pub fn mean(picture: &Picture) -> Vec3 {
    let sum: Vec3 = picture.hdr.iter().map(|[r, g, b, _]| Vec3::new(*r, *g, *b)).sum();
    sum / picture.hdr.len() as f32
}

/// The mean over a part of the picture: pixels from `low` up to but not including `high`.
pub fn mean_of(picture: &Picture, low: UVec2, high: UVec2) -> Vec3 {
    let pixels = (low.y..high.y).flat_map(|y| (low.x..high.x).map(move |x| (x, y)));
    let values: Vec<Vec3> = pixels
        .map(|(x, y)| {
            let [r, g, b, _] = picture.hdr[(y * picture.size.x + x) as usize];
            Vec3::new(r, g, b)
        })
        .collect();
    values.iter().sum::<Vec3>() / values.len() as f32
}

/// The root mean square difference of the pixels from a colour.
pub fn rms(picture: &Picture, from: Vec3) -> f32 {
    let squares =
        picture.hdr.iter().map(|[r, g, b, _]| (Vec3::new(*r, *g, *b) - from).length_squared());
    (squares.sum::<f32>() / (3 * picture.hdr.len()) as f32).sqrt()
}

pub fn assert_near(what: &str, actual: Vec3, expected: Vec3, tolerance: f32) {
    println!("{what}: {actual:.4}, of {expected:.4}");
    let error = (actual - expected).abs().max_element();
    assert!(error <= tolerance, "{what}: {actual}, not {expected}");
}
