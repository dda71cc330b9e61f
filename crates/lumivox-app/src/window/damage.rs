//! Finds the parts of the window that must be repainted.
//!
//! On a software GPU, painting the whole window takes 50 ms. A click that opens a menu takes three
//! frames, in most of which only a button changes. So a canvas keeps the painted window, and each
//! frame repaints only the parts that differ.

use egui::epaint::{ClippedPrimitive, Mesh, Primitive};
use egui::{Color32, Rect, TextureId, pos2};

/// Maximum parts; if there are more, all are merged, since each part paints all primitives that it
/// intersects.
const MOST_PARTS: usize = 4;

/// The parts of a frame that differ from the frame before, in points; they do not overlap.
/// Primitives with a texture in `written` count as different.
pub fn parts(
    before: &[ClippedPrimitive],
    now: &[ClippedPrimitive],
    written: &[TextureId],
) -> Vec<Rect> {
    let mut parts = Vec::new();
    let (mut old_rest, mut new_rest) = (before, now);
    for (at, primitive) in now.iter().enumerate() {
        let Some(ahead) = old_rest.iter().position(|old| is_same(old, primitive)) else { continue };
        let first = now.len() - new_rest.len();
        changes(&old_rest[..ahead], &now[first..at], &mut parts);
        (old_rest, new_rest) = (&old_rest[ahead + 1..], &now[at + 1..]);
    }
    changes(old_rest, new_rest, &mut parts);
    let is_written = |primitive: &&ClippedPrimitive| match &primitive.primitive {
        Primitive::Mesh(mesh) => written.contains(&mesh.texture_id),
        Primitive::Callback(_) => true,
    };
    parts.extend(now.iter().filter(is_written).map(extent));
    disjoint(parts)
}

/// The primitives that paint one part: a black background, and the frame's primitives that
/// intersect the part, clipped to it.
pub fn cut(primitives: &[ClippedPrimitive], part: Rect) -> Vec<ClippedPrimitive> {
    let mut ground = Mesh::default();
    ground.add_colored_rect(part, Color32::BLACK);
    let ground = ClippedPrimitive { clip_rect: part, primitive: Primitive::Mesh(ground) };
    let inside = primitives.iter().filter(|primitive| extent(primitive).intersects(part));
    let cut = inside.map(|primitive| ClippedPrimitive {
        clip_rect: primitive.clip_rect.intersect(part),
        primitive: primitive.primitive.clone(),
    });
    std::iter::once(ground).chain(cut).collect()
}

/// Adds the parts that differ between two runs of primitives, which lie between unchanged ones.
fn changes(old: &[ClippedPrimitive], new: &[ClippedPrimitive], parts: &mut Vec<Rect>) {
    if old.len() == new.len() {
        parts.extend(old.iter().zip(new).filter_map(|(old, new)| difference(old, new)));
    } else {
        parts.extend(old.iter().chain(new).map(extent));
    }
}

fn is_same(a: &ClippedPrimitive, b: &ClippedPrimitive) -> bool {
    match (&a.primitive, &b.primitive) {
        (Primitive::Mesh(old), Primitive::Mesh(new)) => a.clip_rect == b.clip_rect && old == new,
        _ => false,
    }
}

/// The area that a primitive can paint.
fn extent(primitive: &ClippedPrimitive) -> Rect {
    match &primitive.primitive {
        Primitive::Mesh(mesh) => mesh.calc_bounds().intersect(primitive.clip_rect),
        Primitive::Callback(callback) => callback.rect.intersect(primitive.clip_rect),
    }
}

/// The part where two primitives differ: the moved or recoloured triangles if indices and texture
/// are equal, else all of both.
fn difference(old: &ClippedPrimitive, new: &ClippedPrimitive) -> Option<Rect> {
    if is_same(old, new) {
        return None;
    }
    let whole = extent(old).union(extent(new));
    let (Primitive::Mesh(from), Primitive::Mesh(to)) = (&old.primitive, &new.primitive) else {
        return Some(whole);
    };
    let are_alike = old.clip_rect == new.clip_rect
        && from.texture_id == to.texture_id
        && from.indices == to.indices
        && from.vertices.len() == to.vertices.len();
    if !are_alike {
        return Some(whole);
    }
    let mut part = Rect::NOTHING;
    for corners in to.indices.chunks_exact(3) {
        let corners = corners.iter().map(|&corner| corner as usize);
        if corners.clone().any(|corner| from.vertices[corner] != to.vertices[corner]) {
            for corner in corners {
                part.extend_with(from.vertices[corner].pos);
                part.extend_with(to.vertices[corner].pos);
            }
        }
    }
    Some(part.intersect(new.clip_rect))
}

/// Merges parts until they do not overlap.
fn disjoint(parts: Vec<Rect>) -> Vec<Rect> {
    let mut apart: Vec<Rect> = Vec::new();
    for mut part in parts.into_iter().filter(Rect::is_positive) {
        while let Some(other) = apart.iter().position(|other| other.intersects(part)) {
            part = part.union(apart.swap_remove(other));
        }
        apart.push(part);
    }
    if apart.len() > MOST_PARTS {
        return vec![apart.into_iter().fold(Rect::NOTHING, Rect::union)];
    }
    apart
}

/// A part, in points, extended to whole pixels and one more on each side.
pub fn on_pixels(part: Rect, pixels_per_point: f32) -> Rect {
    let low = (part.min.to_vec2() * pixels_per_point).floor() - egui::Vec2::ONE;
    let high = (part.max.to_vec2() * pixels_per_point).ceil() + egui::Vec2::ONE;
    let (low, high) = (low / pixels_per_point, high / pixels_per_point);
    Rect::from_min_max(pos2(low.x, low.y), pos2(high.x, high.y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rect(x: f32, y: f32) -> Rect {
        Rect::from_min_max(pos2(x, y), pos2(x + 10.0, y + 10.0))
    }

    fn filled(rects: &[(Rect, Color32)]) -> ClippedPrimitive {
        let mut mesh = Mesh::default();
        for (rect, color) in rects {
            mesh.add_colored_rect(*rect, *color);
        }
        ClippedPrimitive { clip_rect: Rect::EVERYTHING, primitive: Primitive::Mesh(mesh) }
    }

    #[test]
    fn identical_frames_need_no_repaint() {
        let frame = [filled(&[(rect(0.0, 0.0), Color32::RED)])];
        assert!(parts(&frame, &frame, &[]).is_empty());
        assert_eq!(parts(&[], &frame, &[]), [rect(0.0, 0.0)]);
        assert_eq!(parts(&frame, &frame, &[TextureId::default()]), [rect(0.0, 0.0)]);
    }

    #[test]
    fn only_the_changed_rectangle_is_repainted() {
        let bar = |color| filled(&[(rect(0.0, 0.0), Color32::RED), (rect(50.0, 0.0), color)]);
        let side = filled(&[(rect(0.0, 50.0), Color32::GREEN)]);
        let before = [bar(Color32::RED), side.clone()];
        assert_eq!(parts(&before, &[bar(Color32::BLUE), side.clone()], &[]), [rect(50.0, 0.0)]);
        // A menu between two unchanged primitives is the only part.
        let menu = filled(&[(rect(80.0, 80.0), Color32::BLUE)]);
        let opened = [before[0].clone(), menu, side];
        assert_eq!(parts(&before, &opened, &[]), [rect(80.0, 80.0)]);
        assert_eq!(parts(&opened, &before, &[]), [rect(80.0, 80.0)]);
    }

    #[test]
    fn repainted_rectangles_do_not_overlap() {
        let few = disjoint(vec![rect(0.0, 0.0), rect(100.0, 0.0), rect(5.0, 5.0)]);
        assert_eq!(few.len(), 2);
        assert!(few.contains(&rect(0.0, 0.0).union(rect(5.0, 5.0))), "{few:?}");
        let many = disjoint((0..6).map(|i| rect(20.0 * i as f32, 0.0)).collect());
        assert_eq!(many, [rect(0.0, 0.0).union(rect(100.0, 0.0))]);
        assert!(disjoint(vec![Rect::NOTHING]).is_empty());
    }

    #[test]
    fn a_rectangle_is_painted_by_the_primitives_it_overlaps() {
        let frame = [rect(0.0, 0.0), rect(100.0, 0.0)].map(|rect| filled(&[(rect, Color32::RED)]));
        let cut = cut(&frame, rect(5.0, 5.0));
        assert_eq!(cut.len(), 2, "the ground and one of two");
        assert!(cut.iter().all(|primitive| primitive.clip_rect == rect(5.0, 5.0)));
        assert_eq!(
            on_pixels(rect(0.4, 0.4), 2.0),
            Rect::from_min_max(pos2(-0.5, -0.5), pos2(11.0, 11.0))
        );
    }
}
