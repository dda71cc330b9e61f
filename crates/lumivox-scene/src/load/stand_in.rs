//! Stand-ins for missing parts of a file.

use glam::Vec3;

use super::Notes;
use super::image::Pixels;
use crate::{Filter, Material, Sampler, Texture};

/// Between stone and plaster.
const NO_MATERIAL_ALBEDO: f32 = 0.5;

/// The material of surfaces without one: matte grey, visible from both sides, because such files
/// are mostly bare geometry with arbitrary winding. By its specification glTF's default is a white
/// rough metal of reflectance 1 (glTF 2.0, section 3.9.6), in which indirect light would never end;
/// files without materials do not intend that.
pub(super) fn no_material(notes: &mut Notes) -> Material {
    notes.warn(format!(
        "meshes without a material are shown matte grey with an albedo of {NO_MATERIAL_ALBEDO}"
    ));
    grey("no material")
}

/// The same for a surface whose vertices have colours: these are its albedo.
pub(super) fn only_colors(notes: &mut Notes) -> Material {
    notes.warn("meshes without a material are shown matte in their vertices' colours".to_owned());
    white("vertex colours")
}

/// Matte white, seen from both sides: for vertices whose colours are the albedo.
pub(super) fn white(name: &str) -> Material {
    Material { double_sided: true, ..Material::diffuse(name, Vec3::ONE) }
}

/// Matte grey, seen from both sides.
pub(super) fn grey(name: &str) -> Material {
    Material { double_sided: true, ..Material::diffuse(name, Vec3::splat(NO_MATERIAL_ALBEDO)) }
}

/// The edge of the stand-in for an image, in texels.
pub(super) const BOARD_EDGE: u32 = 8;

/// Texels in place of a missing image: squares of magenta and black, which are hard to overlook.
pub(super) fn board() -> Pixels {
    let texel = |i: u32| {
        let is_even = (i % BOARD_EDGE + i / BOARD_EDGE).is_multiple_of(2);
        if is_even { [255, 0, 255, 255] } else { [0, 0, 0, 255] }
    };
    let rgba8 = (0..BOARD_EDGE * BOARD_EDGE).flat_map(texel).collect();
    Pixels { width: BOARD_EDGE, height: BOARD_EDGE, rgba8 }
}

/// A texture of them.
pub(super) fn checker(name: &str) -> Texture {
    let Pixels { width, height, rgba8 } = board();
    let sampler =
        Sampler { magnify: Filter::Nearest, minify: Filter::Nearest, ..Sampler::default() };
    Texture { name: format!("stand-in for {name}"), width, height, rgba8, sampler }
}
