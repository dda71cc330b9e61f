//! Names of the values of the renderer's types.

use super::{Choice, Choices};
use crate::{ShadowMethod, ToneMap, View, Wireframe, Wires};

impl Choices for View {
    const VALUES: &'static [Self] = &Self::ALL;
    const CHOICES: &'static [Choice] = &[
        Choice::new("final", "all light"),
        Choice::new("direct", "emission, and light straight from lamps and sun"),
        Choice::new("indirect", "light from other surfaces and from the environment"),
        Choice::new("diffuse", "indirect light as a white diffuse surface would reflect it"),
        Choice::new("specular", "indirect light that is reflected glossily"),
        Choice::new("occlusion", "ambient visibility: 1 in the open, 0 where no sky is seen"),
        Choice::new("shadow", "share of the lamps' and the sun's light that arrives"),
        Choice::new("albedo", "share of light that is reflected diffusely; metals are black"),
        Choice::new("normal", "shading normals; -1 to 1 along x, y, z as red, green, blue"),
        Choice::new("depth", "distance from the camera; metres in OpenEXR, near is white in PNG"),
        Choice::new("cost", "cone samples a pixel, from violet (none) to yellow (512 and more)"),
        Choice::new(
            "history",
            "frames in the mean of a pixel's light, from violet to yellow (256); with temporal",
        ),
        Choice::new(
            "disocclusion",
            "pixels of which no earlier frame knew anything; with temporal",
        ),
        Choice::new("voxels", "the voxels of one level (--level) as cubes, in their light"),
        Choice::new(
            "lit",
            "which voxels of one level get direct light (yellow), and which not (grey)",
        ),
        Choice::new("nodes", "the octree's nodes around the voxels of one level, as wire boxes"),
        Choice::new(
            "bricks",
            "the bricks of these nodes, texels pulled apart; those of neighbours are orange",
        ),
        Choice::new("lod", "the volume's light of one level (--level), on the surfaces"),
        Choice::new(
            "wire-voxels",
            "the voxels of one level as wire cubes in the colours of their light",
        ),
    ];
}

impl Choices for ToneMap {
    const VALUES: &'static [Self] = &Self::ALL;
    const CHOICES: &'static [Choice] = &[
        Choice::new("neutral", "Khronos PBR Neutral: colours stay, highlights are compressed"),
        Choice::new("aces", "the ACES film curve: more contrast, hues shift in highlights"),
        Choice::new("linear", "no curve: values above 1 are clipped"),
        Choice::new(
            "raw",
            "no curve and no screen encoding: for display values, as in preset vxct",
        ),
    ];
}

impl Choices for ShadowMethod {
    const VALUES: &'static [Self] = &[Self::Map, Self::Cone];
    const CHOICES: &'static [Choice] = &[
        Choice::new("map", "depth maps: sharp, exact to a texel"),
        Choice::new("cone", "cones through the voxels: soft, as coarse as the voxels"),
    ];
}

impl Choices for Wireframe {
    const VALUES: &'static [Self] = &[Self::Off, Self::Over, Self::Through];
    const CHOICES: &'static [Choice] = &[
        Choice::new("off", "no edges"),
        Choice::new("over", "edges of visible surfaces"),
        Choice::new("through", "all edges, also behind surfaces"),
    ];
}

impl Choices for Wires {
    const VALUES: &'static [Self] = &[Self::Off, Self::Over, Self::Through];
    const CHOICES: &'static [Choice] = &[
        Choice::new("off", "no cubes"),
        Choice::new("over", "cubes in front of surfaces"),
        Choice::new("through", "all cubes, also behind surfaces"),
    ];
}
