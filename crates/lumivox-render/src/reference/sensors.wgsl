// Sensors, which measure light in place of the pixels of a picture.
//
// A lux meter is a white diffuse surface, whose radiance is irradiance / pi. A luminance meter is a
// ray like the camera's.

import package::constants::{SENSOR_NONE, SENSOR_RAY};
import package::render::reference::intersect::Ray;
import package::render::reference::scatter::Surface;
import package::trace::coat::Coat;

// Two texels for each sensor: position and kind, then the unit direction.
@group(0) @binding(13) var sensors: texture_2d<f32>;

struct Sensor {
    ray: Ray,
    is_there: bool,
    // `true` for a luminance meter, `false` for a lux meter.
    is_ray: bool,
}

fn sensor_at(pixel: vec2u) -> Sensor {
    let at = vec2i(pixel) * vec2i(2, 1);
    let place = textureLoad(sensors, at, 0);
    let direction = textureLoad(sensors, at + vec2i(1, 0), 0).xyz;
    let kind = u32(place.w);
    return Sensor(Ray(place.xyz, direction, 3e38), kind != SENSOR_NONE, kind == SENSOR_RAY);
}

// The white surface of a lux meter; it faces along the ray.
fn white_sensor(ray: Ray) -> Surface {
    let normal = ray.direction;
    return Surface(
        ray.origin, normal, normal, normal, vec3f(1.0), vec3f(0.0), 1.0, 0.0, Coat(0.0, 1.0));
}
