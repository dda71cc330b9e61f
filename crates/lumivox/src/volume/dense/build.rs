//! Storing faces into the dense volume, filtering its pyramid, and clearing what an earlier list had written.

use crate::GiError;
use crate::gpu::{BindGroupBuilder, Kernel, LayoutBuilder, Recorder, ShaderLibrary, uniform_buffer};
use crate::voxels::VoxelList;

use super::masks::LevelRange;
use super::{Directionality, LOBE_FORMAT, Pyramid, TILT_FORMAT};

/// A bind group with the number of nodes that it is for.
#[derive(Debug)]
struct Work {
    group: wgpu::BindGroup,
    count: u64,
}

/// Kernels, and the bind groups of the current voxel list. Group 0 is left empty: no globals are needed.
#[derive(Debug)]
pub(super) struct Build {
    kernels: Kernels,
    nothing: wgpu::BindGroup,
    /// For each axis (six lobes) or once (isotropic): the finest level.
    store: Vec<Work>,
    /// For each coarser level, fine to coarse, and each axis.
    filter: Vec<Vec<Work>>,
    /// For each level and axis.
    clear: Vec<Work>,
}

#[derive(Debug)]
struct Kernels {
    directionality: Directionality,
    store_layout: wgpu::BindGroupLayout,
    filter_layout: wgpu::BindGroupLayout,
    store: Kernel,
    filter: Kernel,
    clear: Kernel,
    /// Six lobes alone: storing and filtering the tilt.
    tilt: Option<(Kernel, Kernel)>,
}

impl Kernels {
    fn new(
        device: &wgpu::Device,
        shaders: &ShaderLibrary,
        directionality: Directionality,
    ) -> Result<Self, GiError> {
        let d3 = wgpu::TextureViewDimension::D3;
        let lists = LayoutBuilder::compute().uniform().storage();
        let nothing = LayoutBuilder::compute().build(device, "nothing");
        match directionality {
            Directionality::SixLobes => {
                let outputs = |layout: LayoutBuilder| {
                    layout
                        .storage_texture(d3, LOBE_FORMAT)
                        .storage_texture(d3, LOBE_FORMAT)
                        .storage_texture(d3, TILT_FORMAT)
                };
                let store_layout = outputs(lists.clone().storage().storage().storage())
                    .build(device, "store lobes");
                let filter_layout = outputs(lists.texture_3d().texture_3d().texture_3d())
                    .build(device, "filter lobes");
                let store = |entry| {
                    Kernel::new(device, shaders, "volume::store", entry, &[&nothing, &store_layout])
                };
                let filter = |entry| {
                    let layouts = [&nothing, &filter_layout];
                    Kernel::new(device, shaders, "volume::filter", entry, &layouts)
                };
                Ok(Self {
                    directionality,
                    store: store("store_radiance")?,
                    filter: filter("filter_radiance")?,
                    clear: store("clear")?,
                    tilt: Some((store("store_tilt")?, filter("filter_tilt")?)),
                    store_layout,
                    filter_layout,
                })
            }
            Directionality::Isotropic => {
                let layout = lists
                    .storage()
                    .storage()
                    .storage()
                    .texture_3d()
                    .storage_texture(d3, LOBE_FORMAT)
                    .build(device, "isotropic");
                let kernel = |entry| {
                    let layouts = [&nothing, &layout];
                    Kernel::new(device, shaders, "volume::isotropic_build", entry, &layouts)
                };
                Ok(Self {
                    directionality,
                    store: kernel("store")?,
                    filter: kernel("average")?,
                    clear: kernel("clear")?,
                    tilt: None,
                    store_layout: layout.clone(),
                    filter_layout: layout,
                })
            }
        }
    }
}

impl Build {
    pub(super) fn new(
        device: &wgpu::Device,
        shaders: &ShaderLibrary,
        directionality: Directionality,
    ) -> Result<Self, GiError> {
        let layout = LayoutBuilder::compute().build(device, "nothing");
        Ok(Self {
            kernels: Kernels::new(device, shaders, directionality)?,
            nothing: BindGroupBuilder::new(&layout).build(device, "nothing"),
            store: Vec::new(),
            filter: Vec::new(),
            clear: Vec::new(),
        })
    }

    /// Makes the bind groups for a voxel list.
    pub(super) fn bind(
        &mut self,
        device: &wgpu::Device,
        voxels: &VoxelList,
        radiance: &wgpu::Buffer,
        lobes: &[Pyramid],
        tilts: &[Pyramid],
    ) {
        let binder = Binder { device, kernels: &self.kernels, voxels, radiance, lobes, tilts };
        let axes = tilts.len().max(1) as u32;
        let levels = voxels.level_starts.len() as u32 - 1;
        let at_level = |level, bind: &dyn Fn(u32, u32) -> Work| -> Vec<Work> {
            (0..axes).map(|axis| bind(level, axis)).collect()
        };
        self.store = at_level(0, &|level, axis| binder.store(level, axis));
        self.filter =
            (1..levels).map(|level| at_level(level, &|level, axis| binder.filter(level, axis))).collect();
        self.clear =
            (0..levels).flat_map(|level| at_level(level, &|level, axis| binder.store(level, axis))).collect();
    }

    /// Writes zeros over everything that the current list has written.
    pub(super) fn clear(&self, recorder: &mut Recorder) {
        recorder.compute("volume::clear", |pass| self.run(pass, &self.kernels.clear, &self.clear));
    }

    /// Writes the radiance of all faces into the finest level.
    pub(super) fn store(&self, recorder: &mut Recorder) {
        recorder
            .compute("volume::store", |pass| self.run(pass, &self.kernels.store, &self.store));
    }

    /// Filters the finest level's radiance into the coarser ones.
    pub(super) fn filter(&self, recorder: &mut Recorder) {
        recorder.compute("volume::filter", |pass| {
            for level in &self.filter {
                self.run(pass, &self.kernels.filter, level);
            }
        });
    }

    /// Stores and filters the vector areas, which light does not change. The opacities must be filtered already.
    pub(super) fn tilt(&self, recorder: &mut Recorder) {
        let Some((store, filter)) = &self.kernels.tilt else {
            return;
        };
        recorder.compute("volume::tilt", |pass| {
            self.run(pass, store, &self.store);
            for level in &self.filter {
                self.run(pass, filter, level);
            }
        });
    }

    fn run(&self, pass: &mut wgpu::ComputePass<'_>, kernel: &Kernel, work: &[Work]) {
        for work in work {
            kernel.dispatch_linear(pass, &[&self.nothing, &work.group], work.count);
        }
    }
}

/// What bind groups are made from.
struct Binder<'a> {
    device: &'a wgpu::Device,
    kernels: &'a Kernels,
    voxels: &'a VoxelList,
    radiance: &'a wgpu::Buffer,
    lobes: &'a [Pyramid],
    tilts: &'a [Pyramid],
}

impl Binder<'_> {
    /// Writes to a level from the lists.
    fn store(&self, level: u32, axis: u32) -> Work {
        let range = LevelRange::new(self.voxels, level, axis);
        let uniform = uniform_buffer(self.device, "level range", &range);
        let group = BindGroupBuilder::new(&self.kernels.store_layout)
            .buffer(&uniform)
            .buffer(&self.voxels.nodes)
            .buffer(&self.voxels.first_faces)
            .buffer(&self.voxels.faces)
            .buffer(self.radiance);
        let group = match self.kernels.directionality {
            Directionality::SixLobes => self.outputs(group, level, axis),
            Directionality::Isotropic => {
                // Storing reads no cells, but the binding must not be the level that is written.
                let other = usize::from(level == 0);
                group.view(&self.lobes[0].levels[other]).view(&self.lobes[0].levels[level as usize])
            }
        };
        Work { group: group.build(self.device, "store"), count: u64::from(range.node_count) }
    }

    /// Writes to a level from the one below it.
    fn filter(&self, level: u32, axis: u32) -> Work {
        let range = LevelRange::new(self.voxels, level, axis);
        let uniform = uniform_buffer(self.device, "level range", &range);
        let finer = level as usize - 1;
        let group = BindGroupBuilder::new(&self.kernels.filter_layout)
            .buffer(&uniform)
            .buffer(&self.voxels.nodes);
        let group = match self.kernels.directionality {
            Directionality::SixLobes => {
                let axis_index = axis as usize;
                let group = group
                    .view(&self.lobes[2 * axis_index].levels[finer])
                    .view(&self.lobes[2 * axis_index + 1].levels[finer])
                    .view(&self.tilts[axis_index].levels[finer]);
                self.outputs(group, level, axis)
            }
            Directionality::Isotropic => group
                .buffer(&self.voxels.first_faces)
                .buffer(&self.voxels.faces)
                .buffer(self.radiance)
                .view(&self.lobes[0].levels[finer])
                .view(&self.lobes[0].levels[level as usize]),
        };
        Work { group: group.build(self.device, "filter"), count: u64::from(range.node_count) }
    }

    fn outputs<'b>(
        &'b self,
        group: BindGroupBuilder<'b>,
        level: u32,
        axis: u32,
    ) -> BindGroupBuilder<'b> {
        let (level, axis) = (level as usize, axis as usize);
        group
            .view(&self.lobes[2 * axis].levels[level])
            .view(&self.lobes[2 * axis + 1].levels[level])
            .view(&self.tilts[axis].levels[level])
    }
}
