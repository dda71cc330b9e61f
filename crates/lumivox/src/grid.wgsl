// The voxel grid, as in grid.rs: group 0, binding 0 of every kernel that knows about voxels.

import package::constants::MAX_CASCADES;

struct Grid {
    origin_in_world: vec3f,
    voxel_size_m: f32,
    // Voxels that are stored, along each axis.
    dimensions: vec3u,
    levels: u32,
    // The voxel at the corner of each cascade, in its own voxels.
    lowest: array<vec4i, MAX_CASCADES>,
    // The middle of each cascade, and in w half of its edge, in the finest voxels.
    boxes: array<vec4f, MAX_CASCADES>,
    // Of each the voxels that walks over triangles go over, from the first to that behind the last, in its own voxels: all,
    // or those that have entered the box.
    walked_low: array<vec4i, MAX_CASCADES>,
    walked_high: array<vec4i, MAX_CASCADES>,
}

@group(0) @binding(0) var<uniform> grid: Grid;

fn grid_from_world(position_in_world: vec3f) -> vec3f {
    return (position_in_world - grid.origin_in_world) / grid.voxel_size_m;
}

fn world_from_grid(position_in_grid: vec3f) -> vec3f {
    return grid.origin_in_world + position_in_grid * grid.voxel_size_m;
}
