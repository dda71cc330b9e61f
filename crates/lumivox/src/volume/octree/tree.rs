//! The octree's buffers and its atlas, with a capacity of nodes and bricks.

use bytemuck::{Pod, Zeroable};
use glam::UVec3;

use super::GROWTH;
use super::layout::{AtlasSize, TreeLayout};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    Texture, TextureView, uniform_buffer,
};
use crate::gpu::{Memory, Remedy};
use crate::volume::{CELL_FORMAT, CELL_PARTS, budget};
use crate::{GiError, Grid};

/// Texels of a brick.
pub(super) const BRICK_TEXELS: u32 = 27;
/// Size of a texel and of a value: four half floats.
const TEXEL_BYTES: u64 = 8;
/// Values per brick.
const BRICK_VALUES: u64 = 8;
/// The longest run of bricks: one for each part of a cell.
pub(super) const MAX_RUN: u64 = CELL_PARTS as u64;
/// Kinds of runs: of each length, needed and released.
pub(super) const RUN_KINDS: u64 = 2 * MAX_RUN;
/// Bytes of `Renewal` of `renewals.wgsl`.
const RENEWAL_BYTES: u64 = 48;

/// Capacities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Capacity {
    /// Places for nodes, in groups of eight.
    pub slots: u64,
    /// Nodes that can be renewed at once.
    pub renewals: u64,
    pub bricks: u64,
}

impl Capacity {
    /// Minimum capacities.
    pub const MINIMUM: Self = Self { slots: 8, renewals: 1, bricks: 1 };

    /// The start of the stack of free runs of a length; `stack_start` of `places.wgsl`.
    fn stack_start(self, length: u64) -> u64 {
        (1..length).map(|shorter| self.bricks / shorter).sum()
    }
}

/// The buffers of the octree that is shown.
#[derive(Debug)]
pub(super) struct Tree {
    pub capacity: Capacity,
    /// [`super::TreeUniform`].
    pub uniform: Buffer,
    /// The table and the nodes.
    pub octree: Buffer,
    /// `Site` of each slot.
    pub sites: Buffer,
    /// First bricks of free runs: a stack for each length.
    pub free_runs: Buffer,
    /// Eight values per brick.
    pub values: Buffer,
    pub atlas: TextureView,
}

/// Temporary buffers for updates to a list.
#[derive(Debug)]
pub(super) struct Scratch {
    /// The previous octree.
    pub old_octree: Buffer,
    /// `array<Renewal>`.
    pub renewals: Buffer,
    /// The runs of bricks that workgroups need and release.
    pub run_starts: Buffer,
}

impl Tree {
    /// Creates a tree without nodes.
    ///
    /// # Errors
    /// [`GiError::Limit`] and [`GiError::Budget`] if the tree does not fit.
    pub fn new(
        device: &wgpu::Device,
        (grid, layout): (&Grid, &TreeLayout),
        capacity: Capacity,
        memory_budget: Option<u64>,
    ) -> Result<Self, GiError> {
        let texels = AtlasSize::of(capacity.bricks as u32).texels();
        check_atlas(device, texels, grid)?;
        let remedy = Remedy::Surface(grid.dimensions.max_element());
        let needed = 2 * 4 * layout.words(capacity.slots)
            + capacity.slots * 8
            + capacity.renewals * RENEWAL_BYTES
            + capacity.bricks * BRICK_VALUES * TEXEL_BYTES
            + capacity.stack_start(MAX_RUN + 1) * 4
            + texels.as_u64vec3().element_product() * TEXEL_BYTES;
        budget::check("the octree with its bricks", needed, memory_budget, grid, GROWTH)?;
        let memory = Memory::new(device);
        let uniform = layout.uniform(capacity.slots as u32, capacity.bricks as u32);
        let runs = capacity.stack_start(MAX_RUN + 1);
        let values = capacity.bricks * BRICK_VALUES;
        Ok(Self {
            capacity,
            uniform: uniform_buffer(device, "octree", &uniform),
            octree: memory.buffer("octree: nodes", layout.words(capacity.slots), 4, remedy)?,
            sites: memory.buffer("octree: sites", capacity.slots, 8, remedy)?,
            free_runs: memory.buffer("octree: free bricks", runs, 4, remedy)?,
            values: memory.buffer("octree: values", values, TEXEL_BYTES, remedy)?,
            atlas: atlas(device, texels),
        })
    }

    /// Bytes of the atlas.
    pub fn atlas_bytes(&self) -> u64 {
        let size = self.atlas.texture().size();
        let slice = u64::from(size.width) * u64::from(size.height);
        slice * u64::from(size.depth_or_array_layers) * TEXEL_BYTES
    }
}

impl Scratch {
    /// Creates the buffers for an octree.
    ///
    /// # Errors
    /// [`GiError::Limit`] if they do not fit.
    pub fn new(device: &wgpu::Device, grid: &Grid, tree: &Tree) -> Result<Self, GiError> {
        let remedy = Remedy::Surface(grid.dimensions.max_element());
        let memory = Memory::new(device);
        let blocks = tree.capacity.renewals.div_ceil(u64::from(crate::gpu::LINEAR_WORKGROUP_SIZE));
        let renewals = tree.capacity.renewals;
        Ok(Self {
            old_octree: memory.buffer("octree: nodes", tree.octree.size() / 4, 4, remedy)?,
            renewals: memory.buffer("octree: renewals", renewals, RENEWAL_BYTES, remedy)?,
            run_starts: memory.buffer("octree: runs", RUN_KINDS * blocks + 1, 4, remedy)?,
        })
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.old_octree.size() + self.renewals.size() + self.run_starts.size()
    }
}

/// The texture of all bricks.
fn atlas(device: &wgpu::Device, size: UVec3) -> TextureView {
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

/// Returns an error if the device cannot create the atlas.
fn check_atlas(device: &wgpu::Device, texels: UVec3, grid: &Grid) -> Result<(), GiError> {
    let limit = device.limits().max_texture_dimension_3d;
    let longest = texels.max_element();
    if longest <= limit {
        return Ok(());
    }
    let resolution = grid.dimensions.max_element();
    // The number of bricks grows with the square of the resolution, the atlas's edge with the cube
    // root of that number.
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

/// `OldAtlas` of `resettle.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct OldAtlas {
    pub(crate) bricks: u32,
    pub(crate) row_bits: u32,
}

/// Copies an octree into a larger one.
#[derive(Debug)]
pub(super) struct Resettler {
    tree_layout: wgpu::BindGroupLayout,
    layout: wgpu::BindGroupLayout,
    kernel: Kernel,
}

impl Resettler {
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        tree_layout: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        let layout = LayoutBuilder::compute()
            .uniform()
            .texture_3d()
            .storage_texture(wgpu::TextureViewDimension::D3, CELL_FORMAT)
            .build(device, "volume::octree::resettle");
        let groups = [tree_layout, &layout];
        let module = "volume::octree::resettle";
        let kernel = Kernel::new(device, shaders, module, "main", &groups)?;
        Ok(Self { tree_layout: tree_layout.clone(), layout, kernel })
    }

    /// Copies an octree into one with more capacity.
    pub fn copy(
        &self,
        recorder: &mut Recorder<'_>,
        grid_uniform: &Buffer,
        (old, new): (&Tree, &Tree),
    ) {
        let both = |buffer: fn(&Tree) -> &Buffer| (buffer(old), buffer(new));
        for (from, to) in
            [both(|tree| &tree.octree), both(|tree| &tree.sites), both(|tree| &tree.values)]
        {
            recorder.copy((from, 0), (to, 0), from.size());
        }
        for length in 1..=MAX_RUN {
            let [from, to] = [old, new].map(|tree| tree.capacity.stack_start(length) * 4);
            let bytes = old.capacity.bricks / length * 4;
            if bytes > 0 {
                recorder.copy((&old.free_runs, from), (&new.free_runs, to), bytes);
            }
        }
        let device = recorder.device().clone();
        let bricks = old.capacity.bricks as u32;
        let params = OldAtlas { bricks, row_bits: AtlasSize::of(bricks).row_bits };
        let params = uniform_buffer(&device, "old atlas", &params);
        let globals = BindGroupBuilder::new(&self.tree_layout)
            .buffer(grid_uniform)
            .buffer(&new.uniform)
            .build(&device, "volume::octree::tree");
        let group: BindGroup = BindGroupBuilder::new(&self.layout)
            .buffer(&params)
            .view(&old.atlas)
            .view(&new.atlas)
            .build(&device, "volume::octree::resettle");
        self.kernel.run_linear(
            recorder,
            &[&globals, &group],
            old.capacity.bricks * u64::from(BRICK_TEXELS),
        );
    }
}
