// Coordinates of the nodes: the inverse of a search.

struct Site {
    // Morton code of the node's coordinates.
    morton: u32,
    // 0: there is no node in this place of its group.
    level: u32,
}
