// From triangles to lit voxels: each is drawn along the axis that it faces most, and each fragment
// is a voxel.
//
// In VXCT the last written fragment stays. To make it deterministic, a first pass finds the last
// triangle of each voxel, and a second pass writes the colour of that triangle.

import package::constants::VXCT_OF_EMITTER;
import package::render::scene::point::{is_masked_out, sample_point, Point};
import package::vxct::lights::{arriving_light, injected};
import package::vxct::material::{material_of, vxct_draws};
import package::vxct::uniform::{in_cube, settings};
import package::vxct::vertex::{corner_of, position_of};

// By voxel, x first: the number of the last triangle, from 1.
@group(3) @binding(0) var<storage, read_write> owners: array<atomic<u32>>;
@group(3) @binding(1) var voxels: texture_storage_3d<rgba8unorm, write>;

struct Fragment {
    @builtin(position) pixel: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) texcoords: vec4f,
    @location(3) color: vec4f,
    @location(4) @interpolate(flat) draw: u32,
    @location(5) @interpolate(flat) triangle: u32,
}

@vertex
fn main(@builtin(vertex_index) vertex: u32, @builtin(instance_index) draw: u32) -> Fragment {
    let first = 3u * (vertex / 3u);
    let corner = corner_of(draw, vertex);
    let position = in_cube(corner.position_in_world);
    let a = in_cube(position_of(draw, first));
    let across = abs(cross(
        in_cube(position_of(draw, first + 1u)) - a, in_cube(position_of(draw, first + 2u)) - a));
    var seen = position.xy;
    if across.x > across.y && across.x > across.z {
        seen = position.yz;
    } else if across.y > across.z {
        seen = position.xz;
    }
    let is_there = vxct_draws[draw].is_voxelized != 0u;
    return Fragment(
        // Seen along the axis, or culled: all corners at one point outside the picture.
        select(vec4f(2.0, 2.0, 0.5, 1.0), vec4f(seen, 0.5, 1.0), is_there),
        position,
        corner.normal,
        corner.texcoords,
        corner.color,
        draw,
        vxct_draws[draw].first_triangle + vertex / 3u + 1u,
    );
}

fn voxel_at(position: vec3f) -> vec3i {
    return vec3i(floor((0.5 * position + 0.5) * f32(settings.resolution)));
}

fn is_inside(voxel: vec3i) -> bool {
    return all(voxel >= vec3i(0)) && all(voxel < vec3i(i32(settings.resolution)));
}

fn owner_index(voxel: vec3i) -> u32 {
    let at = vec3u(voxel);
    return at.x + settings.resolution * (at.y + settings.resolution * at.z);
}

fn point_of(fragment: Fragment) -> Point {
    return Point(
        fragment.position, fragment.normal, vec4f(1.0, 0.0, 0.0, 1.0), fragment.texcoords, fragment.color);
}

@fragment
fn own(fragment: Fragment) {
    let samples = sample_point(point_of(fragment));
    let voxel = voxel_at(fragment.position);
    if is_inside(voxel) && !is_masked_out(samples.base) {
        atomicMax(&owners[owner_index(voxel)], fragment.triangle);
    }
}

@fragment
fn paint(fragment: Fragment) {
    let samples = sample_point(point_of(fragment));
    let voxel = voxel_at(fragment.position);
    if !is_inside(voxel) || is_masked_out(samples.base)
        || atomicLoad(&owners[owner_index(voxel)]) != fragment.triangle {
        return;
    }
    let material = material_of(fragment.draw, samples);
    let normal = normalize(fragment.normal);
    // VXCT does not store the light of its own emitters in voxels.
    let is_own = vxct_draws[fragment.draw].kind == VXCT_OF_EMITTER;
    var light = select(material.emission, vec3f(0.0), is_own);
    for (var index = 0u; index < settings.light_count; index++) {
        light += injected(material, normal, arriving_light(index, fragment.position));
    }
    textureStore(voxels, voxel, vec4f(light, 1.0));
}
