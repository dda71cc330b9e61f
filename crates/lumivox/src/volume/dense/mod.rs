//! The dense volume: a 3D texture over the whole grid, with a pyramid of levels.
//!
//! With six lobes a cell has nine parts of four half floats (`parts.wgsl`): 72 bytes, 8/7 of that
//! with the pyramid. An isotropic cell has one part. All parts are in one `Rgba16Float` texture, so
//! that tracing binds a single texture and loops over the parts that a sample needs. A mask of two
//! more bytes per cell marks the existing parts, so that empty space needs no look-up. Only cells
//! of the voxel list are written or cleared: time grows with the surface, memory with the third
//! power of the resolution. Use it for small grids and for comparison.

mod build;
mod masks;
#[cfg(test)]
mod tests;

use glam::UVec3;

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    Texture, TextureView,
};
use crate::volume::changes::ChangedCells;
use crate::volume::{CELL_FORMAT, Directionality, budget};
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

use build::Build;
pub(crate) use masks::MASK_LEVELS;
#[cfg(test)]
pub(crate) use masks::MaskLevels;
use masks::Masks;
#[cfg(test)]
pub(crate) use tests::{Level, read_levels};

impl Directionality {
    /// Slabs of the texture along each of its axes.
    fn slabs(self) -> UVec3 {
        match self {
            Self::SixLobes => UVec3::new(1, 3, 3),
            Self::Isotropic => UVec3::ONE,
        }
    }
}

/// The dense volume.
#[derive(Debug)]
pub(crate) struct DenseVolume {
    globals: BindGroup,
    globals_layout: wgpu::BindGroupLayout,
    grid_uniform: Buffer,
    all_levels: TextureView,
    sampler: wgpu::Sampler,
    /// Group 0 with only the grid, for kernels that write the volume.
    grid: BindGroup,
    levels: Vec<TextureView>,
    texture_bytes: u64,
    masks: Masks,
    build: Build,
}

impl DenseVolume {
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &Grid,
        (directionality, memory_budget): (Directionality, Option<u64>),
        emitters: &Buffer,
    ) -> Result<Self, GiError> {
        let size = grid.dimensions * directionality.slabs();
        check_limits(device, grid, size)?;
        let needed = bytes(grid, directionality);
        budget::check("a dense volume", needed, memory_budget, grid, 3.0)?;
        let texture = Texture::new(
            device,
            &wgpu::TextureDescriptor {
                label: Some("dense volume"),
                size: wgpu::Extent3d {
                    width: size.x,
                    height: size.y,
                    depth_or_array_layers: size.z,
                },
                mip_level_count: grid.levels,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D3,
                format: CELL_FORMAT,
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            },
        );
        let levels: Vec<_> = (0..grid.levels)
            .map(|level| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    label: Some("dense volume level"),
                    base_mip_level: level,
                    mip_level_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        let grid_uniform = grid.uniform(device);
        let grid_layout = LayoutBuilder::compute().uniform().build(device, "grid");
        let masks = Masks::new(device, shaders, grid, &grid_layout)?;
        let globals_layout = super::globals_layout(device);
        let sampler = super::sampler(device);
        let all_levels = texture.view();
        let sampled = (&grid_uniform, &masks, &all_levels, &sampler);
        Ok(Self {
            globals: bind_globals(device, &globals_layout, sampled, emitters),
            globals_layout,
            all_levels,
            sampler,
            grid: BindGroupBuilder::new(&grid_layout).buffer(&grid_uniform).build(device, "grid"),
            grid_uniform,
            levels,
            texture_bytes: texture_bytes(grid, directionality),
            masks,
            build: Build::new(device, shaders, directionality, grid, &grid_layout)?,
        })
    }

    /// Uses the moved boxes for later commands.
    pub(super) fn move_to(&mut self, device: &Pipelines, grid: &Grid, emitters: &Buffer) {
        self.grid_uniform = grid.uniform(device);
        let layout = LayoutBuilder::compute().uniform().build(device, "grid");
        self.grid = BindGroupBuilder::new(&layout).buffer(&self.grid_uniform).build(device, "grid");
        self.bind_emitters(device, emitters);
    }

    /// Binds another list of emitters.
    pub(super) fn bind_emitters(&mut self, device: &wgpu::Device, emitters: &Buffer) {
        let sampled = (&self.grid_uniform, &self.masks, &self.all_levels, &self.sampler);
        self.globals = bind_globals(device, &self.globals_layout, sampled, emitters);
    }

    /// Binds another list, or the same one after its buffers were resized.
    pub(super) fn bind(
        &mut self,
        device: &wgpu::Device,
        light: (&VoxelList, &Buffer),
        cells: [&ChangedCells; 2],
    ) {
        self.build.bind(device, light, cells, &self.levels);
        self.masks.bind(device, light.0);
    }

    /// Updates the volume to the list; `wrong` are its cells with changed surface.
    pub(super) fn show(&self, recorder: &mut Recorder<'_>, wrong: &ChangedCells) {
        recorder.stage("volume");
        self.build.clear(recorder, &self.grid, wrong);
        self.masks.fill(recorder, &self.grid);
    }

    pub(super) fn update(&self, recorder: &mut Recorder, changed: &ChangedCells) {
        self.build.update(recorder, &self.grid, changed);
    }

    pub(super) fn globals(&self) -> &BindGroup {
        &self.globals
    }

    pub(super) fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        &self.globals_layout
    }

    pub(super) fn memory(&self) -> Vec<(&'static str, u64)> {
        vec![
            ("volume: radiance, opacity, vector areas", self.texture_bytes),
            ("volume: empty-space masks", self.masks.entries().size()),
        ]
    }

    /// The texture, for tests.
    #[cfg(test)]
    pub(crate) fn texture(&self) -> &wgpu::Texture {
        self.levels[0].texture()
    }
}

/// Group 0 of everything that samples the volume.
fn bind_globals(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    (grid, masks, texture, sampler): (&Buffer, &Masks, &TextureView, &wgpu::Sampler),
    emitters: &Buffer,
) -> BindGroup {
    BindGroupBuilder::new(layout)
        .buffer(grid)
        .buffer(masks.levels_uniform())
        .buffer(masks.entries())
        .view(texture)
        .sampler(sampler)
        .buffer(emitters)
        .build(device, "globals")
}

/// Bytes of the texture with its levels.
fn texture_bytes(grid: &Grid, directionality: Directionality) -> u64 {
    let parts = directionality.slabs().as_u64vec3().element_product();
    let cells =
        (0..grid.levels).map(|level| grid.level_dimensions(level).as_u64vec3().element_product());
    cells.sum::<u64>() * parts * 8
}

/// Bytes of a volume, masks included.
pub(super) fn bytes(grid: &Grid, directionality: Directionality) -> u64 {
    texture_bytes(grid, directionality) + masks::bytes(grid)
}

fn check_limits(device: &wgpu::Device, grid: &Grid, size: UVec3) -> Result<(), GiError> {
    let limit = device.limits().max_texture_dimension_3d;
    let longest = size.max_element();
    if longest > limit {
        let resolution = grid.dimensions.max_element();
        let fitting = resolution * limit / longest / 8 * 8;
        return Err(GiError::Limit {
            what: format!("a dense volume of {resolution} voxels along its longest axis"),
            needed: u64::from(longest),
            unit: "texels along an axis",
            limit: "max_texture_dimension_3d",
            available: u64::from(limit),
            remedy: format!("set the resolution to at most {fitting}"),
        });
    }
    Ok(())
}
