//! Lumivox's geometry over Bevy's mesh slabs, which are read in place.

use bevy::asset::UntypedAssetId;
use bevy::mesh::{MeshVertexBufferLayoutRef, PrimitiveTopology, VertexFormat};
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use bevy::render::mesh::allocator::MeshAllocator;
use bevy::render::mesh::{RenderMesh, RenderMeshBufferInfo};
use bevy::render::render_asset::RenderAssets;
use lumivox::{Draw, Geometry, GeometryBatch, Indices, VertexAttributes, VertexPositions, wgpu};
use wgpu::util::DeviceExt as _;

use crate::report::{LumivoxEvent, Reports};
use crate::scene::deform::{Deformation, Deformer, Wanted};
use crate::scene::instances::{Instance, Instances};
use crate::scene::surfaces::SurfaceTable;

/// The properties that all draws of a batch share.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct BatchKey {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_format: wgpu::IndexFormat,
    layout: VertexPlaces,
}

/// Offsets of the attributes in a vertex, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct VertexPlaces {
    stride: u32,
    position: u32,
    texcoords: [Option<u32>; 2],
    color: Option<(u32, VertexFormat)>,
    /// Offsets of joint indices and weights.
    joints: Option<[u32; 2]>,
}

/// The location of a mesh in Bevy's slabs.
struct MeshSource {
    vertices: wgpu::Buffer,
    first_vertex: u32,
    vertex_count: u32,
    layout: VertexPlaces,
    indices: wgpu::Buffer,
    index_format: wgpu::IndexFormat,
    first_index: u32,
    index_count: u32,
}

/// The location of a mesh in the geometry.
#[derive(Clone, Debug)]
struct Placed {
    batch: usize,
    first_index: u32,
    index_count: u32,
    base_vertex: u32,
    has_texcoords: bool,
}

/// Why a mesh with a textured material is left out.
const NO_TEXCOORDS: &str =
    "their materials have textures, but they have no `Mesh::ATTRIBUTE_UV_0` of floats";

/// The batch of one deformed mesh.
struct DeformingBatch {
    first_position: u32,
    attributes: Option<VertexAttributes>,
    indices: Indices,
    draw: Draw,
    /// Slot of the instance, whose transform applies; `None` for a skinned mesh.
    slot: Option<usize>,
}

/// The geometry of all instances.
#[derive(Resource, Default)]
pub(crate) struct SceneGeometry {
    pub(crate) geometry: Geometry,
    /// The batch and the draw of each slot.
    draws: Vec<Option<(u32, u32)>>,
    keys: HashMap<BatchKey, usize>,
    meshes: HashMap<AssetId<Mesh>, Option<Placed>>,
    /// The index buffer 0, 1, 2 ... for meshes without indices, and its length.
    counting: Option<(wgpu::Buffer, u32)>,
    /// Batches of deformed meshes, until their position buffer exists.
    deforming: Vec<DeformingBatch>,
    /// Meshes that are not loaded yet.
    waits_for: HashSet<AssetId<Mesh>>,
}

/// The inputs from the render world.
pub(crate) struct Sources<'a> {
    pub(crate) device: &'a wgpu::Device,
    pub(crate) instances: &'a Instances,
    pub(crate) meshes: &'a RenderAssets<RenderMesh>,
    pub(crate) allocator: &'a MeshAllocator,
    pub(crate) reports: &'a Reports,
}

impl SceneGeometry {
    /// Applies the changes of a frame.
    pub(crate) fn update(
        &mut self,
        sources: &Sources<'_>,
        (table, deformer): (&mut SurfaceTable, &mut Deformer),
        meshes_changed: bool,
    ) {
        let instances = sources.instances;
        let is_there = |mesh: &AssetId<Mesh>| sources.meshes.get(*mesh).is_some();
        if instances.is_restructured || meshes_changed || self.waits_for.iter().any(is_there) {
            self.rebuild(sources, table, deformer);
        } else {
            for &slot in &instances.moved {
                self.move_draw(slot, instances);
            }
        }
        // Compares lengths, too: a new material may equal its slot's default, and `clear` drops
        // all.
        let is_short = self.geometry.materials.len() != table.materials().len();
        if table.take_changed() || is_short {
            self.geometry.materials.clone_from(table.materials());
        }
    }

    /// Drops all references to Bevy's buffers.
    pub(crate) fn clear(&mut self, deformer: &mut Deformer) {
        *self = Self::default();
        deformer.clear();
    }

    /// Updates only the transform of a draw.
    fn move_draw(&mut self, slot: usize, instances: &Instances) {
        let place = self.draws.get(slot).copied().flatten();
        if let (Some((batch, draw)), Some(instance)) = (place, instances.get(slot)) {
            let draw = &mut self.geometry.batches[batch as usize].draws[draw as usize];
            draw.world_from_local = instance.world_from_local;
        }
    }

    /// Rebuilds all draws, in the order of their slots.
    fn rebuild(
        &mut self,
        sources: &Sources<'_>,
        table: &mut SurfaceTable,
        deformer: &mut Deformer,
    ) {
        self.waits_for.clear();
        self.keys.clear();
        self.meshes.clear();
        self.draws.clear();
        self.geometry.batches.clear();
        deformer.clear();
        table.forget_missing();
        for (slot, instance) in sources.instances.iter() {
            if !instance.deforms() {
                self.add(slot, instance, sources, table);
            } else if let Err(reason) =
                self.add_deforming(slot, instance, sources, (table, deformer))
            {
                sources.reports.once(LumivoxEvent::MeshLeftOut { reason });
            }
        }
        self.finish_deforming(deformer.positions(sources.device).as_ref());
    }

    fn add(
        &mut self,
        slot: usize,
        instance: &Instance,
        sources: &Sources<'_>,
        table: &mut SurfaceTable,
    ) {
        let Some(material) = Self::material(&instance.material, table) else { return };
        let Some(placed) = self.placed(instance.mesh, sources) else { return };
        if table.is_textured(material) && !placed.has_texcoords {
            let reason = NO_TEXCOORDS.to_owned();
            sources.reports.once(LumivoxEvent::MeshLeftOut { reason });
            return;
        }
        let draws = &mut self.geometry.batches[placed.batch].draws;
        self.draws.resize(self.draws.len().max(slot + 1), None);
        self.draws[slot] = Some((placed.batch as u32, draws.len() as u32));
        draws.push(Draw {
            base_vertex: placed.base_vertex,
            world_from_local: instance.world_from_local,
            is_static: instance.is_static,
            ..Draw::new(placed.first_index, placed.index_count, material)
        });
    }

    /// The number of a material; `None` if the surface is not voxelized, or not loaded yet.
    fn material(id: &UntypedAssetId, table: &mut SurfaceTable) -> Option<u32> {
        // The table requests a rebuild once a missing material exists.
        table.number(id).filter(|number| table.is_there(*number))
    }

    /// The location of a mesh; `None` if it is not loaded yet, has no triangles, or is not
    /// supported.
    fn placed(&mut self, mesh: AssetId<Mesh>, sources: &Sources<'_>) -> Option<Placed> {
        if let Some(known) = self.meshes.get(&mesh) {
            return known.clone();
        }
        let placed = match self.place(mesh, sources) {
            Ok(placed) => placed,
            Err(reason) => {
                sources.reports.once(LumivoxEvent::MeshLeftOut { reason });
                None
            }
        };
        self.meshes.insert(mesh, placed.clone());
        placed
    }

    fn place(
        &mut self,
        mesh: AssetId<Mesh>,
        sources: &Sources<'_>,
    ) -> Result<Option<Placed>, String> {
        let Some(source) = self.source(mesh, sources)? else { return Ok(None) };
        let MeshSource { vertices, indices, index_format, layout, .. } = source;
        let has_texcoords = layout.texcoords[0].is_some();
        let batch = self.batch(BatchKey { vertices, indices, index_format, layout });
        Ok(Some(Placed {
            batch,
            first_index: source.first_index,
            index_count: source.index_count,
            base_vertex: source.first_vertex,
            has_texcoords,
        }))
    }

    /// Adds a deformed mesh, in a batch of its own.
    fn add_deforming(
        &mut self,
        slot: usize,
        instance: &Instance,
        sources: &Sources<'_>,
        (table, deformer): (&mut SurfaceTable, &mut Deformer),
    ) -> Result<(), String> {
        let Some(material) = Self::material(&instance.material, table) else { return Ok(()) };
        let Some(source) = self.source(instance.mesh, sources)? else { return Ok(()) };
        let layout = source.layout;
        // Joint attributes without a skin have no effect.
        let joints = layout.joints.filter(|_| instance.is_skinned);
        if table.is_textured(material) && layout.texcoords[0].is_none() {
            return Err(NO_TEXCOORDS.to_owned());
        }
        let [first, stride] = [source.first_vertex, layout.stride];
        let mut deformation =
            Deformation::new(source.vertex_count, first, stride / 4, layout.position / 4);
        if let Some(joints) = joints {
            [deformation.joint_indices, deformation.joint_weights] =
                joints.map(|offset| offset / 4);
        }
        let targets = morph_targets(instance.mesh, sources, &mut deformation);
        let vertices = source.vertices.clone();
        let wanted = Wanted { entity: instance.entity, vertices, targets, deformation };
        let first_position = deformer.add(wanted);
        let mut attributes = VertexAttributes::new(source.vertices, stride);
        attributes.offset = u64::from(first) * u64::from(stride);
        layout.set(&mut attributes);
        let world_from_local = match joints {
            // Joint matrices map to world space.
            Some(_) => Mat4::IDENTITY,
            None => instance.world_from_local,
        };
        let draw = Draw {
            world_from_local,
            ..Draw::new(source.first_index, source.index_count, material)
        };
        let indices = Indices { buffer: source.indices, format: source.index_format, offset: 0 };
        self.deforming.push(DeformingBatch {
            first_position,
            attributes: layout.has_attributes().then_some(attributes),
            indices,
            draw,
            slot: joints.is_none().then_some(slot),
        });
        Ok(())
    }

    /// Adds the batches of deformed meshes, once their position buffer exists.
    fn finish_deforming(&mut self, positions: Option<&wgpu::Buffer>) {
        let Some(positions) = positions else { return };
        for batch in self.deforming.drain(..) {
            let offset = 12 * u64::from(batch.first_position);
            let buffer = VertexPositions { buffer: positions.clone(), stride: 12, offset };
            let mut made = GeometryBatch::new(buffer, batch.indices, vec![batch.draw]);
            made.attributes = batch.attributes;
            if let Some(slot) = batch.slot {
                self.draws.resize(self.draws.len().max(slot + 1), None);
                self.draws[slot] = Some((self.geometry.batches.len() as u32, 0));
            }
            self.geometry.batches.push(made);
        }
    }

    /// Finds a mesh in Bevy's slabs; `None` if it is not loaded yet, or has no triangles.
    fn source(
        &mut self,
        mesh: AssetId<Mesh>,
        sources: &Sources<'_>,
    ) -> Result<Option<MeshSource>, String> {
        let (Some(render_mesh), Some(vertices)) =
            (sources.meshes.get(mesh), sources.allocator.mesh_vertex_slice(&mesh))
        else {
            self.waits_for.insert(mesh);
            return Ok(None);
        };
        match render_mesh.primitive_topology() {
            PrimitiveTopology::TriangleList => {}
            PrimitiveTopology::TriangleStrip => {
                return Err("triangle strips are not read; give them as triangle lists".to_owned());
            }
            _ => return Ok(None),
        }
        if !vertices.buffer.usage().contains(wgpu::BufferUsages::STORAGE) {
            let error = "their buffers lack `BufferUsages::STORAGE`; add `LumivoxPlugin` before the app is finished";
            return Err(error.to_owned());
        }
        let layout = vertex_places(&render_mesh.layout)?;
        let (indices, index_format, first_index, count) = match render_mesh.buffer_info {
            RenderMeshBufferInfo::Indexed { count, index_format } => {
                let Some(slice) = sources.allocator.mesh_index_slice(&mesh) else {
                    self.waits_for.insert(mesh);
                    return Ok(None);
                };
                ((**slice.buffer).clone(), index_format, slice.range.start, count)
            }
            RenderMeshBufferInfo::NonIndexed => {
                let count = render_mesh.vertex_count;
                (self.counting(sources.device, count), wgpu::IndexFormat::Uint32, 0, count)
            }
        };
        Ok(Some(MeshSource {
            vertices: (**vertices.buffer).clone(),
            first_vertex: vertices.range.start,
            vertex_count: render_mesh.vertex_count,
            layout,
            indices,
            index_format,
            first_index,
            index_count: count - count % 3,
        }))
    }

    /// An index buffer 0, 1, 2 ... of at least `count` indices.
    fn counting(&mut self, device: &wgpu::Device, count: u32) -> wgpu::Buffer {
        if let Some((buffer, room)) = &self.counting
            && *room >= count
        {
            return buffer.clone();
        }
        let room = count.next_power_of_two();
        let numbers: Vec<u32> = (0..room).collect();
        let buffer = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("counting indices"),
            contents: bytemuck::cast_slice(&numbers),
            usage: wgpu::BufferUsages::STORAGE,
        });
        self.counting = Some((buffer.clone(), room));
        buffer
    }

    fn batch(&mut self, key: BatchKey) -> usize {
        if let Some(&batch) = self.keys.get(&key) {
            return batch;
        }
        let BatchKey { vertices, indices, index_format: format, layout } = key.clone();
        let mut attributes = VertexAttributes::new(vertices.clone(), layout.stride);
        layout.set(&mut attributes);
        let positions = VertexPositions {
            buffer: vertices,
            stride: layout.stride,
            offset: u64::from(layout.position),
        };
        let indices = Indices { buffer: indices, format, offset: 0 };
        let mut batch = GeometryBatch::new(positions, indices, Vec::new());
        batch.attributes = layout.has_attributes().then_some(attributes);
        self.geometry.batches.push(batch);
        self.keys.insert(key, self.geometry.batches.len() - 1);
        self.geometry.batches.len() - 1
    }
}

impl VertexPlaces {
    fn has_attributes(&self) -> bool {
        self.texcoords[0].is_some() || self.color.is_some()
    }

    fn set(&self, attributes: &mut VertexAttributes) {
        attributes.texcoords = self.texcoords;
        if let Some((offset, format)) = self.color {
            (attributes.color, attributes.color_format) = (Some(offset), format);
        }
    }
}

/// The vertex attributes of a mesh that voxelization reads.
fn vertex_places(layout: &MeshVertexBufferLayoutRef) -> Result<VertexPlaces, String> {
    let layout = &layout.0;
    let find = |attribute: bevy::mesh::MeshVertexAttribute| {
        let index = layout.attribute_ids().iter().position(|id| *id == attribute.id)?;
        let found = &layout.layout().attributes[index];
        Some((found.format, found.offset as u32))
    };
    let position = match find(Mesh::ATTRIBUTE_POSITION) {
        Some((VertexFormat::Float32x3, offset)) => offset,
        Some((format, _)) => {
            return Err(format!(
                "positions of the format {format:?} are not read; give them as Float32x3, uncompressed"
            ));
        }
        None => return Err("meshes without positions have no surface".to_owned()),
    };
    let texcoords = [Mesh::ATTRIBUTE_UV_0, Mesh::ATTRIBUTE_UV_1].map(|attribute| {
        find(attribute)
            .and_then(|(format, offset)| (format == VertexFormat::Float32x2).then_some(offset))
    });
    let color = match find(Mesh::ATTRIBUTE_COLOR) {
        Some((
            format @ (VertexFormat::Float32x4 | VertexFormat::Unorm8x4 | VertexFormat::Unorm16x4),
            offset,
        )) => Some((offset, format)),
        Some((format, _)) => {
            return Err(format!(
                "colours of the format {format:?} are not read; give them as Float32x4 or Unorm8x4"
            ));
        }
        None => None,
    };
    let joints = find(Mesh::ATTRIBUTE_JOINT_INDEX).zip(find(Mesh::ATTRIBUTE_JOINT_WEIGHT));
    let joints = match joints {
        Some(((VertexFormat::Uint16x4, indices), (VertexFormat::Float32x4, weights))) => {
            Some([indices, weights])
        }
        Some(_) => {
            return Err("compressed joints are not read; give weights as Float32x4".to_owned());
        }
        None => None,
    };
    let stride = layout.layout().array_stride as u32;
    Ok(VertexPlaces { stride, position, texcoords, color, joints })
}

/// Adds a mesh's morph targets to its deformation, and returns their buffer; `None` if there are
/// none that can be read.
#[cfg(feature = "morph")]
fn morph_targets(
    mesh: AssetId<Mesh>,
    sources: &Sources<'_>,
    deformation: &mut Deformation,
) -> Option<wgpu::Buffer> {
    let slice = sources.allocator.mesh_morph_target_slice(&mesh)?;
    if !slice.buffer.usage().contains(wgpu::BufferUsages::STORAGE) || deformation.vertex_count == 0
    {
        return None;
    }
    deformation.first_target = slice.range.start;
    deformation.target_count = slice.range.len() as u32 / deformation.vertex_count;
    Some((**slice.buffer).clone())
}

#[cfg(not(feature = "morph"))]
fn morph_targets(_: AssetId<Mesh>, _: &Sources<'_>, _: &mut Deformation) -> Option<wgpu::Buffer> {
    None
}
