// The irradiance of a face by marched cones: the module package::light::gather_method.

import package::cones::gather::gather;
import package::light::turn::{face_start, settings};
import package::voxels::list::Face;

fn gathered_at(index: u32, face: Face, level: u32) -> vec3f {
    let normal = normalize(face.vector_area);
    let gathered = gather(
        face.position_in_world, normal, normal, level, settings.cone_count, face_start(face), 0u, settings.cones);
    // With few cones the sum may be negative (march.wgsl).
    return max(gathered.irradiance, vec3f(0.0));
}
