//! All triangles of a scene in unit space, few enough for quick rays.
//!
//! Scenes of more than [`Soup::MOST`] triangles are simplified by vertex clustering (Rossignac and
//! Borrel 1993, "Multi-resolution 3D approximations for rendering complex scenes"): the vertices in
//! a grid cell become one, and triangles that collapse are dropped. Dropping random triangles would
//! be simpler, but rays would find the holes, and a closed room must stay closed.

use std::collections::hash_map::Entry;

use glam::{Mat4, UVec3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

use crate::{AlphaMode, Bounds, Instance, Material, Mesh, Scene, Shading};

/// Triangles in unit space.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Soup {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// For each triangle, the shown instance that it belongs to.
    pub(super) part: Vec<u32>,
    /// For each shown instance, the sides of its surface.
    pub(super) sides: Vec<Sides>,
}

/// The sides of a surface for rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sides {
    /// The front is visible; the back is transparent.
    Front,
    /// Both are shown.
    Both,
    /// Most light passes: a pane of glass blocks neither the sun nor a view.
    Transparent,
}

/// The transform of the scene to unit space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    /// The middle of the bounds, in metres.
    center: Vec3,
    /// The longest edge of the bounds, in metres.
    pub(super) scale_m: f32,
    /// Half the edges of the bounds, in the unit space; the longest is 0.5.
    pub(super) half: Vec3,
}

impl Unit {
    pub(super) fn of(bounds: Bounds) -> Self {
        // A scene without size is invalid, but must not break anything.
        let scale_m = bounds.size().max_element().max(f32::MIN_POSITIVE);
        Self { center: bounds.center(), scale_m, half: bounds.size() * 0.5 / scale_m }
    }

    pub(super) fn unit_from_world(self, point: Vec3) -> Vec3 {
        (point - self.center) / self.scale_m
    }

    pub(super) fn world_from_unit(self, point: Vec3) -> Vec3 {
        self.center + point * self.scale_m
    }
}

fn sides(material: &Material) -> Sides {
    let alpha = match &material.shading {
        Shading::MetallicRoughness(m) => m.base_color.w,
        Shading::Phong(p) => p.opacity,
        Shading::Unlit(u) => u.color.w,
    };
    let is_faint = material.alpha == AlphaMode::Blend && alpha < 0.5;
    if is_faint || material.transmission.factor > 0.5 {
        Sides::Transparent
    } else if material.double_sided {
        Sides::Both
    } else {
        Sides::Front
    }
}

/// A mesh and its place.
struct Part<'a> {
    mesh: &'a Mesh,
    unit_from_local: Mat4,
    sides: Sides,
}

impl Part<'_> {
    fn place(&self, local: Vec3) -> Vec3 {
        let position = self.unit_from_local.transform_point3(local);
        // Matrices near the largest float may overflow; losing one corner is harmless.
        if position.is_finite() { position } else { Vec3::ZERO }
    }
}

impl Soup {
    /// Above this many triangles, vertices are clustered.
    pub(super) const MOST: usize = 1_000_000;
    /// Cells along the longest edge at first.
    pub(super) const FINEST: u32 = 1024;

    /// The corners of a triangle.
    pub(super) fn corners_of(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|corner| self.positions[corner as usize])
    }

    pub(super) fn of(scene: &Scene, unit: Unit) -> Self {
        Self::with_at_most(scene, unit, Self::MOST)
    }

    fn with_at_most(scene: &Scene, unit: Unit, most: usize) -> Self {
        let parts = Self::parts(scene, unit);
        let count: usize = parts.iter().map(|part| part.mesh.triangle_count()).sum();
        if count <= most {
            return Self::exact(&parts);
        }
        // Each halving of the grid leaves about a quarter of the surface's cells; a single cell
        // leaves nothing.
        let mut cells = Self::FINEST;
        while cells > 1 {
            if let Some(soup) = Self::clustered(&parts, unit, cells, most) {
                return soup;
            }
            cells /= 2;
        }
        Self::of_parts(&parts)
    }

    /// The triangles, with vertices clustered in this many cells along the longest edge.
    pub(super) fn in_cells(scene: &Scene, unit: Unit, cells: u32) -> Self {
        let parts = Self::parts(scene, unit);
        let soup = Self::clustered(&parts, unit, cells, Self::MOST);
        soup.unwrap_or_else(|| Self::of_parts(&parts))
    }

    fn parts(scene: &Scene, unit: Unit) -> Vec<Part<'_>> {
        let into_unit = Mat4::from_scale(Vec3::splat(1.0 / unit.scale_m))
            * Mat4::from_translation(-unit.center);
        let part = |instance: &Instance| {
            Some(Part {
                mesh: scene.meshes.get(instance.mesh)?,
                unit_from_local: into_unit * instance.world_from_local,
                sides: scene.materials.get(instance.material).map_or(Sides::Front, sides),
            })
        };
        let mut parts: Vec<Part<'_>> = scene.subjects().filter_map(part).collect();
        if parts.iter().all(|part| part.sides == Sides::Transparent) {
            // If there is only glass, the glass is the subject.
            for part in &mut parts {
                part.sides = Sides::Both;
            }
        }
        parts
    }

    fn of_parts(parts: &[Part<'_>]) -> Self {
        Self { sides: parts.iter().map(|part| part.sides).collect(), ..Self::default() }
    }

    fn exact(parts: &[Part<'_>]) -> Self {
        let mut soup = Self::of_parts(parts);
        for (number, part) in (0..).zip(parts) {
            let first = soup.positions.len() as u32;
            soup.positions.extend(part.mesh.positions.iter().map(|&local| part.place(local)));
            for triangle in part.mesh.triangles() {
                soup.triangles.push(triangle.map(|index| first + index as u32));
                soup.part.push(number);
            }
        }
        soup
    }

    /// The clustered triangles, or `None` if there are more than `most`. A cell's vertex is the
    /// first vertex in it, so that flat surfaces stay flat.
    fn clustered(parts: &[Part<'_>], unit: Unit, cells: u32, most: usize) -> Option<Self> {
        let mut soup = Self::of_parts(parts);
        let mut vertex_of_cell: FxHashMap<UVec3, u32> = FxHashMap::default();
        let mut known: FxHashSet<[u32; 3]> = FxHashSet::default();
        let mut cluster = Vec::new();
        for (number, part) in (0..).zip(parts) {
            cluster.clear();
            for &local in &part.mesh.positions {
                let position = part.place(local);
                let cell = ((position + unit.half) * cells as f32).as_uvec3();
                let vertex = match vertex_of_cell.entry(cell) {
                    Entry::Occupied(entry) => *entry.get(),
                    Entry::Vacant(entry) => {
                        soup.positions.push(position);
                        *entry.insert(soup.positions.len() as u32 - 1)
                    }
                };
                if soup.positions.len() > most {
                    return None;
                }
                cluster.push(vertex);
            }
            for triangle in part.mesh.triangles() {
                let [a, b, c] = triangle.map(|index| cluster[index]);
                if a == b || b == c || c == a {
                    continue;
                }
                // A triangle may come again, starting at another corner.
                let turned = if a < b && a < c {
                    [a, b, c]
                } else if b < c {
                    [b, c, a]
                } else {
                    [c, a, b]
                };
                if known.insert(turned) {
                    soup.triangles.push(turned);
                    soup.part.push(number);
                }
                if soup.triangles.len() > most {
                    return None;
                }
            }
        }
        Some(soup)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{rays::Rays, survey::Survey};
    use super::*;
    use crate::builtin;

    /// Two closed rooms, each triangle cut into `n * n`.
    fn fine(n: usize) -> Scene {
        let mut scene = builtin::scene("two-rooms-closed").unwrap();
        for mesh in &mut scene.meshes {
            let mut positions = Vec::new();
            for triangle in mesh.triangles() {
                let [a, b, c] = triangle.map(|index| mesh.positions[index]);
                let at = |i: usize, j: usize| {
                    a + (b - a) * (i as f32 / n as f32) + (c - a) * (j as f32 / n as f32)
                };
                for i in 0..n {
                    for j in 0..n - i {
                        positions.extend([at(i, j), at(i + 1, j), at(i, j + 1)]);
                        if i + j + 1 < n {
                            positions.extend([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                        }
                    }
                }
            }
            mesh.indices = (0..positions.len() as u32).collect();
            mesh.normals = vec![Vec3::Y; positions.len()];
            mesh.uvs = vec![glam::Vec2::ZERO; positions.len()];
            mesh.tangents = vec![glam::Vec4::X; positions.len()];
            mesh.positions = positions;
        }
        scene.validate().unwrap();
        scene
    }

    #[test]
    fn simplified_rooms_stay_closed() {
        let scene = fine(60);
        let unit = Unit::of(scene.bounds());
        let all = Soup::of(&scene, unit);
        assert_eq!(all.triangles.len(), scene.triangle_count());
        let few = Soup::with_at_most(&scene, unit, 5000);
        assert!(
            few.triangles.len() <= 5000 && few.triangles.len() > 500,
            "{}",
            few.triangles.len()
        );
        let survey = Survey::new(&Rays::new(&few), &few, unit.half);
        assert!(survey.is_place);
        assert!(survey.sky() < 1e-3, "{} of all directions leave the room", survey.sky());
    }

    #[test]
    fn simplification_respects_any_triangle_limit() {
        let scene = fine(8);
        let unit = Unit::of(scene.bounds());
        for most in [0, 1, 10, 100] {
            let soup = Soup::with_at_most(&scene, unit, most);
            assert!(soup.triangles.len() <= most.max(1));
            // Rays find their way through whatever is left.
            Survey::new(&Rays::new(&soup), &soup, unit.half);
        }
    }

    #[test]
    fn unit_space_round_trips_to_world() {
        let bounds = Bounds { min: Vec3::new(10.0, 20.0, -5.0), max: Vec3::new(14.0, 21.0, -3.0) };
        let unit = Unit::of(bounds);
        assert_eq!(unit.unit_from_world(bounds.max), unit.half);
        assert_eq!(unit.half, Vec3::new(0.5, 0.125, 0.25));
        assert!(unit.world_from_unit(-unit.half).abs_diff_eq(bounds.min, 1e-5));
    }
}
