// The reflected light of a face, as if it were the same in all directions.
//
// A surface mirrors some of the incident light and lets the rest enter; the reflectance is the
// share of the entering light that comes out again. The mirrored share grows towards grazing
// angles; the voxels store its mean and its growth (gloss.rs), not its direction.

import package::voxels::list::{Face, LARGEST_REFLECTANCE};

// The mean of (1 - cosine)^4 over light from all around.
const GRAZING_MEAN = 1.0 / 15.0;

// The reflected share of light that arrives evenly from all directions.
fn reflected_from_all_around(face: Face) -> vec3f {
    let share = (1.0 - face.gloss.z) * face.reflectance + face.gloss.x;
    return min(share, vec3f(LARGEST_REFLECTANCE));
}

// The reflected share of light that arrives at this cosine.
fn reflected_from(face: Face, cosine: f32) -> vec3f {
    let rest = 1.0 - min(cosine, 1.0);
    let mirrored = face.gloss.x + face.gloss.y * (rest * rest * rest * rest - GRAZING_MEAN);
    return (1.0 - face.gloss.z) * face.reflectance + max(mirrored, 0.0);
}
