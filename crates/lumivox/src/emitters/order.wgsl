// Sorts the emitters along a Morton curve: consecutive emitters are close to each other, whatever
// the order of the meshes. The method is a bitonic network (Batcher 1968, "Sorting networks and
// their applications"), whose order of exchanges is fixed. Emitters of thin closed bodies keep only
// their outer side.

import package::constants::{LINEAR_WORKGROUP_SIZE, SORT_BLOCK, SORT_WORKGROUP_SIZE};
import package::emitters::emitter::{
    distance_to, FAR, NEIGHBOURS, record_of, Emitter, EmitterList,
};
import package::voxels::morton::morton_encode;

struct Sorting {
    count: u32,
    // Runs of this many keys are sorted alternately up and down.
    run: u32,
    // The distance of compared keys.
    distance: u32,
    // Morton cells along a voxel's edge.
    cells_per_voxel: f32,
}

@group(0) @binding(0) var<uniform> sorting: Sorting;
// The Morton code of an emitter, and its index in `unsorted`.
@group(0) @binding(1) var<storage, read_write> keys: array<vec2u>;
@group(0) @binding(2) var<storage, read> unsorted: array<Emitter>;
@group(0) @binding(3) var<storage, read_write> list: EmitterList;

const LAST = 0xffffffffu;

var<workgroup> block: array<vec2u, SORT_BLOCK>;

fn key_of(index: u32) -> vec2u {
    if index >= sorting.count || unsorted[index].power <= 0.0 {
        return vec2u(LAST, index);
    }
    let emitter = unsorted[index];
    let middle = emitter.corner + (emitter.along_ab + emitter.along_ac) / 3.0;
    // The curve repeats outside of the boxes, so a clipmap's boxes may move anywhere.
    let cell = vec3i(floor(middle * sorting.cells_per_voxel)) & vec3i(1023);
    return vec2u(morton_encode(vec3u(cell)), index);
}

fn is_after(a: vec2u, b: vec2u) -> bool {
    return a.x > b.x || (a.x == b.x && a.y > b.y);
}

// The first of a thread's two keys; the distance of the two is a power of two.
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
@compute @workgroup_size(SORT_WORKGROUP_SIZE)
fn sort_blocks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    let start = workgroup.x * SORT_BLOCK;
    block[local] = key_of(start + local);
    block[local + SORT_WORKGROUP_SIZE] = key_of(start + local + SORT_WORKGROUP_SIZE);
    workgroupBarrier();
    for (var run = 2u; run <= SORT_BLOCK; run *= 2u) {
        for (var distance = run / 2u; distance > 0u; distance /= 2u) {
            exchange_in_block(start, local, run, distance);
            workgroupBarrier();
        }
    }
    keys[start + local] = block[local];
    keys[start + local + SORT_WORKGROUP_SIZE] = block[local + SORT_WORKGROUP_SIZE];
}

// Exchanges keys of different blocks.
@compute @workgroup_size(SORT_WORKGROUP_SIZE)
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
@compute @workgroup_size(SORT_WORKGROUP_SIZE)
fn merge_blocks(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    let start = workgroup.x * SORT_BLOCK;
    block[local] = keys[start + local];
    block[local + SORT_WORKGROUP_SIZE] = keys[start + local + SORT_WORKGROUP_SIZE];
    workgroupBarrier();
    for (var distance = SORT_WORKGROUP_SIZE; distance > 0u; distance /= 2u) {
        exchange_in_block(start, local, sorting.run, distance);
        workgroupBarrier();
    }
    keys[start + local] = block[local];
    keys[start + local + SORT_WORKGROUP_SIZE] = block[local + SORT_WORKGROUP_SIZE];
}

// The nearest hit of a ray and the number of its hits, among an emitter's neighbours in the order.
struct Met {
    distance: f32,
    count: u32,
}

fn meet(index: u32, origin: vec3f, direction: vec3f) -> Met {
    var met = Met(FAR, 0u);
    let end = min(index + NEIGHBOURS + 1u, sorting.count);
    for (var other = max(index, NEIGHBOURS) - NEIGHBOURS; other < end; other++) {
        let distance = distance_to(unsorted[keys[other].y], origin, direction);
        if other != index && distance < FAR {
            met = Met(min(met.distance, distance), met.count + 1u);
        }
    }
    return met;
}

// Directions into a half space in which a body must be closed: ahead, oblique, and almost along the
// surface, where two sheets that face each other are open.
const WAYS = array<vec3f, 9>(
    vec3f(0.0, 0.0, 1.0),
    vec3f(0.93, 0.21, 0.3), vec3f(-0.87, 0.35, 0.35),
    vec3f(0.17, -0.91, 0.38), vec3f(-0.11, 0.9, 0.42),
    vec3f(0.98, 0.2, 0.03), vec3f(-0.93, 0.37, 0.03),
    vec3f(0.19, -0.98, 0.03), vec3f(-0.12, 0.99, 0.03),
);

// Distance of the rays' starts in front of the surface, in voxels, so that its other triangles lie
// behind.
const AHEAD = 0.002;

// Points in a triangle where rays start; not its middle, whose mirror image may lie on an edge of
// the other side.
const PLACES = array<vec2f, 3>(vec2f(0.31, 0.23), vec2f(0.05, 0.88), vec2f(0.87, 0.06));

// Whether the side that `normal` points to is inside of a thin body: an odd number of emitters lies
// ahead in all directions, and the body is thinner than a voxel ahead or along the surface.
fn is_inside(index: u32, emitter: Emitter, normal: vec3f) -> bool {
    let along = normalize(emitter.along_ab);
    let frame = mat3x3f(along, cross(normal, along), normal);
    var least = FAR;
    for (var i = 0u; i < 3u; i++) {
        let on = emitter.corner + PLACES[i].x * emitter.along_ab + PLACES[i].y * emitter.along_ac;
        var widths = array<f32, 9>();
        for (var way = 0u; way < 9u; way++) {
            let met = meet(index, on + AHEAD * normal, frame * normalize(WAYS[way]));
            if (met.count & 1u) == 0u {
                return false;
            }
            widths[way] = met.distance;
        }
        // The last four are two opposite pairs: the sum of each is a width along the surface.
        least = min(min(least, widths[0]), min(widths[5] + widths[6], widths[7] + widths[8]));
    }
    return least < 1.0;
}

// The emitter, reduced to its outer side if it is double-sided and part of a closed body thinner
// than a voxel. Rays through voxels would otherwise see the inside.
fn without_inside(index: u32, emitter: Emitter) -> Emitter {
    let outward = cross(emitter.along_ab, emitter.along_ac);
    if emitter.is_double_sided == 0u || emitter.power <= 0.0 || all(outward == vec3f(0.0)) {
        return emitter;
    }
    let normal = normalize(outward);
    let is_back_inside = is_inside(index, emitter, -normal);
    if is_back_inside == is_inside(index, emitter, normal) {
        return emitter;
    }
    var outer = emitter;
    outer.is_double_sided = 0u;
    outer.power = 0.5 * emitter.power;
    outer.along_ab = select(emitter.along_ac, emitter.along_ab, is_back_inside);
    outer.along_ac = select(emitter.along_ab, emitter.along_ac, is_back_inside);
    return outer;
}

// Writes the emitters in sorted order.
@compute @workgroup_size(SORT_WORKGROUP_SIZE)
fn place(@builtin(global_invocation_id) invocation: vec3u) {
    let index = invocation.x;
    if index == 0u {
        list.count = sorting.count;
    }
    if index < sorting.count {
        list.records[index] = record_of(without_inside(index, unsorted[keys[index].y]));
    }
}
