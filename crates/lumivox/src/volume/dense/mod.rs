//! The dense volume: 3D textures over the whole grid, with a pyramid of levels.
//!
//! With six lobes: one `Rgba16Float` texture a lobe (radiance premultiplied by opacity, opacity), one
//! `Rgba8Snorm` texture an axis (the vector areas' components across it): 60 bytes a voxel, 8/7 of it with the
//! pyramid. Isotropic: one `Rgba16Float` texture. Only cells of the voxel list are ever written or cleared, so
//! time goes with the surface while memory goes with the cube; use it for small grids and for comparison.

mod build;
mod masks;
#[cfg(test)]
mod tests;

use glam::UVec3;

use crate::gpu::{BindGroupBuilder, LayoutBuilder, Recorder, ShaderLibrary, uniform_buffer};
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

use build::Build;
use masks::Masks;
#[cfg(test)]
pub(crate) use masks::{LevelRange, MaskLevels};

/// The shader modules of this folder; `package::volume` itself is mounted by [`DenseVolume::new`].
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("volume::masks", include_str!("masks.wgsl")),
    ("volume::mark_masks", include_str!("mark_masks.wgsl")),
    ("volume::store", include_str!("store.wgsl")),
    ("volume::filter", include_str!("filter.wgsl")),
    ("volume::isotropic_build", include_str!("isotropic_build.wgsl")),
];

const LOBE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const TILT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Snorm;

/// How a voxel looks from different sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Directionality {
    /// Six lobes with vector areas: each side of a wall has its own light, and covers what it covers.
    #[default]
    SixLobes,
    /// One value a voxel, the same from everywhere: a seventh of the memory, and surfaces that light and
    /// shadow themselves.
    Isotropic,
}

/// A texture of the volume, with a view of each level.
#[derive(Debug)]
pub(super) struct Pyramid {
    all_levels: wgpu::TextureView,
    levels: Vec<wgpu::TextureView>,
    bytes: u64,
}

/// The dense volume.
#[derive(Debug)]
pub(crate) struct DenseVolume {
    globals: wgpu::BindGroup,
    globals_layout: wgpu::BindGroupLayout,
    /// +x, -x, +y, -y, +z, -z; or the only one.
    lobes: Vec<Pyramid>,
    /// x, y, z; or none.
    tilts: Vec<Pyramid>,
    masks: Masks,
    build: Build,
    /// Whether the vector areas of the current list are yet to be stored.
    tilt_is_due: bool,
}

impl DenseVolume {
    pub(super) fn new(
        device: &wgpu::Device,
        shaders: &mut ShaderLibrary,
        grid: &Grid,
        directionality: Directionality,
    ) -> Result<Self, GiError> {
        check_limits(device, grid)?;
        let grid_uniform = uniform_buffer(device, "grid", &grid.to_gpu());
        mount(shaders, directionality);
        let (lobe_count, tilt_count) = match directionality {
            Directionality::SixLobes => (6, 3),
            Directionality::Isotropic => (1, 0),
        };
        let pyramids = |count: usize, label, format| -> Vec<Pyramid> {
            (0..count).map(|_| Pyramid::new(device, label, format, grid)).collect()
        };
        let lobes = pyramids(lobe_count, "volume lobe", LOBE_FORMAT);
        let tilts = pyramids(tilt_count, "volume tilt", TILT_FORMAT);
        let masks = Masks::new(device, shaders, grid, &grid_uniform)?;

        let mut layout = LayoutBuilder::compute().uniform().uniform().storage();
        for _ in 0..lobe_count + tilt_count {
            layout = layout.texture_3d();
        }
        let globals_layout = layout.sampler().build(device, "globals");
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("volume"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let mut group = BindGroupBuilder::new(&globals_layout)
            .buffer(&grid_uniform)
            .buffer(masks.levels_uniform())
            .buffer(masks.entries());
        for pyramid in lobes.iter().chain(&tilts) {
            group = group.view(&pyramid.all_levels);
        }
        let globals = group.sampler(&sampler).build(device, "globals");
        let build = Build::new(device, shaders, directionality)?;
        Ok(Self { globals, globals_layout, lobes, tilts, masks, build, tilt_is_due: false })
    }

    pub(super) fn rebuild(
        &mut self,
        recorder: &mut Recorder,
        voxels: &VoxelList,
        radiance: &wgpu::Buffer,
    ) {
        recorder.stage("volume");
        self.build.clear(recorder);
        self.build.bind(recorder.device(), voxels, radiance, &self.lobes, &self.tilts);
        self.masks.rebuild(recorder, voxels);
        self.tilt_is_due = true;
    }

    pub(super) fn update(&mut self, recorder: &mut Recorder) {
        self.build.store(recorder);
        self.build.filter(recorder);
        if std::mem::take(&mut self.tilt_is_due) {
            self.build.tilt(recorder);
        }
    }

    /// The lobes' textures, for tests.
    #[cfg(test)]
    pub(crate) fn lobe_textures(&self) -> impl Iterator<Item = &wgpu::Texture> {
        self.lobes.iter().map(|lobe| lobe.all_levels.texture())
    }

    /// The tilts' textures, for tests.
    #[cfg(test)]
    pub(crate) fn tilt_textures(&self) -> impl Iterator<Item = &wgpu::Texture> {
        self.tilts.iter().map(|tilt| tilt.all_levels.texture())
    }

    pub(super) fn globals(&self) -> &wgpu::BindGroup {
        &self.globals
    }

    pub(super) fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        &self.globals_layout
    }

    pub(super) fn memory(&self) -> Vec<(&'static str, u64)> {
        let sum = |pyramids: &[Pyramid]| pyramids.iter().map(|pyramid| pyramid.bytes).sum();
        vec![
            ("volume: radiance and opacity", sum(&self.lobes)),
            ("volume: vector areas", sum(&self.tilts)),
            ("volume: empty-space masks", self.masks.entries().size()),
        ]
    }
}

impl Pyramid {
    fn new(device: &wgpu::Device, label: &str, format: wgpu::TextureFormat, grid: &Grid) -> Self {
        let UVec3 { x, y, z } = grid.dimensions;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: x, height: y, depth_or_array_layers: z },
            mip_level_count: grid.levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let levels = (0..grid.levels)
            .map(|level| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    label: Some(label),
                    base_mip_level: level,
                    mip_level_count: Some(1),
                    ..Default::default()
                })
            })
            .collect();
        let texel_bytes = u64::from(format.block_copy_size(None).unwrap_or(8));
        let cells: u64 =
            (0..grid.levels).map(|level| grid.level_dimensions(level).as_u64vec3().element_product()).sum();
        Self { all_levels: texture.create_view(&Default::default()), levels, bytes: cells * texel_bytes }
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

fn check_limits(device: &wgpu::Device, grid: &Grid) -> Result<(), GiError> {
    let limit = device.limits().max_texture_dimension_3d;
    let longest = grid.dimensions.max_element();
    if longest > limit {
        return Err(GiError::Limit {
            what: format!("a dense volume of {longest} voxels along an axis"),
            needed: u64::from(longest),
            unit: "texels",
            limit: "max_texture_dimension_3d",
            available: u64::from(limit),
            remedy: format!("set the resolution to at most {limit}"),
        });
    }
    Ok(())
}
