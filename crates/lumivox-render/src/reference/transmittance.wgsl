// The light that the surfaces between a point and a light let through.

import package::constants::{NO_TRIANGLE, REFERENCE_SEE_THROUGH, TRIANGLE_SEE_THROUGH};
import package::render::reference::intersect::{intersect, ray_from};
import package::render::reference::scatter::Surface;
import package::render::reference::sources::Question;
import package::render::reference::surface::meet;
import package::render::reference::world::triangle_at;

// The most panes and holes that a ray can pass.
const MOST_LAYERS: u32 = 64u;

// The transmitted share of light along a ray, by colour.
fn transmittance(question: Question, surface: Surface) -> vec3f {
    var ray = ray_from(surface.position, surface.geometric, question.direction, question.reach);
    if REFERENCE_SEE_THROUGH == 0u {
        return select(vec3f(0.0), vec3f(1.0), intersect(ray, question.sides, true).triangle == NO_TRIANGLE);
    }
    var passing = vec3f(1.0);
    for (var layer = 0u; layer < MOST_LAYERS; layer++) {
        let hit = intersect(ray, question.sides, true);
        if hit.triangle == NO_TRIANGLE {
            break;
        }
        if (triangle_at(hit.triangle).vertex_0 & TRIANGLE_SEE_THROUGH) == 0u {
            return vec3f(0.0);
        }
        let met = meet(ray, hit, false);
        passing *= (1.0 - met.coverage) * met.tint;
        if all(passing <= vec3f(0.0)) {
            break;
        }
        let left = ray.reach - hit.distance;
        ray = ray_from(met.surface.position, -met.surface.geometric, ray.direction, left);
    }
    return passing;
}
