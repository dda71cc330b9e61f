// The light that leaves a face, looked at as if it were the same in all directions.
//
// Of what arrives a surface mirrors some and lets the rest enter, of which its reflectance comes back. What is mirrored
// grows towards grazing angles; the voxels know its mean and how it grows (gloss.rs), not where it goes.

import package::voxels::list::{Face, LARGEST_REFLECTANCE};

// The mean of (1 - cosine)^4 over light from all around.
const GRAZING_MEAN = 1.0 / 15.0;

// The share that leaves of light that arrives evenly from all around.
fn reflected_from_all_around(face: Face) -> vec3f {
    let share = (1.0 - face.gloss.z) * face.reflectance + face.gloss.x;
    return min(share, vec3f(LARGEST_REFLECTANCE));
}

// The share that leaves of light that arrives at this cosine.
fn reflected_from(face: Face, cosine: f32) -> vec3f {
    let rest = 1.0 - min(cosine, 1.0);
    let mirrored = face.gloss.x + face.gloss.y * (rest * rest * rest * rest - GRAZING_MEAN);
    return (1.0 - face.gloss.z) * face.reflectance + max(mirrored, 0.0);
}
