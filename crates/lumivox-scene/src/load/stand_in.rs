//! Stand-ins for missing materials of a file.

use glam::Vec3;

use super::Notes;
use crate::Material;

/// Albedo between stone and plaster.
const NO_MATERIAL_ALBEDO: f32 = 0.5;

/// The material of surfaces without one: matte grey, visible from both sides, because such files
/// are mostly bare geometry with arbitrary winding. The default of the glTF specification is a
/// white rough metal of reflectance 1 (glTF 2.0, section 3.9.6), between which light would never be
/// absorbed; files without materials do not intend that.
pub(super) fn no_material(notes: &mut Notes) -> Material {
    notes.warn(format!(
        "meshes without a material are shown matte grey with an albedo of {NO_MATERIAL_ALBEDO}"
    ));
    grey("no material")
}

/// The material of surfaces that only have vertex colours, which are the albedo.
pub(super) fn only_colors(notes: &mut Notes) -> Material {
    notes.warn("meshes without a material are shown matte in their vertices' colours".to_owned());
    white("vertex colours")
}

/// Matte white, double-sided: vertex colours are then the albedo.
pub(super) fn white(name: &str) -> Material {
    Material { double_sided: true, ..Material::diffuse(name, Vec3::ONE) }
}

/// Matte grey, double-sided.
pub(super) fn grey(name: &str) -> Material {
    Material { double_sided: true, ..Material::diffuse(name, Vec3::splat(NO_MATERIAL_ALBEDO)) }
}
