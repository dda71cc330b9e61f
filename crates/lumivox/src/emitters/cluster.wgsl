// A cluster of nearby emitters: bounding box, power and cone of directions (Conty Estevez and Kulla
// 2018, "Importance sampling of many lights with adaptive tree splitting", sections 4.1 and 4.4).

import package::emitters::emitter::{Emitter, Record};

struct Cluster {
    // The box around the emitters, in the grid's coordinates.
    centre: vec3f,
    half_size: vec3f,
    // Power of the emitters; 0 if the cluster is empty.
    power: f32,
    // The axis of a cone that contains the normals of all emitters; `cosine` is that of its half
    // angle.
    axis: vec3f,
    cosine: f32,
    // 1 if some of the emitters may emit to the back as well.
    is_double_sided: u32,
}

fn no_cluster() -> Cluster {
    return Cluster(vec3f(0.0), vec3f(0.0), 0.0, vec3f(0.0, 0.0, 1.0), 1.0, 0u);
}

fn cluster_of(emitter: Emitter) -> Cluster {
    if emitter.power <= 0.0 {
        return no_cluster();
    }
    let b = emitter.along_ab;
    let c = emitter.along_ac;
    let low = min(vec3f(0.0), min(b, c));
    let high = max(vec3f(0.0), max(b, c));
    let centre = emitter.corner + 0.5 * (low + high);
    let axis = normalize(cross(b, c));
    return Cluster(centre, 0.5 * (high - low), emitter.power, axis, 1.0, emitter.is_double_sided);
}

// The smallest cone around two cones (Pharr, Jakob and Humphreys 2023, "Physically based
// rendering", section 3.8.4).
fn unite(a: Cluster, b: Cluster) -> Cluster {
    if a.power <= 0.0 {
        return b;
    }
    if b.power <= 0.0 {
        return a;
    }
    let low = min(a.centre - a.half_size, b.centre - b.half_size);
    let high = max(a.centre + a.half_size, b.centre + b.half_size);
    var all = Cluster(
        0.5 * (low + high), 0.5 * (high - low), a.power + b.power,
        a.axis, a.cosine, max(a.is_double_sided, b.is_double_sided),
    );
    // Double-sided surfaces face both ways.
    var other = b.axis;
    if all.is_double_sided != 0u && dot(a.axis, other) < 0.0 {
        other = -other;
    }
    let between = acos(clamp(dot(a.axis, other), -1.0, 1.0));
    let of_a = acos(clamp(a.cosine, -1.0, 1.0));
    let of_b = acos(clamp(b.cosine, -1.0, 1.0));
    if min(between + of_b, 3.14159265) <= of_a {
        return all;
    }
    if min(between + of_a, 3.14159265) <= of_b {
        all.axis = other;
        all.cosine = b.cosine;
        return all;
    }
    let half_angle = 0.5 * (of_a + between + of_b);
    let aside = other - dot(other, a.axis) * a.axis;
    let size = length(aside);
    if half_angle >= 3.14159265 || size < 1e-6 {
        all.cosine = -1.0;
        return all;
    }
    let turn = half_angle - of_a;
    all.axis = cos(turn) * a.axis + sin(turn) / size * aside;
    all.cosine = cos(half_angle);
    return all;
}

// Packs a cluster into half a record. Rounding to 16 bits never makes sizes too small or cosines
// too large, so no emitter is lost.
fn pack(cluster: Cluster) -> array<vec4u, 2> {
    let half_size = min(cluster.half_size * 1.001 + 1e-4, vec3f(65000.0));
    var cosine = max(cluster.cosine, -1.0);
    if unpack2x16float(pack2x16float(vec2f(cosine, 0.0))).x > cosine {
        cosine = max(cosine - 0.001, -1.0);
    }
    return array(
        vec4u(bitcast<vec3u>(cluster.centre), bitcast<u32>(cluster.power)),
        vec4u(
            pack2x16float(half_size.xy),
            pack2x16float(vec2f(half_size.z, cosine)),
            pack2x16snorm(cluster.axis.xy),
            pack2x16snorm(vec2f(cluster.axis.z, f32(cluster.is_double_sided))),
        ),
    );
}

fn unpack(place: vec4u, shape: vec4u) -> Cluster {
    let size_and_cosine = unpack2x16float(shape.y);
    let axis_and_sides = unpack2x16snorm(shape.w);
    return Cluster(
        bitcast<vec3f>(place.xyz),
        vec3f(unpack2x16float(shape.x), size_and_cosine.x),
        bitcast<f32>(place.w),
        vec3f(unpack2x16snorm(shape.z), axis_and_sides.x),
        size_and_cosine.y,
        u32(axis_and_sides.y > 0.5),
    );
}

// The cosine of the difference of two angles, or 1 if it is negative; both are within [0, pi].
fn cosine_of_rest(cosine: f32, less: f32) -> f32 {
    if cosine >= less {
        return 1.0;
    }
    return cosine * less + sqrt(max((1.0 - cosine * cosine) * (1.0 - less * less), 0.0));
}

// Estimates the contribution of a cluster to a place on a surface, without occlusion; 0 only if the
// contribution is 0.
//
// Along a line from the nearest to the farthest of its emitters, the mean of 1 / d^2 is one over
// the product of both distances. The nearest distance is at least NEAREST times the cluster's
// radius: with a fourth of the radius instead, places near long tubes have 50 % more noise
// (docs/notebook.md).
const NEAREST: f32 = 0.15;

fn importance(cluster: Cluster, place: vec3f, normal: vec3f) -> f32 {
    let to_centre = cluster.centre - place;
    // The condition's sum is the distance that the box extends in front of the surface.
    if cluster.power <= 0.0 || dot(normal, to_centre) + dot(abs(normal), cluster.half_size) <= 0.0 {
        return 0.0;
    }
    let behind = dot(cluster.axis, to_centre) - dot(abs(cluster.axis), cluster.half_size);
    if cluster.cosine >= 1.0 && cluster.is_double_sided == 0u && behind >= 0.0 {
        return 0.0;
    }
    let squared = dot(to_centre, to_centre);
    let radius_squared = dot(cluster.half_size, cluster.half_size);
    let nearest = length(max(abs(to_centre) - cluster.half_size, vec3f(0.0)));
    let farthest = length(abs(to_centre) + cluster.half_size);
    let strength = cluster.power / (max(nearest, NEAREST * sqrt(radius_squared)) * farthest);
    if squared <= radius_squared {
        return strength;
    }
    let direction = to_centre * inverseSqrt(squared);
    // Half the angle that the sphere around the box subtends.
    let spread = sqrt(1.0 - radius_squared / squared);
    let ahead = -dot(cluster.axis, direction);
    let facing = select(ahead, abs(ahead), cluster.is_double_sided != 0u);
    let leaving = cosine_of_rest(cosine_of_rest(facing, cluster.cosine), spread);
    let arriving = cosine_of_rest(dot(normal, direction), spread);
    return strength * max(leaving, 0.0) * max(arriving, 0.0);
}
