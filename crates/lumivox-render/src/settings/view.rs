//! Views: the possible contents of a picture.

use lumivox::settings::Choices as _;

/// The content of the picture.
///
/// Views of light (`Final` to `Specular`) are exposed and tone mapped, and stored in cd/m² in
/// OpenEXR. The others are data: they bypass both, and OpenEXR stores the quantity itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum View {
    /// All light: `Direct` + `Indirect`.
    #[default]
    Final,
    /// Emission, and direct light from lamps and sun.
    Direct,
    /// Light from other surfaces and from the environment, reflected by this surface.
    Indirect,
    /// Indirect light as a white diffuse surface would reflect it: irradiance / pi, without albedo.
    Diffuse,
    /// Indirect light that the surface reflects glossily.
    Specular,
    /// Ambient visibility: 1 where only sky is visible from the surface, 0 where none is.
    Occlusion,
    /// The unblocked share of the lamps' and the sun's light, weighted by luminance; a surface that
    /// faces away from a light blocks it. 1 without lights.
    Shadow,
    /// Diffuse albedo. Metals have none: they are black.
    Albedo,
    /// Shading normal in the world, with x, y and z from -1 to 1 shown as 0 to 255 in red, green,
    /// blue.
    Normal,
    /// Distance from the camera in metres; white is near, black is the distance of the scene's
    /// farthest corner.
    Depth,
    /// Cone samples taken for the pixel, as colours from dark violet (0) over green to yellow
    /// ([`COST_SCALE_SAMPLES`] and above).
    Cost,
    /// The number of frames in the mean of a pixel's light, this one included, as colours from dark
    /// violet (none) to yellow ([`HISTORY_SCALE_FRAMES`] and above), on a logarithmic scale. Like
    /// `Disocclusion`, it shows only the last frame; both need light of earlier frames
    /// ([`TraceSettings::temporal`](lumivox::TraceSettings::temporal)).
    History,
    /// 1 where no earlier frame has seen the surface, as beside an object that has moved; 0
    /// elsewhere.
    Disocclusion,
    /// The voxels of one level as cubes with their stored light.
    Voxels,
    /// The voxels of one level that lamps and sun reach, or that emit (yellow), and the others
    /// (grey).
    Lit,
    /// The nodes of an octree around the cells of one level, as wire boxes: blue for nodes with
    /// their own cells, orange for nodes that exist only for their neighbours.
    Nodes,
    /// The bricks of these nodes, their 3x3x3 texels pulled apart; the neighbours' layer is orange.
    Bricks,
    /// The volume's radiance of one level at the visible surfaces, filtered as by cones that look
    /// against the surface's normal; not weighted by opacity; black where the volume is empty.
    Lod,
    /// The voxels of one level as wire cubes in the colours of their light, visible through each
    /// other; faces between two voxels are left out.
    WireVoxels,
}

/// The number of cone samples at the upper end of [`View::Cost`]'s colours.
pub const COST_SCALE_SAMPLES: f32 = 512.0;

/// The number of frames at the upper end of [`View::History`]'s colours.
pub const HISTORY_SCALE_FRAMES: f32 = 256.0;

impl View {
    /// All views.
    pub const ALL: [Self; 19] = [
        Self::Final,
        Self::Direct,
        Self::Indirect,
        Self::Diffuse,
        Self::Specular,
        Self::Occlusion,
        Self::Shadow,
        Self::Albedo,
        Self::Normal,
        Self::Depth,
        Self::Cost,
        Self::History,
        Self::Disocclusion,
        Self::Voxels,
        Self::Lit,
        Self::Nodes,
        Self::Bricks,
        Self::Lod,
        Self::WireVoxels,
    ];

    /// The view's name in lower case.
    pub fn name(self) -> &'static str {
        self.choice()
    }

    /// The name of the view's constant in the shaders; its value is `self as u32`.
    pub(crate) fn constant(self) -> &'static str {
        match self {
            Self::Final => "VIEW_FINAL",
            Self::Direct => "VIEW_DIRECT",
            Self::Indirect => "VIEW_INDIRECT",
            Self::Diffuse => "VIEW_DIFFUSE",
            Self::Specular => "VIEW_SPECULAR",
            Self::Occlusion => "VIEW_OCCLUSION",
            Self::Shadow => "VIEW_SHADOW",
            Self::Albedo => "VIEW_ALBEDO",
            Self::Normal => "VIEW_NORMAL",
            Self::Depth => "VIEW_DEPTH",
            Self::Cost => "VIEW_COST",
            Self::History => "VIEW_HISTORY",
            Self::Disocclusion => "VIEW_DISOCCLUSION",
            Self::Voxels => "VIEW_VOXELS",
            Self::Lit => "VIEW_LIT",
            Self::Nodes => "VIEW_NODES",
            Self::Bricks => "VIEW_BRICKS",
            Self::Lod => "VIEW_LOD",
            Self::WireVoxels => "VIEW_WIRE_VOXELS",
        }
    }

    /// Whether the values are radiances, which are exposed and tone mapped.
    pub fn is_light(self) -> bool {
        use View::{Bricks, Diffuse, Direct, Final, Indirect, Lod, Specular, Voxels, WireVoxels};
        let is_of_surfaces = matches!(self, Final | Direct | Indirect | Diffuse | Specular);
        is_of_surfaces || matches!(self, Voxels | Bricks | Lod | WireVoxels)
    }

    /// Whether the view shows voxels instead of surfaces.
    pub fn is_of_voxels(self) -> bool {
        matches!(self, Self::Voxels | Self::Lit | Self::Nodes | Self::Bricks | Self::WireVoxels)
    }

    /// Whether the view needs an octree.
    pub fn needs_octree(self) -> bool {
        matches!(self, Self::Nodes | Self::Bricks)
    }

    /// Whether the view shows the known light, and so needs light of earlier frames.
    pub fn needs_past(self) -> bool {
        matches!(self, Self::History | Self::Disocclusion)
    }

    /// Whether the view needs the analytic lights.
    pub(crate) fn needs_direct(self) -> bool {
        matches!(self, Self::Final | Self::Direct | Self::Shadow)
    }

    /// Whether the view needs cones, given the number of bounces.
    pub(crate) fn needs_cones(self, bounces: u32) -> bool {
        let light = matches!(self, Self::Final | Self::Indirect | Self::Diffuse | Self::Specular);
        let is_of_cones = matches!(self, Self::Occlusion | Self::Cost) || self.needs_past();
        is_of_cones || (light && bounces > 0)
    }
}
