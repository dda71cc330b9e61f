//! An estimate of a rendering's GPU memory, before anything is uploaded.
//!
//! Everything except the voxel list follows from known sizes. The number of voxels is estimated
//! from the surface: a plane of area A and unit normal n at a random position in a grid of cells of
//! edge h meets about A / h² · (|nx| + |ny| + |nz|) cells, the area of its projections along the
//! axes (Cauchy's formula, axis by axis). Pieces that share a voxel count several times, so fine
//! detail is overestimated.

use std::collections::HashSet;

use glam::Vec3;
use lumivox::{Directionality, Grid, VolumeKind, dense_volume_bytes};
use lumivox_scene::{Instance, Light, Material, Scene, Shading, Texture};

use crate::gpu::memory::available_memory;
use crate::passes::near_shadows::{MAX_NEAR_BYTES, SQUARES};
use crate::passes::overlay::OVERLAY_BYTES_PER_PIXEL;
use crate::passes::shadow_layers::{MAX_BYTES as MAX_SHADOW_BYTES, ParallelSight, fine_boxes};
use crate::passes::targets::{BYTES_PER_PIXEL, TINT_BYTES_PER_PIXEL, trace_bytes};
use crate::scene::{DrawRecord, Lighting, VERTEX_BYTES};
use crate::{Gpu, MemoryUse, RenderError, RenderSettings, ShadowMethod};

/// Faces per voxel; 0.9 to 1.9 on the built-in scenes.
const FACES_PER_VOXEL: f64 = 1.4;
/// Bytes of a face: its record in the list (96), its patch (48), the hits of its rays (96), its
/// light, three colours in full floats (48), and twice the light from afar (64).
const FACE_BYTES: u64 = 96 + 48 + 96 + 48 + 2 * 64;
/// Bytes of a face's radiance in cells.
const FACE_BYTES_IN_CELLS: u64 = 16;
/// Bytes of a node: its record (8), and the index of its faces (4).
const NODE_BYTES: u64 = 8 + 4;
/// Bytes of a node's entries in two lists of changed cells.
const NODE_BYTES_IN_CELLS: u64 = 24;
/// Bytes of an octree per voxel: 160 to 430 on the scenes of docs/octree.md, with 128 voxels or
/// more along the longest axis.
const OCTREE_BYTES_PER_VOXEL: u64 = 300;
/// Bytes of an octree per voxel, with one value a voxel.
const ISOTROPIC_OCTREE_BYTES_PER_VOXEL: u64 = 170;

/// The estimated GPU memory of a scene with given settings, by its use.
#[derive(Clone, Debug, PartialEq)]
pub struct MemoryEstimate {
    /// Each use; those whose name contains `about` are estimates, the others are exact.
    pub parts: Vec<MemoryUse>,
    /// The estimated number of occupied voxels.
    pub voxels: u64,
    name: String,
    /// The remedy for too many voxels.
    voxel_remedy: &'static str,
}

impl MemoryEstimate {
    /// Estimates for a valid scene (see [`Scene::validate`]).
    ///
    /// # Errors
    /// [`RenderError::Gi`] when the settings' grid is impossible.
    pub fn new(scene: &Scene, settings: &RenderSettings) -> Result<Self, RenderError> {
        let bounds = settings.grid_bounds.unwrap_or_else(|| scene.voxel_bounds());
        let around = bounds.min + 0.5 * bounds.size();
        let camera = scene.cameras.first().map_or(around, |camera| camera.position);
        let grid = settings.grid(bounds, camera)?;
        let vertices: usize = scene.meshes.iter().map(|mesh| mesh.positions.len()).sum();
        let indices: usize = scene.meshes.iter().map(|mesh| mesh.indices.len()).sum();
        let vertex_bytes = vertices as u64 * VERTEX_BYTES + indices as u64 * 4;
        let pixels = u64::from(settings.size.x) * u64::from(settings.size.y);
        let voxels = voxel_count(scene, &grid, |_| true);
        // If instances can move, the static and the moving share have separate buffers.
        let voxelized = || scene.shown().filter(|instance| instance.is_voxelized);
        let fixed = voxelized().filter(|instance| instance.is_static).count();
        let fixed_voxels = || voxel_count(scene, &grid, |instance| instance.is_static);
        let moves = fixed < voxelized().count();
        let kept = if moves { kept_bytes(&grid, fixed_voxels(), voxels) } else { 0 };
        // Clear glass has no tint, but the difference is too small to check.
        let has_glass = scene.materials.iter().any(|material| material.transmission.factor > 0.0);
        let tint = if has_glass { TINT_BYTES_PER_PIXEL } else { 0 };
        let overlay = if settings.overlay.is_on() { OVERLAY_BYTES_PER_PIXEL } else { 0 };
        let cones = trace_bytes(&settings.trace, settings.size);
        let parts = [
            (
                "vertices and indices",
                vertex_bytes.min(settings.geometry_budget.unwrap_or(u64::MAX)),
            ),
            ("textures", texture_bytes(scene)),
            ("instances", (scene.shown().count() * size_of::<DrawRecord>()) as u64),
            ("shadow maps", shadow_bytes(scene, &grid, settings)),
            volume_part(&grid, settings, voxels),
            ("voxel list (about)", list_bytes(&grid, voxels, settings) + kept),
            ("picture", pixels * (BYTES_PER_PIXEL + tint + overlay) + cones),
        ];
        let parts = parts.map(|(name, bytes)| MemoryUse::new(name, bytes)).to_vec();
        Ok(Self { parts, voxels, name: scene.name.clone(), voxel_remedy: voxel_remedy(settings) })
    }

    /// The sum, bytes.
    pub fn bytes(&self) -> u64 {
        self.parts.iter().map(|part| part.bytes).fold(0, u64::saturating_add)
    }

    /// Compares with the device's memory, if it is known. Graphics APIs do not report a GPU's
    /// memory, so there only an allocation can fail; a software driver uses main memory, which the
    /// system reports.
    ///
    /// # Errors
    /// [`RenderError::OutOfMemory`], with the parts and a remedy.
    pub fn check(&self, gpu: &Gpu) -> Result<(), RenderError> {
        // Software drivers overcommit memory, and the system then kills the process.
        let is_short = |available| self.bytes() > available;
        if gpu.is_software() && available_memory().is_some_and(is_short) {
            return Err(self.too_large(gpu));
        }
        Ok(())
    }

    /// The error for a scene that does not fit.
    pub(crate) fn too_large(&self, gpu: &Gpu) -> RenderError {
        let mib = |bytes: u64| bytes.div_ceil(1 << 20);
        let mut parts: Vec<&MemoryUse> = self.parts.iter().collect();
        parts.sort_by_key(|part| std::cmp::Reverse(part.bytes));
        let largest: Vec<String> = parts
            .iter()
            .take(3)
            .map(|part| format!("{} {} MiB", part.name, mib(part.bytes)))
            .collect();
        let remedy = match parts.first().map_or("", |part| part.name.as_str()) {
            "textures" => "allow less memory for textures, so that they are shrunk",
            "picture" => "ask for a smaller picture",
            "shadow maps" => "lower the shadow maps' resolution",
            "vertices and indices" => "keep fewer of them on the GPU (--geometry-budget)",
            "instances" => "simplify the scene",
            _ => self.voxel_remedy,
        };
        let what = format!("the scene \"{}\" ({})", self.name, largest.join(", "));
        gpu.out_of_memory(what, Some(self.bytes()), remedy)
    }
}

/// The change of settings that reduces the memory of voxels.
fn voxel_remedy(settings: &RenderSettings) -> &'static str {
    if settings.volume == VolumeKind::Dense
        && !settings.shows_cells()
        && settings.cone_model.is_none()
    {
        return "lower the voxels' resolution";
    }
    match (settings.volume, settings.directionality) {
        (VolumeKind::Dense, Directionality::SixLobes) => {
            "lower the voxels' resolution, keep them isotropic, or store them in an octree \
             (--volume octree)"
        }
        (VolumeKind::Dense, Directionality::Isotropic) => {
            "lower the voxels' resolution, or store them in an octree (--volume octree)"
        }
        (VolumeKind::Cascades, Directionality::SixLobes) => {
            "use fewer or smaller cascades (--cascades, --cascade-resolution), or keep voxels isotropic"
        }
        (VolumeKind::Cascades, Directionality::Isotropic) => {
            "use fewer or smaller cascades (--cascades, --cascade-resolution)"
        }
        (VolumeKind::Octree, Directionality::SixLobes) => {
            "lower the voxels' resolution, or keep them isotropic"
        }
        (VolumeKind::Octree, Directionality::Isotropic) => "lower the voxels' resolution",
    }
}

/// The volume. An octree's size is an estimate: it depends on how voxels touch each other.
fn volume_part(grid: &Grid, settings: &RenderSettings, voxels: u64) -> (&'static str, u64) {
    match (settings.volume, settings.directionality) {
        (VolumeKind::Dense | VolumeKind::Cascades, _) if !settings.gi_config(*grid).has_cells() => {
            ("voxel volume", 0)
        }
        (VolumeKind::Dense | VolumeKind::Cascades, directionality) => {
            ("voxel volume", dense_volume_bytes(grid, directionality))
        }
        (VolumeKind::Octree, Directionality::SixLobes) => {
            ("voxel volume (about)", voxels * OCTREE_BYTES_PER_VOXEL)
        }
        (VolumeKind::Octree, Directionality::Isotropic) => {
            ("voxel volume (about)", voxels * ISOTROPIC_OCTREE_BYTES_PER_VOXEL)
        }
    }
}

/// The estimated number of voxels that the selected instances occupy. A triangle that extends
/// beyond a cascade is weighted there by the share of its box that is inside.
fn voxel_count(scene: &Scene, grid: &Grid, is_meant: impl Fn(&Instance) -> bool) -> u64 {
    let voxel_m = f64::from(grid.voxel_size_m);
    let boxes: Vec<_> = (0..).zip(grid.boxes_in_world()).collect();
    let mut voxels = 0.0;
    let is_meant = |instance: &&Instance| instance.is_voxelized && is_meant(instance);
    for instance in scene.shown().filter(is_meant) {
        let Some(mesh) = scene.meshes.get(instance.mesh) else { continue };
        let corner = |index: usize| {
            mesh.positions.get(index).map(|p| instance.world_from_local.transform_point3(*p))
        };
        for triangle in mesh.triangles() {
            let [Some(a), Some(b), Some(c)] = triangle.map(corner) else { continue };
            let twice_area: Vec3 = (b - a).cross(c - a);
            let projected = f64::from(twice_area.abs().element_sum()) * 0.5;
            let (low, high) = (a.min(b).min(c), a.max(b).max(c));
            for (cascade, own) in &boxes {
                let share =
                    if grid.cascades.is_some() { share_inside((low, high), *own) } else { 1.0 };
                voxels += share * projected / (voxel_m * 2.0_f64.powi(*cascade)).powi(2);
            }
        }
    }
    (voxels.ceil() as u64).min(grid.voxel_count())
}

/// The share of a box that is inside another box; along an axis without extent, 0 or 1.
fn share_inside((low, high): (Vec3, Vec3), (outer_low, outer_high): (Vec3, Vec3)) -> f64 {
    let common = high.min(outer_high) - low.max(outer_low);
    if common.min_element() < 0.0 {
        return 0.0;
    }
    let share = (common + 1e-6) / (high - low + 1e-6);
    f64::from(share.min(Vec3::ONE).element_product())
}

/// Bits and ranks of occupied cells, and in the index for rays; nodes of all levels; faces, their
/// rays and their light. If light is stored in cells, bits of changed cells, and their ranks twice.
fn list_bytes(grid: &Grid, voxels: u64, settings: &RenderSettings) -> u64 {
    let cells: u64 = (0..grid.levels).map(|level| u64::from(grid.morton_edge(level)).pow(3)).sum();
    // The next level has a quarter of a surface's cells.
    let nodes = voxels + voxels / 3;
    let faces = (voxels as f64 * FACES_PER_VOXEL) as u64;
    let own_bytes = settings.injection.as_ref().map_or(0, |injection| injection.bytes_per_face());
    let face_bytes = FACE_BYTES + own_bytes;
    // Ranks: a word for each word of bits.
    let rays = 4 * cells.div_ceil(8) + nodes * NODE_BYTES + faces * face_bytes;
    if !settings.gi_config(*grid).has_cells() {
        return rays;
    }
    rays + 3 * cells.div_ceil(8) + nodes * NODE_BYTES_IN_CELLS + faces * FACE_BYTES_IN_CELLS
}

/// For each share: bits, ranks, an index with both, planes, and the faces' sums. The moving share
/// also stores faces, with a quarter to spare. Another set of bits is for both shares together.
fn kept_bytes(grid: &Grid, fixed: u64, voxels: u64) -> u64 {
    let cells = u64::from(grid.morton_edge(0)).pow(3);
    let faces = |voxels: u64| (voxels as f64 * FACES_PER_VOXEL) as u64;
    let face = size_of::<lumivox::voxels::FaceRecord>() as u64;
    let moving = voxels.saturating_sub(fixed);
    let share = |voxels: u64| 4 * cells.div_ceil(8) + voxels * 128 + faces(voxels) * face;
    let united = moving * 32 + faces(moving) * (face + 32);
    share(fixed) + 5 * (share(moving) + united) / 4 + 3 * cells.div_ceil(8)
}

/// Each texture with its mips, twice if it is used both as colours and as data.
fn texture_bytes(scene: &Scene) -> u64 {
    let used: HashSet<(usize, bool)> = scene.materials.iter().flat_map(texture_uses).collect();
    used.iter().filter_map(|(index, _)| scene.textures.get(*index)).map(mip_bytes).sum()
}

/// The textures of a material, and whether each holds colours.
fn texture_uses(material: &Material) -> impl Iterator<Item = (usize, bool)> {
    let data = match &material.shading {
        Shading::MetallicRoughness(m) => m.metallic_roughness_texture,
        Shading::Phong(_) | Shading::Unlit(_) => None,
    };
    let data =
        [data, material.normal_texture, material.clearcoat.texture, material.transmission.texture];
    let is_data = move |texture: usize| data.iter().flatten().any(|data| data.texture == texture);
    material.textures().map(move |used| (used.texture, !is_data(used.texture)))
}

/// All levels down to one texel, four bytes per texel.
fn mip_bytes(texture: &Texture) -> u64 {
    let levels = 0..=texture.width.max(texture.height).max(1).ilog2();
    let edge = |edge: u32, level: u32| u64::from((edge >> level).max(1));
    levels.map(|level| 4 * edge(texture.width, level) * edge(texture.height, level)).sum()
}

fn shadow_bytes(scene: &Scene, grid: &Grid, settings: &RenderSettings) -> u64 {
    if settings.shadows != ShadowMethod::Map {
        return 0;
    }
    let (boxes, bounds) = (fine_boxes(grid), scene.bounds());
    let layers = Lighting::of(scene).to_gpu(1.0).into_iter().map(|light| {
        let finer = light
            .source
            .parallel_direction()
            .map_or(0, |direction| ParallelSight::new(direction, bounds).smaller(&boxes).count());
        (light.source.shadow_layers() + finer) as u64
    });
    let layer_bytes = 4 * u64::from(settings.shadow_resolution).pow(2);
    let is_sun = |light: &&Light| light.kind.is_parallel();
    let near = scene.lights.iter().filter(is_sun).count() as u64 * u64::from(SQUARES);
    (layers.sum::<u64>() * layer_bytes).min(MAX_SHADOW_BYTES)
        + (near * layer_bytes).min(MAX_NEAR_BYTES)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Renderer;
    use crate::testing::gpu;
    use lumivox::{Preset, TraceSettings};

    /// Compares with the memory that the renderer reports.
    #[test]
    #[ignore = "slow: over three seconds"]
    fn estimated_memory_matches_allocated_memory() {
        let gpu = gpu();
        let octree = VolumeKind::Octree;
        let presets = [Preset::Balanced, Preset::Fast, Preset::Realtime];
        for ((name, resolution, bounces, moving, volume), preset) in [
            ("spheres", 64, 8, 0, VolumeKind::Dense),
            ("two-rooms", 48, 1, 2, VolumeKind::Dense),
            ("atrium", 96, 8, 0, octree),
        ]
        .into_iter()
        .zip(presets)
        {
            let mut scene = lumivox_scene::builtin::scene(name).expect("a scene");
            for instance in &mut scene.instances[..moving] {
                instance.is_static = false;
            }
            let size = glam::UVec2::new(40, 24);
            let trace = TraceSettings::preset(preset);
            let settings =
                RenderSettings { size, resolution, volume, trace, bounces, ..Default::default() };
            let estimate = MemoryEstimate::new(&scene, &settings).expect("an estimate");
            let mut quiet = |_| {};
            let renderer = Renderer::new(&gpu, &scene, None, settings, &mut quiet);
            let renderer = pollster::block_on(renderer).expect("a renderer");
            let memory = renderer.memory();
            let truth = |prefixes: &[&str]| -> f64 {
                let is_meant =
                    |part: &&MemoryUse| prefixes.iter().any(|p| part.name.starts_with(p));
                memory.iter().filter(is_meant).map(|part| part.bytes as f64).sum()
            };
            for part in &estimate.parts {
                let (truth, tolerance) = match part.name.as_str() {
                    // Tilted walls are overestimated at their edges, and surfaces that share a
                    // voxel count twice.
                    "voxel list (about)" => (truth(&["voxels", "light"]), 0.4),
                    // The rest is the white texel for missing textures.
                    "textures" => (truth(&["textures"]), 0.001),
                    "voxel volume" => (truth(&["volume"]), 0.001),
                    // It depends on how voxels touch each other.
                    "voxel volume (about)" => (truth(&["volume"]), 0.7),
                    other => (truth(&[other]), 0.001),
                };
                let error = (part.bytes as f64 - truth).abs();
                assert!(error <= truth * tolerance + 16.0, "{name}: {part:?}, is {truth}");
            }
            let voxels = f64::from(renderer.voxel_stats().voxels);
            let ratio = estimate.voxels as f64 / voxels;
            assert!((0.7..1.5).contains(&ratio), "{name}: {ratio}");
        }
    }

    #[test]
    fn out_of_memory_message_names_scene_parts_and_remedy() {
        let scene = lumivox_scene::builtin::scene("cornell").expect("a scene");
        let settings = RenderSettings { resolution: 1024, ..RenderSettings::default() };
        let estimate = MemoryEstimate::new(&scene, &settings).expect("an estimate");
        let gpu = gpu();
        let text = estimate.too_large(&gpu).to_string();
        if gpu.is_software() {
            assert!(text.contains(" MiB are free"), "{text}");
        }
        for needle in ["\"cornell\"", "voxel list", "MiB", "lower the voxels' resolution"] {
            assert!(text.contains(needle), "{text}");
        }
    }
}
