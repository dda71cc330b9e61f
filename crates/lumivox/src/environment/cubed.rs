//! An environment map from a cube texture that is already on the GPU, such as an engine's sky,
//! which may change every frame.

use bytemuck::{Pod, Zeroable};
use glam::{Mat3, Vec3};

use super::atlas::Layout;
use super::{EnvironmentMap, FORMAT};
use crate::GiError;
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, Texture,
    storage_buffer, uniform_buffer,
};

/// Maximum number of samples along an edge of a texel; finer cubes are undersampled.
const MAX_SAMPLES: u32 = 16;

/// An [`EnvironmentMap`] that is filled from cube textures on the GPU, while the caller records a
/// frame.
///
/// Peaks are not cut out: pass a sun as a light, not in the cube.
#[derive(Debug)]
pub struct EnvironmentCube {
    map: EnvironmentMap,
    edge: u32,
    take: Kernel,
    halve: Kernel,
    lay_out: Kernel,
    light_layout: wgpu::BindGroupLayout,
    settings: Buffer,
    sampler: wgpu::Sampler,
    levels: Vec<Level>,
    /// The last recorded cube texture.
    bound: Option<(wgpu::TextureView, BindGroup)>,
}

/// How a cube texture is converted to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubeUse {
    /// Transform of directions from the world to the cube texture: a rotation or a mirror.
    pub cube_from_world: Mat3,
    /// Factor for the texture's values. Default: 1.
    pub factor: f32,
    /// Constant radiance added to the map. Default: zero.
    pub added: Vec3,
}

impl Default for CubeUse {
    fn default() -> Self {
        Self { cube_from_world: Mat3::IDENTITY, factor: 1.0, added: Vec3::ZERO }
    }
}

#[derive(Debug)]
struct Level {
    edge: u32,
    group: BindGroup,
}

/// `CubeLight` of `cubed.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CubeLight {
    cube_from_world: [[f32; 4]; 3],
    added: [f32; 3],
    factor: f32,
    samples: u32,
    padding: [u32; 3],
}

/// `CubeLevel` of `cubed.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CubeLevel {
    edge: u32,
    first: u32,
    finer: u32,
    padding_0: u32,
    corner: [u32; 2],
    padding: [u32; 2],
}

impl EnvironmentCube {
    /// A black map with faces of `edge` x `edge` texels, a power of two from 2 to 1024. With an
    /// edge of 128 it takes 3.2 MiB.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::Vec3;
    /// # use lumivox::gpu::{Pipelines, Recorder};
    /// # use lumivox::{CubeUse, EnvironmentCube, EnvironmentLight, Gi, GiConfig, Grid, wgpu};
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// # let size = wgpu::Extent3d { width: 4, height: 4, depth_or_array_layers: 6 };
    /// # let sky = device.create_texture(&wgpu::TextureDescriptor {
    /// #     label: None,
    /// #     size,
    /// #     mip_level_count: 1,
    /// #     sample_count: 1,
    /// #     dimension: wgpu::TextureDimension::D2,
    /// #     format: wgpu::TextureFormat::Rgba16Float,
    /// #     usage: wgpu::TextureUsages::TEXTURE_BINDING,
    /// #     view_formats: &[],
    /// # });
    /// # let view = sky.create_view(&wgpu::TextureViewDescriptor {
    /// #     dimension: Some(wgpu::TextureViewDimension::Cube),
    /// #     ..Default::default()
    /// # });
    /// let mut cube = EnvironmentCube::new(&Pipelines::new(&device), gi.shaders(), 128)?;
    /// // When the sky has changed:
    /// let mut recorder = Recorder::new(&device, &queue);
    /// cube.record(&mut recorder, &view, CubeUse::default());
    /// recorder.submit();
    /// let surroundings =
    ///     EnvironmentLight { radiance: Vec3::ONE, map: Some(cube.map()), rotation_rad: 0.0 };
    /// let lights = gi.bind_lights(&[], surroundings, None);
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::Setting`] for any other edge, [`GiError::Shader`] if `shaders` lacks the modules
    /// of [`crate::Gi::shaders`].
    pub fn new(
        pipelines: &Pipelines,
        shaders: &crate::gpu::ShaderLibrary,
        edge: u32,
    ) -> Result<Self, GiError> {
        if !edge.is_power_of_two() || !(2..=1024).contains(&edge) {
            return Err(GiError::Setting {
                name: "edge of an environment cube",
                value: edge.to_string(),
                expected: "a power of two from 2 to 1024".to_owned(),
            });
        }
        let device = pipelines.device();
        let layout = Layout::new(edge);
        let size = layout.size();
        let texture = Texture::new(
            device,
            &wgpu::TextureDescriptor {
                label: Some("environment"),
                size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: FORMAT,
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            },
        );
        let view = texture.view();
        let light_layout = LayoutBuilder::compute()
            .uniform()
            .texture(
                wgpu::TextureViewDimension::Cube,
                wgpu::TextureSampleType::Float { filterable: true },
            )
            .sampler()
            .build(pipelines, "cube");
        let level_layout = LayoutBuilder::compute()
            .uniform()
            .storage_mut()
            .storage_texture(wgpu::TextureViewDimension::D2, FORMAT)
            .build(pipelines, "level of a cube");
        let kernel = |entry, layouts: &[&wgpu::BindGroupLayout]| {
            Kernel::new(pipelines, shaders, "environment::cubed", entry, layouts)
        };
        let texels = |level: u32| 6 * (edge >> level) * (edge >> level);
        let total: u32 = (0..layout.mips()).map(texels).sum();
        let stored = storage_buffer(device, "levels of a cube", 16 * u64::from(total));
        let mut first = 0;
        let levels = (0..layout.mips()).map(|level| {
            let finer = if level == 0 { 0 } else { first - texels(level - 1) };
            let uniform = CubeLevel {
                edge: edge >> level,
                first,
                finer,
                padding_0: 0,
                corner: layout.place(level, 0).to_array(),
                padding: [0; 2],
            };
            first += texels(level);
            let uniform = uniform_buffer(device, "level of a cube", &uniform);
            let group = BindGroupBuilder::new(&level_layout)
                .buffer(&uniform)
                .buffer(&stored)
                .view(&view)
                .build(device, "level of a cube");
            Level { edge: edge >> level, group }
        });
        let levels = levels.collect();
        let settings = CubeUse::default().to_gpu(1);
        Ok(Self {
            edge,
            take: kernel("take", &[&level_layout, &light_layout])?,
            halve: kernel("halve", &[&level_layout])?,
            lay_out: kernel("lay_out", &[&level_layout])?,
            light_layout,
            settings: uniform_buffer(device, "cube", &settings),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("cube"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            levels,
            bound: None,
            map: EnvironmentMap {
                sharp: view.clone(),
                soft: view,
                unit: 1.0,
                peaks: Vec::new(),
                bytes: u64::from(size.x) * u64::from(size.y) * 8,
            },
        })
    }

    /// Records the conversion of a cube texture: of the first mip of `cube`, a cube view of a
    /// filterable format. Values that are not a radiance (negative, not finite) are skipped.
    ///
    /// Light in the voxels does not change until [`crate::Lights::invalidate`].
    pub fn record(
        &mut self,
        recorder: &mut Recorder<'_>,
        cube: &wgpu::TextureView,
        settings: CubeUse,
    ) {
        let samples = (2 * cube.texture().width().div_ceil(self.edge)).clamp(2, MAX_SAMPLES);
        let uniform = settings.to_gpu(samples);
        recorder.queue().write_buffer(&self.settings, 0, bytemuck::bytes_of(&uniform));
        if self.bound.as_ref().is_none_or(|(bound, _)| bound != cube) {
            let group = BindGroupBuilder::new(&self.light_layout)
                .buffer(&self.settings)
                .view(cube)
                .sampler(&self.sampler)
                .build(recorder.device(), "cube");
            self.bound = Some((cube.clone(), group));
        }
        let Some((_, light)) = &self.bound else { return };
        for (number, level) in self.levels.iter().enumerate() {
            let threads = [level.edge, level.edge, 6];
            match number {
                0 => self.take.run(recorder, &[&level.group, light], threads),
                _ => self.halve.run(recorder, &[&level.group], threads),
            }
        }
        for level in &self.levels {
            let threads = [level.edge + 2, level.edge + 2, 6];
            self.lay_out.run(recorder, &[&level.group], threads);
        }
    }

    /// The map, black before the first [`Self::record`]. Later calls of `record` update it in
    /// place.
    pub fn map(&self) -> &EnvironmentMap {
        &self.map
    }
}

impl CubeUse {
    fn to_gpu(self, samples: u32) -> CubeLight {
        let column = |column: Vec3| column.extend(0.0).to_array();
        let Mat3 { x_axis, y_axis, z_axis } = self.cube_from_world;
        CubeLight {
            cube_from_world: [column(x_axis), column(y_axis), column(z_axis)],
            added: self.added.to_array(),
            factor: self.factor,
            samples,
            padding: [0; 3],
        }
    }
}
