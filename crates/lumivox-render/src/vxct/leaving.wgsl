// The cones that leave a surface in the look of VXCT: diffuse, glossy, and towards a light.

import package::constants::{VXCT_TERM_FRONT, VXCT_TERM_INTERMEDIATE, VXCT_TERM_SIDES};
import package::grid::{grid, grid_from_world};
import package::light::environment::{environment_radiance, environment_reflection};
import package::render::vxct::cone::{trace_vxct, VxctCone, VxctTraced};
import package::render::vxct::material::VxctMaterial;
import package::render::vxct::uniform::{has, settings, VxctShape};
import package::trace::gbuffer::Surface;

// No cell that a cone reads at its start holds its own surface, if it starts this many voxels above: half a voxel from
// the surface to the middle of its cell, and one that a filtered look-up reaches.
const CLEAR_VOXELS: f32 = 1.5;
const FAR: f32 = 3e38;

// A cone that leaves a surface `above` it, in voxels, and starts clear of it.
fn leaving_cone(
    surface: Surface,
    direction: vec3f,
    shape: VxctShape,
    width: f32,
    above: f32,
) -> VxctCone {
    let normal = surface.geometric_normal;
    let cosine = max(dot(direction, normal), 0.0);
    let height = max(above, CLEAR_VOXELS - shape.offset * cosine);
    let origin = grid_from_world(surface.position_in_world) + height * normal;
    return VxctCone(
        origin,
        direction,
        width,
        shape.offset,
        FAR,
        shape.step_per_diameter,
        height,
        cosine,
        0.0,
        0.0,
        settings.unit_voxels,
    );
}

// Two axes across a unit vector: along the world's where it is, and one of them x and z for y. Frisvad 2012, "Building
// an orthonormal basis from a 3D unit vector without normalization", with y for the pole.
fn axes_across(normal: vec3f) -> mat2x3f {
    let is_pole = normal.y < -0.9999;
    let a = 1.0 / (1.0 + select(normal.y, 0.0, is_pole));
    let b = -normal.x * normal.z * a;
    let first = vec3f(1.0 - normal.x * normal.x * a, -normal.x, b);
    let second = vec3f(b, -normal.z, 1.0 - normal.z * normal.z * a);
    let pole_first = vec3f(1.0, 0.0, 0.0);
    let pole_second = vec3f(0.0, 0.0, -1.0);
    return mat2x3f(
        select(first, pole_first, vec3<bool>(is_pole)),
        select(second, pole_second, vec3<bool>(is_pole)),
    );
}

struct DiffuseCones {
    // The mean over the cones: what a white surface shows.
    radiance: vec3f,
    openness: f32,
    samples: u32,
}

// The front cone is number 0, the sides are 1 to 4, those between 5 to 8.
fn diffuse_cones(surface: Surface) -> DiffuseCones {
    let normal = surface.shading_normal;
    let across = axes_across(normal);
    var sum = DiffuseCones(vec3f(0.0), 0.0, 0u);
    var count = 0.0;
    for (var i = 0u; i < 9u; i++) {
        let kind = select(
            select(VXCT_TERM_INTERMEDIATE, VXCT_TERM_SIDES, i < 5u), VXCT_TERM_FRONT, i == 0u);
        if !has(kind) {
            continue;
        }
        let number = i - 1u;
        let sign = select(1.0, -1.0, (number & 1u) != 0u);
        let side = sign * select(across[0], across[1], vec3<bool>((number & 2u) != 0u));
        var direction = select(
            select(normalize(normal + side), side, vec3<bool>(i < 5u)), normal, vec3<bool>(i == 0u));
        // With interpolated normals a cone may point below the surface; it is folded up.
        direction -= 2.0 * min(dot(direction, surface.geometric_normal), 0.0)
            * surface.geometric_normal;
        let cone = leaving_cone(
            surface, direction, settings.diffuse, settings.diffuse.width, settings.origin_offset);
        let traced = trace_vxct(cone);
        sum.radiance += traced.radiance
            + traced.transmittance * environment_radiance(direction, cone.width);
        sum.openness += traced.transmittance;
        sum.samples += traced.samples;
        count += 1.0;
    }
    sum.radiance /= max(count, 1.0);
    sum.openness = select(1.0, sum.openness / max(count, 1.0), count > 0.0);
    return sum;
}

struct Reflection {
    radiance: vec3f,
    samples: u32,
}

fn specular_cone(surface: Surface, material: VxctMaterial, to_camera: vec3f) -> Reflection {
    let normal = surface.shading_normal;
    var direction = reflect(-to_camera, normal);
    direction -= 2.0 * min(dot(direction, surface.geometric_normal), 0.0)
        * surface.geometric_normal;
    // VXCT's materials all reflect alike; others as sharply as they are smooth.
    let width = max(settings.specular.width, material.lobe_width);
    var cone = leaving_cone(surface, direction, settings.specular, width, 0.0);
    cone.fade = select(0.0, settings.shininess_falloff, material.is_vxct);
    let traced = trace_vxct(cone);
    let outside = environment_reflection(direction, width, material.alpha)
        * pow(1.0 + traced.distance / settings.unit_voxels, -cone.fade);
    return Reflection(traced.radiance + traced.transmittance * outside, traced.samples);
}

// What lies between a surface and a light, 0 to 1.
fn occlusion_cone(
    surface: Surface,
    to_light: vec3f,
    distance_m: f32,
    radius_m: f32,
    is_parallel: bool,
) -> VxctTraced {
    var cone = leaving_cone(
        surface, to_light, settings.occlusion, settings.occlusion.width, 0.0);
    // It ends as far before the light as it starts behind the surface. A parallel one is softened as if its light
    // stood one of VXCT's units away.
    let light_voxels = select((distance_m - radius_m) / grid.voxel_size_m, FAR, is_parallel);
    let soft_units = select(distance_m / grid.voxel_size_m / settings.unit_voxels, 1.0, is_parallel);
    cone.reach = light_voxels - select(settings.occlusion.offset, 0.0, is_parallel);
    cone.softness = settings.shadow_strength / (soft_units * sqrt(settings.unit_voxels));
    if settings.shadow_strength <= 0.0 {
        cone.reach = 0.0;
    }
    return trace_vxct(cone);
}
