//! What stands in for what a file does not have.

use glam::Vec3;

use super::Notes;
use crate::{Filter, Material, Sampler, Texture};

/// Between stone and plaster.
const NO_MATERIAL_ALBEDO: f32 = 0.5;

/// What surfaces without a material look like: matte grey, from both sides, for such files are mostly
/// bare geometry, wound as it came. By the letter glTF's is a white rough metal of reflectance 1 (glTF
/// 2.0, section 3.9.6), in which indirect light would never die out; nobody who leaves materials out
/// means it.
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

/// A texture in place of one that is missing: squares of magenta and black, which nobody overlooks.
pub(super) fn checker(name: &str) -> Texture {
    const EDGE: usize = 8;
    let square = |i: usize| (i % EDGE + i / EDGE).is_multiple_of(2);
    let texel = |i| if square(i) { [255, 0, 255, 255] } else { [0, 0, 0, 255] };
    Texture {
        name: format!("stand-in for {name}"),
        width: EDGE as u32,
        height: EDGE as u32,
        rgba8: (0..EDGE * EDGE).flat_map(texel).collect(),
        sampler: Sampler {
            magnify: Filter::Nearest,
            minify: Filter::Nearest,
            ..Sampler::default()
        },
    }
}
