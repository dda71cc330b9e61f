// The irradiance of a face by rays: the module package::light::way.
//
// A face keeps its rays, so that its gathers converge to a fixed point, and what they meet is found once: `hits` keeps it
// until surface moves. Each further gather only looks up what is there.

import package::cones::hemisphere::{basis, cell_cone, cell_jitter};
import package::cones::ray::{shown_by, trace_ray, Passed, Ray};
import package::cones::way::{cone_growth, cone_start};
import package::environment::environment_radiance;
import package::light::turn::{counts, hits, settings, FACE_RAYS, HIT_WORDS, RAY_CLASSES};
import package::volume::patch::{NOTHING, UNLIT};
import package::voxels::list::{Face, HIDDEN};

const PI: f32 = 3.14159265359;

// Hits are kept plus this; zero is unknown.
const OFFSET = 4u;
const UNKNOWN = 0u;

// Whether a ray has to be traced: it never was, its group is due after surface has moved, or it starts on dynamic surface or has met
// some, whose faces have no fixed places in the list.
fn is_outdated(hit: u32, face: u32, ray: u32) -> bool {
    let met = hit - OFFSET;
    let is_moving = face >= counts.fixed_faces || (met >= counts.fixed_faces && met < UNLIT);
    let is_in_turn = ((settings.rays_anew >> (ray % RAY_CLASSES)) & 1u) != 0u;
    return hit == UNKNOWN || is_in_turn || (is_moving && settings.rays_anew != 0u);
}

fn gathered_at(index: u32, face: Face, start: vec2f, level: u32) -> vec3f {
    if (face.flags & HIDDEN) != 0u {
        return vec3f(0.0);
    }
    let normal = normalize(face.vector_area);
    let origin = cone_start(face.position_in_world, normal, level, settings.cones);
    let world_from_normal = basis(normal);
    let jitter = cell_jitter(start, 0u);
    var sum = vec3f(0.0);
    var passed = Passed(0u, true, 1.0);
    for (var i = 0u; i < FACE_RAYS; i++) {
        let local = cell_cone(i, FACE_RAYS, jitter);
        let direction = world_from_normal * local.direction;
        let place = index * HIT_WORDS + i;
        if is_outdated(hits[place], index, i) {
            hits[place] = trace_ray(Ray(origin, direction, 3e38, level), &passed).face + OFFSET;
        }
        let met = hits[place] - OFFSET;
        if met == NOTHING {
            let growth = cone_growth(local.tan_half_angle, local.direction.z, settings.cones);
            sum += environment_radiance(direction, growth);
        } else {
            sum += shown_by(met);
        }
    }
    return sum * (PI / f32(FACE_RAYS));
}
