//! Primitives that share one long list of vertices: some exporters write a primitive per material,
//! each with the vertices of the whole model. Each becomes a mesh with only the vertices that it
//! uses.

use crate::Mesh;

/// A list counts as shared if it has at least this many more vertices than the primitive has
/// corners. Fewer are not worth dropping.
const SPARE: u64 = 1024;

/// The most of `given` vertices that a primitive with `corners` corners keeps.
pub(super) fn kept(given: u64, corners: u64) -> u64 {
    if is_shared(given, corners) { corners } else { given }
}

fn is_shared(given: u64, corners: u64) -> bool {
    given > corners.saturating_add(SPARE)
}

/// Drops the vertices that no triangle of a shared list uses; the others keep their order.
/// `tangents` are the file's, one per vertex, if it has any.
pub(super) fn keep_own(mesh: &mut Mesh, tangents: Option<&mut Vec<[f32; 4]>>) {
    if !is_shared(mesh.positions.len() as u64, mesh.indices.len() as u64) {
        return;
    }
    let mut is_used = vec![false; mesh.positions.len()];
    for &index in &mesh.indices {
        is_used[index as usize] = true;
    }
    let mut count = 0;
    let places: Vec<u32> = is_used
        .iter()
        .map(|&used| {
            let place = count;
            count += u32::from(used);
            place
        })
        .collect();
    for index in &mut mesh.indices {
        *index = places[*index as usize];
    }
    keep(&mut mesh.positions, &is_used);
    keep(&mut mesh.normals, &is_used);
    keep(&mut mesh.uvs, &is_used);
    keep(&mut mesh.uvs1, &is_used);
    keep(&mut mesh.colors, &is_used);
    if let Some(tangents) = tangents {
        keep(tangents, &is_used);
    }
}

/// Keeps the used entries; missing lists stay missing.
fn keep<T: Copy>(values: &mut Vec<T>, is_used: &[bool]) {
    let used = values.iter().zip(is_used).filter(|(_, used)| **used).map(|(value, _)| *value);
    *values = used.collect();
}

#[cfg(test)]
mod tests {
    use glam::{Vec2, Vec3, Vec4};

    use super::*;

    #[test]
    fn a_part_of_a_long_list_keeps_its_own_vertices() {
        let count = 5000;
        let mut mesh = Mesh {
            positions: (0..count).map(|i| Vec3::new(i as f32, 1.0, 2.0)).collect(),
            normals: vec![Vec3::Y; count],
            uvs: (0..count).map(|i| Vec2::new(i as f32, 0.0)).collect(),
            colors: vec![Vec4::ONE; count],
            indices: vec![4000, 3, 17, 17, 3, 4999],
            ..Mesh::default()
        };
        let mut tangents: Vec<[f32; 4]> = (0..count).map(|i| [i as f32, 0.0, 0.0, 1.0]).collect();
        let before: Vec<Vec3> = mesh.indices.iter().map(|&i| mesh.positions[i as usize]).collect();
        keep_own(&mut mesh, Some(&mut tangents));
        assert_eq!(mesh.indices, [2, 0, 1, 1, 0, 3]);
        let after: Vec<Vec3> = mesh.indices.iter().map(|&i| mesh.positions[i as usize]).collect();
        assert_eq!(before, after);
        assert_eq!(mesh.uvs[2].x, 4000.0);
        assert_eq!(tangents[3][0], 4999.0);
        assert_eq!((mesh.normals.len(), mesh.colors.len(), mesh.uvs1.len()), (4, 4, 0));
        assert_eq!(kept(5000, 6), 6);
    }

    #[test]
    fn an_own_vertex_list_is_not_changed() {
        let mut mesh =
            Mesh { positions: vec![Vec3::ZERO; 100], indices: vec![7, 8, 9], ..Mesh::default() };
        let before = mesh.clone();
        keep_own(&mut mesh, None);
        assert_eq!(mesh, before);
        assert_eq!(kept(100, 3), 100);
    }
}
