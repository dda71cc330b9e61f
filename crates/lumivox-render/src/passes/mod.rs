//! The passes of a frame: from the scene's triangles to one frame of radiance, and its overlay.
//!
//! | file | does | reads |
//! | --- | --- | --- |
//! | `shadow_maps` | depth from each light | the scene |
//! | `shadow_layers` | the layers of shadow maps | lights, grid |
//! | `near_shadows` | depth from the sun around the camera | the scene |
//! | `gbuffer` | the surface at each pixel | the scene |
//! | `direct` | direct light from lamps and the sun | G-buffer, shadow maps |
//! | (`lumivox`) | the cones: indirect light | G-buffer, volume |
//! | `composite` | the sum of both, or the part that a view shows | all of these |
//! | `voxel_view/` | the voxels, in place of the composite | the volume |
//! | `accumulate` | the mean over frames | the composite |
//! | `figures` | sums for panels | the cones |
//! | `overlay/` | lines and wires over the picture | G-buffer |
//!
//! A pass receives the textures that it reads and the [library](crate::shaders) that its shader is
//! linked from. It does not depend on the passes that write them: [`Targets`](targets::Targets) and
//! the renderer connect the passes.

pub(crate) mod accumulate;
pub(crate) mod composite;
pub(crate) mod direct;
pub(crate) mod figures;
pub(crate) mod gbuffer;
pub(crate) mod motion;
pub(crate) mod near_shadows;
pub(crate) mod overlay;
pub(crate) mod raster;
pub(crate) mod shadow_layers;
pub(crate) mod shadow_maps;
pub(crate) mod targets;
pub(crate) mod voxel_view;

use lumivox::gpu::ShaderLibrary;

use crate::View;

/// Defines the numbers of the views.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library.constant_u32("FIGURE_SPACING", figures::FIGURE_SPACING);
    for view in View::ALL {
        library.constant_u32(view.constant(), view as u32);
    }
}
