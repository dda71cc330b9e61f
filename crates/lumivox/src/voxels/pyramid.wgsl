// The next coarser level of the occupancy bits: a cell is occupied if any of its eight children is.
// In Morton order the children are one byte, so that a word of parents is eight words of children.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;

struct PyramidParams {
    child_first_word: u32,
    child_words: u32,
    parent_first_word: u32,
    parent_words: u32,
}

@group(1) @binding(0) var<uniform> params: PyramidParams;
@group(1) @binding(1) var<storage, read_write> occupancy: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let parent_word = linear_index(invocation, workgroups);
    if parent_word >= params.parent_words {
        return;
    }
    var parents = 0u;
    for (var i = 0u; i < 8u; i++) {
        let child_word = parent_word * 8u + i;
        if child_word >= params.child_words {
            break;
        }
        var children = occupancy[params.child_first_word + child_word];
        // The lowest bit of each byte: whether any bit of that byte is set.
        children |= children >> 4u;
        children |= children >> 2u;
        children |= children >> 1u;
        children &= 0x01010101u;
        // The lowest bits of the four bytes, side by side.
        let nibble = (children | (children >> 7u) | (children >> 14u) | (children >> 21u)) & 0xfu;
        parents |= nibble << (4u * i);
    }
    occupancy[params.parent_first_word + parent_word] = parents;
}
