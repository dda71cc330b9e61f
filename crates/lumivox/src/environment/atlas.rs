//! A cube with all its mips, laid out in one texture. Every face of every mip has a border of one
//! texel, so that bilinear samples at a face's edge include the neighbouring face's texels.

use glam::{UVec2, Vec3};

use super::cube::{Cube, direction};

/// Texels around a face, on each side.
const BORDER: u32 = 1;

/// The layout of the texture: each mip has two rows of three faces. The first mip is at the left;
/// the others are in a column to its right. `environment.wgsl` has the same layout.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    edge: u32,
}

impl Layout {
    /// The layout for a cube with an edge of a power of two, at least 2 texels.
    pub(super) fn new(edge: u32) -> Self {
        debug_assert!(edge.is_power_of_two() && edge >= 2, "{edge}");
        Self { edge }
    }

    pub(super) fn mips(self) -> u32 {
        self.edge.ilog2() + 1
    }

    /// The size of the texture.
    pub(super) fn size(self) -> UVec2 {
        let last = self.place(self.mips() - 1, 5) + UVec2::splat(1 + 2 * BORDER);
        let first = block(self.edge);
        UVec2::new(first.x + block(self.edge / 2).x, first.y.max(last.y))
    }

    /// The corner of a face of a mip, border included.
    pub(super) fn place(self, mip: u32, face: u32) -> UVec2 {
        let above: u32 = (1..mip).map(|mip| block(self.edge >> mip).y).sum();
        let corner = if mip == 0 { UVec2::ZERO } else { UVec2::new(block(self.edge).x, above) };
        corner + UVec2::new(face % 3, face / 3) * bordered(self.edge >> mip)
    }
}

fn bordered(edge: u32) -> u32 {
    edge + 2 * BORDER
}

/// The texels of a mip.
fn block(edge: u32) -> UVec2 {
    UVec2::new(3, 2) * bordered(edge)
}

/// Lays out a cube and its mips.
pub(super) fn flatten(mut cube: Cube) -> (UVec2, Vec<Vec3>) {
    let layout = Layout::new(cube.edge);
    let size = layout.size();
    let mut texels = vec![Vec3::ZERO; (size.x * size.y) as usize];
    for mip in 0..layout.mips() {
        if mip > 0 {
            cube = cube.halved();
        }
        for face in 0..6 {
            let corner = layout.place(mip, face);
            for y in 0..bordered(cube.edge) {
                let row = ((corner.y + y) * size.x + corner.x) as usize;
                for x in 0..bordered(cube.edge) {
                    texels[row + x as usize] = bordered_texel(&cube, face, x, y);
                }
            }
        }
    }
    (size, texels)
}

/// A texel of a bordered face: beyond an edge the neighbour's texel, at a corner the mean of the
/// three texels that meet.
fn bordered_texel(cube: &Cube, face: u32, x: u32, y: u32) -> Vec3 {
    let last = cube.edge - 1;
    let inside = |i: u32| (BORDER..=last + BORDER).contains(&i);
    let nearest = |i: u32| i.saturating_sub(BORDER).min(last);
    match (inside(x), inside(y)) {
        (true, true) => texel(cube, face, nearest(x), nearest(y)),
        (true, false) | (false, true) => {
            let place = |i: u32| (2.0 * i as f32 - 1.0) / cube.edge as f32 - 1.0;
            beyond(cube, direction(face as usize, place(x), place(y)))
        }
        (false, false) => {
            let (i, j) = (nearest(x), nearest(y));
            let along = |x: u32, y: u32| bordered_texel(cube, face, x, y);
            (texel(cube, face, i, j) + along(x, j + BORDER) + along(i + BORDER, y)) / 3.0
        }
    }
}

fn texel(cube: &Cube, face: u32, x: u32, y: u32) -> Vec3 {
    cube.texels[((face * cube.edge + y) * cube.edge + x) as usize]
}

/// The texel in a direction.
fn beyond(cube: &Cube, towards: Vec3) -> Vec3 {
    let face = towards.abs().max_position();
    let face = 2 * face + usize::from(towards[face] < 0.0);
    // The coordinates on a face are dot products with the derivatives of its direction.
    let along = towards.abs().max_element();
    let place = |axis: Vec3| (towards.dot(axis) / along * 0.5 + 0.5) * cube.edge as f32;
    let middle = direction(face, 0.0, 0.0);
    let (s, t) = (direction(face, 1.0, 0.0) - middle, direction(face, 0.0, 1.0) - middle);
    let texel_of = |place: f32| (place.max(0.0) as u32).min(cube.edge - 1);
    texel(cube, face as u32, texel_of(place(s)), texel_of(place(t)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A colour for each direction, continuous everywhere.
    fn smooth(edge: u32) -> Cube {
        let middle = |i: u32| (2.0 * i as f32 + 1.0) / edge as f32 - 1.0;
        let texels = (0..6)
            .flat_map(|face| (0..edge * edge).map(move |i| (face, i % edge, i / edge)))
            .map(|(face, x, y)| direction(face, middle(x), middle(y)).normalize())
            .collect();
        Cube { edge, texels }
    }

    #[test]
    fn cube_faces_do_not_overlap_in_the_atlas() {
        for edge in [2, 4, 64, 1024] {
            let layout = Layout::new(edge);
            let faces = (0..layout.mips()).flat_map(|mip| (0..6).map(move |face| (mip, face)));
            let boxes: Vec<(UVec2, UVec2)> = faces
                .map(|(mip, face)| {
                    let corner = layout.place(mip, face);
                    (corner, corner + bordered(edge >> mip))
                })
                .collect();
            for (i, (low, high)) in boxes.iter().enumerate() {
                assert!(high.cmple(layout.size()).all(), "{edge}: {high} of {}", layout.size());
                let meets = |(a, b): &(UVec2, UVec2)| a.cmplt(*high).all() && low.cmplt(*b).all();
                assert!(!boxes[..i].iter().any(meets), "{edge}: {low} {high}");
            }
            // The shader computes the edge from the size in this way.
            assert_eq!((2 * layout.size().x - 24) / 9, edge);
            assert!(layout.size().max_element() <= 8192, "WebGPU's textures are no larger");
        }
    }

    /// A function that is smooth over the sphere is smooth across every edge: neighbours across an
    /// edge differ no more than those within a face.
    #[test]
    fn face_borders_continue_the_neighbouring_face() {
        let edge = 16;
        let cube = smooth(edge);
        for face in 0..6 {
            for i in 1..=edge {
                for (border, inner) in [
                    ((0, i), (1, i)),
                    ((edge + 1, i), (edge, i)),
                    ((i, 0), (i, 1)),
                    ((i, edge + 1), (i, edge)),
                ] {
                    let beyond = bordered_texel(&cube, face, border.0, border.1);
                    let own = bordered_texel(&cube, face, inner.0, inner.1);
                    let step = beyond.distance(own);
                    assert!(
                        (0.02..0.13).contains(&step),
                        "{face} {border:?}: {beyond} beside {own}"
                    );
                }
            }
            let corner = bordered_texel(&cube, face, 0, 0);
            assert!(corner.distance(bordered_texel(&cube, face, 1, 1)) < 0.1, "{face}");
        }
    }
}
