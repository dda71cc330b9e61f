//! What is in the octree: values of cells, and the bricks that are filled from them.

use glam::UVec3;

use super::GROWTH;
use super::layout::AtlasSize;
use super::topology::{NodeRanks, Topology};
use super::{Duplication, Input, Mipmapping, OctreeOptions};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, Scan,
    ShaderLibrary, Texture, TextureView, read_buffer, storage_buffer,
};
use crate::gpu::{Memory, Remedy};
use crate::volume::CELL_FORMAT;
use crate::volume::budget;
use crate::volume::changes::{ChangedCells, LevelWords};
use crate::voxels::{LIST_COUNT_BYTES, VoxelList, level_arguments, level_block};
use crate::{GiError, Grid};

/// Texels along a brick's edge.
const BRICK_TEXELS: u64 = 27;
/// Four half floats.
const TEXEL_BYTES: u64 = 8;

/// The texture of all bricks.
pub(super) fn atlas(device: &wgpu::Device, size: UVec3) -> TextureView {
    let texture = Texture::new(
        device,
        &wgpu::TextureDescriptor {
            label: Some("octree bricks"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: size.z },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: CELL_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        },
    );
    texture.view()
}

/// What belongs to the current voxel list.
#[derive(Debug)]
pub(super) struct Content {
    pub atlas: TextureView,
    pub atlas_bytes: u64,
    value_starts: Buffer,
    values: Buffer,
    /// Own cells and next nodes, for the ways to fill bricks that need them.
    neighbors: Option<[Buffer; 2]>,
    /// Group 0 of the kernels that do not search for nodes, and of those that do.
    globals: BindGroup,
    searching: BindGroup,
    bound: Option<Bound>,
    /// Threads that fill bricks.
    fill_threads: u64,
    /// The bricks are new and empty.
    is_empty: bool,
}

/// Bind groups of a list.
#[derive(Debug)]
struct Bound {
    store: BindGroup,
    /// Of each level but the finest, with the threads that go over every cell.
    filters: Vec<(BindGroup, u64)>,
    /// All texels, and those of changed cells.
    fill_all: BindGroup,
    fill_changed: BindGroup,
}

impl Content {
    /// Bytes of the values and of where each cell's start.
    pub fn value_bytes(&self) -> u64 {
        self.value_starts.size() + self.values.size()
    }

    /// Bytes of what nodes know of their neighbours.
    pub fn neighbor_bytes(&self) -> u64 {
        self.neighbors.iter().flatten().map(|buffer| buffer.size()).sum()
    }
}

/// The kernels that fill the octree.
#[derive(Debug)]
pub(super) struct ContentKernels {
    options: OctreeOptions,
    scan: Scan,
    /// Group 0 for kernels that write nodes, and for those that read them.
    write_layout: wgpu::BindGroupLayout,
    read_layout: wgpu::BindGroupLayout,
    masks_layout: wgpu::BindGroupLayout,
    bricks_layout: wgpu::BindGroupLayout,
    count_layout: wgpu::BindGroupLayout,
    neighbors_layout: wgpu::BindGroupLayout,
    store_layout: wgpu::BindGroupLayout,
    filter_layout: wgpu::BindGroupLayout,
    fill_layout: wgpu::BindGroupLayout,
    carry_layout: wgpu::BindGroupLayout,
    masks: Kernel,
    count_bricks: Kernel,
    assign_bricks: Kernel,
    count_values: Kernel,
    own_cells: Kernel,
    pointers: Kernel,
    store: Kernel,
    filter: Kernel,
    fill: Kernel,
    carry: Kernel,
    /// [`LevelWords`] of each level.
    levels: Vec<Buffer>,
}

impl ContentKernels {
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &Grid,
        options: OctreeOptions,
    ) -> Result<Self, GiError> {
        let compute = LayoutBuilder::compute;
        let storage = |count: usize| (0..count).fold(compute(), |layout, _| layout.storage());
        let write_layout = compute().uniform().uniform().build(device, "volume::octree::tree");
        let read_layout =
            compute().uniform().uniform().storage().build(device, "volume::octree::search");
        let masks_layout = storage(4).storage_mut().build(device, "volume::octree::masks");
        let bricks_layout =
            storage(3).storage_mut().storage_mut().build(device, "volume::octree::bricks");
        let count_layout = storage(1).storage_mut().build(device, "volume::octree::count_values");
        let neighbors_layout =
            storage(3).storage_mut().storage_mut().build(device, "volume::octree::neighbors");
        let values =
            || (0..4).fold(compute().uniform(), |layout, _| layout.storage()).storage_mut();
        let store_layout =
            values().storage().storage().storage().build(device, "volume::octree::store");
        let filter_layout = values().storage().storage().build(device, "volume::octree::filter");
        let carry_layout = (0..3)
            .fold(compute().uniform(), |layout, _| layout.storage())
            .storage_mut()
            .storage()
            .storage()
            .storage()
            .storage()
            .build(device, "volume::octree::carry");
        let fill_layout = storage(7)
            .storage_texture(wgpu::TextureViewDimension::D3, CELL_FORMAT)
            .build(device, "volume::octree::fill");
        let write = |module: &str, entry: &str, layout: &wgpu::BindGroupLayout| {
            Kernel::new(device, shaders, module, entry, &[&write_layout, layout])
        };
        let read = |module: &str, entry: &str, layout: &wgpu::BindGroupLayout| {
            Kernel::new(device, shaders, module, entry, &[&read_layout, layout])
        };
        let filter = match options.mipmapping {
            Mipmapping::Occupied => "main",
            Mipmapping::Every => "every_cell",
        };
        let fill = match options.duplication {
            Duplication::Ranks => "volume::octree::fill_ranked",
            Duplication::Pointers => "volume::octree::fill_pointers",
            Duplication::Search => "volume::octree::fill_search",
        };
        Ok(Self {
            options,
            scan: Scan::new(device, shaders)?,
            masks: write("volume::octree::masks", "main", &masks_layout)?,
            count_bricks: write("volume::octree::bricks", "count", &bricks_layout)?,
            assign_bricks: write("volume::octree::bricks", "assign", &bricks_layout)?,
            count_values: write("volume::octree::count_values", "main", &count_layout)?,
            own_cells: read("volume::octree::neighbors", "own_cells", &neighbors_layout)?,
            pointers: read("volume::octree::neighbors", "pointers", &neighbors_layout)?,
            store: write("volume::octree::store", "main", &store_layout)?,
            filter: write("volume::octree::filter", filter, &filter_layout)?,
            fill: read(fill, "main", &fill_layout)?,
            carry: write("volume::octree::carry", "main", &carry_layout)?,
            levels: LevelWords::of_levels(device, grid),
            write_layout,
            read_layout,
            masks_layout,
            bricks_layout,
            count_layout,
            neighbors_layout,
            store_layout,
            filter_layout,
            fill_layout,
            carry_layout,
        })
    }

    /// Numbers and allocates bricks and values. Waits for their counts.
    pub async fn build(
        &self,
        recorder: &mut Recorder<'_>,
        input: &Input<'_>,
        (topology, order): (&mut Topology, NodeRanks),
    ) -> Result<Content, GiError> {
        let Input { grid, grid_uniform, voxels, memory_budget } = *input;
        let device = recorder.device().clone();
        let globals = BindGroupBuilder::new(&self.write_layout)
            .buffer(grid_uniform)
            .buffer(&topology.tree)
            .build(&device, "volume::octree::tree");
        let searching = BindGroupBuilder::new(&self.read_layout)
            .buffer(grid_uniform)
            .buffer(&topology.tree)
            .buffer(&topology.octree)
            .build(&device, "volume::octree::search");
        let remedy = Remedy::Surface(grid.dimensions.max_element());
        let mut memory = Memory::new(&device);
        let value_starts =
            self.count(recorder, &mut memory, &globals, input, (topology, &order)).await?;
        let stats = &mut topology.stats;
        let size = AtlasSize::of(stats.bricks);
        let texels = size.texels();
        check_atlas(&device, texels, grid)?;
        let atlas_bytes = texels.as_u64vec3().element_product() * TEXEL_BYTES;
        let needed = atlas_bytes
            + topology.octree.size()
            + topology.sites.size()
            + value_starts.size()
            + u64::from(stats.values) * TEXEL_BYTES
            + self.neighbor_bytes(topology.slots);
        budget::check("the octree with its bricks", needed, memory_budget, grid, GROWTH)?;
        let values = memory.buffer("octree: values", stats.values.into(), TEXEL_BYTES, remedy)?;
        let tree = topology.layout.uniform(topology.slots, stats.bricks);
        recorder.queue().write_buffer(&topology.tree, 0, bytemuck::bytes_of(&tree));
        let atlas = atlas(&device, texels);
        let neighbors =
            self.neighbors(recorder, &mut memory, grid, &searching, voxels, topology)?;
        Ok(Content {
            atlas,
            atlas_bytes,
            value_starts,
            values,
            neighbors,
            globals,
            searching,
            bound: None,
            fill_threads: u64::from(topology.slots) * BRICK_TEXELS,
            is_empty: true,
        })
    }

    /// Counts bricks and values into the statistics, and gives nodes their bricks; where the values of each cell start
    /// is returned.
    async fn count(
        &self,
        recorder: &mut Recorder<'_>,
        memory: &mut Memory<'_>,
        globals: &BindGroup,
        &Input { grid, voxels, .. }: &Input<'_>,
        (topology, order): (&mut Topology, &NodeRanks),
    ) -> Result<Buffer, GiError> {
        let device = recorder.device().clone();
        let queue = recorder.queue().clone();
        let remedy = Remedy::Surface(grid.dimensions.max_element());
        let slots = u64::from(topology.slots);
        let cells = voxels.level_starts[grid.levels as usize];
        let masks = BindGroupBuilder::new(&self.masks_layout)
            .buffer(&voxels.occupancy)
            .buffer(&voxels.ranks)
            .buffer(&voxels.nodes)
            .buffer(&topology.sites)
            .buffer(&topology.octree)
            .build(&device, "volume::octree::masks");
        self.masks.run_linear(recorder, &[globals, &masks], slots);
        let brick_starts = memory.buffer("octree: brick starts", slots + 1, 4, remedy)?;
        let bricks = BindGroupBuilder::new(&self.bricks_layout)
            .buffer(&order.node_bits)
            .buffer(&order.group_ranks)
            .buffer(&topology.sites)
            .buffer(&topology.octree)
            .buffer(&brick_starts)
            .build(&device, "volume::octree::bricks");
        self.count_bricks.run_linear(recorder, &[globals, &bricks], slots);
        self.scan.run(recorder, &brick_starts, topology.slots + 1);
        self.assign_bricks.run_linear(recorder, &[globals, &bricks], slots);
        let value_starts =
            memory.buffer("octree: value starts", u64::from(cells) + 1, 4, remedy)?;
        let values = BindGroupBuilder::new(&self.count_layout)
            .buffer(&voxels.nodes)
            .buffer(&value_starts)
            .build(&device, "volume::octree::count_values");
        self.count_values.run_linear(recorder, &[globals, &values], cells.into());
        self.scan.run(recorder, &value_starts, cells + 1);
        let totals = storage_buffer(&device, "octree: totals", 12);
        recorder.copy((&brick_starts, slots * 4), (&totals, 0), 4);
        recorder.copy((&value_starts, u64::from(cells) * 4), (&totals, 4), 4);
        recorder.flush();
        let totals: Vec<u32> = read_buffer(&device, &queue, &totals, 0..8).await?;
        topology.stats.bricks = totals[0];
        topology.stats.values = totals[1];
        Ok(value_starts)
    }

    /// Bytes of what nodes must know of their neighbours.
    fn neighbor_bytes(&self, slots: u32) -> u64 {
        let a_node = match self.options.duplication {
            Duplication::Ranks => 0,
            Duplication::Pointers => 20,
            Duplication::Search => 8,
        };
        a_node * u64::from(slots)
    }

    /// What nodes must know of their neighbours, by the way in which bricks are filled.
    fn neighbors(
        &self,
        recorder: &mut Recorder,
        memory: &mut Memory<'_>,
        grid: &Grid,
        globals: &BindGroup,
        voxels: &VoxelList,
        topology: &Topology,
    ) -> Result<Option<[Buffer; 2]>, GiError> {
        if self.options.duplication == Duplication::Ranks {
            return Ok(None);
        }
        let device = recorder.device().clone();
        let remedy = Remedy::Surface(grid.dimensions.max_element());
        let slots = u64::from(topology.slots);
        let has_pointers = self.options.duplication == Duplication::Pointers;
        let contents = memory.buffer("octree: own cells", slots, 8, remedy)?;
        let pointers = if has_pointers { 3 * slots } else { 1 };
        let next_nodes = memory.buffer("octree: next nodes", pointers, 4, remedy)?;
        let group = BindGroupBuilder::new(&self.neighbors_layout)
            .buffer(&voxels.occupancy)
            .buffer(&voxels.ranks)
            .buffer(&topology.sites)
            .buffer(&contents)
            .buffer(&next_nodes)
            .build(&device, "volume::octree::neighbors");
        self.own_cells.run_linear(recorder, &[globals, &group], slots);
        if has_pointers {
            self.pointers.run_linear(recorder, &[globals, &group], slots);
        }
        Ok(Some([contents, next_nodes]))
    }

    /// Binds what was built to its list, its light, and the cells that will change.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        grid: &Grid,
        (voxels, radiance): (&VoxelList, &Buffer),
        (changed, bits): (&ChangedCells, &Buffer),
        topology: &Topology,
        content: &mut Content,
    ) {
        let Content { value_starts, values, .. } = &*content;
        let of_level = |layout, level: usize| {
            BindGroupBuilder::new(layout)
                .buffer(&self.levels[level])
                .buffer(&changed.ranks)
                .buffer(&changed.cells)
                .buffer(&voxels.nodes)
                .buffer(value_starts)
                .buffer(values)
        };
        let store = of_level(&self.store_layout, 0)
            .buffer(&voxels.first_faces)
            .buffer(&voxels.faces)
            .buffer(radiance)
            .build(device, "volume::octree::store");
        let filters = (1..grid.levels)
            .map(|level| {
                let group = of_level(&self.filter_layout, level as usize)
                    .buffer(&voxels.occupancy)
                    .buffer(&voxels.ranks)
                    .build(device, "volume::octree::filter");
                (group, u64::from(grid.morton_edge(level)).pow(3))
            })
            .collect();
        let [first, second] = match &content.neighbors {
            Some([contents, next_nodes]) => [contents, next_nodes],
            None => [&voxels.occupancy, &voxels.ranks],
        };
        let fill = |bits: &Buffer| {
            BindGroupBuilder::new(&self.fill_layout)
                .buffer(first)
                .buffer(second)
                .buffer(value_starts)
                .buffer(values)
                .buffer(&voxels.nodes)
                .buffer(&topology.sites)
                .buffer(bits)
                .view(&content.atlas)
                .build(device, "volume::octree::fill")
        };
        let (fill_all, fill_changed) = (fill(&voxels.occupancy), fill(bits));
        content.bound = Some(Bound { store, filters, fill_all, fill_changed });
    }

    /// Copies the values of cells in which nothing has changed from the content of the list before.
    pub fn carry(
        &self,
        recorder: &mut Recorder,
        grid: &Grid,
        voxels: &VoxelList,
        (old, earlier): ([&Buffer; 2], &Content),
        content: &Content,
        changed: &Buffer,
    ) {
        let device = recorder.device().clone();
        let groups: Vec<_> = (0..grid.levels)
            .map(|level| {
                BindGroupBuilder::new(&self.carry_layout)
                    .slice(&voxels.counts, level_block(level), LIST_COUNT_BYTES)
                    .buffer(&voxels.nodes)
                    .buffer(changed)
                    .buffer(&content.value_starts)
                    .buffer(&content.values)
                    .buffer(old[0])
                    .buffer(old[1])
                    .buffer(&earlier.value_starts)
                    .buffer(&earlier.values)
                    .build(&device, "volume::octree::carry")
            })
            .collect();
        recorder.compute("volume::octree::carry", |pass| {
            for (level, group) in (0..).zip(&groups) {
                let groups = [&content.globals, group];
                self.carry.dispatch_indirect(pass, &groups, &voxels.counts, level_arguments(level));
            }
        });
    }

    /// Stores the radiance of the faces, filters it, and fills the bricks, where it has changed.
    pub fn update(&self, recorder: &mut Recorder, content: &mut Content, changed: &ChangedCells) {
        let Some(bound) = &content.bound else {
            return;
        };
        let globals = &content.globals;
        recorder.compute("volume::octree::store", |pass| {
            changed.dispatch(pass, &self.store, &[globals, &bound.store], 0);
        });
        recorder.compute("volume::octree::filter", |pass| {
            for (finer, (group, every_cell)) in bound.filters.iter().enumerate() {
                let groups = [globals, group];
                match self.options.mipmapping {
                    Mipmapping::Occupied => {
                        changed.dispatch(pass, &self.filter, &groups, finer + 1);
                    }
                    Mipmapping::Every => self.filter.dispatch_linear(pass, &groups, *every_cell),
                }
            }
        });
        let fill = if content.is_empty { &bound.fill_all } else { &bound.fill_changed };
        self.fill.run_linear(recorder, &[&content.searching, fill], content.fill_threads);
        content.is_empty = false;
    }
}

/// Refuses an atlas that the device cannot make.
fn check_atlas(device: &wgpu::Device, texels: UVec3, grid: &Grid) -> Result<(), GiError> {
    let limit = device.limits().max_texture_dimension_3d;
    let longest = texels.max_element();
    if longest <= limit {
        return Ok(());
    }
    let resolution = grid.dimensions.max_element();
    // The bricks go with the square of the resolution, the atlas's edge with their cube root.
    let share = (f64::from(limit) / f64::from(longest)).powf(1.5);
    let fitting = (f64::from(resolution) * share) as u32 / 8 * 8;
    Err(GiError::Limit {
        what: format!("the atlas of an octree's bricks at a resolution of {resolution}"),
        needed: longest.into(),
        unit: "texels along an axis",
        limit: "max_texture_dimension_3d",
        available: limit.into(),
        remedy: format!("set the resolution to at most {fitting}"),
    })
}
