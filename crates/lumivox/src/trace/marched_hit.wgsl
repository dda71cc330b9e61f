// The light of a surface in a mirror, by marched cones: the module package::trace::hit_method.

import package::cones::cone::Traced;
import package::trace::reflections::Shown;

// A march finds no single surface.
fn light_of_hit(traced: Traced, place: vec3f, direction: vec3f, may_mirror: bool) -> Shown {
    return Shown(traced.radiance, vec3f(0.0), vec3f(0.0));
}
