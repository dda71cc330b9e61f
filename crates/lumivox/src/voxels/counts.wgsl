// The counts of the list of voxels, on the GPU.
//
// They are stored in one buffer of blocks of COUNT_BLOCK_WORDS words: first `ListCounts`, then for
// each level a `NodeRange`, followed by the workgroups of a dispatch over its nodes.

struct ListCounts {
    // Number of faces of static surface, which come first, and of all faces.
    fixed_faces: u32,
    faces: u32,
    // Number of nodes of all levels.
    nodes: u32,
    // Number of voxels that dynamic surface touches.
    moving_voxels: u32,
    // The workgroups of a dispatch over all faces.
    face_groups: vec3u,
    padding: u32,
}

// The nodes of a level.
struct NodeRange {
    level: u32,
    first: u32,
    count: u32,
    padding: u32,
}
