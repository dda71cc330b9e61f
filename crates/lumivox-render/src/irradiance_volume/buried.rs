//! Finds probes inside solid objects.

use glam::Vec3;
use lumivox_scene::{Picker, Scene};
use rayon::prelude::*;

/// The rays of a probe: to a cube's sides and corners, rotated a little so that they do not run
/// along the edges and diagonals of right-angled geometry.
fn sights() -> impl Iterator<Item = Vec3> {
    let turn = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.21, 0.34, 0.13);
    let all = (-1..=1)
        .flat_map(|x| (-1..=1).flat_map(move |y| (-1..=1).map(move |z| glam::IVec3::new(x, y, z))));
    let is_sight = |way: &glam::IVec3| matches!(way.abs().element_sum(), 1 | 3);
    all.filter(is_sight).map(move |way| turn * way.as_vec3().normalize())
}

/// Whether each place, m, is inside a solid or behind a single-sided wall: most of its rays first
/// hit the back of a single-sided surface. Double-sided surfaces have no back.
pub fn buried(scene: &Scene, places: &[Vec3]) -> Vec<bool> {
    let picker = Picker::new(scene);
    let bounds = scene.bounds();
    let reach = bounds.min.distance(bounds.max);
    let sights: Vec<Vec3> = sights().collect();
    let is_buried = |&place: &Vec3| {
        // The whole scene is within this distance.
        let far = reach + place.distance(bounds.min);
        let meets_back = |&&sight: &&Vec3| {
            let front = picker.pick(place, sight).map_or(far, |pick| pick.distance_m);
            // Picking ignores backs; seen from the opposite direction they are fronts.
            let end = front * (1.0 - 1e-4);
            picker
                .pick(place + sight * end, -sight)
                .is_some_and(|pick| pick.distance_m < end * (1.0 - 1e-4))
        };
        2 * sights.iter().filter(meets_back).count() > sights.len()
    };
    places.par_iter().map(is_buried).collect()
}
