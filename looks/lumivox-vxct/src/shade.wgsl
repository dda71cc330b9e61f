// The colour of a fragment: Phong's light, and the light of the cones.
//
// The picture is, for each light, (Phong + specular) (1 - occlusion), plus diffuse (1 - the least
// occlusion).

import package::constants::{
    PI, VIEW_ALBEDO, VIEW_COST, VIEW_DEPTH, VIEW_DIFFUSE, VIEW_DIRECT, VIEW_INDIRECT, VIEW_LOD,
    VIEW_NORMAL, VIEW_OCCLUSION, VIEW_SHADOW, VIEW_SPECULAR, VXCT_AMBIENT, VXCT_DIFFUSE,
    VXCT_DIFFUSE_CONES, VXCT_HIGHLIGHTS, VXCT_INDIRECT, VXCT_OCCLUSION_CONES, VXCT_OF_EMITTER,
    VXCT_OF_OTHERS, VXCT_PHONG, VXCT_SPECULAR_CONES,
};
import package::render::scene::point::{frame_at, is_masked_out, sample_point, Point, PointSamples};
import package::vxct::cones::{
    diffuse_cones, occlusion_cone, sample_voxels, specular_cone, Traced,
};
import package::vxct::lights::{arriving_light, vxct_lights, Arriving};
import package::vxct::material::{material_of, vxct_draws, VxctMaterial};
import package::vxct::uniform::{has, in_cube, settings};
import package::vxct::vertex::corner_of;
import package::trace::surface::octahedral_encode;

struct Fragment {
    @builtin(position) @invariant clip: vec4f,
    @location(0) from_camera: vec3f,
    @location(1) normal: vec3f,
    @location(2) tangent: vec4f,
    @location(3) texcoords: vec4f,
    @location(4) color: vec4f,
    @location(5) @interpolate(flat) draw: u32,
}

@vertex
fn main(@builtin(vertex_index) vertex: u32, @builtin(instance_index) draw: u32) -> Fragment {
    let corner = corner_of(draw, vertex);
    return Fragment(
        settings.clip_from_world * vec4f(corner.position_in_world, 1.0),
        corner.position_in_world - settings.camera_in_world,
        corner.normal,
        corner.tangent,
        corner.texcoords,
        corner.color,
        draw,
    );
}

// Phong's terms of one light.
fn phong(
    material: VxctMaterial,
    normal: vec3f,
    to_camera: vec3f,
    arriving: Arriving,
    terms: vec3<bool>,
) -> vec3f {
    let facing = max(dot(normal, arriving.direction), 0.0);
    let mirrored = reflect(-arriving.direction, normal);
    let highlight = pow(max(dot(mirrored, to_camera), 1e-6), material.shininess);
    var share = select(vec3f(0.0), material.ambient, terms.x);
    share += select(vec3f(0.0), material.diffuse * facing, terms.y);
    share += select(vec3f(0.0), material.specular * highlight, terms.z);
    return share * arriving.color;
}

// The factor of mirrored light for a light beside the mirrored direction.
fn highlight_falloff(direction: vec3f, to_light: vec3f, shininess: f32) -> f32 {
    let angle = acos(clamp(dot(direction, to_light), -1.0, 1.0));
    let off = max(angle - 0.008 * PI * shininess, 0.0) / PI;
    return pow(max(1.0 - off, 1e-6), settings.shininess_falloff);
}

// Longer than any distance in the cube.
const BEYOND: f32 = 3.5;

struct Shaded {
    direct: vec3f,
    specular: vec3f,
    diffuse: vec3f,
    // The least occlusion of all lights.
    occlusion: f32,
    // The sum of 1 - occlusion over all lights.
    visible: f32,
    samples: u32,
}

fn shade(material: VxctMaterial, position: vec3f, normal: vec3f, to_camera: vec3f) -> Shaded {
    let terms = vec3<bool>(
        has(VXCT_PHONG) && has(VXCT_AMBIENT),
        has(VXCT_PHONG) && has(VXCT_DIFFUSE),
        has(VXCT_PHONG) && has(VXCT_HIGHLIGHTS),
    );
    var shaded = Shaded(material.emission, vec3f(0.0), vec3f(0.0), 1.0, 0.0, 0u);
    let mirrored = reflect(-to_camera, normal);
    var reflection = Traced(vec3f(0.0), 0.0, 0u);
    if has(VXCT_SPECULAR_CONES) {
        reflection = specular_cone(position, mirrored, material.lobe_width);
        shaded.samples += reflection.samples;
    }
    for (var index = 0u; index < settings.light_count; index++) {
        let arriving = arriving_light(index, position);
        var occlusion = 0.0;
        if has(VXCT_OCCLUSION_CONES) || has(VXCT_DIFFUSE_CONES) {
            let reach = select(arriving.distance, BEYOND, vxct_lights[index].is_parallel != 0u);
            let traced = occlusion_cone(position, arriving.direction, reach, arriving.distance);
            occlusion = traced.occlusion;
            shaded.samples += traced.samples;
        }
        // Dims the light of diffuse cones even without shadows.
        shaded.occlusion = min(shaded.occlusion, occlusion);
        let visible = select(1.0, 1.0 - occlusion, has(VXCT_OCCLUSION_CONES));
        let lit = highlight_falloff(mirrored, arriving.direction, material.shininess);
        shaded.direct += phong(material, normal, to_camera, arriving, terms) * visible;
        shaded.specular += material.mirror * reflection.color * (lit * visible);
        shaded.visible += visible;
    }
    if settings.light_count == 0u {
        shaded.occlusion = 0.0;
    }
    if has(VXCT_DIFFUSE_CONES) {
        let gathered = diffuse_cones(position, normal);
        shaded.diffuse = gathered.color * (1.0 - shaded.occlusion);
        shaded.samples += gathered.samples;
    }
    return shaded;
}

// All of Phong's light, without cones.
fn shade_plainly(
    material: VxctMaterial,
    position: vec3f,
    normal: vec3f,
    to_camera: vec3f,
) -> vec3f {
    var sum = material.emission;
    for (var index = 0u; index < settings.light_count; index++) {
        let arriving = arriving_light(index, position);
        sum += phong(material, normal, to_camera, arriving, vec3<bool>(true));
    }
    return sum;
}

fn final_color(shaded: Shaded) -> vec3f {
    if !has(VXCT_PHONG) && !has(VXCT_SPECULAR_CONES) && !has(VXCT_DIFFUSE_CONES) {
        return vec3f(select(0.0, shaded.visible, has(VXCT_OCCLUSION_CONES)));
    }
    return shaded.direct + shaded.specular + shaded.diffuse;
}

// The colour in display values; alpha is the coverage of earlier fragments.
fn shown_at(fragment: Fragment, samples: PointSamples, point: Point) -> vec4f {
    let draw = vxct_draws[fragment.draw];
    let material = material_of(fragment.draw, samples);
    let position = in_cube(settings.camera_in_world + fragment.from_camera);
    let to_camera = -normalize(fragment.from_camera);
    var normal = normalize(fragment.normal);
    var alpha = 1.0;
    if draw.kind == VXCT_OF_OTHERS {
        normal = frame_at(point, samples).shading;
        alpha = samples.base.a;
    }
    let shown = settings.shown;
    switch shown {
        case VIEW_ALBEDO: {
            return vec4f(material.diffuse, 1.0);
        }
        case VIEW_NORMAL: {
            return vec4f(normal, 1.0);
        }
        case VIEW_DEPTH: {
            return vec4f(vec3f(length(fragment.from_camera)), 1.0);
        }
        default: {}
    }
    if draw.kind == VXCT_OF_EMITTER {
        return vec4f(material.emission, 1.0);
    }
    if draw.is_voxelized == 0u {
        return vec4f(shade_plainly(material, position, normal, to_camera), alpha);
    }
    if shown == VIEW_LOD {
        return sample_voxels(position, settings.level);
    }
    if !has(VXCT_INDIRECT) {
        return vec4f(shade_plainly(material, position, normal, to_camera), alpha);
    }
    let shaded = shade(material, position, normal, to_camera);
    switch shown {
        case VIEW_DIRECT: {
            return vec4f(shaded.direct, alpha);
        }
        case VIEW_INDIRECT: {
            return vec4f(shaded.specular + shaded.diffuse, alpha);
        }
        case VIEW_DIFFUSE: {
            return vec4f(shaded.diffuse, alpha);
        }
        case VIEW_SPECULAR: {
            return vec4f(shaded.specular, alpha);
        }
        case VIEW_OCCLUSION: {
            return vec4f(vec3f(1.0 - shaded.occlusion), 1.0);
        }
        case VIEW_SHADOW: {
            let count = f32(max(settings.light_count, 1u));
            return vec4f(vec3f(select(shaded.visible / count, 1.0, settings.light_count == 0u)), 1.0);
        }
        case VIEW_COST: {
            return vec4f(vec3f(f32(shaded.samples)), 1.0);
        }
        default: {}
    }
    return vec4f(final_color(shaded), alpha);
}

struct Targets {
    @location(0) shown: vec4f,
    // Normals as in the G-buffer.
    @location(1) normals: vec4f,
}

@fragment
fn fragment(fragment: Fragment) -> Targets {
    let point = Point(
        fragment.from_camera, fragment.normal, fragment.tangent, fragment.texcoords, fragment.color);
    let samples = sample_point(point);
    let is_other = vxct_draws[fragment.draw].kind == VXCT_OF_OTHERS;
    if is_other && is_masked_out(samples.base) {
        discard;
    }
    let shown = shown_at(fragment, samples, point);
    let is_data = settings.shown == VIEW_NORMAL || settings.shown == VIEW_DEPTH
        || settings.shown == VIEW_COST;
    // Display values end at 1.
    let frame = frame_at(point, samples);
    return Targets(
        select(clamp(shown, vec4f(0.0), vec4f(1.0)), shown, vec4<bool>(is_data)),
        vec4f(octahedral_encode(frame.shading), octahedral_encode(frame.geometric)),
    );
}
