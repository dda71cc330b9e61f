//! Photon insertion: direct light into the voxels from the texels of the lights' depth maps.
//!
//! This is how Crassin et al. 2011 ("Interactive indirect illumination using voxel cone tracing",
//! section 5) light their octree. Each texel of a map is a bundle of photons that carries its flux
//! to the voxel that it shows (`insert.wgsl`); a face then reflects the received flux over its area
//! (`reflect.wgsl`). Its expected irradiance is that of the direct evaluation. Its noise depends on
//! the number of texels that see a face, so texels must be at most half a voxel wide.
//!
//! A face that fewer than four texels see is evaluated directly, since it would get all light or
//! none. A voxel does not distinguish layers behind each other (a ceiling, and a lamp's black panel
//! below it), so faces are also evaluated directly if light arrives in front of their middle
//! (`reflect.wgsl`).
//!
//! Advantages over the direct evaluation: a face in half shadow gets the light of its lit part, to
//! the texel; the time depends on the number of texels, not of faces.
//!
//! Fluxes are summed up as integers, light after light. The sum of a face is bounded:
//!
//! - by the light's solid angle, 4 pi for a point light: `incident_light` only reduces the light;
//! - for parallel light by the voxel's cross-section, at most sqrt(3) of its sides (a cube along
//!   its diagonal), and by the texels at its outline: at most `A + P d + pi d^2` texels have their
//!   centres in an area A of perimeter P, where d is half a texel's diagonal (Steiner's formula),
//!   all in texels.
//!
//! `counts_per_flux` maps that bound to 2^31, half of what a word holds.

use std::any::Any;
use std::f32::consts::{PI, SQRT_2, TAU};
use std::mem::offset_of;
use std::sync::Arc;

use bytemuck::{Pod, Zeroable};
use glam::Mat4;

use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    storage_buffer, uniform_buffer,
};
use lumivox::hooks::{FaceLight, Injection, InjectionParts, Injector, MappedLight};
use lumivox::voxels::VoxelList;
use lumivox::{Gi, GiError, Grid, LightSource, ShadowLayer};

use crate::with_modules;

/// Photons, as [`lumivox::GiConfig::injection`]: each texel of a light's shadow map is a bundle of
/// photons that carries its flux to the voxel that it shows. Lights without a map, and faces that
/// the map shows in too few texels, are evaluated directly.
pub fn photons() -> Arc<dyn Injection> {
    Arc::new(PhotonInjection)
}

/// One [`PhotonFates`] for the last call of [`Gi::light`]; `None` without photons.
pub fn photon_fates(gi: &Gi) -> Option<&Buffer> {
    let injector: &dyn Any = gi.injector()?;
    injector.downcast_ref::<Photons>().map(|photons| &photons.fates)
}

/// The name of the injection.
pub const NAME: &str = "photons";

/// Noise depends on the texels that see a voxel's side: at least two along an edge.
const MAX_TEXEL_VOXELS: f32 = 0.5;

#[derive(Debug)]
struct PhotonInjection;

impl Injection for PhotonInjection {
    fn name(&self) -> &'static str {
        NAME
    }

    fn bytes_per_face(&self) -> u64 {
        SUMS_BYTES
    }

    fn largest_texel_voxels(&self) -> f32 {
        MAX_TEXEL_VOXELS
    }

    fn make(&self, parts: &InjectionParts<'_>) -> Result<Box<dyn Injector>, GiError> {
        Ok(Box::new(Photons::new(parts)?))
    }
}

/// The shader modules of this folder.
const MODULES: &[(&str, &str)] = &[
    ("classics::photons::direct", include_str!("direct.wgsl")),
    ("classics::photons::photon_map", include_str!("photon_map.wgsl")),
    ("classics::photons::insert", include_str!("insert.wgsl")),
    ("classics::photons::reflect", include_str!("reflect.wgsl")),
];

/// The most layers of a light's maps: those of a point light.
const PHOTON_LAYERS: usize = 6;

/// The library with the modules of this folder.
fn link_into(shaders: &ShaderLibrary) -> ShaderLibrary {
    let mut library = with_modules(shaders, MODULES);
    library
        .constant_u32("PHOTON_LAYERS", PHOTON_LAYERS as u32)
        .constant_u32("FATES", size_of::<PhotonFates>() as u32 / 4)
        .constant_u32("FATE_NONE", offset_of!(PhotonFates, none) as u32 / 4)
        .constant_u32("FATE_KEPT", offset_of!(PhotonFates, kept) as u32 / 4)
        .constant_u32("FATE_ABSORBED", offset_of!(PhotonFates, absorbed) as u32 / 4)
        .constant_u32("FATE_LOST", offset_of!(PhotonFates, lost) as u32 / 4);
    library
}

/// `Taken` of `photon_map.wgsl`, for each face.
const SUMS_BYTES: u64 = 8;
/// The largest possible sum: half of what a word holds.
const LARGEST_SUM: f32 = 2_147_483_648.0;

/// `PhotonMap` of `photon_map.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct PhotonMap {
    world_from_clip: [Mat4; PHOTON_LAYERS],
    light: u32,
    first_layer: u32,
    layer_count: u32,
    counts_per_flux: f32,
}

impl PhotonMap {
    fn new(light: &MappedLight, grid: &Grid) -> Self {
        let mut world_from_clip = [Mat4::IDENTITY; PHOTON_LAYERS];
        // Photons come from the layers that cover the whole light, not from finer maps within them.
        let finer = light.layers.iter().filter(|layer| layer.has_finer).count();
        let layers = &light.layers[..light.layers.len() - finer];
        for (inverse, layer) in world_from_clip.iter_mut().zip(layers) {
            // In f64: projections from far away lose digits.
            *inverse = layer.clip_from_world.as_dmat4().inverse().as_mat4();
        }
        Self {
            world_from_clip,
            light: light.index,
            first_layer: light.first_layer,
            layer_count: layers.len() as u32,
            counts_per_flux: LARGEST_SUM / largest_flux(light, grid),
        }
    }
}

/// The maximum flux into a voxel, for an intensity of one.
fn largest_flux(light: &MappedLight, grid: &Grid) -> f32 {
    let texel = light.layers.first().map_or(0.0, |layer: &ShadowLayer| layer.texel_size);
    // An area with the texels at its outline.
    let with_outline = |area: f32, perimeter: f32| {
        let reach = texel / SQRT_2;
        area + perimeter * reach + PI * reach * reach
    };
    match light.source {
        LightSource::Directional { .. } | LightSource::Environment { .. } => {
            let side = grid.voxel_size_m;
            // A hexagon: the outline of a cube along its diagonal.
            with_outline(3.0_f32.sqrt() * side * side, 24.0_f32.sqrt() * side)
        }
        // The texels of six faces tile the sphere.
        LightSource::Point { .. } => 2.0 * TAU,
        LightSource::Spot { outer_angle_rad, .. } => {
            let (sine, cosine) = outer_angle_rad.sin_cos();
            with_outline(TAU * (1.0 - cosine), TAU * sine)
        }
    }
}

/// The fates of the bundles of all lights, in texels of their maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct PhotonFates {
    /// Texels without a surface, or whose direction belongs to another face of a cube.
    pub none: u32,
    /// Bundles inserted into a voxel.
    pub kept: u32,
    /// Bundles that met a side without a face, such as the back of a single-sided wall, which
    /// reflects nothing.
    pub absorbed: u32,
    /// Bundles that met no voxel, or one without faces: at edges that rounding moves into another
    /// voxel, at masks that are open in voxels but not in maps, or outside the grid.
    pub lost: u32,
}

/// Inserts photons.
#[derive(Debug)]
struct Photons {
    grid: Grid,
    grid_group: BindGroup,
    direct: Kernel,
    insert: Kernel,
    reflect: Kernel,
    direct_layout: wgpu::BindGroupLayout,
    insert_layout: wgpu::BindGroupLayout,
    reflect_layout: wgpu::BindGroupLayout,
    fates: Buffer,
    list: Option<List>,
}

/// The resources of the current voxel list.
#[derive(Debug)]
struct List {
    occupancy: Buffer,
    ranks: Buffer,
    first_faces: Buffer,
    faces: Buffer,
    face_count: u64,
    sums: Buffer,
}

impl Photons {
    fn new(parts: &InjectionParts<'_>) -> Result<Self, GiError> {
        let InjectionParts { device, grid, globals, lights, .. } = *parts;
        let shaders = link_into(parts.shaders);
        // The volume's storage buffers would exceed WebGPU's limit.
        let grid_layout = LayoutBuilder::compute().uniform().build(device, "grid");
        let grid_group =
            BindGroupBuilder::new(&grid_layout).buffer(&grid.uniform(device)).build(device, "grid");
        let direct_layout =
            LayoutBuilder::compute().storage().storage_mut().build(device, "light before photons");
        let insert_layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .storage()
            .storage()
            .storage()
            .storage_mut()
            .storage_mut()
            .build(device, "insert photons");
        let reflect_layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .storage_mut()
            .storage_mut()
            .build(device, "reflect photons");
        let kernel = |module, group_0, layout| {
            Kernel::new(device, &shaders, module, "main", &[group_0, layout, lights])
        };
        Ok(Self {
            grid: *grid,
            grid_group,
            direct: kernel("classics::photons::direct", globals, &direct_layout)?,
            insert: kernel("classics::photons::insert", &grid_layout, &insert_layout)?,
            reflect: kernel("classics::photons::reflect", &grid_layout, &reflect_layout)?,
            direct_layout,
            insert_layout,
            reflect_layout,
            fates: storage_buffer(device, "fates of photons", size_of::<PhotonFates>() as u64),
            list: None,
        })
    }
}

impl Injector for Photons {
    fn take(&mut self, device: &Pipelines, voxels: &VoxelList) {
        // The capacity, since it is constant while the list changes.
        let face_count = voxels.face_capacity();
        if self.list.as_ref().is_some_and(|list| list.faces == voxels.faces) {
            return;
        }
        self.list = Some(List {
            occupancy: voxels.occupancy.clone(),
            ranks: voxels.ranks.clone(),
            first_faces: voxels.first_faces.clone(),
            faces: voxels.faces.clone(),
            face_count,
            sums: storage_buffer(device, "flux of the faces", face_count * SUMS_BYTES),
        });
    }

    fn run(&self, recorder: &mut Recorder, light: FaceLight<'_>) {
        let Some(list) = &self.list else {
            return;
        };
        let FaceLight { globals, lights, direct } = light;
        let device = recorder.device().clone();
        let direct_group = BindGroupBuilder::new(&self.direct_layout)
            .buffer(&list.faces)
            .buffer(direct)
            .build(&device, "light before photons");
        self.direct.run_linear(recorder, &[globals, &direct_group, &lights.group], list.face_count);
        recorder.clear(&self.fates);
        let [width, height] = lights.map_size;
        for light in &lights.mapped {
            let map = PhotonMap::new(light, &self.grid);
            let layers = map.layer_count;
            let map = uniform_buffer(&device, "photon map", &map);
            let insert_group = BindGroupBuilder::new(&self.insert_layout)
                .buffer(&map)
                .buffer(&list.occupancy)
                .buffer(&list.ranks)
                .buffer(&list.first_faces)
                .buffer(&list.faces)
                .buffer(&list.sums)
                .buffer(&self.fates)
                .build(&device, "insert photons");
            let reflect_group = BindGroupBuilder::new(&self.reflect_layout)
                .buffer(&map)
                .buffer(&list.faces)
                .buffer(&list.sums)
                .buffer(direct)
                .build(&device, "reflect photons");
            let groups = [&self.grid_group, &insert_group, &lights.group];
            self.insert.run(recorder, &groups, [width, height, layers]);
            let groups = [&self.grid_group, &reflect_group, &lights.group];
            self.reflect.run_linear(recorder, &groups, list.face_count);
        }
    }

    fn memory(&self) -> Vec<(&'static str, u64)> {
        vec![("light: flux of the faces", self.list.as_ref().map_or(0, |list| list.sums.size()))]
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use lumivox::{Directionality, VolumeKind, shaders::library_with_volume};
    use lumivox_reflect::{check_modules, layout};

    use super::{MODULES, PhotonMap, link_into};

    #[test]
    fn shaders_are_valid_and_struct_layouts_match() {
        let library = link_into(&library_with_volume(VolumeKind::Dense, Directionality::SixLobes));
        assert!(check_modules(&library, "classics::photons") > 0);
        let (members, size) = layout(&library, MODULES[1].0, "PhotonMap");
        let offsets = [
            ("world_from_clip", offset_of!(PhotonMap, world_from_clip)),
            ("light", offset_of!(PhotonMap, light)),
            ("first_layer", offset_of!(PhotonMap, first_layer)),
            ("layer_count", offset_of!(PhotonMap, layer_count)),
            ("counts_per_flux", offset_of!(PhotonMap, counts_per_flux)),
        ];
        let offsets = offsets.map(|(name, offset)| (name.to_owned(), offset as u32));
        assert_eq!(members, offsets);
        assert_eq!(size as usize, size_of::<PhotonMap>());
    }
}
