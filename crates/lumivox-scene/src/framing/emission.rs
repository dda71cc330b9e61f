//! The emission of a scene's surfaces: its flux, and sample points.
//!
//! The emissive factor is not enough: exporters switch emission on and keep the dark parts black by
//! a texture. So emission is sampled at points spread evenly over the area of all surfaces whose
//! material emits. A diffuse emitter of luminance L and area A has the flux `pi L A`.

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::directions;
use super::soup::Unit;
use crate::{Instance, Material, Mesh, Scene, Texture, TextureRef, Wrap};

/// Points at which emission is sampled: a lit window of a thousandth of the emitting area gets
/// four.
const SAMPLES: usize = 4096;
/// Texels up to this code (of 255) count as black: compression makes black images a little grey.
const BLACK: u8 = 8;

/// A piece of an emitting surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Emitter {
    /// The position in unit space.
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
    pub(super) is_double_sided: bool,
    /// Luminance times area, cd.
    pub(super) intensity_cd: f32,
}

/// The emission of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Emission {
    /// The pieces that are not black.
    pub(super) emitters: Vec<Emitter>,
    /// The flux of all pieces, lm.
    pub(super) flux_lm: f32,
    /// The emitting area, counting each side, m².
    emitting_m2: f32,
    /// The area of all surfaces, counting each visible side, m².
    pub(super) area_m2: f32,
}

/// A triangle that may emit.
struct Candidate<'a> {
    mesh: &'a Mesh,
    material: &'a Material,
    triangle: [usize; 3],
    corners: [Vec3; 3],
}

impl Emission {
    pub(super) fn of(scene: &Scene, unit: Unit) -> Self {
        let (mut area_m2, mut candidates_m2) = (0.0, 0.0);
        let (mut candidates, mut up_to_m2) = (Vec::new(), Vec::new());
        for instance in scene.subjects() {
            let Some(mesh) = scene.meshes.get(instance.mesh) else { continue };
            let Some(material) = scene.materials.get(instance.material) else { continue };
            let sides = if material.double_sided { 2.0 } else { 1.0 };
            let emits = material.emissive.max_element() > 0.0;
            for triangle in mesh.triangles() {
                let corners = corners(instance, mesh, triangle);
                let [a, b, c] = corners;
                let own_m2 = 0.5 * f64::from((b - a).cross(c - a).length());
                area_m2 += sides * own_m2;
                if emits {
                    candidates_m2 += own_m2;
                    up_to_m2.push(candidates_m2);
                    candidates.push(Candidate { mesh, material, triangle, corners });
                }
            }
        }
        let mut emission = Self { area_m2: area_m2 as f32, ..Self::default() };
        let each_m2 = candidates_m2 / SAMPLES as f64;
        for (index, weights) in directions::triangles(&up_to_m2, SAMPLES) {
            let emitter = candidates[index].emitter(weights, each_m2 as f32, unit, scene);
            let Some(emitter) = emitter else { continue };
            let sides = if emitter.is_double_sided { 2.0 } else { 1.0 };
            emission.flux_lm += PI * sides * emitter.intensity_cd;
            emission.emitting_m2 += sides * each_m2 as f32;
            emission.emitters.push(emitter);
        }
        emission
    }

    /// The mean luminance of the emitting area, cd/m²; 0 if there is none.
    pub(super) fn luminance(&self) -> f32 {
        if self.emitting_m2 > 0.0 { self.flux_lm / (PI * self.emitting_m2) } else { 0.0 }
    }

    /// The mean illuminance of all surfaces if the flux stayed in the scene.
    pub(super) fn mean_lux(&self) -> f32 {
        if self.area_m2 > 0.0 { self.flux_lm / self.area_m2 } else { 0.0 }
    }
}

impl Candidate<'_> {
    /// The piece at a point between the corners; `None` if it is black.
    fn emitter(
        &self,
        weights: [f32; 3],
        area_m2: f32,
        unit: Unit,
        scene: &Scene,
    ) -> Option<Emitter> {
        let [a, b, c] = self.corners;
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        let normal = (b - a).cross(c - a).try_normalize()?;
        let texel = match self.material.emissive_texture {
            None => Vec3::ONE,
            Some(reference) => {
                let texture = scene.textures.get(reference.texture)?;
                texel(texture, reference, self.texcoord(reference, weights)?)
            }
        };
        let luminance = luminance(self.material.emissive * texel);
        (luminance > 0.0).then_some(Emitter {
            position: unit.unit_from_world(position),
            normal,
            is_double_sided: self.material.double_sided,
            intensity_cd: luminance * area_m2,
        })
    }

    fn texcoord(&self, reference: TextureRef, weights: [f32; 3]) -> Option<Vec2> {
        let second = Some(&self.mesh.uvs1).filter(|uvs| reference.uv_set == 1 && !uvs.is_empty());
        let uvs = second.unwrap_or(&self.mesh.uvs);
        let corners = self.triangle.map(|index| uvs.get(index));
        corners.into_iter().zip(weights).map(|(uv, weight)| Some(*uv? * weight)).sum()
    }
}

fn corners(instance: &Instance, mesh: &Mesh, triangle: [usize; 3]) -> [Vec3; 3] {
    triangle.map(|index| {
        let local = mesh.positions.get(index).copied().unwrap_or_default();
        instance.world_from_local.transform_point3(local)
    })
}

/// The linear colour of the nearest texel.
fn texel(texture: &Texture, reference: TextureRef, uv: Vec2) -> Vec3 {
    let uv = reference.transform.transform_point2(uv);
    let place = |at: f32, wrap: Wrap, size: u32| {
        let at = match wrap {
            Wrap::Repeat => at.rem_euclid(1.0),
            Wrap::MirroredRepeat => 1.0 - (at.rem_euclid(2.0) - 1.0).abs(),
            Wrap::ClampToEdge => at,
        };
        ((at * size as f32) as usize).min(size as usize - 1)
    };
    let x = place(uv.x, texture.sampler.wrap_u, texture.width);
    let y = place(uv.y, texture.sampler.wrap_v, texture.height);
    let start = 4 * (y * texture.width as usize + x);
    let Some(&[r, g, b]) = texture.rgba8.get(start..).and_then(|bytes| bytes.first_chunk()) else {
        return Vec3::ZERO;
    };
    if r.max(g).max(b) <= BLACK {
        return Vec3::ZERO;
    }
    // IEC 61966-2-1.
    let linear = |code: u8| {
        let encoded = f32::from(code) / 255.0;
        if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    Vec3::new(linear(r), linear(g), linear(b))
}

/// ITU-R BT.709-6, section 3.2.
pub(super) fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests {
    use glam::{Mat4, Vec4};

    use super::*;
    use crate::builtin::shapes::quad;
    use crate::{Sampler, builtin};

    /// A square of 4 m² that emits 10 cd/m², on a matt one of 16 m²; a texture may blacken parts of
    /// it.
    fn lit_square(rgba8: Option<[[u8; 4]; 4]>) -> Scene {
        let mut scene = Scene::default();
        let mut lamp = Material::diffuse("lamp", Vec3::ZERO);
        lamp.emissive = Vec3::splat(10.0);
        if let Some(texels) = rgba8 {
            scene.textures.push(Texture {
                name: String::new(),
                width: 2,
                height: 2,
                rgba8: texels.concat(),
                sampler: Sampler::default(),
            });
            lamp.emissive_texture = Some(TextureRef::new(0));
        }
        scene.materials = vec![lamp, Material::diffuse("floor", Vec3::ONE)];
        scene.meshes = vec![
            quad(Vec3::Y, Vec3::X, Vec3::Z),
            quad(Vec3::ZERO, Vec3::X * 2.0, Vec3::NEG_Z * 2.0),
        ];
        let instance = |mesh| Instance { mesh, material: mesh, ..Instance::default() };
        scene.instances = vec![instance(0), instance(1)];
        scene
    }

    fn emission(scene: &Scene) -> Emission {
        Emission::of(scene, Unit::of(scene.bounds()))
    }

    #[test]
    fn flux_is_pi_times_luminance_times_area() {
        let mut scene = lit_square(None);
        let all = emission(&scene);
        assert!((all.flux_lm / (PI * 10.0 * 4.0) - 1.0).abs() < 1e-3, "{} lm", all.flux_lm);
        assert!((all.area_m2 - 20.0).abs() < 1e-4);
        assert!((all.luminance() - 10.0).abs() < 0.01);
        assert!((all.mean_lux() - 2.0 * PI).abs() < 0.01);
        assert!(all.emitters.iter().all(|emitter| emitter.normal == Vec3::NEG_Y));
        scene.materials[0].double_sided = true;
        let both = emission(&scene);
        assert!((both.flux_lm / all.flux_lm - 2.0).abs() < 1e-4 && both.area_m2 > 23.9);
        // Twice as large, four times the flux: nothing depends on the unit.
        for instance in &mut scene.instances {
            instance.world_from_local = Mat4::from_scale(Vec3::splat(2.0));
        }
        let large = emission(&scene);
        assert!((large.flux_lm / both.flux_lm - 4.0).abs() < 1e-3);
        assert!((large.mean_lux() / both.mean_lux() - 1.0).abs() < 1e-3);
    }

    #[test]
    fn emitted_flux_is_scaled_by_the_texture() {
        let (black, white) = ([3, 8, 5, 255], [255; 4]);
        let quarter = emission(&lit_square(Some([white, black, black, black])));
        assert!((quarter.flux_lm / (PI * 10.0) - 1.0).abs() < 0.01, "{} lm", quarter.flux_lm);
        // The upper left texel: -x, and towards the side that v points to.
        assert!(quarter.emitters.iter().all(|emitter| emitter.position.x < 0.0));
        let none = emission(&lit_square(Some([black; 4])));
        assert_eq!((none.flux_lm, none.emitters.len(), none.luminance()), (0.0, 0, 0.0));
        assert!((quarter.luminance() - 10.0).abs() < 0.01, "what is black does not emit");
        let half = emission(&lit_square(Some([[188, 188, 188, 255]; 4])));
        assert!((half.flux_lm / (PI * 40.0) - 0.5).abs() < 0.01, "188 encodes one half");
    }

    #[test]
    fn emitters_without_uvs_or_area_are_skipped() {
        let mut scene = lit_square(Some([[255; 4]; 4]));
        scene.meshes[0].uvs.clear();
        assert_eq!(emission(&scene).flux_lm, 0.0);
        let empty = emission(&Scene::default());
        assert_eq!((empty.mean_lux(), empty.area_m2), (0.0, 0.0));
        let furnace = emission(&builtin::scene("furnace").unwrap());
        assert!((furnace.mean_lux() / PI - 1.0).abs() < 1e-3, "each point emits as all do");
        assert!(Vec4::from((Vec3::ONE, luminance(Vec3::ONE))).abs_diff_eq(Vec4::ONE, 1e-6));
    }
}
