// Writes the lobes of each voxel of the list, and the index of its first face.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::counts::{ListCounts, NodeRange};
import package::voxels::list::Node;
import package::voxels::lookup::bits_below;
import package::voxelize::needs::Needs;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<uniform> counts: ListCounts;
// The nodes of level 0.
@group(1) @binding(2) var<uniform> finest: NodeRange;
// For each share: its cells' bits and ranks, its voxels' lobes, and the indices of their first
// faces.
@group(1) @binding(3) var<storage, read> fixed_cells: array<vec2u>;
@group(1) @binding(4) var<storage, read> fixed_nodes: array<Node>;
@group(1) @binding(5) var<storage, read> fixed_faces: array<u32>;
@group(1) @binding(6) var<storage, read> moving_cells: array<vec2u>;
@group(1) @binding(7) var<storage, read> moving_nodes: array<Node>;
@group(1) @binding(8) var<storage, read> united_faces: array<u32>;
@group(1) @binding(9) var<storage, read_write> nodes: array<Node>;
@group(1) @binding(10) var<storage, read_write> first_faces: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if needs.overflow != 0u || voxel >= finest.count {
        return;
    }
    let word = nodes[voxel].morton / 32u;
    let bit = nodes[voxel].morton % 32u;
    // Dynamic surface takes precedence: its faces include those of static surface.
    if word < arrayLength(&moving_cells) {
        let cell = moving_cells[word];
        if (cell.x & (1u << bit)) != 0u {
            let own = cell.y + bits_below(cell.x, bit);
            nodes[voxel].lobes = moving_nodes[own].lobes;
            first_faces[voxel] = counts.fixed_faces + united_faces[own];
            return;
        }
    }
    let cell = fixed_cells[word];
    let own = cell.y + bits_below(cell.x, bit);
    nodes[voxel].lobes = fixed_nodes[own].lobes;
    first_faces[voxel] = fixed_faces[own];
}
