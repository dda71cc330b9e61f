// The irradiance of a face from the hits of its rays (find.wgsl): the module
// package::light::gather_method.

import package::cones::hemisphere::{basis, cell_cone};
import package::cones::ray::shown_by;
import package::cones::trace_method::cone_growth;
import package::constants::{HIDDEN, HIT_WORDS, PI};
import package::environment::environment_radiance;
import package::light::turn::{face_jitter, hits, settings, FACE_RAYS, HIT_OFFSET};
import package::volume::patch::NOTHING;
import package::voxels::list::Face;

fn gathered_at(index: u32, face: Face, level: u32) -> vec3f {
    if (face.flags & HIDDEN) != 0u {
        return vec3f(0.0);
    }
    var sum = vec3f(0.0);
    var open = 0u;
    for (var i = 0u; i < FACE_RAYS; i++) {
        let met = hits[index * HIT_WORDS + i] - HIT_OFFSET;
        sum += shown_by(met, settings.has_emitters == 0u);
        open |= u32(met == NOTHING) << i;
    }
    // The rays that leave the grid, a loop of their own: in closed rooms there are none.
    let world_from_normal = basis(normalize(face.vector_area));
    let jitter = face_jitter(face);
    loop {
        let local = cell_cone(firstTrailingBit(open) % FACE_RAYS, FACE_RAYS, jitter);
        let growth = cone_growth(local.tan_half_angle, local.direction.z, settings.cones);
        let outside = environment_radiance(world_from_normal * local.direction, growth);
        sum += select(vec3f(0.0), outside, open != 0u);
        open &= open - 1u;
        continuing {
            break if open == 0u;
        }
    }
    return sum * (PI / f32(FACE_RAYS));
}
