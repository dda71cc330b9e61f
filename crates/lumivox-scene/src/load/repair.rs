//! Repairs NaN and infinite numbers of meshes, so that each costs at most its own vertex.

use glam::{Vec2, Vec3, Vec4};

use super::{Notes, normals};
use crate::Mesh;

/// Replaces numbers that are not finite, before normals and tangents are computed. Triangles with
/// such a corner lose their area and are removed when the scene is validated; vertices that no
/// triangle uses do not matter. Colours are clamped to 0 to 1.
pub(super) fn attributes(mesh: &mut Mesh, notes: &mut Notes) {
    let mut lost = 0;
    if mesh.positions.iter().any(|position| !position.is_finite()) {
        for triangle in mesh.indices.chunks_exact_mut(3) {
            if triangle.iter().any(|&i| !mesh.positions[i as usize].is_finite()) {
                triangle.fill(triangle[0]);
                lost += 1;
            }
        }
        replace(mesh.positions.iter_mut(), Vec3::is_finite, Vec3::ZERO);
    }
    let uvs = mesh.uvs.iter_mut().chain(&mut mesh.uvs1);
    let uvs = replace(uvs, Vec2::is_finite, Vec2::ZERO);
    let white = replace(mesh.colors.iter_mut(), Vec4::is_finite, Vec4::ONE);
    let mut limited = 0;
    for color in &mut mesh.colors {
        let within = color.clamp(Vec4::ZERO, Vec4::ONE);
        limited += usize::from(std::mem::replace(color, within) != within);
    }
    for (count, what) in [
        (lost, "triangles with a corner that is not finite were left out"),
        (uvs, "texture coordinates are not finite and became zero"),
        (white, "vertices have no colour, or one that is not finite, and became white"),
        (limited, "colours were limited to 0 to 1"),
    ] {
        if count > 0 {
            notes.warn(format!("mesh \"{}\": {count} {what}", mesh.name));
        }
    }
}

/// Normalises normals; normals of length zero are replaced by their triangles'.
pub(super) fn directions(mesh: &mut Mesh, notes: &mut Notes) {
    let broken = normals::repair(&mut mesh.normals, &mesh.positions, &mesh.indices);
    if broken > 0 {
        let name = &mesh.name;
        notes.warn(format!("mesh \"{name}\": {broken} normals without a direction were replaced"));
    }
}

/// Replaces the values that are not finite, and returns their number.
pub(super) fn replace<'a, T: Copy + 'a>(
    values: impl Iterator<Item = &'a mut T>,
    is_finite: fn(T) -> bool,
    other: T,
) -> usize {
    values.filter(|value| !is_finite(**value)).map(|value| *value = other).count()
}
