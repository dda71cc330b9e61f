//! A scene on the GPU: buffers shared by rasterizer and voxelizer, materials, lights.

mod draws;
mod geometry;
mod lights;
mod material_record;
mod materials;
mod mips;
mod motion;
mod reference_white;
mod sheen;
mod streaming;
mod textures;
mod units;

use std::mem::offset_of;

use bytemuck::Zeroable as _;
use glam::Vec3;
use lumivox::gpu::{Buffer, ShaderLibrary};
use lumivox::internal::filled_buffer;
use lumivox::{Draw, Geometry, GeometryBatch, VertexAttributes};
use lumivox_scene::{Bounds, InstanceBounds, Scene};

pub(crate) use draws::DrawRecord;
pub use draws::SceneDraw;
pub use geometry::Attributes;
pub(crate) use geometry::{AllAttributes, Shading, VERTEX_BYTES};
pub use lights::Lighting;
#[cfg(test)]
pub(crate) use material_record::TexturePlace;
pub(crate) use material_record::{MaterialRecord, TEXTURE_COUNT, TEXTURES, has_sheen, is_layered};
pub(crate) use material_record::{record as material_record, textures as material_textures};
pub use materials::GpuMaterial;
pub(crate) use materials::{Presence, material_layout};
pub(crate) use mips::{Alpha, Encoding, Level, mip_chain};
pub(crate) use reference_white::reference_white;
pub(crate) use sheen::{EDGE as SHEEN_EDGE, table as sheen_table};
pub use streaming::{GeometryBudget, StreamedGeometry};
pub use units::radiance_unit;
pub(crate) use units::{radiance_unit_within, suits};

use crate::gpu::memory::MemoryUse;
use crate::{Gpu, RenderError};
use draws::{InstanceKind, InstanceParts, number_records};
use geometry::{BatchKind, BatchLimits, Run, pack, runs};
use materials::{MaterialUpload, VertexColors};
use motion::Motion;
use streaming::Streaming;

/// Defines the constants of materials.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library.constant_u32("TEXTURE_COUNT", TEXTURE_COUNT as u32);
    for (index, (name, _)) in TEXTURES.into_iter().enumerate() {
        library.constant_u32(name, index as u32);
    }
}

/// The vertex buffers of one batch.
#[derive(Debug)]
pub struct VertexBuffers {
    /// The attributes of the vertices.
    pub kind: Attributes,
    /// The fingerprint of the content ([`geometry::Batch::fingerprint`]).
    fingerprint: [u64; 2],
    /// Three floats a vertex.
    pub positions: Buffer,
    /// Texture coordinates, and the other attributes of `kind`.
    pub attributes: Buffer,
    /// Normals and tangents, seven floats a vertex.
    pub shading: Buffer,
    /// Three indices for each triangle.
    pub indices: Buffer,
}

/// An uploaded scene.
#[derive(Debug)]
pub struct GpuScene {
    /// The scene's triangles for the voxelizer, in the buffers that the rasterizer draws.
    pub geometry: Geometry,
    /// The box around the whole scene.
    pub bounds: Bounds,
    /// The unit of radiances on the GPU, in cd/m².
    pub radiance_unit: f32,
    /// The vertex buffers of the draws.
    pub batches: Vec<VertexBuffers>,
    /// The draws, in the scene's order.
    pub draws: Vec<SceneDraw>,
    /// Runs of records of draws that differ only in their transforms; each run is one draw call.
    pub(crate) runs: Vec<std::ops::Range<u32>>,
    /// The index in `draws` of each record's draw.
    pub(crate) order: Vec<u32>,
    parts: Vec<InstanceParts>,
    boxes: InstanceBounds,
    /// Buffer of the draws' transforms, `DrawRecord` of `package::render::scene::draws`.
    pub draw_records: Buffer,
    /// The materials.
    pub materials: Vec<GpuMaterial>,
    /// The layout of their bind groups.
    pub material_layout: wgpu::BindGroupLayout,
    /// The draws that have moved since the last frame.
    pub(crate) motion: Motion,
    /// The streamed batches; `None` if there is no geometry budget.
    streaming: Option<Streaming>,
    pub(crate) memory: Vec<MemoryUse>,
}

/// The parts of a scene that change when it moves: vertices and transforms.
struct Placed {
    geometry: Vec<GeometryBatch>,
    batches: Vec<VertexBuffers>,
    draws: Vec<SceneDraw>,
    runs: Vec<std::ops::Range<u32>>,
    order: Vec<u32>,
    parts: Vec<InstanceParts>,
    boxes: InstanceBounds,
    draw_records: Buffer,
    streaming: Option<Streaming>,
    memory: [MemoryUse; 2],
}

impl GpuScene {
    /// Uploads a valid scene (see [`Scene::validate`]).
    ///
    /// `lighting` determines the brightness of unlit surfaces. `radiance_unit` is the unit of
    /// emission, cd/m²; [`radiance_unit`] chooses it. Mips of textures are computed here, on all
    /// CPU cores. With a `budget`, only the vertices nearest to the camera are uploaded.
    ///
    /// # Errors
    /// [`RenderError::Limit`] when the scene has more instances than the device can bind.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        lighting: &Lighting,
        radiance_unit: f32,
        budget: Option<GeometryBudget>,
    ) -> Result<Self, RenderError> {
        let material_layout = material_layout(&gpu.pipelines);
        let white = reference_white(scene, lighting);
        let mut upload = MaterialUpload::new(gpu, scene, radiance_unit, white, &material_layout);
        let colors = colors_of_materials(scene);
        let (materials, surfaces): (Vec<_>, Vec<_>) = scene
            .materials
            .iter()
            .zip(colors)
            .map(|(material, colors)| upload.upload(material, colors))
            .unzip();
        let texture_bytes = upload.texture_bytes();

        let placed = Placed::new(gpu, scene, &materials, Vec::new(), budget)?;
        let [vertices, instances] = placed.memory;
        let mut uploaded = Self {
            geometry: Geometry::new(placed.geometry, surfaces),
            bounds: placed.boxes.all(scene),
            radiance_unit,
            batches: placed.batches,
            draws: placed.draws,
            runs: placed.runs,
            order: placed.order,
            parts: placed.parts,
            boxes: placed.boxes,
            draw_records: placed.draw_records,
            materials,
            material_layout,
            motion: Motion::default(),
            streaming: placed.streaming,
            memory: vec![vertices, MemoryUse::new("textures", texture_bytes), instances],
        };
        uploaded.stream_anew(gpu);
        Ok(uploaded)
    }

    /// Uploads the batches nearest to the camera, as far as the budget allows.
    fn stream_anew(&mut self, gpu: &Gpu) {
        if let Some(budget) = self.budget() {
            self.stream(gpu, budget.camera, u64::MAX);
        }
    }

    /// Uploads the vertices and transforms of the same scene in another pose. Materials, textures
    /// and bounds are kept, as are buffers whose content does not change.
    ///
    /// # Errors
    /// As [`GpuScene::new`], and [`RenderError::Setting`] when it is another scene, or has other
    /// materials.
    pub(crate) fn repose(&mut self, gpu: &Gpu, scene: &Scene) -> Result<(), RenderError> {
        if scene.materials.len() != self.materials.len() {
            return Err(RenderError::Setting {
                name: "the scene in another pose",
                value: format!("one of {} materials", scene.materials.len()),
                expected: format!("the same scene, of {} materials", self.materials.len()),
            });
        }
        self.geometry.batches.clear();
        let draws = std::mem::take(&mut self.draws);
        let earlier = std::mem::take(&mut self.batches);
        let positions = self.motion.keep(&earlier);
        let budget = self.budget();
        let placed = Placed::new(gpu, scene, &self.materials, earlier, budget)?;
        self.geometry.batches = placed.geometry;
        self.batches = placed.batches;
        self.draws = placed.draws;
        self.motion.compare((&draws, &positions), (&self.draws, &self.batches));
        (self.runs, self.order) = (placed.runs, placed.order);
        (self.parts, self.boxes) = (placed.parts, placed.boxes);
        self.draw_records = placed.draw_records;
        self.streaming = placed.streaming;
        let [vertices, instances] = placed.memory;
        self.memory[0] = vertices;
        self.memory[2] = instances;
        self.stream_anew(gpu);
        Ok(())
    }

    /// The box around the scene, as [`Scene::bounds`] computes it; `scene` is the one that was
    /// uploaded last.
    pub(crate) fn bounds_of(&self, scene: &Scene) -> Bounds {
        self.boxes.all(scene)
    }

    /// Moves instances to their transforms in `scene`. Returns `false` if the uploaded scene
    /// differs otherwise; then upload `scene` again.
    pub(crate) fn move_instances(&mut self, gpu: &Gpu, scene: &Scene, moved: &[usize]) -> bool {
        let is_same = |&number: &usize| {
            let (instance, parts) = (scene.instances.get(number), self.parts.get(number));
            instance.zip(parts).is_some_and(|(i, parts)| InstanceKind::of(i) == parts.kind)
        };
        if scene.instances.len() != self.parts.len() || !moved.iter().all(is_same) {
            return false;
        }
        for &number in moved {
            let (parts, instance) = (&self.parts[number], &scene.instances[number]);
            self.boxes.follow(scene, number);
            let record = DrawRecord::new(instance.world_from_local);
            for draw in &mut self.draws[parts.draws.clone()] {
                self.motion.leave(draw.record, draw.world_from_local);
                draw.world_from_local = instance.world_from_local;
                draw.bounds = self.boxes.get(number);
                let offset = u64::from(draw.record) * size_of::<DrawRecord>() as u64;
                gpu.queue.write_buffer(&self.draw_records, offset, bytemuck::bytes_of(&record));
            }
            for &(batch, place) in &parts.voxelized {
                self.geometry.batches[batch].draws[place].world_from_local =
                    instance.world_from_local;
            }
        }
        true
    }

    /// Updates the materials of the same instances if they use the same textures; otherwise returns
    /// `false`, and the scene has to be uploaded again. If a material becomes or stops being
    /// absent, that takes effect with the next pose.
    pub(crate) fn set_materials(&mut self, gpu: &Gpu, scene: &Scene, lighting: &Lighting) -> bool {
        let white = reference_white(scene, lighting);
        let colors = colors_of_materials(scene);
        scene.materials.len() == self.materials.len()
            && self
                .materials
                .iter_mut()
                .zip(&mut self.geometry.materials)
                .zip(scene.materials.iter().zip(colors))
                .all(|((gpu_material, surface), (material, colors))| {
                    let units = (self.radiance_unit, white);
                    gpu_material.set(&gpu.queue, scene, material, units, colors, surface)
                })
    }

    /// The draw whose transform is in a record.
    pub(crate) fn draw_of(&self, record: u32) -> &SceneDraw {
        &self.draws[self.order[record as usize] as usize]
    }

    /// Whether any surface may change the colour of transmitted light.
    pub(crate) fn is_tinted(&self) -> bool {
        self.materials.iter().any(|material| material.is_tinted)
    }
}

impl Placed {
    /// Uploads geometry; buffers of `earlier` with the same content are reused.
    fn new(
        gpu: &Gpu,
        scene: &Scene,
        materials: &[GpuMaterial],
        mut earlier: Vec<VertexBuffers>,
        budget: Option<GeometryBudget>,
    ) -> Result<Self, RenderError> {
        let limits = gpu.device.limits();
        let kinds = batch_kinds(scene);
        let most = BatchLimits::of_device(&limits);
        let most = if budget.is_some() { GeometryBudget::limits(most) } else { most };
        let (packed, pieces) = pack(&scene.meshes, &kinds, most);
        let prints: Vec<_> = packed.iter().map(geometry::Batch::fingerprint).collect();
        // Drop unused buffers first: two poses at a time could exceed the device's memory.
        earlier.retain(|buffers| prints.contains(&buffers.fingerprint));
        let reuse = |(batch, print): (&geometry::Batch, &[u64; 2])| {
            let place = earlier.iter().position(|buffers| buffers.fingerprint == *print);
            match place {
                Some(place) => earlier.swap_remove(place),
                None if budget.is_some() => GeometryBudget::absent(&gpu.device, batch),
                None => VertexBuffers::new(&gpu.device, batch, *print),
            }
        };
        let runs_of_mesh: Vec<Vec<Run>> = pieces
            .iter()
            .map(|pieces| {
                pieces.iter().flat_map(|piece| runs(&packed[piece.batch], piece)).collect()
            })
            .collect();
        let batches: Vec<VertexBuffers> = packed.iter().zip(&prints).map(reuse).collect();
        let mut geometry: Vec<GeometryBatch> =
            batches.iter().map(VertexBuffers::for_voxels).collect();
        let boxes = InstanceBounds::of(scene);
        let mut draws: Vec<SceneDraw> = Vec::new();
        let mut parts = Vec::with_capacity(scene.instances.len());
        for (number, instance) in scene.instances.iter().enumerate() {
            let kind = InstanceKind::of(instance);
            let first = draws.len();
            let mut voxelized = Vec::new();
            let material = &materials[instance.material];
            let is_drawn = kind.is_some() && material.presence != Presence::Absent;
            for piece in pieces[instance.mesh].iter().filter(|_| is_drawn) {
                draws.push(SceneDraw {
                    batch: piece.batch,
                    indices: piece.first_index..piece.first_index + piece.index_count,
                    base_vertex: piece.base_vertex as i32,
                    material: instance.material,
                    world_from_local: instance.world_from_local,
                    bounds: boxes.get(number),
                    is_voxelized: instance.is_voxelized,
                    is_mirrored: instance.world_from_local.determinant() < 0.0,
                    record: 0,
                });
            }
            for run in
                runs_of_mesh[instance.mesh].iter().filter(|_| is_drawn && instance.is_voxelized)
            {
                let of_batch = &mut geometry[run.piece.batch].draws;
                voxelized.push((run.piece.batch, of_batch.len()));
                of_batch.push(Draw {
                    first_index: run.piece.first_index,
                    index_count: run.piece.index_count,
                    base_vertex: run.piece.base_vertex,
                    material: instance.material as u32,
                    world_from_local: instance.world_from_local,
                    is_static: instance.is_static,
                    bounds: Some(run.bounds),
                });
            }
            parts.push(InstanceParts { kind, draws: first..draws.len(), voxelized });
        }
        let (runs, order) = number_records(&mut draws);
        let mut records = vec![DrawRecord::zeroed(); draws.len()];
        for (instance, parts) in scene.instances.iter().zip(&parts) {
            for draw in &draws[parts.draws.clone()] {
                records[draw.record as usize] = DrawRecord::new(instance.world_from_local);
            }
        }
        let draw_bytes = records.len() as u64 * size_of::<DrawRecord>() as u64;
        if draw_bytes > limits.max_storage_buffer_binding_size {
            return Err(RenderError::Limit {
                what: format!("the transforms of {} instances", records.len()),
                needed: draw_bytes,
                unit: "bytes",
                limit: "max_storage_buffer_binding_size",
                available: limits.max_storage_buffer_binding_size,
                remedy: "join meshes that share a material".to_owned(),
            });
        }
        let vertex_bytes = batches.iter().map(VertexBuffers::bytes).sum();
        let streaming = budget.map(|budget| {
            let packed = packed.into_iter().zip(prints).collect();
            Streaming::new(budget, packed, &batches, (&mut draws, &mut geometry))
        });
        Ok(Self {
            geometry,
            batches,
            draws,
            runs,
            order,
            parts,
            boxes,
            draw_records: lumivox::gpu::upload(&gpu.device, "draws", &records),
            streaming,
            memory: [
                MemoryUse::new("vertices and indices", vertex_bytes),
                MemoryUse::new("instances", draw_bytes),
            ],
        })
    }
}

/// For each material, the colours of the vertices on which it is used.
pub(crate) fn colors_of_materials(scene: &Scene) -> Vec<VertexColors> {
    let of_meshes: Vec<VertexColors> = scene
        .meshes
        .iter()
        .map(|mesh| VertexColors {
            has_colors: !mesh.colors.is_empty(),
            has_alpha: mesh.colors.iter().any(|color| color.w < 1.0),
        })
        .collect();
    let mut materials = vec![VertexColors::default(); scene.materials.len()];
    for instance in &scene.instances {
        let (material, mesh) = (&mut materials[instance.material], of_meshes[instance.mesh]);
        material.has_colors |= mesh.has_colors;
        material.has_alpha |= mesh.has_alpha;
    }
    materials
}

/// For each mesh, the attributes that its vertices need on the GPU, and whether a static instance
/// shows it.
fn batch_kinds(scene: &Scene) -> Vec<BatchKind> {
    let mut uses_second_set = vec![false; scene.meshes.len()];
    let mut is_static = vec![false; scene.meshes.len()];
    for instance in &scene.instances {
        let mut textures = scene.materials[instance.material].textures();
        uses_second_set[instance.mesh] |= textures.any(|texture| texture.uv_set == 1);
        is_static[instance.mesh] |= instance.is_static;
    }
    let kind = |((mesh, uses), is_static)| BatchKind {
        attributes: Attributes::needed(mesh, uses),
        is_static,
    };
    scene.meshes.iter().zip(uses_second_set).zip(is_static).map(kind).collect()
}

impl VertexBuffers {
    fn new(device: &wgpu::Device, batch: &geometry::Batch, fingerprint: [u64; 2]) -> Self {
        let buffer = |label, contents: &[u8], usage| {
            // A scene without visible triangles still needs buffers to bind.
            let contents = if contents.is_empty() { &[0; 16] } else { contents };
            filled_buffer(device, label, contents, usage)
        };
        let (vertex, index) = (wgpu::BufferUsages::VERTEX, wgpu::BufferUsages::INDEX);
        let storage = wgpu::BufferUsages::STORAGE;
        let cast = bytemuck::cast_slice::<[f32; 3], u8>;
        Self {
            kind: batch.kind.attributes,
            fingerprint,
            positions: buffer("positions", cast(&batch.positions), vertex | storage),
            attributes: buffer("attributes", &batch.attribute_bytes, vertex | storage),
            shading: buffer("normals", bytemuck::cast_slice(&batch.shading), vertex | storage),
            indices: buffer("indices", bytemuck::cast_slice(&batch.indices), index | storage),
        }
    }

    fn for_voxels(&self) -> GeometryBatch {
        let (positions, indices) = (&self.positions, &self.indices);
        let [positions, indices] = [positions, indices].map(|own| wgpu::Buffer::clone(own));
        let mut batch = GeometryBatch::new(positions, indices, Vec::new());
        batch.attributes = Some(self.attributes_for_voxels());
        batch
    }

    fn attributes_for_voxels(&self) -> VertexAttributes {
        let buffer = wgpu::Buffer::clone(&self.attributes);
        match self.kind {
            Attributes::Texcoords => VertexAttributes::texcoords(buffer),
            Attributes::All => {
                let stride = size_of::<AllAttributes>() as u32;
                let mut attributes = VertexAttributes::new(buffer, stride);
                attributes.texcoords = [
                    Some(offset_of!(AllAttributes, texcoord) as u32),
                    Some(offset_of!(AllAttributes, texcoord_1) as u32),
                ];
                attributes.color = Some(offset_of!(AllAttributes, color) as u32);
                attributes
            }
        }
    }

    fn bytes(&self) -> u64 {
        [&self.positions, &self.attributes, &self.shading, &self.indices]
            .map(|buffer| buffer.size())
            .iter()
            .sum()
    }
}

/// The eight corners of a box.
pub(crate) fn corners(bounds: Bounds) -> [Vec3; 8] {
    std::array::from_fn(|corner| {
        let pick = |bit: usize, low: f32, high: f32| if corner & bit == 0 { low } else { high };
        Vec3::new(
            pick(1, bounds.min.x, bounds.max.x),
            pick(2, bounds.min.y, bounds.max.y),
            pick(4, bounds.min.z, bounds.max.z),
        )
    })
}
