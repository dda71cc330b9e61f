// The nearest emitter along a ray.

import package::emitters::cluster::{unpack, Cluster};
import package::emitters::draw::{emitters, EmitterPoint};
import package::emitters::emitter::{distance_to, emitter_of, nodes_at, tree_levels, FAR};

// An emitter that a ray hits.
struct Met {
    index: u32,
    // Distance from the ray's origin, in voxels; FAR if no emitter is hit.
    distance: f32,
}

// Whether a ray hits the box of a cluster nearer than `limit`. `inverse` is one over the ray's
// direction, in which zeros are replaced.
fn may_meet(cluster: Cluster, origin: vec3f, inverse: vec3f, limit: f32) -> bool {
    let to_centre = (cluster.centre - origin) * inverse;
    let reach = cluster.half_size * abs(inverse);
    let enters = to_centre - reach;
    let leaves = to_centre + reach;
    let first = max(max(enters.x, enters.y), enters.z);
    let last = min(min(leaves.x, leaves.y), leaves.z);
    return cluster.power > 0.0 && last >= max(first, 0.0) && first < limit;
}

// The nearest emitter along a ray; one-sided emitters are hit only from the front. The list must
// not be empty.
//
// The tree is complete, so it can be searched depth-first without a stack: from a missed node or an
// emitter, the search climbs until it has come from a left child.
fn emitter_along(origin: vec3f, direction: vec3f) -> Met {
    var met = Met(0u, FAR);
    let count = emitters.count;
    let inverse = 1.0 / select(direction, vec3f(1e-20), abs(direction) < vec3f(1e-20));
    let top = tree_levels(count);
    var level = top;
    var index = 0u;
    // The first record of the level above.
    var above = count;
    // Every step of the loop visits a node or an emitter.
    for (;;) {
        var goes_down = level == top && level > 0u;
        if level < top {
            let node = emitters.records[above + index / 2u];
            let place = select(node[0], node[2], (index & 1u) != 0u);
            let shape = select(node[1], node[3], (index & 1u) != 0u);
            goes_down = may_meet(unpack(place, shape), origin, inverse, met.distance);
        }
        if level == 0u && (goes_down || top == 0u) {
            let emitter = emitter_of(emitters.records[index]);
            let distance = distance_to(emitter, origin, direction);
            let facing = -dot(cross(emitter.along_ab, emitter.along_ac), direction);
            if distance < met.distance && (facing > 0.0 || emitter.is_double_sided != 0u) {
                met = Met(index, distance);
            }
            goes_down = false;
        }
        if goes_down {
            if level < top {
                above += nodes_at(count, level + 1u);
            }
            level -= 1u;
            index *= 2u;
            continue;
        }
        while (index & 1u) != 0u {
            index /= 2u;
            level += 1u;
            if level < top {
                above -= nodes_at(count, level + 1u);
            }
        }
        index += 1u;
        if level == top || index >= nodes_at(count, level) {
            break;
        }
    }
    return met;
}

// The point that a ray from `place` hits. Its solid angle is 0, since it was not drawn.
fn point_along(met: Met, place: vec3f, direction: vec3f) -> EmitterPoint {
    let emitter = emitter_of(emitters.records[met.index]);
    let front = normalize(cross(emitter.along_ab, emitter.along_ac));
    return EmitterPoint(
        place + met.distance * direction,
        select(front, -front, dot(front, direction) > 0.0),
        direction,
        emitter.radiance,
        met.distance,
        met.index,
        emitter.is_double_sided != 0u,
        0.0,
    );
}
