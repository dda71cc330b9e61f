//! The dense volume: a 3D texture over the whole grid, with a pyramid of levels.
//!
//! With six lobes a cell has nine parts of four half floats (`atlas.wgsl`): 72 bytes, 8/7 of it with the
//! pyramid. Isotropic it has one. All parts stand in one `Rgba16Float` texture, so that tracing binds a single
//! texture and loops over the parts that a sample needs. Two more bytes a cell tell which parts are there, so
//! that empty space costs no look-up. Only cells of the voxel list are ever written or cleared: time goes
//! with the surface, memory with the cube. Use it for small grids and for comparison.

mod build;
mod masks;
#[cfg(test)]
mod tests;

use glam::UVec3;

use crate::gpu::{BindGroupBuilder, LayoutBuilder, Recorder, ShaderLibrary, uniform_buffer};
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

use super::changes::ChangedCells;
use build::Build;
#[cfg(test)]
pub(crate) use build::LevelWords;
use masks::Masks;
#[cfg(test)]
pub(crate) use masks::{MaskLevels, NodeRange};
#[cfg(test)]
pub(crate) use tests::{Level, read_levels};

/// The shader modules of this folder; `package::volume` itself is mounted by [`mount`].
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("volume::atlas", include_str!("atlas.wgsl")),
    ("volume::border", include_str!("border.wgsl")),
    ("volume::changed_cells", include_str!("changed_cells.wgsl")),
    ("volume::clear", include_str!("clear.wgsl")),
    ("volume::filter", include_str!("filter.wgsl")),
    ("volume::isotropic_filter", include_str!("isotropic_filter.wgsl")),
    ("volume::isotropic_store", include_str!("isotropic_store.wgsl")),
    ("volume::level_range", include_str!("level_range.wgsl")),
    ("volume::mark_masks", include_str!("mark_masks.wgsl")),
    ("volume::masks", include_str!("masks.wgsl")),
    ("volume::store", include_str!("store.wgsl")),
];

const CELL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// How a voxel looks from different sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Directionality {
    /// Six lobes with vector areas: each side of a wall has its own light, and covers what it covers.
    #[default]
    SixLobes,
    /// One value a voxel, the same from everywhere: a ninth of the memory, and surfaces that light and
    /// shadow themselves.
    Isotropic,
}

impl Directionality {
    /// Slabs of the texture along each of its axes.
    fn slabs(self) -> UVec3 {
        match self {
            Self::SixLobes => UVec3::new(1, 3, 3),
            Self::Isotropic => UVec3::ONE,
        }
    }
}

/// Makes the shader that samples the volume the module `package::volume`.
pub(crate) fn mount(shaders: &mut ShaderLibrary, directionality: Directionality) {
    let source = match directionality {
        Directionality::SixLobes => include_str!("six_lobes.wgsl"),
        Directionality::Isotropic => include_str!("isotropic.wgsl"),
    };
    shaders.add("volume", source);
}

/// The dense volume.
#[derive(Debug)]
pub(crate) struct DenseVolume {
    globals: wgpu::BindGroup,
    globals_layout: wgpu::BindGroupLayout,
    /// Group 0 with the grid alone, for the kernels that write the volume.
    grid: wgpu::BindGroup,
    levels: Vec<wgpu::TextureView>,
    bytes: u64,
    masks: Masks,
    build: Build,
}

impl DenseVolume {
    pub(super) fn new(
        device: &wgpu::Device,
        shaders: &mut ShaderLibrary,
        grid: &Grid,
        directionality: Directionality,
    ) -> Result<Self, GiError> {
        let size = grid.dimensions * directionality.slabs();
        check_limits(device, grid, size)?;
        mount(shaders, directionality);
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("dense volume"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: size.z },
            mip_level_count: grid.levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: CELL_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
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
        let texels: u64 =
            (0..grid.levels).map(|level| (size >> level).as_u64vec3().element_product()).sum();

        let grid_uniform = uniform_buffer(device, "grid", &grid.to_gpu());
        let grid_layout = LayoutBuilder::compute().uniform().build(device, "grid");
        let masks = Masks::new(device, shaders, grid, &grid_layout)?;
        let globals_layout = LayoutBuilder::compute()
            .uniform()
            .uniform()
            .storage()
            .texture_3d()
            .sampler()
            .build(device, "globals");
        // The tracer draws one level for each sample, so that levels need no mixing.
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("volume"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let all_levels = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let globals = BindGroupBuilder::new(&globals_layout)
            .buffer(&grid_uniform)
            .buffer(masks.levels_uniform())
            .buffer(masks.entries())
            .view(&all_levels)
            .sampler(&sampler)
            .build(device, "globals");
        Ok(Self {
            globals,
            globals_layout,
            grid: BindGroupBuilder::new(&grid_layout).buffer(&grid_uniform).build(device, "grid"),
            levels,
            bytes: texels * 8,
            masks,
            build: Build::new(device, shaders, directionality, grid, &grid_layout)?,
        })
    }

    pub(super) fn rebuild(
        &mut self,
        recorder: &mut Recorder,
        voxels: &VoxelList,
        radiance: &wgpu::Buffer,
        (wrong, changed): (Option<&ChangedCells>, &ChangedCells),
    ) {
        recorder.stage("volume");
        if let Some(wrong) = wrong {
            self.build.clear(recorder, &self.grid, wrong, &self.levels);
        }
        self.build.bind(recorder.device(), voxels, radiance, changed, &self.levels);
        self.masks.rebuild(recorder, &self.grid, voxels);
    }

    pub(super) fn update(&self, recorder: &mut Recorder, changed: &ChangedCells) {
        self.build.update(recorder, &self.grid, changed);
    }

    pub(super) fn globals(&self) -> &wgpu::BindGroup {
        &self.globals
    }

    pub(super) fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        &self.globals_layout
    }

    pub(super) fn memory(&self) -> Vec<(&'static str, u64)> {
        vec![
            ("volume: radiance, opacity, vector areas", self.bytes),
            ("volume: empty-space masks", self.masks.entries().size()),
        ]
    }

    /// The texture, for tests.
    #[cfg(test)]
    pub(crate) fn texture(&self) -> &wgpu::Texture {
        self.levels[0].texture()
    }
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
