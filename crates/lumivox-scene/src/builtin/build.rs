//! Building blocks of scenes.

use glam::{Mat4, Vec3};

use super::shapes::{Faces, cuboid};
use crate::{
    Filter, Instance, Light, Material, Mesh, MetallicRoughness, Sampler, Scene, Shading, Texture,
    TextureRef, Wrap,
};

/// Albedo of white paint, as in the Cornell box.
pub(super) const WHITE: Vec3 = Vec3::splat(0.73);
/// Albedo of the Cornell box's left wall.
pub(super) const RED: Vec3 = Vec3::new(0.65, 0.05, 0.05);
/// Albedo of the Cornell box's right wall.
pub(super) const GREEN: Vec3 = Vec3::new(0.12, 0.45, 0.15);

/// Distance from a lamp's face down to its point light, in metres.
const LAMP_LIGHT_DROP_M: f32 = 0.04;

pub(super) fn material(scene: &mut Scene, material: Material) -> usize {
    scene.materials.push(material);
    scene.materials.len() - 1
}

pub(super) fn diffuse(scene: &mut Scene, name: &str, albedo: Vec3) -> usize {
    material(scene, Material::diffuse(name, albedo))
}

/// A dielectric with an index of refraction of 1.5.
pub fn lacquer(scene: &mut Scene, name: &str, color: Vec3, roughness: f32) -> usize {
    let paint = diffuse(scene, name, color);
    glaze(scene, paint, roughness);
    paint
}

/// Gives a diffuse material the gloss of a dielectric.
pub fn glaze(scene: &mut Scene, material: usize, roughness: f32) {
    if let Shading::MetallicRoughness(shading) = &mut scene.materials[material].shading {
        *shading = MetallicRoughness {
            base_color: shading.base_color,
            base_color_texture: shading.base_color_texture,
            metallic: 0.0,
            roughness,
            ..MetallicRoughness::default()
        };
    }
}

/// A material that emits this radiance, in cd/m², and reflects nothing.
pub fn glowing(scene: &mut Scene, name: &str, radiance: Vec3) -> usize {
    let mut black = Material::diffuse(name, Vec3::ZERO);
    black.emissive = radiance;
    material(scene, black)
}

/// A small round lamp without a body.
pub fn point_light(scene: &mut Scene, name: &str, position: Vec3, intensity_cd: f32) {
    scene.lights.push(Light {
        name: name.to_owned(),
        intensity: intensity_cd,
        position,
        radius_m: 0.03,
        ..Light::default()
    });
}

/// Places a mesh that is already in world space.
pub fn place(scene: &mut Scene, name: &str, mesh: Mesh, material: usize) {
    place_at(scene, name, mesh, material, Mat4::IDENTITY);
}

pub(super) fn place_at(
    scene: &mut Scene,
    name: &str,
    mut mesh: Mesh,
    material: usize,
    world_from_local: Mat4,
) {
    name.clone_into(&mut mesh.name);
    scene.meshes.push(mesh);
    let mesh = scene.meshes.len() - 1;
    scene.instances.push(Instance {
        name: name.to_owned(),
        mesh,
        material,
        world_from_local,
        ..Instance::default()
    });
}

/// A ceiling lamp: a flat box flush with the ceiling, whose face glows, with a point light below.
pub(super) struct Lamp {
    /// The middle of the box's top, on the ceiling.
    pub(super) top: Vec3,
    /// Half the box's edges along x and z, and its height, in metres.
    pub(super) half_x_m: f32,
    pub(super) half_z_m: f32,
    pub(super) drop_m: f32,
    /// Radiance of the face in cd/m².
    pub(super) face_radiance: f32,
    /// The light's luminous intensity in candela; 0 for a lamp that only its face lights.
    pub(super) intensity_cd: f32,
}

impl Lamp {
    pub(super) fn install(self, scene: &mut Scene) {
        let half = Vec3::new(self.half_x_m, 0.0, self.half_z_m);
        let min = self.top - half - Vec3::Y * self.drop_m;
        let max = self.top + half;

        let sides = diffuse(scene, "lamp sides", WHITE);
        let body = cuboid(min, max, Faces::SIDES);
        place(scene, "lamp sides", body, sides);

        // The face is black apart from its emission: on a white face, the close light would make a
        // spot that no voxel resolves.
        let mut face = Material::diffuse("lamp face", Vec3::ZERO);
        face.emissive = Vec3::splat(self.face_radiance);
        let face = material(scene, face);
        let only_bottom = Faces { x: [false; 2], y: [true, false], z: [false; 2] };
        place(scene, "lamp face", cuboid(min, max, only_bottom), face);

        if self.intensity_cd == 0.0 {
            return;
        }
        scene.lights.push(Light {
            name: "lamp".to_owned(),
            intensity: self.intensity_cd,
            position: self.top - Vec3::Y * (self.drop_m + LAMP_LIGHT_DROP_M),
            // Smaller than the distance to the face, which the sphere must not touch.
            radius_m: 0.03,
            ..Light::default()
        });
    }
}

/// A diffuse checkerboard: a repeating image of 2 x 2 texels of sRGB-encoded colours, so one unit
/// of u covers two squares.
pub fn checker(scene: &mut Scene, name: &str, colors: [[u8; 3]; 2]) -> usize {
    let [a, b] = colors.map(|[r, g, b]| [r, g, b, 255]);
    scene.textures.push(Texture {
        name: name.to_owned(),
        width: 2,
        height: 2,
        rgba8: [a, b, b, a].concat(),
        sampler: Sampler {
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            magnify: Filter::Nearest,
            minify: Filter::Linear,
        },
    });
    let texture = TextureRef::new(scene.textures.len() - 1);
    let mut checkered = Material::diffuse(name, Vec3::ONE);
    if let Shading::MetallicRoughness(shading) = &mut checkered.shading {
        shading.base_color_texture = Some(texture);
    }
    material(scene, checkered)
}

/// Repeats the image on a mesh `times_u` and `times_v` times.
pub(super) fn tile(mut mesh: Mesh, times_u: f32, times_v: f32) -> Mesh {
    for uv in &mut mesh.uvs {
        uv.x *= times_u;
        uv.y *= times_v;
    }
    mesh
}

/// Hashes three numbers to a number from 0 to below 1 (Jarzynski and Olano 2020, "Hash functions
/// for GPU rendering", PCG3D).
pub fn chance(x: u32, y: u32, z: u32) -> f32 {
    let step = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let (mut x, mut y, mut z) = (step(x), step(y), step(z));
    for _ in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(z));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        x ^= x >> 16;
        y ^= y >> 16;
        z ^= z >> 16;
    }
    (x >> 8) as f32 / (1 << 24) as f32
}

/// Picks one of several things by a number from 0 to below 1.
pub fn pick<T: Copy>(things: &[T], chance: f32) -> T {
    things[((chance * things.len() as f32) as usize).min(things.len() - 1)]
}
