// The values of the cells, one after another in the order of the voxel list: what bricks are filled from.
//
// A cell has a value of four half floats for each of its parts (parts.wgsl), in the order of parts. The children of a
// node follow one another in the list, so that filtering reads side by side; and since bricks are copies alone, no
// texture is read and written at once.

import package::voxels::list::Node;

// Bindings 0 to 2 are those of the changed cells (volume/changes/cells.wgsl).
@group(1) @binding(3) var<storage, read> nodes: array<Node>;
// Of each cell of the list, the first value; one more than there are cells: the total.
@group(1) @binding(4) var<storage, read> value_starts: array<u32>;
@group(1) @binding(5) var<storage, read_write> values: array<vec2u>;

fn pack_value(value: vec4f) -> vec2u {
    return vec2u(pack2x16float(value.xy), pack2x16float(value.zw));
}

fn unpack_value(packed: vec2u) -> vec4f {
    return vec4f(unpack2x16float(packed.x), unpack2x16float(packed.y));
}

// A part of a cell of the list that has the parts `parts`; zero if it lacks this one.
fn load_value(cell: u32, parts: u32, part: u32) -> vec4f {
    if ((parts >> part) & 1u) == 0u {
        return vec4f(0.0);
    }
    return unpack_value(values[value_starts[cell] + countOneBits(parts & ((1u << part) - 1u))]);
}

fn store_value(cell: u32, parts: u32, part: u32, value: vec4f) {
    let place = value_starts[cell] + countOneBits(parts & ((1u << part) - 1u));
    values[place] = pack_value(value);
}
