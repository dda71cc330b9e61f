//! All surfaces for rays, in one texture (`surface.wgsl`): an index of the voxels, and for each
//! face its patch and far light.

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Memory, Pipelines, Recorder,
    Remedy, ShaderLibrary, TEXEL_COLUMNS, Texture, texel_bytes, texels, uniform_buffer,
};
use crate::light::FAR_TEXELS;
use crate::voxels::{FACE_ARGUMENTS, LIST_COUNT_BYTES, VoxelList, level_first_word, level_words};
use crate::{GiError, Grid};
use bytemuck::{Pod, Zeroable};

/// Texels of a patch.
pub(super) const PATCH_TEXELS: u32 = 3;

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
    store: Store,
    emitters: Buffer,
    bound: Option<Bound>,
}

/// `Parts` of `surface.wgsl`: the first texels of parts of the texture.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct Parts {
    first_patch: u32,
    first_far: u32,
}

/// The texture of `surface.wgsl`.
#[derive(Debug)]
struct Store {
    texture: Texture,
    parts: Parts,
    parts_uniform: Buffer,
}

impl Store {
    /// A texture for a number of voxels and faces.
    fn new(device: &wgpu::Device, grid: &Grid, sizes: (u64, u64)) -> Self {
        let [first_patch, first_far, texel_count] = part_ends(grid, sizes);
        let parts = Parts { first_patch: first_patch as u32, first_far: first_far as u32 };
        let parts_uniform = uniform_buffer(device, "parts of the surface", &parts);
        Self { texture: texels(device, "surface", texel_count), parts, parts_uniform }
    }
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
    /// Creates a texture without any surface.
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &Grid,
        emitters: &Buffer,
    ) -> Result<Self, GiError> {
        let compute = LayoutBuilder::compute;
        let grid_layout = compute().uniform().build(device, "grid");
        let globals_layout =
            compute().uniform().skip(4).storage().uniform().texels().build(device, "surface");
        let index_layout = (0..4).fold(compute(), |layout, _| layout.storage());
        let index_layout = index_layout.storage_texels().build(device, "voxels::index");
        let patches_layout = compute()
            .uniform()
            .storage()
            .storage()
            .uniform()
            .storage_texels()
            .build(device, "patches");
        let kernel = |module, entry, layout| {
            Kernel::new(device, shaders, module, entry, &[&grid_layout, layout])
        };
        let grid_uniform = grid.uniform(device);
        let (memory, remedy) = (Memory::new(device), Remedy::Volume(grid.dimensions.max_element()));
        memory.check("occupancy", level_first_word(grid, grid.levels), 4, remedy)?;
        Self::check(memory, grid, (1, 1), remedy)?;
        let store = Store::new(device, grid, (1, 1));
        Ok(Self {
            globals: bind_globals(device, &globals_layout, [&grid_uniform, emitters], &store),
            grid: BindGroupBuilder::new(&grid_layout).buffer(&grid_uniform).build(device, "grid"),
            fill_index: kernel("voxels::index", "main", &index_layout)?,
            fill_patches: kernel("volume::fill_patches", "create", &patches_layout)?,
            fill_light: kernel("volume::fill_patches", "light", &patches_layout)?,
            globals_layout,
            index_layout,
            patches_layout,
            grid_layout,
            grid_uniform,
            cells: *grid,
            store,
            emitters: emitters.clone(),
            bound: None,
        })
    }

    /// Checks that a device can hold a number of voxels and faces.
    ///
    /// # Errors
    /// [`GiError::Limit`] if not.
    pub(crate) fn check(
        memory: Memory<'_>,
        grid: &Grid,
        sizes: (u64, u64),
        remedy: Remedy,
    ) -> Result<(), GiError> {
        memory.check_texels("the surface", part_ends(grid, sizes)[2], remedy)
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
        let buffers = [&self.grid_uniform, &self.emitters];
        self.globals = bind_globals(device, &self.globals_layout, buffers, &self.store);
    }

    /// Binds another list, or the same one after its buffers were resized, and the radiance of its
    /// faces.
    pub(super) fn bind(&mut self, device: &wgpu::Device, (list, radiance): (&VoxelList, &Buffer)) {
        let sizes = (list.node_capacity(), list.face_capacity());
        self.store = Store::new(device, &self.cells, sizes);
        let view = self.store.texture.view();
        let index = BindGroupBuilder::new(&self.index_layout)
            .buffer(&list.occupancy)
            .buffer(&list.ranks)
            .buffer(&list.nodes)
            .buffer(&list.first_faces)
            .view(&view)
            .build(device, "voxels::index");
        let patches = BindGroupBuilder::new(&self.patches_layout)
            .slice(&list.counts, 0, LIST_COUNT_BYTES)
            .buffer(&list.faces)
            .buffer(radiance)
            .buffer(&self.store.parts_uniform)
            .view(&view)
            .build(device, "patches");
        let threads = list.node_capacity().max(level_words(&self.cells, 0) * 2).div_ceil(4);
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

    /// Shows the radiance of the faces.
    pub(super) fn show_light(&self, recorder: &mut Recorder<'_>) {
        self.fill(recorder, &self.fill_light);
    }

    /// Writes the far light of the faces.
    pub(super) fn show_far(&self, recorder: &mut Recorder<'_>, far: &Texture) {
        let row = self.store.parts.first_far / TEXEL_COLUMNS;
        recorder.copy_rows(far, (&self.store.texture, row));
    }

    fn fill(&self, recorder: &mut Recorder<'_>, kernel: &Kernel) {
        let Some(bound) = &self.bound else { return };
        recorder.compute("volume::fill_patches", |pass| {
            let groups = [&self.grid, &bound.patches];
            kernel.dispatch_indirect(pass, &groups, &bound.counts, FACE_ARGUMENTS);
        });
    }

    /// The texture, with all parts.
    pub(crate) fn texture(&self) -> &Texture {
        &self.store.texture
    }

    /// The uniform of the texture's parts.
    pub(crate) fn parts(&self) -> &Buffer {
        &self.store.parts_uniform
    }

    pub(super) fn globals(&self) -> &BindGroup {
        &self.globals
    }

    pub(super) fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        &self.globals_layout
    }

    pub(super) fn memory(&self) -> Vec<(&'static str, u64)> {
        vec![("voxels: surface for rays", texel_bytes(&self.store.texture))]
    }
}

/// Group 0 of everything that traces cones.
fn bind_globals(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    [grid, emitters]: [&Buffer; 2],
    store: &Store,
) -> BindGroup {
    BindGroupBuilder::new(layout)
        .buffer(grid)
        .skip(4)
        .buffer(emitters)
        .buffer(&store.parts_uniform)
        .view(&store.texture.view())
        .build(device, "surface")
}

/// The ends of the texture's parts, in texels, for a number of voxels and faces: of the index
/// (`voxels/index.wgsl`), of the patches, and of far light, which starts at a row of its own.
fn part_ends(grid: &Grid, (voxels, faces): (u64, u64)) -> [u64; 3] {
    let index = level_words(grid, 0).div_ceil(2) + voxels.div_ceil(4);
    let patches = index + faces * u64::from(PATCH_TEXELS);
    let first_far = patches.next_multiple_of(TEXEL_COLUMNS.into());
    [index, first_far, first_far + faces * u64::from(FAR_TEXELS)]
}

#[cfg(test)]
mod tests {
    #[test]
    fn rust_and_wgsl_structs_have_the_same_layout() {
        let library = &crate::shaders::library();
        lumivox_reflect::check_struct::<super::Parts>(library, "volume::surface", "Parts");
    }
}
