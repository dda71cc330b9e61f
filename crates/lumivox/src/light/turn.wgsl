// Which faces gather in a turn.

import package::cascades::{cascade_of, voxel_of};
import package::cones::cone::ConeSettings;
import package::constants::{HIT_WORDS, MOVED_BOXES, RAREST_CASCADE};
import package::gpu::random::{hash, random_pair};
import package::volume::far_light::power_of_two;
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
    // The rays that are traced again, and the groups of faces that sample emitters again: a bit for
    // each of RAY_CLASSES, zero if nothing has moved.
    rays_anew: u32,
    // Whether gathers are accelerated (bounce.wgsl).
    relaxes: u32,
    // Whether all faces sample emitters again.
    shines_on_all: u32,
    // Number of latest boxes that cover all surface moved since the oldest stored hit was traced,
    // and since the emitters' oldest stored irradiance; zero if unknown.
    boxes: u32,
    // The place of the last of these boxes.
    box_written: u32,
    // Whether the list of dynamic surface is new.
    has_moved: u32,
}

@group(1) @binding(0) var<uniform> settings: BounceSettings;
@group(1) @binding(1) var<uniform> counts: ListCounts;
// Boxes around the voxels that dynamic surface touched after each of the last moves
// (box_moved.wgsl). Each is two vectors: MOST_COORDINATE minus its low corner, and its high corner;
// zeros if there were no such voxels.
@group(1) @binding(2) var<uniform> boxes: array<vec4u, 2 * MOVED_BOXES>;
@group(1) @binding(3) var<storage, read> faces: array<Face>;
// Gathered irradiance in rgb; w is the number of gathers from the last plain one on, or 0 if the
// face has never gathered.
@group(1) @binding(4) var<storage, read_write> irradiance: array<vec4f>;
// HIT_WORDS for each face: the hits of its FACE_RAYS rays, the adjacent faces (find.wgsl), the
// irradiance straight from emitters, and the last step of the accelerated gathers.
@group(1) @binding(5) var<storage, read_write> hits: array<u32>;

const FACE_RAYS = 16u;

// The adjacent faces on the same surface, after the rays: the previous and the next one along each
// axis.
const FIRST_BESIDE = FACE_RAYS;
const FACES_BESIDE = 4u;
const FROM_EMITTERS = FIRST_BESIDE + FACES_BESIDE;
const LAST_STEP = FROM_EMITTERS + 3u;

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

// Added to exponents of steps, so that none is negative.
const STEP_BIAS = 16;

// The change of a face's irradiance by its last gather, stored in a word: three signed numbers of
// nine bits with a common exponent.
fn last_step(face: u32) -> vec3f {
    let word = hits[face * HIT_WORDS + LAST_STEP];
    let numbers = vec3i(vec3u(word << 23u, word << 14u, word << 5u)) >> vec3u(23u);
    return vec3f(numbers) * power_of_two(i32(word >> 27u) - STEP_BIAS - 8);
}

fn keep_last_step(face: u32, step: vec3f) {
    let most = max(max(abs(step.r), abs(step.g)), abs(step.b));
    // The exponent of a power of two above `most`.
    let above = i32(bitcast<u32>(most) >> 23u) - 126;
    let exponent = clamp(above, -STEP_BIAS, 31 - STEP_BIAS);
    let numbers = vec3i(clamp(round(step * power_of_two(8 - exponent)), vec3f(-255.0), vec3f(255.0)));
    let bits = vec3u(numbers) & vec3u(0x1ffu);
    hits[face * HIT_WORDS + LAST_STEP] =
        bits.x | (bits.y << 9u) | (bits.z << 18u) | (u32(exponent + STEP_BIAS) << 27u);
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

const BOX_WORDS = 8u;
// More than any coordinate of a box.
const MOST_COORDINATE = 0xffffu;

// Hits may change by this distance around surface that has moved, in voxels.
const AROUND = 2.0;

// A box in the grid's coordinates; empty if `low` is above `high`.
struct Box {
    low: vec3f,
    high: vec3f,
}

// The box around dynamic surface before and after the last `moves` moves.
fn moved_box(moves: u32) -> Box {
    var words = array<vec4u, 2>();
    for (var i = 0u; i < min(settings.boxes, moves + 1u); i++) {
        let place = 2u * ((settings.box_written + MOVED_BOXES - i) % MOVED_BOXES);
        words[0] = max(words[0], boxes[place]);
        words[1] = max(words[1], boxes[place + 1u]);
    }
    let low = vec3f(MOST_COORDINATE - words[0].xyz);
    return Box(low - AROUND, select(vec3f(words[1].xyz) + AROUND, low - 2.0 * AROUND, words[1].x == 0u));
}

// Whether a line from a point to any point of a box `to` meets the box `around`. After the share t
// of the way, these lines fill the box whose corners are at this share of the way to those of `to`.
// Both boxes overlap if t satisfies a linear condition for each of their sides.
fn may_meet(origin: vec3f, to: Box, around: Box) -> bool {
    let to_low = to.low - origin;
    let to_high = origin - to.high;
    let low = select(to_low, vec3f(1e-9), abs(to_low) < vec3f(1e-9));
    let high = select(to_high, vec3f(1e-9), abs(to_high) < vec3f(1e-9));
    // t * low <= around.high - origin, and t * high <= origin - around.low.
    let of_low = (around.high - origin) / low;
    let of_high = (origin - around.low) / high;
    let first = max(select(vec3f(0.0), of_low, low < vec3f(0.0)), select(vec3f(0.0), of_high, high < vec3f(0.0)));
    let last = min(select(vec3f(1.0), of_low, low > vec3f(0.0)), select(vec3f(1.0), of_high, high > vec3f(0.0)));
    let start = max(max(first.x, first.y), max(first.z, 0.0));
    return start <= min(min(last.x, last.y), min(last.z, 1.0));
}

// The first face that may never have gathered.
fn first_fresh() -> u32 {
    return select(counts.fixed_faces, 0u, settings.is_list_new != 0u);
}

// Whether a face has never gathered and does not gather in this turn.
fn is_fresh(face: u32) -> bool {
    return face < counts.faces && irradiance[face].w == 0.0 && !is_in_turn(face);
}
