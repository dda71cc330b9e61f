// Irradiance at a surface by marched cones: the module package::trace::gather_method.

import package::cones::cone::ConeSettings;
import package::cones::gather::{gather, Gathered};
import package::volume::far_light::Known;

// Marched cones use no known light.
fn find_known(position_in_world: vec3f, normal: vec3f, level: u32) {
}

fn known_from(local: vec3f) -> Known {
    return Known(vec3f(0.0), 0.0, false);
}

fn gather_surface(
    position_in_world: vec3f,
    shading_normal: vec3f,
    geometric_normal: vec3f,
    level: u32,
    cone_count: u32,
    start: vec2f,
    frame: u32,
    settings: ConeSettings,
) -> Gathered {
    return gather(
        position_in_world, shading_normal, geometric_normal, level, cone_count, start, frame, settings);
}
