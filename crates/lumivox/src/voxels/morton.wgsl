// Morton order: the bits of three coordinates of up to 10 bits each, interleaved, x in the lowest
// bit. The eight children of a cell are consecutive, so that they are one byte of a bit mask.

fn spread_bits(value: u32) -> u32 {
    var bits = value & 0x3ffu;
    bits = (bits | (bits << 16u)) & 0x030000ffu;
    bits = (bits | (bits << 8u)) & 0x0300f00fu;
    bits = (bits | (bits << 4u)) & 0x030c30c3u;
    bits = (bits | (bits << 2u)) & 0x09249249u;
    return bits;
}

fn gather_bits(value: u32) -> u32 {
    var bits = value & 0x09249249u;
    bits = (bits | (bits >> 2u)) & 0x030c30c3u;
    bits = (bits | (bits >> 4u)) & 0x0300f00fu;
    bits = (bits | (bits >> 8u)) & 0x030000ffu;
    bits = (bits | (bits >> 16u)) & 0x000003ffu;
    return bits;
}

fn morton_encode(cell: vec3u) -> u32 {
    return spread_bits(cell.x) | (spread_bits(cell.y) << 1u) | (spread_bits(cell.z) << 2u);
}

fn morton_decode(code: u32) -> vec3u {
    return vec3u(gather_bits(code), gather_bits(code >> 1u), gather_bits(code >> 2u));
}
