//! Scenes made in code: always available, exact, and small enough to reason about.

mod arcade;
mod atrium;
#[doc(hidden)]
pub mod build;
mod city;
mod clutter;
mod cornell;
mod furnace;
mod furnished;
mod glow;
mod lacquer;
mod mirrors;
mod panel;
pub mod shapes;
mod spheres;
mod two_rooms;
mod window;

use crate::{Material, Scene, SceneError, Shading};
use cornell::LightSource;

/// A built-in scene.
struct Builtin {
    name: &'static str,
    /// The scene's purpose in a line.
    about: &'static str,
    /// `true` if the scene is a kilometre wide.
    is_large: bool,
    make: fn() -> Result<Scene, SceneError>,
}

const fn small(
    name: &'static str,
    about: &'static str,
    make: fn() -> Result<Scene, SceneError>,
) -> Builtin {
    Builtin { name, about, is_large: false, make }
}

const fn large(
    name: &'static str,
    about: &'static str,
    make: fn() -> Result<Scene, SceneError>,
) -> Builtin {
    Builtin { name, about, is_large: true, make }
}

const ALL: [Builtin; 20] = [
    small("cornell", "the Cornell box with a small lamp: colour bleeding", || {
        Ok(cornell::scene(LightSource::Point))
    }),
    small("cornell-area", "the same with its area light: soft shadows", || {
        Ok(cornell::scene(LightSource::Area))
    }),
    small(
        "two-rooms",
        "a wall thinner than a voxel with a doorway: bleeding against leaking",
        || Ok(two_rooms::scene(true)),
    ),
    small(
        "two-rooms-closed",
        "the same without the doorway: the dark room must stay black",
        || Ok(two_rooms::scene(false)),
    ),
    small(
        "atrium",
        "a two-storey hall under sun and sky: large contrasts, columns, cloths",
        || Ok(atrium::scene()),
    ),
    small("arcade", "arches beside a sunny court: a sun patch, and sky between columns", || {
        Ok(arcade::scene())
    }),
    small(
        "furnace",
        "a closed cube of emission e and albedo a: radiance e / (1 - a) everywhere",
        || Ok(furnace::scene()),
    ),
    small("panel", "a large emitter over a floor: form factors in closed form", || {
        Ok(panel::scene())
    }),
    small(
        "spheres",
        "roughness from 0.05 to 1, metal and dielectric, over a textured floor",
        || Ok(spheres::scene()),
    ),
    small("furnished", "a furnished room: things thinner than a voxel, one lamp", || {
        Ok(furnished::scene())
    }),
    small("window", "a low sun and a sky through one window", || Ok(window::scene())),
    small("glow", "a closed room without lamps, lit by what glows in it", || Ok(glow::scene())),
    small("clutter", "three hundred small things under a lamp and a sky", || Ok(clutter::scene())),
    small(
        "lacquer",
        "deep colours and black, more glossy than diffuse; checkered floor and ceiling",
        || Ok(lacquer::scene()),
    ),
    small("mirrors", "a mirror, chrome near a wall, polished stone and water", || {
        Ok(mirrors::mirrors())
    }),
    small("metals", "brushed metals with a roughness from 0.2 to 0.7", || Ok(mirrors::metals())),
    large("city", "a kilometre of streets, houses with rooms, a stadium; a fly-through", || {
        city::scene(false, false)
    }),
    large("city-night", "the same by night: lamps in the streets and in rooms", || {
        city::scene(true, false)
    }),
    large("interior", "a furnished room in the city by day", || city::scene(false, true)),
    large("interior-night", "the same by night, by the light of its lamp", || {
        city::scene(true, true)
    }),
];

const NAMES: [&str; ALL.len()] = {
    let mut names = [""; ALL.len()];
    let mut i = 0;
    while i < ALL.len() {
        names[i] = ALL[i].name;
        i += 1;
    }
    names
};

/// The suffix of a name that gives the scene's matt surfaces the gloss that modelling programs
/// export.
const GLOSSY: &str = "-glossy";

/// The roughness of glossy surfaces.
const ROUGHNESS: f32 = 0.5;

fn is_matt(material: &Material) -> bool {
    matches!(&material.shading, Shading::MetallicRoughness(shading) if shading.specular == 0.0)
}

fn find(name: &str) -> Option<&'static Builtin> {
    let name = name.strip_suffix(GLOSSY).unwrap_or(name);
    ALL.iter().find(|scene| scene.name == name)
}

/// The names that [`scene`] knows, without those that end in `-glossy`.
pub fn names() -> &'static [&'static str] {
    &NAMES
}

/// The purpose of a built-in scene in a line; `None` if the name is unknown.
pub fn about(name: &str) -> Option<&'static str> {
    Some(find(name)?.about)
}

/// `true` for scenes with millions of triangles over a kilometre. They open in seconds, but take
/// minutes to render on a CPU: longer than all other scenes together. Code that loops over all
/// scenes should skip them.
pub fn is_large(name: &str) -> bool {
    find(name).is_some_and(|scene| scene.is_large)
}

/// Makes the built-in scene of that name. If `-glossy` follows the name, its matt surfaces are
/// dielectrics of roughness 0.5, as modelling programs export them.
///
/// # Errors
/// [`SceneError::UnknownBuiltin`], which lists the names, if the name is unknown.
pub fn scene(name: &str) -> Result<Scene, SceneError> {
    let Some(builtin) = find(name) else {
        return Err(SceneError::UnknownBuiltin { name: name.to_owned(), known: NAMES.to_vec() });
    };
    let mut scene = (builtin.make)()?;
    if name.ends_with(GLOSSY) {
        for index in 0..scene.materials.len() {
            if is_matt(&scene.materials[index]) {
                build::glaze(&mut scene, index, ROUGHNESS);
            }
        }
    }
    name.clone_into(&mut scene.name);
    scene.validate()?;
    Ok(scene)
}

#[cfg(test)]
mod tests;
