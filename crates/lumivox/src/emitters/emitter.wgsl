// Emissive triangles, as lights.

struct Emitter {
    // A corner and the edges from it, in the grid's coordinates; counter-clockwise seen from the
    // front.
    corner: vec3f,
    // Strength times area, summed over both sides if both emit.
    power: f32,
    along_ab: vec3f,
    // 1 if it emits to the back as well.
    is_double_sided: u32,
    along_ac: vec3f,
    padding_0: u32,
    // Radiance, constant over the triangle.
    radiance: vec3f,
    padding_1: u32,
}

// An emitter, or a node of the tree over them (emitters::tree).
alias Record = array<vec4u, 4>;

struct EmitterList {
    count: u32,
    // Nonzero while all rays see emission, so that no emitter is sampled: from a change of the
    // voxels to the next lighting.
    is_shown: u32,
    padding_0: u32,
    padding_1: u32,
    // The emitters in Morton order, then the nodes of the tree, level by level from its root.
    records: array<Record>,
}

// The weight of a radiance in sampling: all channels count equally. With luminance, rare blue
// samples would have thirteen times their share, and be noise.
fn strength(radiance: vec3f) -> f32 {
    return dot(radiance, vec3f(1.0 / 3.0));
}

// Number of emitters before and after one in the list that are searched for parts of the same body.
const NEIGHBOURS: u32 = 64u;

// The distance of rays without a hit.
const FAR: f32 = 3e38;

// The distance along a ray to an emitter (Möller and Trumbore 1997, "Fast, minimum storage
// ray/triangle intersection").
fn distance_to(emitter: Emitter, origin: vec3f, direction: vec3f) -> f32 {
    let across = cross(direction, emitter.along_ac);
    let volume = dot(emitter.along_ab, across);
    let from_corner = origin - emitter.corner;
    let aside = cross(from_corner, emitter.along_ab);
    let u = dot(from_corner, across) / volume;
    let v = dot(direction, aside) / volume;
    let distance = dot(emitter.along_ac, aside) / volume;
    let is_met = emitter.power > 0.0 && volume != 0.0
        && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 1e-4;
    return select(FAR, distance, is_met);
}

fn record_of(emitter: Emitter) -> Record {
    return Record(
        vec4u(bitcast<vec3u>(emitter.corner), bitcast<u32>(emitter.power)),
        vec4u(bitcast<vec3u>(emitter.along_ab), emitter.is_double_sided),
        vec4u(bitcast<vec3u>(emitter.along_ac), 0u),
        vec4u(bitcast<vec3u>(emitter.radiance), 0u),
    );
}

fn emitter_of(record: Record) -> Emitter {
    return Emitter(
        bitcast<vec3f>(record[0].xyz), bitcast<f32>(record[0].w),
        bitcast<vec3f>(record[1].xyz), record[1].w,
        bitcast<vec3f>(record[2].xyz), 0u,
        bitcast<vec3f>(record[3].xyz), 0u,
    );
}

// The number of levels of nodes above the emitters: 0 for a single emitter.
fn tree_levels(count: u32) -> u32 {
    return 32u - countLeadingZeros(max(count, 1u) - 1u);
}

// The number of nodes of a level, each with two children in the level below; level 0 is the
// emitters.
fn nodes_at(count: u32, level: u32) -> u32 {
    return (count + (1u << level) - 1u) >> level;
}
