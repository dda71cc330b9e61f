// Samples a point on an emitter that may light a place.
//
// An emitter is chosen by descending the tree from its root: at each node one of the two children
// is sampled in proportion to its estimated contribution to the place (emitters::cluster). A point
// on the emitter is then sampled evenly over the solid angle that it subtends there (Arvo 1995,
// "Stratified sampling of spherical triangles"), so that nearby emitters add no noise. Points on
// emitters of a small solid angle are sampled evenly over the area: the result is equal, without
// loss of precision.

import package::emitters::cluster::{importance, unpack};
import package::emitters::emitter::{emitter_of, nodes_at, tree_levels, EmitterList};

@group(0) @binding(5) var<storage, read> emitters: EmitterList;

struct EmitterPoint {
    // The point, in the grid's coordinates.
    position: vec3f,
    // Normal of the emitter, on the side of the place; unit length.
    normal: vec3f,
    // Direction from the place to the point; unit length.
    direction: vec3f,
    radiance: vec3f,
    // Distance from the place to the point, in voxels.
    distance: f32,
    // The emitter's index in the list.
    index: u32,
    is_double_sided: bool,
    // One over the probability density of the direction, sr; 0 if no emitter lights the place.
    solid_angle: f32,
}

// Emitters of a smaller solid angle, sr, are sampled by area.
const SMALL_SOLID_ANGLE: f32 = 0.01;

// A sampled emitter.
struct Drawn {
    index: u32,
    // The probability of sampling this emitter; 0 if no emitter lights the place.
    share: f32,
    // The random numbers in [0, 1) that choose the point on the emitter.
    on: vec2f,
}

// The contributions of a node's two children to a place.
fn importances(node: u32, place: vec3f, normal: vec3f) -> vec2f {
    let record = emitters.records[node];
    return vec2f(
        importance(unpack(record[0], record[1]), place, normal),
        importance(unpack(record[2], record[3]), place, normal),
    );
}

// The contributions of the root's children, which all draws for a place share.
fn root_importances(place: vec3f, normal: vec3f) -> vec2f {
    return select(importances(emitters.count, place, normal), vec2f(1.0, 0.0), emitters.count == 1u);
}

// Chooses one of two children.
fn descend(drawn: Drawn, children: vec2f) -> Drawn {
    let both = children.x + children.y;
    let is_right = drawn.on.x * both >= children.x && children.y > 0.0;
    let share = select(children.x, children.y, is_right) / both;
    // Reuses the rest of the random number after it has chosen a child.
    let before = select(0.0, children.x / both, is_right);
    let rest = clamp((drawn.on.x - before) / share, 0.0, 0.99999994);
    let chosen =
        Drawn(2u * drawn.index + u32(is_right), drawn.share * share, vec2f(rest, drawn.on.y));
    if both <= 0.0 || drawn.share <= 0.0 {
        return Drawn(0u, 0.0, drawn.on);
    }
    return chosen;
}

// Samples an emitter; `random` is in [0, 1)^2, `root` from root_importances. The list must not be
// empty.
fn draw_emitter(place: vec3f, normal: vec3f, random: vec2f, root: vec2f) -> Drawn {
    let count = emitters.count;
    var drawn = Drawn(0u, 1.0, random);
    if count > 1u {
        drawn = descend(drawn, root);
    }
    let levels = tree_levels(count);
    var first = count + 1u;
    for (var level = max(levels, 1u) - 1u; level > 0u; level--) {
        drawn = descend(drawn, importances(first + drawn.index, place, normal));
        first += nodes_at(count, level);
    }
    return drawn;
}

// The part of a unit vector perpendicular to another, normalized.
fn away_from(vector: vec3f, base: vec3f) -> vec3f {
    let part = vector - dot(vector, base) * base;
    return part / max(length(part), 1e-12);
}

// A direction in the spherical triangle of three unit vectors; `volume` is their triple product.
fn direction_in(a: vec3f, b: vec3f, c: vec3f, volume: f32, solid_angle: f32, random: vec2f) -> vec3f {
    // The angle at a, between the planes of the sides.
    let of_a = vec2f(dot(cross(a, b), cross(a, c)), volume);
    let turn = of_a / max(length(of_a), 1e-12);
    let angle = atan2(turn.y, turn.x);
    let part = random.x * solid_angle - angle;
    let s = sin(part);
    let t = cos(part);
    let u = t - turn.x;
    let v = s + turn.y * dot(a, b);
    let q = ((v * t - u * s) * turn.x - v) / ((v * s + u * t) * turn.y);
    let cosine = clamp(q, -1.0, 1.0);
    let corner = cosine * a + sqrt(1.0 - cosine * cosine) * away_from(c, a);
    let z = 1.0 - random.y * (1.0 - dot(corner, b));
    return z * b + sqrt(max(1.0 - z * z, 0.0)) * away_from(corner, b);
}

fn point_of(drawn: Drawn, place: vec3f) -> EmitterPoint {
    let emitter = emitter_of(emitters.records[drawn.index]);
    let on = drawn.on;
    let corner = emitter.corner - place;
    let outward = cross(emitter.along_ab, emitter.along_ac);
    let twice_area = length(outward);
    let front = outward / twice_area;
    // The distance of the place in front of the emitter; negative behind it.
    let ahead = -dot(corner, front);
    let normal = select(front, -front, ahead < 0.0);
    let height = abs(ahead);
    var point = EmitterPoint(
        vec3f(0.0), normal, vec3f(0.0), emitter.radiance, 0.0, drawn.index, emitter.is_double_sided != 0u, 0.0);
    if emitter.power <= 0.0 || drawn.share <= 0.0 || (ahead <= 0.0 && emitter.is_double_sided == 0u) || height < 1e-4 {
        return point;
    }
    let a = normalize(corner);
    let b = normalize(corner + emitter.along_ab);
    let c = normalize(corner + emitter.along_ac);
    // Van Oosterom and Strackee 1983, "The solid angle of a plane triangle".
    let volume = abs(dot(a, cross(b, c)));
    let solid_angle = 2.0 * atan2(volume, 1.0 + dot(a, b) + dot(b, c) + dot(c, a));
    if solid_angle > SMALL_SOLID_ANGLE {
        let direction = direction_in(a, b, c, volume, solid_angle, on);
        let distance = -height / dot(direction, normal);
        point.direction = direction;
        point.position = place + distance * direction;
        point.distance = distance;
        point.solid_angle = solid_angle / drawn.share;
    } else {
        let root = sqrt(on.x);
        let local = corner + root * (1.0 - on.y) * emitter.along_ab + root * on.y * emitter.along_ac;
        let squared = dot(local, local);
        point.direction = local * inverseSqrt(squared);
        point.position = place + local;
        point.distance = sqrt(squared);
        point.solid_angle =
            0.5 * twice_area * abs(dot(point.direction, normal)) / (squared * drawn.share);
    }
    return point;
}
