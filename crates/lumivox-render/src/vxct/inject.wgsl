// VXCT's light in the voxels: of each light (ambient + n l) times its colour, without attenuation or shadow, clamped at
// white. Lights without a polynomial come in as they do physically.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::light::lights::{incident_light, light_globals, lights};
import package::light::visibility::light_visibility;
import package::render::vxct::lights::arriving_light;
import package::voxels::list::Face;

struct InjectSettings {
    // Of the scene's materials; voxels do not know their own.
    ambient: f32,
    // The radiance that the screen shows as 1.
    white: f32,
    padding_0: u32,
    padding_1: u32,
}

@group(1) @binding(0) var<uniform> inject_settings: InjectSettings;
@group(1) @binding(2) var<storage, read> faces: array<Face>;
@group(1) @binding(3) var<storage, read_write> direct: array<vec4f>;
@group(1) @binding(4) var<storage, read_write> radiance: array<vec4f>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= arrayLength(&direct) {
        return;
    }
    let face = faces[index];
    let normal = normalize(face.vector_area);
    var arriving = vec3f(0.0);
    for (var i = 0u; i < light_globals.light_count; i++) {
        let sent = arriving_light(i, face.position_in_world);
        let cosine = max(dot(normal, sent.direction), 0.0);
        if sent.has_polynomial {
            arriving += sent.color * (inject_settings.ambient + cosine);
        } else if cosine > 0.0 && any(sent.radiance > vec3f(0.0)) {
            let light = lights[i];
            let incident = incident_light(light, face.position_in_world);
            arriving += sent.radiance * cosine
                * light_visibility(light, incident, face.position_in_world, normal);
        }
    }
    let reflected = min(face.reflectance * arriving, vec3f(inject_settings.white));
    let leaving = vec4f(face.emission + reflected, 1.0);
    direct[index] = leaving;
    radiance[index] = leaving;
}
