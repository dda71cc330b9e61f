// The tracer's view of a volume with six lobes: the module package::volume. package::volume::cells
// defines where its cells are stored.
//
// Seen along d, a lobe with vector area N covers max(0, -d . N): exactly the coverage of a plane of
// that orientation, and zero from behind.

import package::constants::CELL_PARTS;
import package::volume::cells::{fetch, inside_share, load_part, parts_at, place_at, Place};
import package::volume::parts::{part_of, NEGATIVE, POSITIVE, TILT};

// Bit mask of the tilts of all axes.
const TILTS: u32 = 0x49u;

// Radiance times coverage, and coverage, of a lobe seen along a direction. `along` and `across` are
// the direction's components in the frame of the lobe; `along` is positive outwards.
fn seen(lobe: vec4f, tilt: vec2f, along: f32, across: vec2f) -> vec4f {
    let coverage = max(0.0, -(along * lobe.a + dot(across, tilt)));
    if coverage <= 0.0 || lobe.a <= 0.0 {
        return vec4f(0.0);
    }
    return vec4f(lobe.rgb * (coverage / lobe.a), coverage);
}

fn across_axis(direction: vec3f, axis: u32) -> vec2f {
    return vec2f(direction[(axis + 1u) % 3u], direction[(axis + 2u) % 3u]);
}

// The parts that are visible along a direction: on each axis the lobe that faces against the
// direction, and the other lobe only if something is tilted and the direction is more across the
// axis than along it. Otherwise only that lobe's back is visible, since a lobe's axis is the
// longest component of its normals.
fn parts_facing(parts: u32, direction: vec3f) -> u32 {
    var facing = 0u;
    for (var axis = 0u; axis < 3u; axis++) {
        let there = (parts >> (3u * axis)) & 7u;
        let along = direction[axis];
        let across = abs(across_axis(direction, axis));
        var wanted = select(4u, 2u, along < 0.0);
        if (there & 1u) != 0u && abs(along) < across.x + across.y {
            wanted = 6u;
        }
        let lobes = there & wanted;
        facing |= select(0u, lobes | (there & 1u), lobes != 0u) << (3u * axis);
    }
    return facing;
}

// A place in the volume where a sample may be taken: cheap to compute, and enough to detect empty
// space.
struct Probe {
    place: Place,
    // The visible parts; the sample is zero if 0.
    parts: u32,
}

fn probe_volume(position_in_grid: vec3f, level: u32, direction: vec3f) -> Probe {
    let place = place_at(position_in_grid, level);
    return Probe(place, parts_facing(parts_at(place), direction));
}

fn is_empty(probe: Probe) -> bool {
    return probe.parts == 0u;
}

// Whether a look-up is empty in all directions.
fn is_clear(position_in_grid: vec3f, level: u32) -> bool {
    return parts_at(place_at(position_in_grid, level)) == 0u;
}

// Whether a visible surface is oblique to the grid.
fn is_oblique(probe: Probe) -> bool {
    return (probe.parts & TILTS) != 0u;
}

// Radiance that leaves the surfaces around a probe against `direction`, times their coverage, and
// the coverage. The probe must not be empty.
fn sample_probe(probe: Probe, direction: vec3f) -> vec4f {
    var parts = probe.parts;
    var sum = vec4f(0.0);
    var tilt = vec4f(0.0);
    var tilted_axis = 3u;
    loop {
        let part = min(firstTrailingBit(parts), CELL_PARTS - 1u);
        let axis = part / 3u;
        let kind = part % 3u;
        let value = fetch(probe.place, part);
        if kind == TILT {
            tilt = value;
            tilted_axis = axis;
        } else {
            let own = select(vec4f(0.0), tilt, tilted_axis == axis);
            let is_positive = kind == POSITIVE;
            sum += seen(
                value,
                select(own.zw, own.xy, is_positive),
                select(-direction[axis], direction[axis], is_positive),
                across_axis(direction, axis),
            );
        }
        parts &= parts - 1u;
        continuing {
            break if parts == 0u;
        }
    }
    // The border's weight scales everything, vector areas included.
    return sum * inside_share(probe.place);
}

// The coverage of surfaces across an axis in cells of a level: in x of those that face along the
// axis, in y against it.
fn wall_coverage(position_in_grid: vec3f, level: u32, axis: u32) -> vec2f {
    let place = place_at(position_in_grid, level);
    let positive = fetch(place, part_of(axis, POSITIVE)).a;
    let negative = fetch(place, part_of(axis, NEGATIVE)).a;
    return vec2f(positive, negative) * inside_share(place);
}

// The value of `sample_probe` for one cell of a level, unfiltered.
fn load_cell(cell: vec3u, level: u32, direction: vec3f) -> vec4f {
    var sum = vec4f(0.0);
    for (var axis = 0u; axis < 3u; axis++) {
        let across = across_axis(direction, axis);
        let tilt = load_part(cell, level, part_of(axis, TILT));
        let positive = load_part(cell, level, part_of(axis, POSITIVE));
        let negative = load_part(cell, level, part_of(axis, NEGATIVE));
        sum += seen(positive, tilt.xy, direction[axis], across)
            + seen(negative, tilt.zw, -direction[axis], across);
    }
    return sum;
}
