//! Emissive surfaces as lights: a list of their triangles, which gathers sample.
//!
//! Cones rarely hit a small lamp. So diffuse gathers sample points on lamps instead, and their
//! cones leave emission out.
//!
//! The list is made from the triangles themselves, so that a lamp's light does not depend on its
//! voxels: each entry has the corners in the grid's coordinates and the radiance, 64 bytes
//! (`emitter.wgsl`). Textured triangles are cut into pieces of constant radiance. The list is
//! sorted along a Morton curve, with a binary tree over it: a node has the box, the power and the
//! directions of its emitters. So an emitter is sampled by its contribution to a place: power is
//! area times the mean of the channels, nearer emitters count more, and those that face away do not
//! count (Conty Estevez and Kulla 2018, "Importance sampling of many lights with adaptive tree
//! splitting"). The tree is complete, so nodes need no pointers: each level has half the nodes of
//! the one below. A node takes 64 bytes, like an emitter, and stores the boxes of its two children.
//!
//! | file | does | once per |
//! | --- | --- | --- |
//! | `list.wgsl` | the emitters of a run of triangles | change of triangles |
//! | `order.wgsl` | their order; the outer sides of thin bodies | change of triangles |
//! | `tree.wgsl`, `cluster.wgsl` | their tree, and a node's importance | change of triangles |
//! | `draw.wgsl` | a point on an emitter | candidate |
//! | `gather.wgsl` | the best of some points, and a ray to it | gather |

mod order;
#[cfg(test)]
mod tests;

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    Staged, upload,
};
use crate::voxelize::Voxelizer;
use crate::voxelize::batch::{Fallbacks, run_group, textures_of, triangles_group};
use crate::voxelize::input::{DrawGroup, PreparedBatch, ShareInput, emission_scale, emits};
use crate::{Geometry, GeometryBatch, GiError, Grid, SurfaceMaterial, SurfaceTexture};

use order::Order;
pub(crate) use order::empty_list;
#[cfg(test)]
pub(crate) use order::{Sorting, TreePart};

/// The constant that decides whether a kernel samples emitters.
pub(crate) const SAMPLES_EMITTERS: &str = "SAMPLES_EMITTERS";

/// Defines the constants that Rust and the shaders of this folder share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_u32(SAMPLES_EMITTERS, 1)
        .constant_u32("SORT_WORKGROUP_SIZE", order::SORT_WORKGROUP_SIZE)
        .constant_u32("SORT_BLOCK", order::SORT_BLOCK)
        .constant_u32("TREE_PASS_NODES", order::TREE_PASS_NODES)
        .constant_u32("TREE_PASS_LEVELS", order::TREE_PASS_LEVELS);
}

/// `Emitter` of `emitter.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct EmitterRecord {
    pub(crate) corner: [f32; 3],
    pub(crate) power: f32,
    pub(crate) along_ab: [f32; 3],
    pub(crate) is_double_sided: u32,
    pub(crate) along_ac: [f32; 3],
    padding_0: u32,
    pub(crate) radiance: [f32; 3],
    padding_1: u32,
}

/// Bytes before the first emitter, and the byte offset of `is_shown` in them.
const HEADER_BYTES: u64 = 16;
const SHOWN_BYTE: u64 = 4;

/// Maximum number of listed triangles (64 MiB with their tree). If more triangles are emissive,
/// only cones find them.
const MOST_TRIANGLES: u64 = 1 << 19;

/// Maximum number of pieces of a geometry's textured triangles, unless it has more runs: half of
/// the space that a binding has beside all triangles.
const MOST_PIECES_OF_ALL: u32 = 1 << 18;

/// `RunEmitters` of `list.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct RunEmitters {
    first_emitter: u32,
    levels: u32,
    emission_scale: f32,
    padding: u32,
}

/// Maximum number of pieces of all textured triangles of a run: a screen of two triangles gets 32 x
/// 32 pieces, 10 000 triangles get one each.
const MOST_PIECES: u32 = 2048;

/// Number of times that a run's triangles are quartered.
fn levels_of(group: &DrawGroup, material: &SurfaceMaterial, most_pieces: u32) -> u32 {
    let is_even = textures_of(material).iter().all(Option::is_none);
    let pieces = most_pieces / (group.triangles.end - group.triangles.start);
    if is_even { 0 } else { pieces.checked_ilog(4).unwrap_or(0) }
}

/// The kernels, and the list.
#[derive(Debug)]
pub(crate) struct Emitters {
    layouts: [wgpu::BindGroupLayout; 3],
    list_layout: wgpu::BindGroupLayout,
    list_kernel: Kernel,
    order: Order,
    grid: Grid,
    globals: BindGroup,
    fallbacks: Fallbacks,
    /// Single-word buffers with the values 1 and 0.
    words: [Buffer; 2],
    batches: Vec<BoundBatch>,
    /// `true` if the contents of the buffers of static draws may have changed.
    is_forgotten: bool,
    /// `true` if there were dynamic emitters.
    has_moving: bool,
    emission_scale: f32,
    version: u64,
}

/// A batch with emissive triangles.
#[derive(Debug)]
struct BoundBatch {
    /// The bound batch, without draws.
    source: GeometryBatch,
    draws: Staged,
    known: Vec<u8>,
    triangles: BindGroup,
    runs: Vec<BoundRun>,
}

/// Triangles that share their textures.
#[derive(Debug)]
struct BoundRun {
    group: DrawGroup,
    textures: [Option<SurfaceTexture>; 3],
    run: BindGroup,
    first_emitter: u32,
    levels: u32,
    params: Staged,
    own: BindGroup,
}

impl BoundRun {
    fn count(&self) -> u32 {
        (self.group.triangles.end - self.group.triangles.start) << (2 * self.levels)
    }

    fn is_of(&self, group: &DrawGroup, materials: &[SurfaceMaterial]) -> bool {
        let textures = textures_of(&materials[group.material as usize]);
        self.group == (DrawGroup { material: self.group.material, ..group.clone() })
            && self.textures.each_ref().map(Option::as_ref) == textures
    }
}

impl BoundBatch {
    fn is_of(&self, (batch, prepared): &(&GeometryBatch, PreparedBatch), all: &Geometry) -> bool {
        self.source.is_same_but_draws(batch)
            && self.known.len() == size_of_val(prepared.draws.as_slice())
            && self.runs.len() == prepared.groups.len()
            && self.runs.iter().zip(&prepared.groups).all(|(own, g)| own.is_of(g, &all.materials))
    }
}

impl Emitters {
    pub(crate) fn new(
        device: &Pipelines,
        queue: &wgpu::Queue,
        shaders: &ShaderLibrary,
        voxelizer: &Voxelizer,
        grid: &Grid,
    ) -> Result<Self, GiError> {
        let layouts = voxelizer.triangle_layouts();
        let [grid_layout, triangles, run] = layouts;
        let list_layout =
            LayoutBuilder::compute().uniform().storage_mut().build(device, "emitters::list");
        let groups = [grid_layout, triangles, &list_layout, run];
        let list_kernel = Kernel::deferred(device, shaders, "emitters::list", "main", &groups)?;
        let globals =
            BindGroupBuilder::new(grid_layout).buffer(&grid.uniform(device)).build(device, "grid");
        Ok(Self {
            layouts: layouts.map(Clone::clone),
            list_layout,
            list_kernel,
            order: Order::new(device, shaders, grid)?,
            grid: *grid,
            globals,
            fallbacks: Fallbacks::new(device, queue),
            words: [1_u32, 0].map(|word| upload(device, "a word", &[word])),
            batches: Vec::new(),
            is_forgotten: true,
            has_moving: false,
            emission_scale: 0.0,
            version: 0,
        })
    }

    /// `EmitterList` of `emitter.wgsl`.
    pub(crate) fn list(&self) -> &Buffer {
        self.order.list()
    }

    /// Differs after each change of the list.
    pub(crate) fn version(&self) -> u64 {
        self.version
    }

    /// `true` if a geometry has emitters, and all of them can be listed.
    pub(crate) fn are_in(geometry: &Geometry) -> bool {
        if !geometry.materials.iter().any(emits) {
            return false;
        }
        let draws = geometry.batches.iter().flat_map(|batch| &batch.draws);
        let shining = draws.filter(|draw| {
            let material = geometry.materials.get(draw.material as usize);
            material.is_some_and(emits)
        });
        let triangles: u64 = shining.map(|draw| u64::from(draw.index_count / 3)).sum();
        (1..=MOST_TRIANGLES).contains(&triangles)
    }

    /// `true` if emitters are listed.
    pub(crate) fn has_any(&self) -> bool {
        !self.batches.is_empty()
    }

    /// Queues the kernels for compilation.
    pub(crate) fn expect(&self, device: &Pipelines) {
        self.list_kernel.expect(device);
        self.order.expect(device);
    }

    /// Forces the next call of `record` to rebuild the list, even if no draw has changed.
    pub(crate) fn forget(&mut self) {
        self.is_forgotten = true;
    }

    /// Bytes on the GPU.
    pub(crate) fn bytes(&self) -> u64 {
        self.order.bytes()
    }

    /// Lists the emitters of a geometry. Assumes that vertices and textures of static draws have
    /// not changed, unless [`Self::forget`] was called. Returns `true` if the list is in a new
    /// buffer.
    ///
    /// # Errors
    /// [`GiError::Geometry`] and [`GiError::Limit`] as for voxelizations.
    pub(crate) fn record(
        &mut self,
        recorder: &mut Recorder<'_>,
        geometry: &Geometry,
    ) -> Result<bool, GiError> {
        let device = recorder.device().clone();
        let input = if Self::are_in(geometry) {
            ShareInput::of_emitters(geometry, &self.grid, &device.limits())?
        } else {
            ShareInput::default()
        };
        let scale = emission_scale(geometry);
        let is_moving = |batch: &GeometryBatch| {
            let mut draws = batch.draws.iter();
            draws.any(|draw| !draw.is_static && emits(&geometry.materials[draw.material as usize]))
        };
        let has_moving = geometry.batches.iter().any(is_moving);
        let is_bound = self.batches.len() == input.batches.len()
            && self.batches.iter().zip(&input.batches).all(|(own, new)| own.is_of(new, geometry));
        let is_same = !std::mem::take(&mut self.is_forgotten)
            && is_bound
            && !has_moving
            && !self.has_moving
            && scale.to_bits() == self.emission_scale.to_bits()
            && self.batches.iter().zip(&input.batches).all(|(own, (_, prepared))| {
                own.known == bytemuck::cast_slice::<_, u8>(&prepared.draws)
            });
        (self.has_moving, self.emission_scale) = (has_moving, scale);
        if is_same {
            return Ok(false);
        }
        self.version += 1;
        recorder.stage("emitters");
        let has_grown = !is_bound && self.bind(recorder, &input, geometry)?;
        for (batch, (_, prepared)) in self.batches.iter_mut().zip(&input.batches) {
            let draws: &[u8] = bytemuck::cast_slice(&prepared.draws);
            batch.draws.set(recorder, draws);
            batch.known = draws.to_vec();
            for run in &mut batch.runs {
                let (first_emitter, levels) = (run.first_emitter, run.levels);
                let params =
                    RunEmitters { first_emitter, levels, emission_scale: scale, padding: 0 };
                run.params.set(recorder, bytemuck::bytes_of(&params));
                let groups = [&self.globals, &batch.triangles, &run.own, &run.run];
                self.list_kernel.run_linear(recorder, &groups, u64::from(run.count()));
            }
        }
        if self.has_any() {
            self.order.record(recorder);
        } else {
            recorder.clear(self.order.list());
        }
        Ok(has_grown)
    }

    /// Disables emitter sampling: rays see emission instead.
    pub(crate) fn rest(&self, recorder: &mut Recorder<'_>) {
        recorder.copy((&self.words[0], 0), (self.order.list(), SHOWN_BYTE), 4);
    }

    /// Enables emitter sampling: rays no longer see emission.
    pub(crate) fn wake(&self, recorder: &mut Recorder<'_>) {
        recorder.copy((&self.words[1], 0), (self.order.list(), SHOWN_BYTE), 4);
    }

    /// Binds emitters and allocates the list; returns `true` if it is in a new buffer.
    fn bind(
        &mut self,
        recorder: &Recorder<'_>,
        input: &ShareInput<'_>,
        geometry: &Geometry,
    ) -> Result<bool, GiError> {
        let device = recorder.device();
        let runs: usize = input.batches.iter().map(|(_, prepared)| prepared.groups.len()).sum();
        let most_pieces = MOST_PIECES.min(MOST_PIECES_OF_ALL / runs.max(1) as u32);
        let levels = |prepared: &PreparedBatch| -> Vec<u32> {
            let of = |group: &DrawGroup| {
                levels_of(group, &geometry.materials[group.material as usize], most_pieces)
            };
            prepared.groups.iter().map(of).collect()
        };
        let pieces = |prepared: &PreparedBatch| -> u64 {
            let groups = prepared.groups.iter().zip(levels(prepared));
            let of = |(group, levels): (&DrawGroup, u32)| {
                u64::from(group.triangles.end - group.triangles.start) << (2 * levels)
            };
            groups.map(of).sum()
        };
        let count: u64 = input.batches.iter().map(|(_, prepared)| pieces(prepared)).sum();
        let has_grown = self.order.reserve(device, count)?;
        let mut first_emitter = 0;
        self.batches.clear();
        for (batch, prepared) in &input.batches {
            let bytes = size_of_val(prepared.draws.as_slice());
            let draws = Staged::new(device, "draws of emitters", bytes as u64);
            let [_, triangles, run_layout] = &self.layouts;
            let mut runs = Vec::new();
            for (group, levels) in prepared.groups.iter().zip(levels(prepared)) {
                let textures = textures_of(&geometry.materials[group.material as usize]);
                let params =
                    Staged::new(device, "run of emitters", size_of::<RunEmitters>() as u64);
                let own = BindGroupBuilder::new(&self.list_layout)
                    .buffer(params.buffer())
                    .buffer(self.order.unsorted())
                    .build(device, "emitters::list");
                let run = BoundRun {
                    run: run_group(device, run_layout, &self.fallbacks, group, &textures),
                    group: group.clone(),
                    textures: textures.map(Option::<&SurfaceTexture>::cloned),
                    first_emitter,
                    levels,
                    params,
                    own,
                };
                first_emitter += run.count();
                runs.push(run);
            }
            self.batches.push(BoundBatch {
                triangles: triangles_group(device, triangles, &self.fallbacks, batch, &draws),
                source: GeometryBatch { draws: Vec::new(), ..(*batch).clone() },
                known: vec![0; bytes],
                draws,
                runs,
            });
        }
        Ok(has_grown)
    }
}
