// Irradiance at a surface: the module package::trace::gather_method.
//
// Light from farther away than NEAR is known: the faces around have gathered it (light/far.wgsl,
// light/share_far.wgsl), and it is summed over the hemisphere without sampling. Rays find nearer
// surfaces, whose light replaces the known light in their direction. Without known light, rays find
// all surfaces.

import package::cones::cone::ConeSettings;
import package::cones::gather::Gathered;
import package::cones::hemisphere::{basis, cell_cone, cell_jitter};
import package::cones::ray::{shown_by, trace_ray, Passed, Ray};
import package::cones::trace_method::{cone_growth, cone_start};
import package::constants::{FAR_CELLS, PI};
import package::emitters::gather::has_emitters;
import package::environment::environment_radiance;
import package::grid::grid_from_world;
import package::volume::beside::{is_parted, spot_at};
import package::volume::far_light::{mean_of, with_far_light, FarSum, Known, NEAR};
import package::volume::patch::NOTHING;
import package::volume::surface::{far_cells, far_texel};

// The cell of FAR_CELLS that contains a direction: cell_cone of hemisphere.wgsl has 5 cells in the
// inner ring and 11 in the outer one.
const INNER_CELLS = 5.0;

fn cell_of(local: vec3f) -> u32 {
    let is_inner = (1.0 - local.z * local.z) * f32(FAR_CELLS) < INNER_CELLS;
    let ring = select(f32(FAR_CELLS) - INNER_CELLS, INNER_CELLS, is_inner);
    let turn = fract(atan2(local.y, local.x) / 6.28318530718 + 1.0);
    return u32(select(INNER_CELLS, 0.0, is_inner) + min(floor(turn * ring), ring - 1.0));
}

// The four faces around a point of a surface, and their weights: 0 for a face of another surface.
var<private> faces_around: array<u32, 4>;
var<private> weights_around: array<f32, 4>;

// Finds the four faces around a point, with bilinear weights.
fn find_known(position_in_world: vec3f, normal: vec3f, level: u32) {
    let point = grid_from_world(position_in_world) * exp2(-f32(level));
    let size = abs(normal);
    let axis = select(select(2u, 1u, size.y > size.z), 0u, size.x > max(size.y, size.z));
    let lobe = 2u * axis + select(1u, 0u, normal[axis] > 0.0);
    let along = vec2u((axis + 1u) % 3u, (axis + 2u) % 3u);
    let low = floor(vec2f(point[along.x], point[along.y]) - 0.5);
    let share = vec2f(point[along.x], point[along.y]) - 0.5 - low;
    for (var i = 0u; i < far_cells() / 4u; i++) {
        let side = vec2f(vec2u(i & 1u, i >> 1u));
        let parts = mix(1.0 - share, share, side);
        let away = low + side + 0.5 - vec2f(point[along.x], point[along.y]);
        var place = point;
        place[along.x] += away.x;
        place[along.y] += away.y;
        place[axis] -= (normal[along.x] * away.x + normal[along.y] * away.y) / normal[axis];
        let spot = spot_at(place, lobe, normal, level);
        faces_around[i] = spot.face;
        let is_there = spot.face != NOTHING && !is_parted(point, spot.start, normal, level);
        weights_around[i] = select(0.0, parts.x * parts.y, is_there);
    }
}

// The far light from a cell, whose words of the faces around are `words`: their weighted mean. Call
// find_known before.
fn known_in(words: vec4u) -> Known {
    var sum = FarSum();
    for (var i = 0u; i < far_cells() / 4u; i++) {
        sum = with_far_light(sum, words[i], weights_around[i]);
    }
    return mean_of(sum);
}

// The far light from a direction `local`, in the frame whose z is the surface's normal.
fn known_from(local: vec3f) -> Known {
    let cell = cell_of(local);
    var words = vec4u();
    for (var i = 0u; i < far_cells() / 4u; i++) {
        // Without a face the weight is zero, and the texel any one.
        words[i] = far_texel(faces_around[i], cell / 4u)[cell % 4u];
    }
    return known_in(words);
}

// Parameters and result are those of `gather` in package::cones::gather.
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
    find_known(position_in_world, geometric_normal, level);
    let world_from_cells = basis(geometric_normal);
    let cells_from_world = transpose(world_from_cells);
    var sum = vec4f(0.0);
    // far_cells() / 4u is also the number of faces around, and of cells in a texel.
    for (var four = 0u; four < far_cells() / 4u; four++) {
        let a = far_texel(faces_around[0], four);
        let b = far_texel(faces_around[1], four);
        let c = far_texel(faces_around[2], four);
        let d = far_texel(faces_around[3], four);
        for (var i = 0u; i < far_cells() / 4u; i++) {
            let local = cell_cone(4u * four + i, FAR_CELLS, vec2f(0.5)).direction;
            let cosine = max(dot(world_from_cells * local, shading_normal), 0.0);
            let known = known_in(vec4u(a[i], b[i], c[i], d[i]));
            sum += vec4f(known.radiance, known.openness) * (cosine / local.z / f32(FAR_CELLS));
        }
    }
    let origin = cone_start(position_in_world, geometric_normal, level, settings);
    let world_from_normal = basis(shading_normal);
    let jitter = cell_jitter(start, frame);
    // Rays reach at least to a finite occlusion distance.
    let near = NEAR * exp2(f32(level));
    let is_occlusion_near = settings.occlusion_distance < 3e38;
    let least_reach = select(near, max(near, settings.occlusion_distance), is_occlusion_near);
    var passed = Passed(0u, true, 1.0);
    var openness = 0.0;
    for (var i = 0u; i < cone_count; i++) {
        let local = cell_cone(i, cone_count, jitter);
        var direction = world_from_normal * local.direction;
        // With a normal map, a part of the hemisphere is below the surface; mirror directions there
        // up.
        let below = min(dot(direction, geometric_normal), 0.0);
        direction = direction - 2.0 * below * geometric_normal;
        let known = known_from(cells_from_world * direction);
        let reach = select(3e38, least_reach, known.is_known);
        let hit = trace_ray(Ray(origin, direction, reach, level), &passed);
        let far = vec4f(known.radiance, known.openness);
        var found = far;
        if hit.face != NOTHING && (hit.distance < near || !known.is_known) {
            found = vec4f(shown_by(hit.face, !has_emitters()), 0.0);
        } else if !known.is_known {
            let growth = cone_growth(local.tan_half_angle, dot(direction, geometric_normal), settings);
            found = vec4f(environment_radiance(direction, growth), 1.0);
        }
        sum += (found - far) / f32(cone_count);
        openness += select(1.0, 0.0, hit.face != NOTHING && hit.distance < settings.occlusion_distance);
    }
    sum = max(sum, vec4f(0.0));
    return Gathered(
        PI * sum.rgb, select(min(sum.a, 1.0), openness / f32(cone_count), is_occlusion_near), passed.steps);
}
