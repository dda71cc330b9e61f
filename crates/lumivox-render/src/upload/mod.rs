//! A scene on the GPU: buffers that rasterizer and voxelizer share, materials, lights.

mod geometry;
mod lights;
mod material_record;
mod materials;
mod mips;
mod reference_white;
mod sheen;
mod textures;
mod units;

use lumivox::gpu::Buffer;
use std::mem::offset_of;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};
use lumivox::{Draw, Geometry, GeometryBatch, VertexAttributes};
use lumivox_scene::{Bounds, Scene};
use wgpu::util::DeviceExt as _;

pub(crate) use geometry::{AllAttributes, Attributes, Shading, VERTEX_BYTES};
pub use lights::Lighting;
#[cfg(test)]
pub(crate) use material_record::TexturePlace;
pub(crate) use material_record::{MaterialRecord, TEXTURE_COUNT, has_sheen, is_layered};
pub(crate) use material_record::{record as material_record, textures as material_textures};
pub(crate) use materials::{GpuMaterial, Presence, material_layout};
pub(crate) use mips::{Alpha, Encoding, Level, mip_chain};
pub(crate) use reference_white::reference_white;
pub(crate) use sheen::{EDGE as SHEEN_EDGE, table as sheen_table};
pub use units::radiance_unit;
pub(crate) use units::radiance_unit_within;

use crate::memory::MemoryUse;
use crate::{Gpu, RenderError};
use geometry::{BatchKind, BatchLimits, pack};
use materials::{MaterialUpload, VertexColors};

/// `DrawRecord` of `draws.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct DrawRecord {
    pub(crate) world_from_local: Mat4,
    pub(crate) normal_from_local: Mat4,
}

/// The vertex buffers of one batch.
#[derive(Debug)]
pub(crate) struct VertexBuffers {
    pub(crate) kind: Attributes,
    /// Of their content ([`geometry::Batch::fingerprint`]).
    fingerprint: [u64; 2],
    pub(crate) positions: Buffer,
    pub(crate) attributes: Buffer,
    pub(crate) shading: Buffer,
    pub(crate) indices: Buffer,
}

/// A run of triangles with one material and one transform; its number is its place in `draws`.
#[derive(Clone, Debug)]
pub(crate) struct SceneDraw {
    pub(crate) batch: usize,
    pub(crate) indices: std::ops::Range<u32>,
    pub(crate) base_vertex: i32,
    pub(crate) material: usize,
    /// In the world.
    pub(crate) bounds: Bounds,
    /// Whether the voxels have it.
    pub(crate) is_voxelized: bool,
    /// Whether its transform turns the winding of triangles round.
    pub(crate) is_mirrored: bool,
}

/// A scene, uploaded.
#[derive(Debug)]
pub struct GpuScene {
    /// The scene's triangles as the voxelizer reads them: the same buffers that are drawn from.
    pub geometry: Geometry,
    /// The box around all of it.
    pub bounds: Bounds,
    /// All radiances on the GPU are multiples of this, in cd/m².
    pub radiance_unit: f32,
    pub(crate) batches: Vec<VertexBuffers>,
    pub(crate) draws: Vec<SceneDraw>,
    pub(crate) draw_records: Buffer,
    pub(crate) materials: Vec<GpuMaterial>,
    pub(crate) material_layout: wgpu::BindGroupLayout,
    pub(crate) memory: Vec<MemoryUse>,
}

/// What of a scene changes when it moves: vertices, and where they are.
struct Placed {
    geometry: Vec<GeometryBatch>,
    batches: Vec<VertexBuffers>,
    draws: Vec<SceneDraw>,
    draw_records: Buffer,
    memory: [MemoryUse; 2],
}

impl GpuScene {
    /// Uploads a valid scene (see [`Scene::validate`]).
    ///
    /// `lighting` says how bright what takes no light is shown. `radiance_unit` is what one stands for in
    /// emission, cd/m²; [`radiance_unit`] chooses it.
    /// Textures get their mips here, on all cores of the CPU.
    ///
    /// # Errors
    /// [`RenderError::Limit`] when the scene has more instances than the device can bind.
    pub fn new(
        gpu: &Gpu,
        scene: &Scene,
        lighting: &Lighting,
        radiance_unit: f32,
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

        let Placed { geometry, batches, draws, draw_records, memory } =
            Placed::new(gpu, scene, &materials, Vec::new())?;
        let [vertices, instances] = memory;
        Ok(Self {
            geometry: Geometry { batches: geometry, materials: surfaces },
            bounds: scene.bounds(),
            radiance_unit,
            batches,
            draws,
            draw_records,
            materials,
            material_layout,
            memory: vec![vertices, MemoryUse::new("textures", texture_bytes), instances],
        })
    }

    /// Uploads the vertices and transforms of the same scene in another pose. Materials and textures
    /// stay as they are, and so do the bounds, and buffers whose content does not change.
    ///
    /// # Errors
    /// As [`GpuScene::new`], and [`RenderError::Setting`] when it is another scene, of other
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
        self.draws.clear();
        let earlier = std::mem::take(&mut self.batches);
        let placed = Placed::new(gpu, scene, &self.materials, earlier)?;
        self.geometry.batches = placed.geometry;
        self.batches = placed.batches;
        self.draws = placed.draws;
        self.draw_records = placed.draw_records;
        let [vertices, instances] = placed.memory;
        self.memory[0] = vertices;
        self.memory[2] = instances;
        Ok(())
    }

    /// Takes other materials for the same instances, if they name the textures that they named; else says so, and has to
    /// be uploaded again. Those of a kind that draws nothing come into effect with the next pose.
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

    /// Whether light that passes something may change its colour.
    pub(crate) fn is_tinted(&self) -> bool {
        self.materials.iter().any(|material| material.is_tinted)
    }
}

impl Placed {
    /// `earlier` are buffers of which those are used again that hold what is needed.
    fn new(
        gpu: &Gpu,
        scene: &Scene,
        materials: &[GpuMaterial],
        mut earlier: Vec<VertexBuffers>,
    ) -> Result<Self, RenderError> {
        let limits = gpu.device.limits();
        let kinds = batch_kinds(scene);
        let (packed, pieces) = pack(&scene.meshes, &kinds, BatchLimits::of_device(&limits));
        let prints: Vec<_> = packed.iter().map(geometry::Batch::fingerprint).collect();
        // Gone first: two poses at a time could be more than the device holds.
        earlier.retain(|buffers| prints.contains(&buffers.fingerprint));
        let reuse = |(batch, print): (&geometry::Batch, &[u64; 2])| {
            let place = earlier.iter().position(|buffers| buffers.fingerprint == *print);
            match place {
                Some(place) => earlier.swap_remove(place),
                None => VertexBuffers::new(&gpu.device, batch, *print),
            }
        };
        let batches: Vec<VertexBuffers> = packed.iter().zip(&prints).map(reuse).collect();
        let mut geometry: Vec<GeometryBatch> =
            batches.iter().map(VertexBuffers::for_voxels).collect();
        let mut draws = Vec::new();
        let mut records = Vec::new();
        for instance in scene.shown() {
            let material = &materials[instance.material];
            if material.presence == Presence::Absent {
                continue;
            }
            let mesh = &scene.meshes[instance.mesh];
            let bounds = Bounds::from_points(
                mesh.positions.iter().map(|p| instance.world_from_local.transform_point3(*p)),
            );
            for piece in &pieces[instance.mesh] {
                draws.push(SceneDraw {
                    batch: piece.batch,
                    indices: piece.first_index..piece.first_index + piece.index_count,
                    base_vertex: piece.base_vertex as i32,
                    material: instance.material,
                    bounds,
                    is_voxelized: instance.is_voxelized,
                    is_mirrored: instance.world_from_local.determinant() < 0.0,
                });
                records.push(DrawRecord::new(instance.world_from_local));
                if !instance.is_voxelized {
                    continue;
                }
                geometry[piece.batch].draws.push(Draw {
                    first_index: piece.first_index,
                    index_count: piece.index_count,
                    base_vertex: piece.base_vertex,
                    material: instance.material as u32,
                    world_from_local: instance.world_from_local,
                    is_static: instance.is_static,
                });
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
        Ok(Self {
            geometry,
            batches,
            draws,
            draw_records: lumivox::gpu::upload(&gpu.device, "draws", &records),
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

/// For each mesh, the attributes that its vertices need on the GPU, and whether anything static shows it.
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

impl DrawRecord {
    fn new(world_from_local: Mat4) -> Self {
        // With the determinant's sign: a mirror must not turn normals inwards.
        let linear = glam::Mat3::from_mat4(world_from_local);
        let normal_from_local = Mat4::from_mat3(linear.inverse().transpose());
        Self { world_from_local, normal_from_local }
    }
}

impl VertexBuffers {
    fn new(device: &wgpu::Device, batch: &geometry::Batch, fingerprint: [u64; 2]) -> Self {
        let buffer = |label, contents: &[u8], usage| {
            // A scene of no visible triangles still needs buffers to bind.
            let contents = if contents.is_empty() { &[0; 16] } else { contents };
            let label = Some(label);
            let descriptor = wgpu::util::BufferInitDescriptor { label, contents, usage };
            Buffer::own(device.create_buffer_init(&descriptor))
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
        GeometryBatch {
            positions: wgpu::Buffer::clone(&self.positions),
            attributes: Some(self.attributes_for_voxels()),
            indices: wgpu::Buffer::clone(&self.indices),
            draws: Vec::new(),
        }
    }

    fn attributes_for_voxels(&self) -> VertexAttributes {
        let buffer = wgpu::Buffer::clone(&self.attributes);
        match self.kind {
            Attributes::Texcoords => VertexAttributes::texcoords(buffer),
            Attributes::All => VertexAttributes {
                buffer,
                stride: size_of::<AllAttributes>() as u32,
                texcoords: [
                    Some(offset_of!(AllAttributes, texcoord) as u32),
                    Some(offset_of!(AllAttributes, texcoord_1) as u32),
                ],
                color: Some(offset_of!(AllAttributes, color) as u32),
            },
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
