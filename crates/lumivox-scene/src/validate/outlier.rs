//! Finds a vertex far from all others, which makes the rest of the scene a speck: everything is
//! fitted to the bounds.

use std::fmt;

use glam::{DVec3, Vec3};

use crate::{Mesh, Scene};

/// The distance of an outlier, in extents of nearly all of the scene: the rest is then within a
/// single voxel of the finest grid, 1024 along an axis.
const FAR: f64 = 1024.0;
/// Corners that are sampled to find nearly all of the scene.
const SAMPLES: usize = 4096;

/// A vertex so far away that the rest of the scene is too small to be seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Outlier {
    /// The name of its mesh.
    pub mesh: String,
    /// Its number there, from 0.
    pub vertex: usize,
    /// Its position in the world, m.
    pub position: Vec3,
    /// The middle of nearly all of the scene, m.
    pub center: Vec3,
    /// The greatest distance of nearly all of the scene from `center` along any axis, m.
    pub reach_m: f64,
}

impl fmt::Display for Outlier {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mesh, vertex, position: p, center: c, reach_m } = self;
        write!(
            f,
            "vertex {vertex} of the mesh \"{mesh}\" lies at ({:.3e}, {:.3e}, {:.3e}) m, and nearly all \
             of the scene within {reach_m:.3} m of ({:.3}, {:.3}, {:.3}) m",
            p.x, p.y, p.z, c.x, c.y, c.z
        )
    }
}

impl Scene {
    /// The farthest vertex of a valid scene, usually a mistake of the export, if it makes nearly
    /// all of the scene smaller than a voxel. `None` if the file itself gives the box of the grid.
    pub fn outlier(&self) -> Option<Outlier> {
        let count: usize = self.shapes().map(|(mesh, _)| mesh.indices.len()).sum();
        if self.grid_bounds.is_some() || count == 0 {
            return None;
        }
        let mut sample: Vec<DVec3> =
            self.corners(count / SAMPLES + 1).map(|(.., position)| position).collect();
        let center = median(&mut sample);
        let mut distances: Vec<f64> =
            sample.iter().map(|position| distance(*position, center)).collect();
        distances.sort_unstable_by(f64::total_cmp);
        let usual = distances[distances.len() * 9 / 10];
        // Most scenes return here.
        let bounds = self.bounds();
        let extent = (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element();
        if extent <= FAR * usual {
            return None;
        }

        // The number of corners at distances up to each power of two, from 2^-200.
        let mut counts = [0_usize; 512];
        let mut farthest = (0.0, None);
        for (mesh, vertex, position) in self.corners(1) {
            let far = distance(position, center);
            counts[(far.log2().ceil().clamp(-200.0, 300.0) + 200.0) as usize] += 1;
            if far > farthest.0 {
                farthest = (far, Some((mesh, vertex, position)));
            }
        }
        // One corner in a thousand may be a stray; in small scenes a few more.
        let strays = (count / 1000).max(8.min(count / 8));
        let mut beyond = count;
        let reach = counts.iter().position(|within| {
            beyond -= within;
            beyond <= strays
        })?;
        let reach_m = 2.0_f64.powi(reach as i32 - 200);
        let (far, Some((mesh, vertex, position))) = farthest else { return None };
        (far > FAR * reach_m).then(|| Outlier {
            mesh: mesh.name.clone(),
            vertex,
            position: position.as_vec3(),
            center: center.as_vec3(),
            reach_m,
        })
    }

    /// The visible instances, and their transforms to the world.
    fn shapes(&self) -> impl Iterator<Item = (&Mesh, glam::DMat4)> {
        self.shown().filter_map(|instance| {
            let mesh = self.meshes.get(instance.mesh)?;
            Some((mesh, instance.world_from_local.as_dmat4()))
        })
    }

    /// Every `step`th corner of each mesh: its vertex, and its position in the world.
    fn corners(&self, step: usize) -> impl Iterator<Item = (&Mesh, usize, DVec3)> {
        self.shapes().flat_map(move |(mesh, world_from_local)| {
            mesh.indices.iter().step_by(step).filter_map(move |&vertex| {
                let vertex = vertex as usize;
                let position = mesh.positions.get(vertex)?.as_dvec3();
                Some((mesh, vertex, world_from_local.transform_point3(position)))
            })
        })
    }
}

/// The largest distance along an axis.
fn distance(a: DVec3, b: DVec3) -> f64 {
    (a - b).abs().max_element()
}

/// The median along each axis; there must be points.
fn median(points: &mut [DVec3]) -> DVec3 {
    let middle = points.len() / 2;
    let mut along = |axis: usize| {
        let order = |a: &DVec3, b: &DVec3| a[axis].total_cmp(&b[axis]);
        points.select_nth_unstable_by(middle, order).1[axis]
    };
    DVec3::new(along(0), along(1), along(2))
}

#[cfg(test)]
mod tests {
    use glam::Mat4;

    use super::*;
    use crate::builtin;

    /// Moves a corner of the scene's last mesh.
    fn with_stray(name: &str, position: Vec3) -> (Scene, usize) {
        let mut scene = builtin::scene(name).unwrap();
        let instance = scene.instances.last_mut().unwrap();
        instance.world_from_local = Mat4::IDENTITY;
        let mesh = instance.mesh;
        let vertex = scene.meshes[mesh].indices[0] as usize;
        scene.meshes[mesh].positions[vertex] = position;
        (scene, vertex)
    }

    #[test]
    fn a_stray_vertex_is_named() {
        for name in ["cornell", "spheres", "atrium"] {
            for far in [1e6, 1e20, 3e38] {
                let (scene, vertex) = with_stray(name, Vec3::new(0.0, -far, 1.0));
                let outlier = scene.outlier().unwrap_or_else(|| panic!("{name} {far}"));
                assert_eq!((outlier.vertex, outlier.position.y), (vertex, -far), "{name}");
                assert_eq!(outlier.mesh, scene.meshes[scene.instances.last().unwrap().mesh].name);
                assert!(outlier.reach_m < 100.0 && outlier.center.length() < 100.0, "{outlier}");
                let words = format!("vertex {vertex} of the mesh \"{}\" lies at (", outlier.mesh);
                assert!(outlier.to_string().starts_with(&words), "{outlier}");
            }
        }
    }

    #[test]
    fn large_scenes_have_no_outlier() {
        for name in builtin::names() {
            assert_eq!(builtin::scene(name).unwrap().outlier(), None, "{name}");
        }
        // A hundred times as far as the rest, which is then some voxels large.
        assert_eq!(with_stray("cornell", Vec3::new(200.0, 0.0, 0.0)).0.outlier(), None);
        let (mut framed, _) = with_stray("cornell", Vec3::new(1e20, 0.0, 0.0));
        framed.grid_bounds = Some(crate::Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE });
        assert_eq!(framed.outlier(), None);
        assert_eq!(Scene::default().outlier(), None);
    }
}
