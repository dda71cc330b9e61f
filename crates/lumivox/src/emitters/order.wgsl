// The order of the emitters along a Morton curve: consecutive emitters are close to each other,
// whatever the order of the meshes. Sorted by a bitonic network (Batcher 1968, "Sorting networks
// and their applications"), whose order of exchanges is fixed.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::emitters::emitter::{record_of, Emitter, EmitterList};
import package::voxels::morton::morton_encode;

struct Sorting {
    count: u32,
    // Runs of this many keys are sorted alternately up and down.
    run: u32,
    // The distance of the keys that are compared.
    distance: u32,
    // Morton cells along a voxel's edge.
    cells_per_voxel: f32,
}

@group(0) @binding(0) var<uniform> sorting: Sorting;
// The Morton code of an emitter, and its index in `unsorted`.
@group(0) @binding(1) var<storage, read_write> keys: array<vec2u>;
@group(0) @binding(2) var<storage, read> unsorted: array<Emitter>;
@group(0) @binding(3) var<storage, read_write> list: EmitterList;

const THREADS = 256u;
const BLOCK = 2u * THREADS;
const LAST = 0xffffffffu;

var<workgroup> block: array<vec2u, BLOCK>;

fn key_of(index: u32) -> vec2u {
    if index >= sorting.count || unsorted[index].power <= 0.0 {
        return vec2u(LAST, index);
    }
    let emitter = unsorted[index];
    let middle = emitter.corner + (emitter.along_ab + emitter.along_ac) / 3.0;
    // The curve repeats outside of the boxes, so those of a clipmap may move anywhere.
    let cell = vec3i(floor(middle * sorting.cells_per_voxel)) & vec3i(1023);
    return vec2u(morton_encode(vec3u(cell)), index);
}

fn is_after(a: vec2u, b: vec2u) -> bool {
    return a.x > b.x || (a.x == b.x && a.y > b.y);
}

// The first of a thread's two keys: their distance is a power of two.
fn first_of(thread: u32, distance: u32) -> u32 {
    return 2u * thread - (thread & (distance - 1u));
}

fn exchange_in_block(start: u32, local: u32, run: u32, distance: u32) {
    let low = first_of(local, distance);
    let a = block[low];
    let b = block[low + distance];
    if is_after(a, b) == (((start + low) & run) == 0u) {
        block[low] = b;
        block[low + distance] = a;
    }
}

// Makes the keys, and sorts each block.
@compute @workgroup_size(THREADS)
fn sort_blocks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    let start = workgroup.x * BLOCK;
    block[local] = key_of(start + local);
    block[local + THREADS] = key_of(start + local + THREADS);
    workgroupBarrier();
    for (var run = 2u; run <= BLOCK; run *= 2u) {
        for (var distance = run / 2u; distance > 0u; distance /= 2u) {
            exchange_in_block(start, local, run, distance);
            workgroupBarrier();
        }
    }
    keys[start + local] = block[local];
    keys[start + local + THREADS] = block[local + THREADS];
}

// Exchanges keys of different blocks.
@compute @workgroup_size(THREADS)
fn exchange(@builtin(global_invocation_id) invocation: vec3u) {
    let low = first_of(invocation.x, sorting.distance);
    let a = keys[low];
    let b = keys[low + sorting.distance];
    if is_after(a, b) == ((low & sorting.run) == 0u) {
        keys[low] = b;
        keys[low + sorting.distance] = a;
    }
}

// All exchanges of a run within blocks.
@compute @workgroup_size(THREADS)
fn merge_blocks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    let start = workgroup.x * BLOCK;
    block[local] = keys[start + local];
    block[local + THREADS] = keys[start + local + THREADS];
    workgroupBarrier();
    for (var distance = THREADS; distance > 0u; distance /= 2u) {
        exchange_in_block(start, local, sorting.run, distance);
        workgroupBarrier();
    }
    keys[start + local] = block[local];
    keys[start + local + THREADS] = block[local + THREADS];
}

// What a ray meets among the emitters that are close in the order.
struct Met {
    distance: f32,
    count: u32,
}

// Emitters that are searched on each side in the order.
const SEARCHED = 64u;

// The distance to a triangle (Moeller and Trumbore 1997, "Fast, minimum storage ray/triangle
// intersection"); FAR if the ray misses it.
const FAR = 3e38;

fn distance_to(emitter: Emitter, origin: vec3f, direction: vec3f) -> f32 {
    let across = cross(direction, emitter.along_ac);
    let volume = dot(emitter.along_ab, across);
    let from_corner = origin - emitter.corner;
    let aside = cross(from_corner, emitter.along_ab);
    let u = dot(from_corner, across) / volume;
    let v = dot(direction, aside) / volume;
    let distance = dot(emitter.along_ac, aside) / volume;
    let is_hit = volume != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 1e-5;
    return select(FAR, distance, is_hit);
}

fn meet(index: u32, origin: vec3f, direction: vec3f) -> Met {
    var met = Met(FAR, 0u);
    let end = min(index + SEARCHED + 1u, sorting.count);
    for (var other = max(index, SEARCHED) - SEARCHED; other < end; other++) {
        let emitter = unsorted[keys[other].y];
        let distance = distance_to(emitter, origin, direction);
        let is_met = other != index && emitter.power > 0.0 && distance < FAR;
        met.count += u32(is_met);
        met.distance = select(met.distance, min(met.distance, distance), is_met);
    }
    return met;
}

// The length of the line through a point to what it meets both ways.
fn width_along(index: u32, point: vec3f, direction: vec3f) -> f32 {
    return meet(index, point, direction).distance + meet(index, point, -direction).distance;
}

// The emitter with its outer side only, if it is double-sided and part of a closed body thinner
// than a voxel: nothing sees its inside, and rays through voxels would. A side is inside
// where the number of emitters ahead is odd.
fn without_inside(index: u32, emitter: Emitter) -> Emitter {
    let outward = cross(emitter.along_ab, emitter.along_ac);
    if emitter.is_double_sided == 0u || emitter.power <= 0.0 || all(outward == vec3f(0.0)) {
        return emitter;
    }
    let normal = normalize(outward);
    // Off the middle, whose mirror image may lie on an edge of the other side.
    let point = emitter.corner + 0.31 * emitter.along_ab + 0.23 * emitter.along_ac;
    let front = meet(index, point, normal);
    let back = meet(index, point, -normal);
    let is_front_inside = (front.count & 1u) != 0u;
    if is_front_inside == ((back.count & 1u) != 0u) {
        return emitter;
    }
    let depth = select(back.distance, front.distance, is_front_inside);
    let inside = point + select(-0.5, 0.5, is_front_inside) * depth * normal;
    let along = normalize(emitter.along_ab);
    let width = min(width_along(index, inside, along), width_along(index, inside, cross(normal, along)));
    if min(depth, width) > 1.0 {
        return emitter;
    }
    var outer = emitter;
    outer.is_double_sided = 0u;
    outer.power = 0.5 * emitter.power;
    if is_front_inside {
        outer.along_ab = emitter.along_ac;
        outer.along_ac = emitter.along_ab;
    }
    return outer;
}

// Writes the emitters in sorted order.
@compute @workgroup_size(THREADS)
fn place(@builtin(global_invocation_id) invocation: vec3u) {
    let index = invocation.x;
    if index == 0u {
        list.count = sorting.count;
    }
    if index < sorting.count {
        list.records[index] = record_of(without_inside(index, unsorted[keys[index].y]));
    }
}
