// Runs `intersect` for each query, and writes the hit in place.

import package::render::reference::intersect::{intersect, Ray};

struct Query {
    origin: vec3f,
    sides: u32,
    direction: vec3f,
    // Input: the reach. Output: the distance of the hit.
    distance: f32,
    weights: vec2f,
    triangle: u32,
    padding: u32,
}

@group(0) @binding(7) var<storage, read_write> queries: array<Query>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    if invocation.x >= arrayLength(&queries) {
        return;
    }
    let query = queries[invocation.x];
    let hit = intersect(Ray(query.origin, query.direction, query.distance), query.sides, false);
    queries[invocation.x].distance = hit.distance;
    queries[invocation.x].weights = hit.weights;
    queries[invocation.x].triangle = hit.triangle;
}
