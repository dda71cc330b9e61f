// Which faces gather in a turn.

import package::cascades::{cascade_of, voxel_of};
import package::cones::cone::ConeSettings;
import package::constants::{HIT_WORDS, RAREST_CASCADE};
import package::gpu::random::{hash, random_pair};
import package::voxels::counts::ListCounts;
import package::voxels::list::{Face, lobe_axis};
import package::voxels::morton::morton_decode;

struct BounceSettings {
    cones: ConeSettings,
    cone_count: u32,
    // The maximum number of faces that gather in a turn, and the number of the turn.
    faces_at_a_time: u32,
    turn: u32,
    // Whether there are emitters.
    has_emitters: u32,
    // Whether faces gather by cascade: those of coarse cascades less often.
    by_cascade: u32,
    // Whether some faces of static surface may never have gathered.
    is_list_new: u32,
    // The rays that are traced again: a bit for each of RAY_CLASSES, zero if nothing has moved.
    rays_anew: u32,
    padding: u32,
}

@group(1) @binding(0) var<uniform> settings: BounceSettings;
@group(1) @binding(1) var<uniform> counts: ListCounts;
@group(1) @binding(2) var<storage, read> faces: array<Face>;
// Gathered irradiance in rgb; w is 1 once a face has gathered.
@group(1) @binding(3) var<storage, read_write> irradiance: array<vec4f>;
// HIT_WORDS for each face: the hits of its FACE_RAYS rays, the adjacent faces (find.wgsl), and the
// irradiance straight from emitters.
@group(1) @binding(4) var<storage, read_write> hits: array<u32>;

const FACE_RAYS = 16u;

// The adjacent faces on the same surface, after the rays: the previous and the next one along each
// axis.
const FIRST_BESIDE = FACE_RAYS;
const FACES_BESIDE = 4u;
const FROM_EMITTERS = FIRST_BESIDE + FACES_BESIDE;

// Hits are stored plus this offset; zero is unknown.
const HIT_OFFSET = 4u;

// A face's start in the jitter's sequence. It is the same for all bounces, so that they converge to
// a fixed point.
fn face_start(face: Face) -> vec2f {
    return random_pair(face.cell, hash(face.lobe));
}

// The edge of the squares of faces that share far light.
const SHARING_FACES = 7u;
// Adjacent faces have jitters far apart, so that a square cut off at a border also has well spread
// ones.
const JITTER_STEP = 3u;

// The jitter of a face's rays within their cells. Any square of SHARING_FACES x SHARING_FACES faces
// has evenly distributed jitters: in a grid, and along both of its sides.
fn face_jitter(face: Face) -> vec2f {
    let voxel = vec3u(voxel_of(morton_decode(face.cell)).voxel + 0x400000);
    let axis = lobe_axis(face.lobe);
    let along = vec2u(voxel[(axis + 1u) % 3u], voxel[(axis + 2u) % 3u]);
    let square = vec2f(along % SHARING_FACES * JITTER_STEP % SHARING_FACES);
    return (square + (square.yx + 0.5) / f32(SHARING_FACES)) / f32(SHARING_FACES);
}

fn from_emitters(face: u32) -> vec3f {
    let first = face * HIT_WORDS + FROM_EMITTERS;
    return bitcast<vec3f>(vec3u(hits[first], hits[first + 1u], hits[first + 2u]));
}

fn keep_from_emitters(face: u32, irradiance_of_them: vec3f) {
    let bits = bitcast<vec3u>(irradiance_of_them);
    let first = face * HIT_WORDS + FROM_EMITTERS;
    for (var i = 0u; i < 3u; i++) {
        hits[first + i] = bits[i];
    }
}

// The number of turns until all faces have gathered, if they are not grouped by cascade.
fn turns() -> u32 {
    let most = max(settings.faces_at_a_time, 1u);
    return max((counts.faces + most - 1u) / most, 1u);
}

// Whether a face gathers in this turn. By cascade: the finest in each turn, the next in every
// second turn, then in every fourth, ...
fn is_in_turn(face: u32) -> bool {
    if settings.by_cascade != 0u {
        let cascade = cascade_of(morton_decode(faces[face].cell));
        return (settings.turn + cascade) % (1u << min(cascade, RAREST_CASCADE)) == 0u;
    }
    let all = turns();
    return face % all == settings.turn % all;
}

// The face at a place among those that gather in this turn; an index out of range if there is none.
fn face_in_turn(place: u32) -> u32 {
    if settings.by_cascade != 0u {
        return select(counts.faces, place, place < counts.faces && is_in_turn(place));
    }
    let all = turns();
    return place * all + settings.turn % all;
}

// The first face that may never have gathered.
fn first_fresh() -> u32 {
    return select(counts.fixed_faces, 0u, settings.is_list_new != 0u);
}

// Whether a face has never gathered and does not gather in this turn.
fn is_fresh(face: u32) -> bool {
    return face < counts.faces && irradiance[face].w == 0.0 && !is_in_turn(face);
}
