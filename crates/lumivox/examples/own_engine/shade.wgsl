// The engine's own shading: it links against Lumivox's modules for its lights, their shadows and
// the G-buffer, and adds the traced irradiance.

import package::environment::environment_background;
import package::light::lights::{incident_light, light_globals, lights};
import package::light::visibility::light_visibility;
import package::trace::gbuffer::{gbuffer_diffuse, load_surface};
import package::trace::view::{ray_direction, view};

@group(1) @binding(0) var irradiance: texture_2d<f32>;
@group(1) @binding(1) var picture: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn shade(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let surface = load_surface(pixel);
    var color = environment_background(ray_direction(pixel));
    if surface.depth > 0.0 {
        var sum = textureLoad(irradiance, pixel, 0).rgb;
        for (var i = 0u; i < light_globals.light_count; i++) {
            let incident = incident_light(lights[i], surface.position_in_world);
            let cosine = max(dot(surface.shading_normal, incident.direction), 0.0);
            sum += incident.irradiance * cosine * light_visibility(
                lights[i], incident, surface.position_in_world, surface.geometric_normal);
        }
        color = textureLoad(gbuffer_diffuse, pixel, 0).rgb / 3.14159265 * sum;
    }
    textureStore(picture, pixel, vec4f(color, 1.0));
}
