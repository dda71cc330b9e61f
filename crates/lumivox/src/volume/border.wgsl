// Cells outside the grid are zero. Textures clamp to their edge instead, so a look-up near the
// border is weighted by the share of its trilinear filter inside the grid.

import package::cascades::{box_size, lowest_voxel};

// `position` is in the voxels of the cascade; `up` is the level minus the cascade's number.
fn border_weight(position: vec3f, up: u32, cascade: u32) -> f32 {
    let scale = exp2(-f32(up));
    let texel = (position - vec3f(lowest_voxel(cascade))) * scale;
    let inside = vec3f(box_size()) * scale - texel;
    let weight = saturate(texel + 0.5) * saturate(inside + 0.5);
    return weight.x * weight.y * weight.z;
}
