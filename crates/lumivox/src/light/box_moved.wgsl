// The box around all voxels that dynamic surface touches, after surface has moved. Rays that meet
// neither this box nor the previous ones keep their hits (turn.wgsl).

import package::constants::{LINEAR_WORKGROUP_SIZE, MOVED_BOXES};
import package::gpu::dispatch::linear_index;
import package::light::turn::{BounceSettings, BOX_WORDS, MOST_COORDINATE};
import package::voxels::counts::ListCounts;
import package::voxels::list::Face;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> settings: BounceSettings;
@group(1) @binding(1) var<uniform> counts: ListCounts;
@group(1) @binding(2) var<storage, read> faces: array<Face>;
@group(1) @binding(3) var<storage, read_write> boxes: array<atomic<u32>, MOVED_BOXES * BOX_WORDS>;

var<workgroup> around_group: array<atomic<u32>, BOX_WORDS>;

// Empties the box. One workgroup.
@compute @workgroup_size(BOX_WORDS)
fn empty(@builtin(local_invocation_index) word: u32) {
    atomicStore(&boxes[settings.box_written * BOX_WORDS + word], 0u);
}

// A thread for each face of a voxel that dynamic surface touches.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    let face = counts.fixed_faces + linear_index(invocation, workgroups);
    if face < counts.faces {
        let voxel = morton_decode(faces[face].cell);
        for (var axis = 0u; axis < 3u; axis++) {
            atomicMax(&around_group[axis], MOST_COORDINATE - voxel[axis]);
            atomicMax(&around_group[4u + axis], voxel[axis] + 1u);
        }
    }
    workgroupBarrier();
    if thread < BOX_WORDS {
        let word = settings.box_written * BOX_WORDS + thread;
        atomicMax(&boxes[word], atomicLoad(&around_group[thread]));
    }
}
