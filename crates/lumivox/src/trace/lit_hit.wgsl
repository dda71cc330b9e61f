// The light of a surface in a mirror: the module package::trace::hit_method.
//
// A face has one radiance, so a mirror would show each face. Instead, lights are evaluated at the
// point that the mirror shows, if all have shadow maps, and gathered light is that of the faces
// around.

import package::cones::cone::Traced;
import package::constants::{FAR_CELLS, HAS_INJECTION, PI, SHADOW_CONE, SHADOW_MAP};
import package::grid::{grid, world_from_grid};
import package::light::lights::{incident_light, light_globals, lights};
import package::light::shadow_map::shadow_map_visibility;
import package::trace::brdf::{alpha_from_roughness, fresnel_schlick};
import package::trace::gbuffer::{load_albedo, load_specular, load_surface};
import package::trace::reflections::{Shown, SHARP_ALPHA};
import package::trace::view::{pixel_of, view};
import package::volume::beside::patch_of;
import package::volume::face_light::unpack_face_light;
import package::volume::patch::UNLIT;
import package::volume::surface::far_texel;

// The irradiance of the lights at a point; `of_face` if shadow maps do not show all of them, or a
// caller computes them.
fn direct_at(position_in_world: vec3f, normal: vec3f, of_face: vec3f) -> vec3f {
    if HAS_INJECTION != 0u {
        return of_face;
    }
    var sum = vec3f(0.0);
    var is_known = true;
    for (var i = 0u; i < light_globals.light_count; i++) {
        let light = lights[i];
        let incident = incident_light(light, position_in_world);
        var visible = select(1.0, -1.0, light.shadow == SHADOW_CONE);
        if light.shadow == SHADOW_MAP {
            visible = shadow_map_visibility(light, position_in_world, normal);
        }
        is_known = is_known && visible >= 0.0;
        sum += incident.irradiance * (visible * max(dot(normal, incident.direction), 0.0));
    }
    return select(of_face, sum, is_known);
}

// A point's surface.
struct Point {
    normal: vec3f,
    // The share of irradiance that it reflects diffusely.
    reflected: vec3f,
    // The share of light that it mirrors.
    mirrored: vec3f,
}

// Maximum distance of a point of a face from the surface of a pixel that shows it, in voxels.
const BESIDE_SURFACE = 0.1;

// The surface of the pixel that shows a point, in place of that of the point's face: a face has
// neither texture nor curvature, and reflects all light diffusely.
fn on_screen(position_in_world: vec3f, direction: vec3f, face: Point, may_mirror: bool) -> Point {
    let pixel = pixel_of(position_in_world);
    if any(pixel < vec2i(0)) || any(pixel >= vec2i(view.size)) {
        return face;
    }
    let surface = load_surface(vec2u(pixel));
    let away = dot(position_in_world - surface.position_in_world, surface.geometric_normal);
    if surface.depth <= 0.0 || abs(away) > BESIDE_SURFACE * grid.voxel_size_m
        || dot(surface.geometric_normal, face.normal) < 0.9 {
        return face;
    }
    let gloss = load_specular(vec2u(pixel));
    let cosine = -dot(direction, surface.shading_normal);
    let next = reflect(direction, surface.shading_normal);
    // A bent normal must not mirror light from behind the surface.
    let is_mirror = may_mirror && alpha_from_roughness(gloss.roughness) < SHARP_ALPHA
        && cosine > 0.0 && dot(next, surface.geometric_normal) > 0.0;
    let mirrored = select(vec3f(0.0), fresnel_schlick(gloss.reflectance, cosine), is_mirror);
    let albedo = load_albedo(vec2u(pixel));
    // Other metals reflect as if they were matt.
    let reflected = select(face.reflected, mix(albedo.rgb, vec3f(1.0), gloss.reflectance), albedo.a > 0.0);
    return Point(surface.shading_normal, max(reflected - mirrored, vec3f(0.0)), mirrored);
}

// The light of the surface that a ray has hit: diffusely reflected, and mirrored if `may_mirror`.
fn light_of_hit(traced: Traced, place: vec3f, direction: vec3f, may_mirror: bool) -> Shown {
    if traced.face >= UNLIT {
        return Shown(traced.radiance, vec3f(0.0), vec3f(0.0));
    }
    let face = unpack_face_light(far_texel(traced.face, FAR_CELLS / 4u));
    let position = world_from_grid(place);
    let normal = normalize(patch_of(traced.face).normal);
    let point = on_screen(position, direction, Point(normal, face.reflected, vec3f(0.0)), may_mirror);
    // Planes lie beside their curved surface, which must not shade them.
    let receiver = position + normal * (BESIDE_SURFACE * grid.voxel_size_m);
    let direct = direct_at(receiver, point.normal, face.direct);
    return Shown(point.reflected / PI * (direct + face.gathered), point.mirrored, point.normal);
}
