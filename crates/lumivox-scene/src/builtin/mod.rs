//! Scenes made in code: always available, exact, and small enough to reason about.
//!
//! | Name | Purpose |
//! | --- | --- |
//! | `cornell` | the Cornell box: colour bleeding, soft indirect shadows |
//! | `two-rooms` | a wall thinner than a voxel with a doorway: leaking against bleeding |
//! | `two-rooms-closed` | the same without the doorway: the dark room must stay black |
//! | `atrium` | a two-storey hall under sun and sky: large contrasts, columns, cloths |
//! | `furnace` | a closed cube of emission e and albedo a: radiance e / (1 - a) everywhere |
//! | `panel` | a large emitter over a floor: form factors in closed form |
//! | `spheres` | roughness from 0.05 to 1, metal and dielectric, over a textured floor |
//! | `furnished` | a furnished room: things thinner than a voxel, one lamp |
//! | `window` | a low sun and a sky through one window |
//! | `glow` | a closed room without lamps, lit by what glows in it |
//! | `clutter` | three hundred small things under a lamp and a sky |
//! | `lacquer` | deep colours and black, more glossy than diffuse; checkered floor and ceiling |
//! | `city`, `city-night` | a kilometre of streets, houses with rooms, a stadium; a fly-through |
//! | `interior`, `interior-night` | the same, seen from a furnished room in it |
//!
//! Each but the last two also exists as `NAME-rotated`: rotated by [`ROTATION_RAD`] about the
//! centre of its bounds, so that no wall is aligned with a voxel grid. Nothing else may change in
//! the picture.

mod atrium;
pub(crate) mod build;
mod city;
mod clutter;
mod cornell;
mod furnace;
mod furnished;
mod glow;
mod lacquer;
mod panel;
pub(crate) mod shapes;
mod spheres;
mod two_rooms;
mod window;

use glam::Vec3;

use crate::{Scene, SceneError};

/// The rotation of the `-rotated` scenes: Euler angles in radians about x, y and z (intrinsic, in
/// that order).
pub const ROTATION_RAD: Vec3 = Vec3::new(0.5, 0.35, 0.4);

const ROTATED: &str = "-rotated";

const NAMES: [&str; 28] = [
    "cornell",
    "cornell-rotated",
    "two-rooms",
    "two-rooms-rotated",
    "two-rooms-closed",
    "two-rooms-closed-rotated",
    "atrium",
    "atrium-rotated",
    "furnace",
    "furnace-rotated",
    "panel",
    "panel-rotated",
    "spheres",
    "spheres-rotated",
    "furnished",
    "furnished-rotated",
    "window",
    "window-rotated",
    "glow",
    "glow-rotated",
    "clutter",
    "clutter-rotated",
    "lacquer",
    "lacquer-rotated",
    "city",
    "city-night",
    "interior",
    "interior-night",
];

/// The scenes that are a kilometre large.
const LARGE: [&str; 4] = ["city", "city-night", "interior", "interior-night"];

/// The names that [`scene`] knows.
pub fn names() -> &'static [&'static str] {
    &NAMES
}

/// `true` for scenes with millions of triangles over a kilometre. They open in seconds like the
/// others, but take minutes to render on a CPU. Code that loops over all scenes should skip them,
/// or it takes longer than for all the others together.
pub fn is_large(name: &str) -> bool {
    LARGE.contains(&name)
}

/// Makes the built-in scene of that name.
///
/// # Errors
/// [`SceneError::UnknownBuiltin`], which lists the names, if the name is unknown.
pub fn scene(name: &str) -> Result<Scene, SceneError> {
    let plain = name.strip_suffix(ROTATED).filter(|plain| !is_large(plain)).unwrap_or(name);
    let mut scene = match plain {
        "cornell" => cornell::scene(),
        "two-rooms" => two_rooms::scene(true),
        "two-rooms-closed" => two_rooms::scene(false),
        "atrium" => atrium::scene(),
        "furnace" => furnace::scene(),
        "panel" => panel::scene(),
        "spheres" => spheres::scene(),
        "furnished" => furnished::scene(),
        "window" => window::scene(),
        "glow" => glow::scene(),
        "clutter" => clutter::scene(),
        "lacquer" => lacquer::scene(),
        "city" => city::scene(false, false)?,
        "city-night" => city::scene(true, false)?,
        "interior" => city::scene(false, true)?,
        "interior-night" => city::scene(true, true)?,
        _ => {
            return Err(SceneError::UnknownBuiltin {
                name: name.to_owned(),
                known: NAMES.to_vec(),
            });
        }
    };
    name.clone_into(&mut scene.name);
    scene.validate()?;
    if plain != name {
        scene.rotate(ROTATION_RAD);
    }
    Ok(scene)
}

#[cfg(test)]
mod tests;
