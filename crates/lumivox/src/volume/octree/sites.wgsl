// Where the nodes are: the other way round than a search.

struct Site {
    // The node's coordinates, interleaved.
    morton: u32,
    // 0: there is no node in this place of its group.
    level: u32,
}
