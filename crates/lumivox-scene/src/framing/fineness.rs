//! Whether voxels are fine enough for what a camera sees.
//!
//! Light between surfaces that are nearer to each other than a few voxels is that of faces which are as large as the way. So rays go
//! from what is seen to all sides, and tell how far light comes from.

use super::directions;
use super::rays::Rays;
use super::sight::{Note, three_digits};
use super::soup::Unit;
use super::survey::Patch;

/// Rays from each point that is seen.
const DIRECTIONS: usize = 16;
/// The voxels that light should come from afar.
const NEAR_VOXELS: f32 = 2.0;
/// The most of the rays that may end nearer.
const MOST_NEAR: f32 = 1.0 / 3.0;
/// The least share of the rays that must end anywhere: under the open sky little light goes from surface to surface.
const LEAST_MET: f32 = 0.02;

/// A note for voxels that are coarse against the distances between what is seen and what lights it.
pub(super) fn note(seen: &[Patch], rays: &Rays, unit: Unit, voxel_m: f32) -> Option<Note> {
    let (mut cast, mut met, mut near) = (0, 0, 0);
    for patch in seen {
        for way in directions::sphere(2 * DIRECTIONS).filter(|way| way.dot(patch.normal) > 0.0) {
            cast += 1;
            if let Some(hit) = rays.cast(patch.position, way) {
                met += 1;
                near += i32::from(hit.distance * unit.scale_m < NEAR_VOXELS * voxel_m);
            }
        }
    }
    let share = near as f32 / (met as f32).max(1.0);
    if share <= MOST_NEAR || (met as f32) < LEAST_MET * cast as f32 {
        return None;
    }
    let text = format!(
        "voxels of {} m are coarse here: {:.0} % of the light between surfaces comes from nearer than two of them",
        three_digits(voxel_m),
        100.0 * share
    );
    Some(Note { about: "grid", text, option: "--volume cascades has finer ones around the camera" })
}

#[cfg(test)]
mod tests {
    use std::cell::OnceCell;

    use crate::{Framing, Sight, SightOptions, Staging, builtin};

    #[test]
    fn voxels_are_coarse_where_light_comes_from_within_two_of_them() {
        let scene = builtin::scene("cornell").unwrap();
        // The box is 2 m wide.
        for (voxel_m, is_coarse) in [(1.0 / 64.0, false), (1.0 / 16.0, false), (0.5, true)] {
            let options = SightOptions {
                staging: Staging::None,
                voxel_m: Some(voxel_m),
                ..SightOptions::default()
            };
            let framing = OnceCell::from(Framing::of(&scene));
            let notes = Sight::of(&scene, &options, &framing).notes;
            assert_eq!(notes.iter().any(|note| note.about == "grid"), is_coarse, "{voxel_m} m");
        }
    }
}
