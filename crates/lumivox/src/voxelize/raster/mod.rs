//! Voxelization by the hardware rasterizer: each fragment stands for a voxel, or for the few of its column.
//!
//! This is how voxel cone tracing was done at first (Crassin and Green 2012, OpenGL Insights, chapter 22). It is
//! here to be compared with the exact walk, and shares all with it but the way to the voxels: the same three
//! walks, the same bits and integer sums, the same list. Corners are pulled from storage buffers, since there is
//! no geometry shader that could choose the plane or widen a triangle; the picture has a pixel for each column
//! of voxels, and nothing is drawn into it.

use crate::gpu::pipelines::{DrawPipeline, DrawPlan, Shader};
use crate::gpu::{
    BindGroup, Kept, Pipelines, Recorder, ShaderError, ShaderLibrary, Texture, TextureView,
};
use crate::{Grid, VoxelizeMethod};

use super::batch::SplitBatch;
use super::kernels::{Detail, Layouts};
use super::walk::Step;

/// The shader modules of this folder.
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("voxelize::raster::accumulate", include_str!("accumulate.wgsl")),
    ("voxelize::raster::corners", include_str!("corners.wgsl")),
    ("voxelize::raster::fragment", include_str!("fragment.wgsl")),
    ("voxelize::raster::lobes", include_str!("lobes.wgsl")),
    ("voxelize::raster::mark", include_str!("mark.wgsl")),
    ("voxelize::raster::share", include_str!("share.wgsl")),
    ("voxelize::raster::widen", include_str!("widen.wgsl")),
];

/// `RASTER_METHOD` where only pixel centres along the dominant axis count.
const DOMINANT_AXIS: u32 = 0;
/// Where every pixel that is touched counts.
const CONSERVATIVE: u32 = 1;
/// Where triangles are drawn along all three axes.
const THREE_PLANE: u32 = 2;

/// The picture that WebGPU wants to have; one byte a pixel, and never written.
const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// Defines the constants that Rust and the shaders of this folder share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_u32("RASTER_CONSERVATIVE", CONSERVATIVE)
        .constant_u32("RASTER_THREE_PLANE", THREE_PLANE)
        .constant_u32("RASTER_METHOD", DOMINANT_AXIS);
}

/// The pipelines of a walk, one for each [`Detail`].
pub(super) type Variants = [DrawPipeline; 3];

/// The pipelines of one method.
#[derive(Debug)]
pub(super) struct Raster {
    mark: Variants,
    lobes: Variants,
    accumulate: Variants,
    /// How often each triangle is drawn.
    planes: u32,
}

impl Raster {
    /// Compiles the pipelines; `None` for the method that needs none.
    ///
    /// # Errors
    /// When a shader does not link.
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        layouts: &Layouts,
        method: VoxelizeMethod,
    ) -> Result<Option<Self>, ShaderError> {
        let (constant, planes) = match method {
            VoxelizeMethod::Exact => return Ok(None),
            VoxelizeMethod::DominantAxis => (DOMINANT_AXIS, 1),
            VoxelizeMethod::Conservative => (CONSERVATIVE, 1),
            VoxelizeMethod::ThreePlane => (THREE_PLANE, 3),
        };
        let mut shaders = shaders.clone();
        shaders.constant_u32("RASTER_METHOD", constant);
        let corners = device.shader(&shaders, "voxelize::raster::corners")?;
        let pipelines = |module: &str, entries: [&str; 3], pass: &wgpu::BindGroupLayout| {
            let fragments = device.shader(&shaders, module)?;
            let groups = [&layouts.grid, &layouts.triangles, pass, &layouts.run];
            let [uniform, varied, pierced] =
                entries.map(|entry| pipeline(device, groups, &corners, &fragments, entry));
            Ok::<_, ShaderError>([uniform?, varied?, pierced?])
        };
        // Where the surface itself does not matter, what is not pierced is all alike.
        let by_holes = ["opaque", "opaque", "covered"];
        let by_detail = ["plain", "varied", "pierced"];
        Ok(Some(Self {
            mark: pipelines("voxelize::raster::mark", by_holes, &layouts.mark)?,
            lobes: pipelines("voxelize::raster::lobes", by_holes, &layouts.lobes)?,
            accumulate: pipelines("voxelize::raster::accumulate", by_detail, &layouts.accumulate)?,
            planes,
        }))
    }

    /// The pipelines of a step; `None` for what is walked exactly by all methods.
    pub fn variants(&self, step: Step) -> Option<&Variants> {
        match step {
            Step::Mark => Some(&self.mark),
            Step::Lobes => Some(&self.lobes),
            Step::Fronts => None,
            Step::Accumulate => Some(&self.accumulate),
        }
    }

    /// Draws all batches in one pass; each comes with its bind group 2.
    pub fn walk<'b>(
        &self,
        recorder: &mut Recorder,
        label: &str,
        grid: (&Grid, &BindGroup),
        batches: impl Iterator<Item = (&'b SplitBatch, &'b BindGroup)>,
        variants: &Variants,
    ) {
        let picture = picture(recorder.device(), grid.0);
        let attachment = wgpu::RenderPassColorAttachment {
            view: &picture.1,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Discard,
            },
        };
        recorder.render(label, &[Some(attachment)], None, |pass| {
            for (batch, own) in batches {
                let choose = |detail: Detail| &variants[detail as usize];
                batch.draw(pass, grid.1, own, self.planes, choose);
            }
        });
        recorder.keep(Kept::Texture(picture.0));
    }
}

/// The picture: a pixel for each column of voxels, whichever axis they stand along.
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
