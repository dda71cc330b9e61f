//! Why a scene has no lightmap.

/// Why a scene has no lightmap. Each message names the mesh or node and a remedy.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LightmapError {
    /// Nothing in the scene can be baked.
    #[error(
        "nothing in the scene is static and visible, but only that is baked; export it without animations"
    )]
    Nothing,
    /// A mesh has no texture coordinates in the set.
    #[error(
        "mesh \"{mesh}\" has no texture coordinates in set {set} (TEXCOORD_{set}); {}", unwrapping(*set)
    )]
    Missing {
        /// The mesh.
        mesh: String,
        /// The set.
        set: u32,
    },
    /// Texture coordinates are outside the unit square.
    #[error(
        "mesh \"{mesh}\": its texture coordinates in set {set} reach from {min:?} to {max:?}, but a \
         lightmap's are within 0 to 1; {}", unwrapping(*set)
    )]
    Outside {
        /// The mesh.
        mesh: String,
        /// The set.
        set: u32,
        /// The least u and v.
        min: [f32; 2],
        /// The greatest u and v.
        max: [f32; 2],
    },
    /// All triangles have no area in texture coordinates.
    #[error(
        "mesh \"{mesh}\": its triangles have no area in texture coordinates, set {set}; {}",
        unwrapping(*set)
    )]
    Flat {
        /// The mesh.
        mesh: String,
        /// The set.
        set: u32,
    },
    /// Triangles of a node overlap each other.
    #[error(
        "node \"{node}\": {texels} of its {covered} texels belong to several triangles, first at \
         u = {:.3}, v = {:.3}; triangles may not overlap in a lightmap's coordinates: unwrap the mesh \
         without overlaps, or choose another set", at[0], at[1]
    )]
    Overlap {
        /// The node.
        node: String,
        /// The number of texels that several triangles cover.
        texels: usize,
        /// The number of texels that any triangle covers.
        covered: usize,
        /// The mesh's coordinates of the first such texel.
        at: [f32; 2],
    },
    /// The density needs more texels than a map has.
    #[error(
        "the density needs {texels} texels along an edge of the map, but it has {most} at most; use a \
         lower one"
    )]
    Dense {
        /// The texels along an edge that the density needs.
        texels: u64,
        /// The most texels along an edge.
        most: u32,
    },
    /// The parts of all nodes do not fit into the map.
    #[error(
        "{nodes} nodes share texture coordinates, and their parts do not fit into a map with an edge \
         of {edge} texels; use a larger map or a lower density, or unwrap them into one common square"
    )]
    TooMany {
        /// The number of nodes.
        nodes: usize,
        /// The map's edge in texels.
        edge: u32,
    },
}

/// The remedy for unsuitable coordinates.
fn unwrapping(set: u32) -> &'static str {
    if set == 0 {
        "unwrap it, or bake into another set"
    } else {
        "unwrap it: in Blender, add a second UV map and use UV > Lightmap Pack, then export both"
    }
}
