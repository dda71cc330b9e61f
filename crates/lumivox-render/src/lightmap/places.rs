//! The places of samples: on surfaces, and outside solids that hide them.
//!
//! A texel that a solid covers partly, such as one of a floor under a wall's face, is sampled
//! beside the solid. One that a solid covers entirely gets no sample, but the light of its
//! neighbours.

use glam::{Quat, Vec3};
use lumivox_scene::{Instance, Material, Mesh, Picker, Scene};
use rayon::prelude::*;

use super::charts::Triangle;
use super::cover::Texel;

/// Rays over the hemisphere of a sample.
const SIGHTS: usize = 16;
/// Rays in the plane of a texel, to find the way out of a solid.
const WAYS: usize = 8;
/// Height of the starts of rays above the surface, as a share of a texel's edge.
const LIFT: f32 = 0.05;
/// Height of the starts of rays, as a share of the scene's diagonal, above rounding errors.
const LEAST_LIFT: f32 = 1e-6;

/// The sample of a covered texel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// Index of the texel in the map.
    pub(super) texel: usize,
    pub(super) at: Vec3,
    pub(super) normal: Vec3,
    /// Whether it was moved out of a solid.
    pub(super) is_pushed: bool,
    /// Whether it is hidden inside a solid.
    pub(super) is_buried: bool,
}

/// The samples of all covered texels.
pub(super) fn samples(scene: &Scene, triangles: &[Triangle], texels: &[Texel]) -> Vec<Sample> {
    let solids = merged(scene);
    let bounds = scene.bounds();
    let surroundings =
        Surroundings { picker: Picker::new(&solids), reach_m: bounds.min.distance(bounds.max) };
    let covered: Vec<usize> =
        (0..texels.len()).filter(|&texel| texels[texel].is_covered()).collect();
    let sample = |texel: usize| {
        let triangle = &triangles[texels[texel].triangle as usize];
        surroundings.sample(texel, triangle, texels[texel].weights())
    };
    covered.into_par_iter().map(sample).collect()
}

/// The scene as two meshes, one-sided and two-sided, since a picker tries every instance.
fn merged(scene: &Scene) -> Scene {
    let mut meshes = [Mesh::default(), Mesh::default()];
    for instance in scene.shown() {
        let Some(mesh) = scene.meshes.get(instance.mesh) else { continue };
        let is_double =
            scene.materials.get(instance.material).is_some_and(|material| material.double_sided);
        let into = &mut meshes[usize::from(is_double)];
        let first = into.positions.len() as u32;
        let place = |&position: &Vec3| instance.world_from_local.transform_point3(position);
        into.positions.extend(mesh.positions.iter().map(place));
        into.indices.extend(mesh.indices.iter().map(|index| first + index));
    }
    let material =
        |double_sided| Material { double_sided, ..Material::diffuse("solid", Vec3::ONE) };
    let instance = |mesh| Instance { mesh, material: mesh, ..Instance::default() };
    Scene {
        meshes: meshes.into(),
        instances: [0, 1].map(instance).into(),
        materials: [false, true].map(material).into(),
        ..Scene::default()
    }
}

struct Surroundings {
    picker: Picker,
    /// The scene's diagonal, m.
    reach_m: f32,
}

impl Surroundings {
    fn sample(&self, texel: usize, triangle: &Triangle, weights: Vec3) -> Sample {
        let at = triangle.at(weights);
        let front = triangle.front();
        let [a, b, c] = triangle.normals;
        let normal = (weights.x * a + weights.y * b + weights.z * c).normalize_or(front);
        let [along_u, along_v] = steps(triangle);
        let size = along_u.length().max(along_v.length());
        let above = (LIFT * size).max(LEAST_LIFT * self.reach_m) * front;
        let way_out = (0..WAYS)
            .filter_map(|way| {
                let (v, u) = (way as f32 * std::f32::consts::TAU / WAYS as f32).sin_cos();
                // To the texel's edge or corner.
                let step = (u * along_u + v * along_v) * (0.5 / u.abs().max(v.abs()));
                let length = step.length();
                let back = self.picker.back_m(at + above, step, length)?;
                Some((back, step / length))
            })
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let is_pushed = way_out.is_some();
        // Beside the solid's face, and as far from it as partly covered texels from edges.
        let at = way_out.map_or(at, |(back, way)| at + (back + LIFT * size) * way);
        Sample { texel, at, normal, is_pushed, is_buried: self.is_buried(at + above, front) }
    }

    /// Whether most rays from a surface first meet the back of a single-sided surface.
    fn is_buried(&self, at: Vec3, front: Vec3) -> bool {
        let towards = Quat::from_rotation_arc(Vec3::Z, front);
        let meets_back = |&sight: &usize| {
            // A spiral with equal shares of the hemisphere.
            let height = (sight as f32 + 0.5) / SIGHTS as f32;
            let (sin, cos) = (sight as f32 * 2.399_963).sin_cos();
            let radius = (1.0 - height * height).sqrt();
            let way = towards * Vec3::new(radius * cos, radius * sin, height);
            self.picker.back_m(at, way, self.reach_m).is_some()
        };
        2 * (0..SIGHTS).filter(meets_back).count() > SIGHTS
    }
}

/// The vectors in the world that one texel along u and v covers.
fn steps(triangle: &Triangle) -> [Vec3; 2] {
    let [a, b, c] = triangle.uvs;
    let (b_uv, c_uv) = (b - a, c - a);
    let area = b_uv.perp_dot(c_uv);
    let (to_b, to_c) =
        (triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]);
    [(to_b * c_uv.y - to_c * b_uv.y) / area, (to_c * b_uv.x - to_b * c_uv.x) / area]
}
