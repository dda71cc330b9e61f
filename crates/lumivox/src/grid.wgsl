// The voxel grid, as in grid.rs: group 0, binding 0 of every kernel that uses voxels.

import package::constants::MAX_CASCADES;

struct Grid {
    origin_in_world: vec3f,
    voxel_size_m: f32,
    // Stored voxels along each axis.
    dimensions: vec3u,
    levels: u32,
    // The voxel at the corner of each cascade, in voxels of that cascade.
    lowest: array<vec4i, MAX_CASCADES>,
    // The center of each cascade, and in w half of its edge, in the finest voxels.
    boxes: array<vec4f, MAX_CASCADES>,
    // Range of voxels of each cascade that triangle walks cover, first inclusive, last exclusive,
    // in voxels of that cascade: all voxels, or only those that have entered the box.
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
