// All surface, as rays meet it: group 0 next to the grid and the emitters.

// Where the faces of voxels are (voxels/index.wgsl).
@group(0) @binding(6) var<storage, read> index: array<u32>;
// The faces (patch.wgsl).
@group(0) @binding(7) var<storage, read> patches: array<vec2u>;
