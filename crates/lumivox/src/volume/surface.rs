//! All surfaces for rays: an index of the voxels, and a patch for each face (`patch.wgsl`).

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    storage_buffer,
};
use crate::light::FAR_BYTES;
use crate::voxels::{FACE_ARGUMENTS, LIST_COUNT_BYTES, VoxelList, level_words};
use crate::{GiError, Grid};

/// Pairs of 32-bit words of a patch.
pub(super) const PATCH_WORDS: u32 = 6;
const PATCH_BYTES: u64 = 8 * PATCH_WORDS as u64;

/// Bytes of a face in the buffer of patches: more than in any other buffer.
pub(crate) const SURFACE_BYTES: u64 = PATCH_BYTES + FAR_BYTES;

/// The level of the blocks that rays skip at once (`voxels/index.wgsl`).
pub(super) const BLOCK_LEVEL: u32 = 3;

/// All surfaces on the GPU.
#[derive(Debug)]
pub(crate) struct Surface {
    globals_layout: wgpu::BindGroupLayout,
    globals: BindGroup,
    index_layout: wgpu::BindGroupLayout,
    patches_layout: wgpu::BindGroupLayout,
    grid_layout: wgpu::BindGroupLayout,
    grid_uniform: Buffer,
    /// Group 0 with only the grid.
    grid: BindGroup,
    cells: Grid,
    fill_index: Kernel,
    fill_patches: Kernel,
    fill_light: Kernel,
    fill_reflected: Kernel,
    index: Buffer,
    patches: Buffer,
    emitters: Buffer,
    bound: Option<Bound>,
}

/// Bind groups of a list.
#[derive(Debug)]
struct Bound {
    index: BindGroup,
    threads: u64,
    patches: BindGroup,
    counts: Buffer,
}

impl Surface {
    /// Creates buffers without any surface.
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &Grid,
        emitters: &Buffer,
    ) -> Result<Self, GiError> {
        let compute = LayoutBuilder::compute;
        let grid_layout = compute().uniform().build(device, "grid");
        let globals_layout =
            compute().uniform().skip(4).storage().storage().storage().build(device, "surface");
        let index_layout = (0..4).fold(compute(), |layout, _| layout.storage());
        let index_layout = index_layout.storage_mut().build(device, "voxels::index");
        let patches_layout =
            compute().uniform().storage().storage().storage_mut().build(device, "patches");
        let kernel = |module, entry, layout| {
            Kernel::new(device, shaders, module, entry, &[&grid_layout, layout])
        };
        check_index(grid, &device.limits())?;
        let grid_uniform = grid.uniform(device);
        // The index is needed even without voxels.
        let index = storage_buffer(device, "index of voxels", index_bytes(grid, 1));
        let patches = storage_buffer(device, "patches", SURFACE_BYTES);
        Ok(Self {
            globals: bind_globals(
                device,
                &globals_layout,
                [&grid_uniform, emitters, &index, &patches],
            ),
            grid: BindGroupBuilder::new(&grid_layout).buffer(&grid_uniform).build(device, "grid"),
            fill_index: kernel("voxels::index", "main", &index_layout)?,
            fill_patches: kernel("volume::fill_patches", "surface", &patches_layout)?,
            fill_light: kernel("volume::fill_patches", "light", &patches_layout)?,
            fill_reflected: Kernel::deferred(
                device,
                shaders,
                "volume::fill_patches",
                "reflected_light",
                &[&grid_layout, &patches_layout],
            )?,
            globals_layout,
            index_layout,
            patches_layout,
            grid_layout,
            grid_uniform,
            cells: *grid,
            index,
            patches,
            emitters: emitters.clone(),
            bound: None,
        })
    }

    /// Uses the moved boxes for later commands.
    pub(super) fn move_to(&mut self, device: &Pipelines, grid: &Grid, emitters: &Buffer) {
        self.grid_uniform = grid.uniform(device);
        self.grid = BindGroupBuilder::new(&self.grid_layout)
            .buffer(&self.grid_uniform)
            .build(device, "grid");
        self.cells = *grid;
        self.bind_emitters(device, emitters);
    }

    /// Binds another list of emitters.
    pub(super) fn bind_emitters(&mut self, device: &wgpu::Device, emitters: &Buffer) {
        self.emitters = emitters.clone();
        self.bind_globals(device);
    }

    fn bind_globals(&mut self, device: &wgpu::Device) {
        let buffers = [&self.grid_uniform, &self.emitters, &self.index, &self.patches];
        self.globals = bind_globals(device, &self.globals_layout, buffers);
    }

    /// Queues the kernel that only geometry with emitters needs for compilation.
    pub(super) fn expect_emitters(&self, device: &Pipelines) {
        self.fill_reflected.expect(device);
    }

    /// Binds another list, or the same one after its buffers were resized, and the radiance of its
    /// faces.
    pub(super) fn bind(&mut self, device: &wgpu::Device, (list, radiance): (&VoxelList, &Buffer)) {
        let bytes = index_bytes(&self.cells, list.node_capacity());
        self.index = storage_buffer(device, "index of voxels", bytes);
        self.patches = storage_buffer(device, "patches", list.face_capacity() * SURFACE_BYTES);
        let index = BindGroupBuilder::new(&self.index_layout)
            .buffer(&list.occupancy)
            .buffer(&list.ranks)
            .buffer(&list.nodes)
            .buffer(&list.first_faces)
            .buffer(&self.index)
            .build(device, "voxels::index");
        let patches = BindGroupBuilder::new(&self.patches_layout)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(&list.faces)
            .buffer(radiance)
            .buffer(&self.patches)
            .build(device, "patches");
        let threads = list.node_capacity().max(level_words(&self.cells, 0));
        self.bound = Some(Bound { index, threads, patches, counts: list.counts.clone() });
        self.bind_globals(device);
    }

    /// Updates the index and the patches to the changed list.
    pub(super) fn show(&self, recorder: &mut Recorder<'_>) {
        let Some(bound) = &self.bound else { return };
        recorder.stage("volume");
        let groups = [&self.grid, &bound.index];
        self.fill_index.run_linear(recorder, &groups, bound.threads);
        self.fill(recorder, &self.fill_patches);
    }

    /// Shows the radiance of the faces, without emission if `hides_emission`.
    pub(super) fn show_light(&self, recorder: &mut Recorder<'_>, hides_emission: bool) {
        let kernel = if hides_emission { &self.fill_reflected } else { &self.fill_light };
        self.fill(recorder, kernel);
    }

    /// Writes the far light of the faces, after the patches.
    pub(super) fn show_far(&self, recorder: &mut Recorder<'_>, far: &Buffer) {
        let first = self.patches.size() / SURFACE_BYTES * PATCH_BYTES;
        recorder.copy((far, 0), (&self.patches, first), far.size());
    }

    fn fill(&self, recorder: &mut Recorder<'_>, kernel: &Kernel) {
        let Some(bound) = &self.bound else { return };
        recorder.compute("volume::fill_patches", |pass| {
            let groups = [&self.grid, &bound.patches];
            kernel.dispatch_indirect(pass, &groups, &bound.counts, FACE_ARGUMENTS);
        });
    }

    pub(super) fn patches(&self) -> &Buffer {
        &self.patches
    }

    pub(super) fn globals(&self) -> &BindGroup {
        &self.globals
    }

    pub(super) fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        &self.globals_layout
    }

    pub(super) fn memory(&self) -> Vec<(&'static str, u64)> {
        vec![("voxels: index", self.index.size()), ("voxels: patches", self.patches.size())]
    }
}

/// Group 0 of everything that traces cones.
fn bind_globals(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    [grid, emitters, index, patches]: [&Buffer; 4],
) -> BindGroup {
    BindGroupBuilder::new(layout)
        .buffer(grid)
        .skip(4)
        .buffer(emitters)
        .buffer(index)
        .buffer(patches)
        .build(device, "surface")
}

/// Bytes of the index for a number of voxels.
fn index_bytes(grid: &Grid, voxels: u64) -> u64 {
    4 * (2 * level_words(grid, 0) + level_words(grid, BLOCK_LEVEL) + voxels)
}

/// Checks that a device can bind the index of a grid without voxels; each voxel adds a word.
fn check_index(grid: &Grid, limits: &wgpu::Limits) -> Result<(), GiError> {
    let available = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
    let needed = index_bytes(grid, 1);
    if needed <= available {
        return Ok(());
    }
    // Doubling the edge needs eight times as much.
    let fitting =
        (0..).map(|halvings| (needed >> (3 * halvings), grid.dimensions.max_element() >> halvings));
    let fitting =
        fitting.into_iter().find(|(bytes, _)| *bytes <= available).map_or(0, |(_, edge)| edge);
    Err(GiError::Limit {
        what: format!(
            "an index of {} voxels along its longest axis",
            grid.dimensions.max_element()
        ),
        needed,
        unit: "bytes",
        limit: "max_storage_buffer_binding_size",
        available,
        remedy: format!("set the resolution to at most {fitting}"),
    })
}
