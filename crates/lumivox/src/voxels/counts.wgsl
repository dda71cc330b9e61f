// How much there is in the list of voxels: numbers that stay on the GPU.
//
// They stand in one buffer of blocks of COUNT_BLOCK_WORDS words: first `ListCounts`, then for each level a `NodeRange` and behind it the workgroups of a dispatch over its nodes.

struct ListCounts {
    // Faces: those of static surface, which come first, and all.
    fixed_faces: u32,
    faces: u32,
    // Nodes of all levels.
    nodes: u32,
    // Voxels that dynamic surface touches.
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
