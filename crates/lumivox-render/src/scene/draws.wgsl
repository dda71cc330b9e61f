// The draws of a scene: binding 1 of group 0 of the passes that rasterize, indexed by instance.

struct DrawRecord {
    world_from_local: mat4x4f,
    // Inverse transpose of the linear part, for normals.
    normal_from_local: mat4x4f,
}

@group(0) @binding(1) var<storage, read> draws: array<DrawRecord>;
