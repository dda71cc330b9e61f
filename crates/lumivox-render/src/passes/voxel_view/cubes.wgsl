// The cells of one level as cubes.

import package::environment::environment_background;
import package::render::passes::voxel_view::first_cube::first_cube;
import package::render::passes::voxel_view::view::{outline, picture, pixel_ray, voxel_view_settings};
import package::trace::view::view;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let level = voxel_view_settings.level;
    let ray = pixel_ray(pixel, level);
    let hit = first_cube(ray, level);
    if hit.is_hit {
        let shade = outline(hit.position, hit.axis, hit.distance);
        textureStore(picture, pixel, vec4f(hit.radiance * shade, 1.0));
    } else {
        textureStore(picture, pixel, vec4f(environment_background(ray.direction), 0.0));
    }
}

// Lit cells are yellow, the others grey, shaded by the visible side. Brightness does not depend on
// the amount of light, so that weakly lit cells are visible.
@compute @workgroup_size(8, 8)
fn lit(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let level = voxel_view_settings.level;
    let ray = pixel_ray(pixel, level);
    let hit = first_cube(ray, level);
    var shown = vec4f(0.02, 0.02, 0.03, 0.0);
    if hit.is_hit {
        let is_lit = any(hit.radiance > vec3f(0.0));
        let side = array<f32, 3>(0.75, 1.0, 0.6)[hit.axis];
        let color = select(vec3f(0.12, 0.13, 0.16), vec3f(1.0, 0.78, 0.2), is_lit);
        shown = vec4f(color * side * outline(hit.position, hit.axis, hit.distance), 1.0);
    }
    textureStore(picture, pixel, shown);
}
