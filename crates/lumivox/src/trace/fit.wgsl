// The share of arriving light that two places have in common. Light gathered by cones is smooth
// below the size of a voxel, so the fit of a place falls to zero within a voxel off the surface's
// plane, and falls with the angle between the normals.

import package::cascades::voxel_size_at;
import package::trace::surface::Surface;

// 1 on the same surface, 0 on another. `offset` is from the surface to the other place, m.
fn fit(offset: vec3f, normal: vec3f, surface: Surface) -> f32 {
    let off_plane = abs(dot(offset, surface.geometric_normal));
    let facing = max(dot(normal, surface.shading_normal), 0.0);
    let facing_2 = facing * facing;
    return max(1.0 - off_plane / voxel_size_at(surface.position_in_world), 0.0) * facing_2 * facing_2;
}
