//! What is drawn over the picture.

use clap::Args;
use lumivox_render::{Overlay, Wireframe, Wires};

use super::choices;

/// The overlay of a picture.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Overlay")]
pub struct OverlayArgs {
    /// Draw the edges of all triangles over the picture [default: off]
    ///
    /// An overlay is in PNG alone; OpenEXR stays what it is.
    #[arg(long, value_name = "HOW", value_parser = choices::wireframe())]
    wireframe: Option<Wireframe>,

    /// Draw the voxels of one level (--level) as wire cubes over the picture [default: off]
    ///
    /// Faces between two voxels are left out.
    #[arg(long, value_name = "HOW", value_parser = choices::wire_voxels())]
    wire_voxels: Option<Wires>,

    /// Draw the box that the voxels lie in [default: off]
    ///
    /// It is faint where surfaces hide it.
    #[arg(long)]
    show_grid: bool,

    /// Show the overlay on a plain background instead of the picture [default: off]
    ///
    /// Surfaces still hide what they hide of it.
    #[arg(long)]
    hide_surfaces: bool,
}

impl OverlayArgs {
    /// The overlay that is asked for.
    pub fn overlay(&self) -> Overlay {
        Overlay {
            wireframe: self.wireframe.unwrap_or_default(),
            wire_voxels: self.wire_voxels.unwrap_or_default(),
            hides_surfaces: self.hide_surfaces,
            grid_box: self.show_grid,
            lines: Vec::new(),
        }
    }
}
