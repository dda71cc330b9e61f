//! Voxelization by the hardware rasterizer: each fragment represents one voxel, or a few of its
//! column.
//!
//! The first voxel cone tracers worked like this (Crassin and Green 2012, OpenGL Insights, chapter
//! 22). It is here for comparison with the exact walk, and differs from it only in how voxels are
//! found: the same three walks, the same bits and integer sums, the same list. Corners are pulled
//! from storage buffers, since WebGPU has no geometry shader to choose the plane or widen a
//! triangle. The picture has a pixel for each column of voxels, and stays empty.

use lumivox::gpu::pipelines::{DrawPipeline, DrawPlan, Shader};
use lumivox::gpu::{Pipelines, Recorder, ShaderError, ShaderLibrary, Texture, TextureView};
use lumivox::hooks::{Voxelization, VoxelizationShares, Walk, WalkStep, Walker};
use lumivox::internal::Kept;
use lumivox::{GiError, Grid};

use crate::with_modules;

/// The shader modules of this folder.
const MODULES: &[(&str, &str)] = &[
    ("classics::raster::accumulate", include_str!("accumulate.wgsl")),
    ("classics::raster::corners", include_str!("corners.wgsl")),
    ("classics::raster::fragment", include_str!("fragment.wgsl")),
    ("classics::raster::mark", include_str!("mark.wgsl")),
    ("classics::raster::planes", include_str!("planes.wgsl")),
    ("classics::raster::share", include_str!("share.wgsl")),
    ("classics::raster::widen", include_str!("widen.wgsl")),
];

/// Format of the render target that WebGPU requires: one byte per pixel, never written.
const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Methods of the rasterizer to voxelize triangles, for [`lumivox::GiConfig::voxelizer`].
///
/// They miss voxels or find too many, and the surface in a voxel is an estimate. All depend only on
/// the grid, never on the viewer. See `docs/voxelizers.md`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Raster {
    /// The triangle is drawn along its normal's dominant axis. Each pixel centre that it covers
    /// gives the voxel at its depth there, with an area of 1. Thin parts fall between the centres.
    DominantAxis,
    /// As [`Self::DominantAxis`], except that every pixel that the triangle touches counts, with
    /// all voxels that its plane passes there within the triangle's box (Hasselgren, Akenine-Möller
    /// and Ohlsson 2005; Crassin and Green 2012). Misses nothing; the area covered in a pixel is
    /// exact, its distribution along the depth is an estimate.
    Conservative,
    /// The triangle is drawn along all three axes, at pixel centres only: less falls between the
    /// centres. The three planes share one area.
    ThreePlane,
}

impl Raster {
    /// All methods.
    pub const ALL: [Self; 3] = [Self::DominantAxis, Self::Conservative, Self::ThreePlane];

    /// The name in lower case, as on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::DominantAxis => "dominant-axis",
            Self::Conservative => "conservative",
            Self::ThreePlane => "three-plane",
        }
    }

    /// How often each triangle is drawn.
    const fn planes(self) -> u32 {
        match self {
            Self::ThreePlane => 3,
            Self::DominantAxis | Self::Conservative => 1,
        }
    }

    /// The library with the modules of this folder.
    fn link_into(self, shaders: &ShaderLibrary) -> ShaderLibrary {
        let mut library = with_modules(shaders, MODULES);
        library
            .constant_u32("RASTER_CONSERVATIVE", Self::Conservative as u32)
            .constant_u32("RASTER_THREE_PLANE", Self::ThreePlane as u32)
            .constant_u32("RASTER_METHOD", self as u32);
        library
    }
}

impl Voxelization for Raster {
    fn name(&self) -> &'static str {
        Self::name(*self)
    }

    fn stages(&self) -> wgpu::ShaderStages {
        wgpu::ShaderStages::VERTEX_FRAGMENT
    }

    fn make(&self, parts: &VoxelizationShares<'_>) -> Result<Box<dyn Walker>, GiError> {
        let device = parts.device;
        let shaders = self.link_into(parts.shaders);
        let corners = device.shader(&shaders, "classics::raster::corners")?;
        let pipelines = |module: &str, entries: [&str; 3], step: WalkStep| {
            let fragments = device.shader(&shaders, module)?;
            let groups = parts.layouts(step);
            let [uniform, varied, pierced] =
                entries.map(|entry| pipeline(device, groups, &corners, &fragments, entry));
            Ok::<_, ShaderError>([uniform?, varied?, pierced?])
        };
        // These steps do not read opaque surfaces, so all opaque surfaces share one pipeline.
        let by_holes = ["opaque", "opaque", "covered"];
        let again = ["opaque_again", "opaque_again", "covered_again"];
        let by_detail = ["plain", "varied", "pierced"];
        Ok(Box::new(RasterWalker {
            mark: pipelines("classics::raster::mark", by_holes, WalkStep::Mark)?,
            first_planes: pipelines("classics::raster::planes", by_holes, WalkStep::Planes)?,
            more_planes: pipelines("classics::raster::planes", again, WalkStep::MorePlanes)?,
            accumulate: pipelines("classics::raster::accumulate", by_detail, WalkStep::Accumulate)?,
            planes: self.planes(),
        }))
    }
}

/// The pipelines of a walk, one for each [`lumivox::hooks::Detail`].
type Variants = [DrawPipeline; 3];

/// The pipelines of one method.
#[derive(Debug)]
struct RasterWalker {
    mark: Variants,
    first_planes: Variants,
    more_planes: Variants,
    accumulate: Variants,
    planes: u32,
}

impl Walker for RasterWalker {
    /// Draws all batches in one pass.
    fn walk(&self, recorder: &mut Recorder, step: WalkStep, walk: &Walk<'_>) -> bool {
        let variants = match step {
            WalkStep::Mark => &self.mark,
            WalkStep::Planes => &self.first_planes,
            WalkStep::MorePlanes => &self.more_planes,
            WalkStep::Accumulate => &self.accumulate,
        };
        let picture = picture(recorder.device(), walk.grid);
        let attachment = wgpu::RenderPassColorAttachment {
            view: &picture.1,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Discard,
            },
        };
        recorder.render(walk.label, &[Some(attachment)], None, |pass| {
            for run in walk.runs() {
                pass.set_pipeline(&variants[run.detail as usize]);
                for (index, group) in (0..).zip(run.groups) {
                    pass.bind(index, group);
                }
                pass.draw(3 * run.triangles.start..3 * run.triangles.end, 0..self.planes);
            }
        });
        recorder.keep(Kept::Texture(picture.0));
        true
    }
}

/// The picture: a pixel for each column of voxels, along any axis.
fn picture(device: &wgpu::Device, grid: &Grid) -> (Texture, TextureView) {
    let edge = grid.dimensions.max_element();
    let texture = Texture::new(
        device,
        &wgpu::TextureDescriptor {
            label: Some("columns of voxels"),
            size: wgpu::Extent3d { width: edge, height: edge, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: PICTURE_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        },
    );
    let view = texture.view();
    (texture, view)
}

fn pipeline(
    pipelines: &Pipelines,
    groups: [&wgpu::BindGroupLayout; 4],
    corners: &Shader,
    fragments: &Shader,
    entry: &str,
) -> Result<DrawPipeline, ShaderError> {
    let target = wgpu::ColorTargetState {
        format: PICTURE_FORMAT,
        blend: None,
        write_mask: wgpu::ColorWrites::empty(),
    };
    // Both sides of a triangle are surface.
    Ok(pipelines.draw(DrawPlan {
        fragment: Some(fragments.entry(entry)?),
        targets: vec![Some(target)],
        groups: groups.map(Clone::clone).to_vec(),
        ..DrawPlan::new(corners, "main")?
    }))
}

#[cfg(test)]
mod tests {
    use lumivox_reflect::check_modules;

    use super::Raster;

    #[test]
    fn shaders_are_valid() {
        for way in Raster::ALL {
            let library = way.link_into(&lumivox::shaders::library());
            assert!(check_modules(&library, "classics::raster") > 0);
        }
    }
}
