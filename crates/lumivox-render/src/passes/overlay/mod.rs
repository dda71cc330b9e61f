//! Overlays over a picture: edges of triangles, wire cubes of voxels, the grid's bounds, lines.
//!
//! An overlay is display-referred: its colours are those of a screen, neither exposed nor tone
//! mapped. It has its own texture, in which frames are averaged like the picture's, so that the
//! same jitter smooths its lines. It is blended over the encoded picture at the very end
//! (`blend.wgsl`), and never changes radiance. In each frame coverage is all or nothing, so an edge
//! that two triangles share does not get denser when it is drawn twice.
//!
//! | file | draws |
//! | --- | --- |
//! | `segment.wgsl` | a line as a quad with a width in pixels, hidden behind surfaces |
//! | `edges.rs`, `edges.wgsl` | all edges of triangles, from rasterizer and voxelizer buffers |
//! | `lines.rs`, `lines.wgsl` | the caller's lines, and the grid's box |
//! | `voxels.rs`, `voxels.wgsl` | wire cubes, by a walk through the occupancy bits |
//!
//! While the overlay is off, it has no resources.

mod edges;
mod lines;
mod pass;
mod segment;
mod voxels;

use glam::Vec3;

#[cfg(test)]
pub(crate) use edges::EdgeRange;
pub(crate) use lines::LineRecord;
pub(crate) use pass::{OVERLAY_BYTES_PER_PIXEL, OverlayPass, OverlayView, Shown};
#[cfg(test)]
pub(crate) use segment::SegmentView;
#[cfg(test)]
pub(crate) use voxels::WireSettings;

/// Colour of triangles' edges: sRGB-encoded, and coverage.
pub(crate) const WIREFRAME_COLOR: [f32; 4] = [0.16, 0.85, 1.0, 1.0];
/// Colour of wire cubes.
pub(crate) const WIRE_VOXEL_COLOR: [f32; 4] = [1.0, 0.72, 0.2, 1.0];
/// Colour of the grid's box.
const GRID_BOX_COLOR: [f32; 4] = [0.75, 0.55, 1.0, 1.0];
/// The share of the box that remains visible behind surfaces.
const HIDDEN_SHARE: f32 = 0.25;
/// Colour behind the overlay where surfaces are hidden.
pub(crate) const BACKGROUND: [f32; 4] = [0.07, 0.07, 0.09, 1.0];

/// Width of triangles' edges in pixels.
pub(crate) const WIREFRAME_WIDTH: f32 = 1.25;
/// Width of the caller's lines and of the grid's box, in pixels.
pub(crate) const LINE_WIDTH: f32 = 2.0;

/// An overlay over the picture on a screen; OpenEXR pictures of radiance do not contain it.
/// Default: nothing, at no cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Edges of the scene's triangles. Default: none.
    pub wireframe: Wireframe,
    /// Wire cubes of the voxels at
    /// [`RenderSettings::voxel_level`](crate::RenderSettings::voxel_level): outlines of the faces
    /// between an occupied cell and an empty one. Default: none.
    pub wire_voxels: Wires,
    /// `true` replaces a picture of surfaces by a plain background, so that only the overlay is
    /// visible. Surfaces still hide the parts of the overlay behind them. Views of voxels are not
    /// replaced. Default: `false`.
    pub hides_surfaces: bool,
    /// `true` draws the voxel grid's bounds; they are faint behind surfaces. Default: `false`.
    pub grid_box: bool,
    /// Markers, selection boxes, gizmos. Default: none. Later lines are drawn over earlier ones.
    pub lines: Vec<OverlayLine>,
}

/// Selects the edges of triangles to draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wireframe {
    /// None.
    #[default]
    Off,
    /// Edges of visible surfaces: hidden lines are removed.
    Over,
    /// All edges, also behind surfaces.
    Through,
}

/// Selects the wire cubes to draw.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wires {
    /// None.
    #[default]
    Off,
    /// Cubes in front of surfaces: each surface is within its voxels, whose near faces are visible.
    Over,
    /// All cubes, also behind surfaces.
    Through,
}

/// A line in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OverlayLine {
    /// One end, m.
    pub from: Vec3,
    /// The other end, m; equal ends make a dot.
    pub to: Vec3,
    /// sRGB-encoded colour as a screen shows it, and coverage in the last component, all 0 to 1;
    /// the colour is not premultiplied.
    pub color: [f32; 4],
    /// `true` if surfaces hide it; otherwise it is visible through them.
    pub is_hidden_by_surfaces: bool,
}

impl Wireframe {
    /// The name in lower case, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Over => "over",
            Self::Through => "through",
        }
    }
}

impl Wires {
    /// The name in lower case, as on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Over => "over",
            Self::Through => "through",
        }
    }
}

impl Overlay {
    /// Whether there is anything to draw.
    pub fn is_on(&self) -> bool {
        *self != Self::default()
    }

    /// Whether surfaces hide any part of it, so that their depth must be known.
    pub(crate) fn needs_depth(&self) -> bool {
        self.wireframe == Wireframe::Over
            || self.wire_voxels == Wires::Over
            || self.grid_box
            || self.lines.iter().any(|line| line.is_hidden_by_surfaces)
    }
}
