// Coordinates of the nodes: the inverse of a search.

struct Site {
    // Morton code of the node's coordinates.
    morton: u32,
    // 0 if this place of the group has no node.
    level: u32,
}
