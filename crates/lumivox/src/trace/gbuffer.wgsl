// The G-buffer: group 3 of every pass over the screen; its binding 0 is the camera.
//
// A caller's own module (`GiConfig::gbuffer`) can replace it as `package::trace::gbuffer`, with its
// own bindings from 1 on and the functions load_surface, load_specular, load_motion and, if it
// knows albedos, load_albedo.

import package::constants::AS_THE_CAMERA;
import package::trace::surface::{octahedral_decode, Specular, Surface};
import package::trace::view::{camera_motion, position_from_depth, view};

// Reversed z: 1 at the near plane, 0 at infinity and for pixels without surface.
@group(3) @binding(1) var gbuffer_depth: texture_depth_2d;
// Octahedral unit vectors in [-1, 1]: shading normal in xy, geometric normal in zw; both face the
// camera.
@group(3) @binding(2) var gbuffer_normals: texture_2d<f32>;
// Diffuse albedo in rgb; 1 minus the strength of a clear coat in a.
@group(3) @binding(3) var gbuffer_diffuse: texture_2d<f32>;
// Specular reflectance at normal incidence in rgb, perceptual roughness in a.
@group(3) @binding(4) var gbuffer_specular: texture_2d<f32>;
// Emitted radiance in rgb; the coat's perceptual roughness in a.
@group(3) @binding(5) var gbuffer_emission: texture_2d<f32>;
// Motion in xy, read if view.has_motion is set; AS_THE_CAMERA for static surfaces.
@group(3) @binding(6) var gbuffer_motion: texture_2d<f32>;

// The position and orientation of the pixel's surface.
fn load_surface(pixel: vec2u) -> Surface {
    let depth = textureLoad(gbuffer_depth, pixel, 0);
    let normals = textureLoad(gbuffer_normals, pixel, 0);
    return Surface(
        position_from_depth(pixel, max(depth, 1e-7)),
        depth,
        octahedral_decode(normals.xy),
        octahedral_decode(normals.zw),
    );
}

// The specular properties of the pixel's surface.
fn load_specular(pixel: vec2u) -> Specular {
    let specular = textureLoad(gbuffer_specular, pixel, 0);
    return Specular(
        specular.rgb,
        specular.a,
        1.0 - textureLoad(gbuffer_diffuse, pixel, 0).a,
        textureLoad(gbuffer_emission, pixel, 0).a,
    );
}

// The diffuse albedo of the pixel's surface in rgb; a is above 0 if it is known.
fn load_albedo(pixel: vec2u) -> vec4f {
    return vec4f(textureLoad(gbuffer_diffuse, pixel, 0).rgb, 1.0);
}

// The position of the pixel's surface in the picture minus its position in the previous frame: as a
// share of the picture, x to the right, y down.
fn load_motion(pixel: vec2u, position_in_world: vec3f) -> vec2f {
    if view.has_motion != 0u {
        let motion = textureLoad(gbuffer_motion, pixel, 0).xy;
        if motion.x < 0.5 * AS_THE_CAMERA {
            return motion;
        }
    }
    return camera_motion(pixel, position_in_world);
}
