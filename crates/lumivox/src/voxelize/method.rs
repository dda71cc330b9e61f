//! Ways from triangles to voxels.

/// How the voxels of a triangle are found.
///
/// All but [`Self::Exact`] are the hardware rasterizer's, and here to be compared with it: they miss voxels or
/// find too many, and the surface in a voxel is an estimate. Only the grid, never the viewer, decides in any of
/// them. See `docs/voxelizers.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum VoxelizeMethod {
    /// Every voxel that the triangle touches, by separating axes (Schwarz and Seidel 2010), with the area and
    /// the centroid of the piece in it.
    #[default]
    Exact,
    /// The triangle is drawn along its normal's dominant axis, and each pixel's centre that it covers is the
    /// voxel at its depth there: an area of 1. Thin parts fall between the centres.
    DominantAxis,
    /// As before, but every pixel that the triangle touches, with all voxels that its plane passes there within
    /// the triangle's box (Hasselgren, Akenine-Möller and Ohlsson 2005; Crassin and Green 2012). Misses nothing;
    /// the area covered in a pixel is exact, its distribution along the depth an estimate.
    Conservative,
    /// The triangle is drawn along all three axes, pixels' centres alone: less falls between them. The three
    /// share out one area.
    ThreePlane,
}

impl VoxelizeMethod {
    /// All methods.
    pub const ALL: [Self; 4] =
        [Self::Exact, Self::DominantAxis, Self::Conservative, Self::ThreePlane];

    /// The method's name in lower case, as on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::DominantAxis => "dominant-axis",
            Self::Conservative => "conservative",
            Self::ThreePlane => "three-plane",
        }
    }
}
