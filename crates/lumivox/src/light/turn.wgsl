// Whose turn it is: faces gather a share at a time.

import package::cones::cone::ConeSettings;
import package::voxels::counts::ListCounts;
import package::voxels::list::Face;

struct BounceSettings {
    cones: ConeSettings,
    cone_count: u32,
    // The most faces that gather at a time, and the number of the time: they take turns.
    faces_at_a_time: u32,
    turn: u32,
    // Whether there are emitters.
    has_emitters: u32,
}

@group(1) @binding(0) var<uniform> settings: BounceSettings;
@group(1) @binding(1) var<uniform> counts: ListCounts;
@group(1) @binding(2) var<storage, read> faces: array<Face>;
// In rgb; w is 1 once a face has gathered.
@group(1) @binding(3) var<storage, read_write> irradiance: array<vec4f>;
// The part of it that comes straight from emitters.
@group(1) @binding(4) var<storage, read_write> from_emitters: array<vec4f>;

// How many turns there are until all faces have gathered.
fn turns() -> u32 {
    let most = max(settings.faces_at_a_time, 1u);
    return max((counts.faces + most - 1u) / most, 1u);
}

// Of the faces whose turn it is; beyond the last one there may be more.
fn face_in_turn(place: u32) -> u32 {
    let all = turns();
    return place * all + settings.turn % all;
}

// Whether a face has never gathered, though it is not its turn.
fn is_fresh(face: u32) -> bool {
    let all = turns();
    return face < counts.faces && face % all != settings.turn % all && irradiance[face].w == 0.0;
}
