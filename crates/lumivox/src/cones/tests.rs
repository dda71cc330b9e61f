//! Compares rays and the march with twins on the CPU, and the hemisphere's cells with integrals.

use std::sync::Arc;

use glam::{UVec3, Vec3, Vec4};

use crate::cones::{ConeModel, LEAST_SURPLUS, SURPLUS};
use crate::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Pipelines, Recorder, Timing, storage_buffer, upload,
};
use crate::testing::{busy_room, device, morton_decode, read};
use crate::volume::{Level, read_levels};
use crate::voxels::FaceRecord;
use crate::{Gi, GiConfig, Grid, TraceSettings};

use bytemuck::{Pod, Zeroable};

#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct ConeIn {
    origin: [f32; 3],
    growth: f32,
    direction: [f32; 3],
    reach: f32,
    level_offset: f32,
    padding: [f32; 3],
}

const CONES_WGSL: &str = "
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::cones::cone::{Cone, ConeSettings};
import package::cones::trace_method::trace_cone;
struct ConeIn { origin: vec3f, growth: f32, direction: vec3f, reach: f32, level_offset: f32 }
@group(1) @binding(0) var<storage, read> cones: array<ConeIn>;
@group(1) @binding(1) var<storage, read_write> traced: array<vec4f>;
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&traced) { return; }
    let cone = cones[id.x];
    var settings = ConeSettings();
    settings.voxel_per_diameter = 0.25;
    settings.normal_offset = 0.75;
    settings.step_per_voxel = 1.0;
    settings.min_transmittance = 0.004;
    settings.occlusion_distance = 3e38;
    settings.model_values = vec4f(0.5, 2.0, 0.0, 0.0);
    let result = trace_cone(Cone(cone.origin, cone.direction, cone.growth, cone.reach, cone.level_offset, 0u), settings);
    traced[id.x] = vec4f(result.radiance + result.emission, result.transmittance);
}";

/// As in `march.wgsl`.
fn is_spent(transmittance: f32, settings: &TraceSettings) -> bool {
    let least = -settings.min_transmittance.min(LEAST_SURPLUS);
    (least..=settings.min_transmittance).contains(&transmittance)
}

/// `shown_share` of `model.wgsl`, of the absorbed and the remaining transmittance, level and width.
type ShownShare = fn(f32, f32, u32, f32) -> f32;

/// The volume read back.
struct VolumeTwin {
    grid: Grid,
    levels: Vec<Level>,
}

impl VolumeTwin {
    /// Trilinear at one level; texels outside are zero.
    fn trilinear(&self, texels: &[[f32; 4]], level: u32, position: Vec3) -> Vec4 {
        let dimensions = self.grid.level_dimensions(level).as_ivec3();
        let texel = position / (1 << level) as f32 - 0.5;
        let corner = texel.floor();
        let fraction = texel - corner;
        let mut sum = Vec4::ZERO;
        for i in 0..8 {
            let offset = UVec3::new(i & 1, (i >> 1) & 1, i >> 2);
            let at = corner.as_ivec3() + offset.as_ivec3();
            if at.cmplt(glam::IVec3::ZERO).any() || at.cmpge(dimensions).any() {
                continue;
            }
            let side = offset.as_vec3();
            let weight = (side * fraction + (1.0 - side) * (1.0 - fraction)).element_product();
            let index = (at.z * dimensions.y + at.y) * dimensions.x + at.x;
            sum += weight * Vec4::from_array(texels[index as usize]);
        }
        sum
    }

    /// Radiance times coverage, and coverage: the definition, over all six lobes.
    fn sample(&self, position: Vec3, level: u32, direction: Vec3) -> Vec4 {
        let cells = &self.levels[level as usize];
        let mut sum = Vec4::ZERO;
        for lobe in 0..6 {
            let axis = lobe / 2;
            let sign = if lobe % 2 == 0 { 1.0 } else { -1.0 };
            let value = self.trilinear(&cells.lobes[lobe], level, position);
            let tilt = self.trilinear(&cells.tilts[axis], level, position);
            let across = if lobe % 2 == 0 { [tilt.x, tilt.y] } else { [tilt.z, tilt.w] };
            let mut area = Vec3::ZERO;
            area[axis] = sign * value.w;
            area[(axis + 1) % 3] = across[0];
            area[(axis + 2) % 3] = across[1];
            let coverage = (-direction.dot(area)).max(0.0);
            if value.w > 0.0 && coverage > 0.0 {
                sum += (value.truncate() * (coverage / value.w)).extend(coverage);
            }
        }
        sum
    }

    /// The lobes of the 2x2x2 cells of a look-up, and the axes on which one of these lobes is
    /// tilted.
    fn near(&self, position: Vec3, level: u32) -> ([bool; 6], [bool; 3]) {
        let cells = &self.levels[level as usize];
        let dimensions = cells.dimensions.as_ivec3();
        let corner = (position / (1 << level) as f32 - 0.5).floor().as_ivec3();
        let (mut present, mut tilted) = ([false; 6], [false; 3]);
        for i in 0..8 {
            let at = corner + glam::IVec3::new(i & 1, (i >> 1) & 1, i >> 2);
            if at.cmplt(glam::IVec3::ZERO).any() || at.cmpge(dimensions).any() {
                continue;
            }
            let index = ((at.z * dimensions.y + at.y) * dimensions.x + at.x) as usize;
            for (lobe, present) in present.iter_mut().enumerate() {
                *present |= cells.lobes[lobe][index][3] > 0.0;
                // A tilt counts if it survives rounding to 8 bits.
                let tilt = Vec4::from_array(cells.tilts[lobe / 2][index]).abs().max_element();
                tilted[lobe / 2] |= tilt > 0.5 / 127.0;
            }
        }
        (present, tilted)
    }

    /// `true` if the cells of a look-up have no lobe.
    fn is_clear(&self, position: Vec3, level: u32) -> bool {
        self.near(position, level).0.iter().all(|is_present| !is_present)
    }

    /// `None` if none of the 2x2x2 cells of a look-up has a lobe that may face against the
    /// direction: one whose axis does, or a tilted one (or its opposite) if the direction leans
    /// more across the axis than along. Otherwise whether one of them is tilted.
    fn is_oblique(&self, position: Vec3, level: u32, direction: Vec3) -> Option<bool> {
        let (present, tilted) = self.near(position, level);
        let facing = (0..6).filter(|&lobe| {
            let axis = lobe / 2;
            let along = direction[axis];
            let across = direction.abs().element_sum() - along.abs();
            let faces = (along < 0.0) == (lobe % 2 == 0);
            present[lobe] && (faces || (tilted[axis] && along.abs() < across))
        });
        facing.map(|lobe| tilted[lobe / 2]).reduce(|a, b| a || b)
    }

    /// `trace_cone`, with the same loops.
    fn trace(&self, cone: &ConeIn, settings: &TraceSettings, shown_share: ShownShare) -> Vec4 {
        let (origin, direction) = (Vec3::from(cone.origin), Vec3::from(cone.direction));
        let extent = self.grid.dimensions.as_vec3();
        let side = extent.max_element();
        let largest = (1 << (self.grid.levels - 1)) as f32;
        let reach = cone.reach.min(1.75 * side + 2.0 * largest);
        let (mut radiance, mut transmittance, mut distance) = (Vec3::ZERO, 1.0_f32, 0.0_f32);
        let (mut level, mut pays_back) = (0, false);
        while distance < reach {
            let near = (cone.growth * distance).clamp(1.0, largest);
            let wanted = (cone.growth * (distance + 0.5 * near)).clamp(1.0, largest);
            let wanted = ((wanted.log2() + cone.level_offset) as u32).min(self.grid.levels - 1);
            let cell = (1 << level) as f32;
            let middle = distance + 0.5 * cell;
            let position = origin + direction * middle;
            let margin = cell.min(0.5 * side);
            if position.cmplt(Vec3::splat(-margin)).any() || position.cmpgt(extent + margin).any() {
                break;
            }
            let is_oblique = |level| self.is_oblique(position, level, direction);
            let here = is_oblique(level);
            if here.is_none() {
                pays_back = true;
                if is_spent(transmittance, settings) {
                    break;
                }
            }
            let seen = self.sample(position, level, direction);
            if seen.w > 0.0 {
                let may_exceed = here == Some(true);
                pays_back = transmittance < 0.0 && (pays_back || !may_exceed);
                let covered = seen.w * cell.min(reach - distance) / cell;
                let taken = if pays_back {
                    -covered.min(-transmittance)
                } else {
                    covered.min(transmittance + if may_exceed { SURPLUS } else { 0.0 })
                };
                let width = cone.growth / settings.voxel_per_diameter * middle / side;
                let shown = shown_share(taken, transmittance, level, width);
                radiance += seen.truncate() * (shown / seen.w);
                transmittance -= taken;
                pays_back |= transmittance <= -SURPLUS;
                if is_spent(transmittance, settings) && (pays_back || !may_exceed) {
                    break;
                }
            }
            distance += cell;
            if wanted > level && here.is_none() && self.is_clear(position, level + 1) {
                level += 1;
            }
        }
        if is_spent(transmittance, settings) {
            radiance /= 1.0 - transmittance;
            transmittance = 0.0;
        }
        radiance.extend(transmittance)
    }
}

/// A few hundred cones from all over the room and from outside, of all directions and widths.
fn cones(grid: &Grid) -> Vec<ConeIn> {
    let mut state = 1_u64;
    let mut random = move || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1_u64 << 24) as f32
    };
    (0..400)
        .map(|_| {
            let place = Vec3::new(random(), random(), random()) * 1.2 - 0.1;
            let direction = loop {
                let v = 2.0 * Vec3::new(random(), random(), random()) - 1.0;
                if v.length() > 0.1 && v.length() < 1.0 {
                    break v.normalize();
                }
            };
            let reach = if random() < 0.3 { 20.0 * random() } else { 3e38 };
            ConeIn {
                origin: (place * grid.dimensions.as_vec3()).to_array(),
                growth: 0.02 + 0.5 * random(),
                direction: direction.to_array(),
                reach,
                level_offset: random(),
                padding: [0.0; 3],
            }
        })
        .collect()
}

/// A room with light, and the results of its cones.
struct Traced {
    gi: Gi,
    cones: Vec<ConeIn>,
    found: Vec<Vec4>,
}

fn trace(device: &Pipelines, queue: &wgpu::Queue, config: GiConfig) -> Traced {
    let grid = config.grid;
    let mut gi = Gi::with_pipelines(device, queue, config).expect("a device");
    let geometry = busy_room().build(device);
    pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let lights = gi.bind_lights(&[], Vec3::ZERO, None);
    let mut recorder = Recorder::new(device, queue);
    gi.light(&mut recorder, &lights, 2, &TraceSettings::default()).expect("valid settings");
    recorder.submit();
    let cones = cones(&grid);
    let found = trace_cones((device, queue), &gi, CONES_WGSL, &cones);
    Traced { gi, cones, found }
}

/// The results of cones.
fn trace_cones(
    (device, queue): (&Pipelines, &wgpu::Queue),
    gi: &Gi,
    source: &str,
    cones: &[ConeIn],
) -> Vec<Vec4> {
    let mut shaders = gi.shaders().clone();
    shaders.add("test::cones", source);
    let layout =
        LayoutBuilder::compute().storage().storage_mut().build(gi.pipelines(), "test cones");
    let layouts = [gi.globals_layout(), &layout];
    let kernel =
        Kernel::new(gi.pipelines(), &shaders, "test::cones", "main", &layouts).expect("it links");
    let input = upload(device, "cones", cones);
    let output = storage_buffer(device, "traced", cones.len() as u64 * 16);
    let group =
        BindGroupBuilder::new(&layout).buffer(&input).buffer(&output).build(device, "test cones");
    let mut recorder = Recorder::new(device, queue);
    kernel.run_linear(&mut recorder, &[gi.globals(), &group], cones.len() as u64);
    recorder.submit();
    read(device, queue, &output, cones.len())
}

/// Rays that test all faces, one after another.
struct RayTwin {
    grid: Grid,
    faces: Vec<FaceRecord>,
    radiance: Vec<Vec4>,
}

impl RayTwin {
    /// Radiance and the share that hits nothing, like `trace_cone` of `exact.wgsl`.
    fn trace(&self, ray: &ConeIn) -> Vec4 {
        let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
        let mut nearest = (ray.reach, Vec4::W);
        for (face, radiance) in self.faces.iter().zip(&self.radiance) {
            let voxel = morton_decode(face.cell).as_vec3();
            let place = (Vec3::from(face.position_in_world) - self.grid.origin_in_world)
                / self.grid.voxel_size_m
                - voxel;
            let normal = Vec3::from(face.vector_area).normalize();
            let cosine = normal.dot(direction);
            let distance = normal.dot(place - (origin - voxel)) / cosine;
            let is_back = cosine > 0.0;
            let blocks = face.flags & FaceRecord::SINGLE_SIDED != 0 && distance >= 1.0;
            let at = origin - voxel + direction * distance;
            if distance > 0.0 && distance < nearest.0 && (!is_back || blocks) && covers(face, at) {
                let light = if is_back { Vec3::ZERO } else { radiance.truncate() };
                nearest = (distance, light.extend(0.0));
            }
        }
        nearest.1
    }
}

fn covers(face: &FaceRecord, at: Vec3) -> bool {
    let axis = face.lobe as usize / 2;
    let (u, v) = (at[(axis + 1) % 3], at[(axis + 2) % 3]);
    let [x, y] = [u, v].map(|place| place.clamp(0.0, 1.0));
    let bit = |bits: u32, place: f32| bits >> (32.0 * place).min(31.0) as u32 & 1 == 1;
    let square = (8.0 * y).min(7.0) as u32 * 8 + (8.0 * x).min(7.0) as u32;
    let mask = u64::from(face.mask_high) << 32 | u64::from(face.mask_low);
    let along = [x, y, 0.5 * (x + y), 0.5 * (x - y) + 0.5];
    (u - x).abs() <= 0.01
        && (v - y).abs() <= 0.01
        && mask >> square & 1 == 1
        && face.profiles.iter().zip(along).all(|(bits, place)| bit(*bits, place))
}

/// Before anything is voxelized, rays leave the grid in steps of at least four voxels.
#[test]
fn rays_without_voxels_leave_the_grid_in_few_steps() {
    let (device, queue) = device();
    let grid = Grid::fit(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), 32, Vec3::ZERO).expect("fits");
    let gi = Gi::with_pipelines(&device, &queue, GiConfig::new(grid)).expect("a device");
    let source = CONES_WGSL.replace(
        "vec4f(result.radiance + result.emission, result.transmittance)",
        "vec4f(f32(result.samples), 0.0, 0.0, result.transmittance)",
    );
    for found in trace_cones((&device, &queue), &gi, &source, &cones(&grid)) {
        assert!(found.x <= 3.0 * 8.0 + 1.0 && found.w > 0.5, "{found}");
    }
}

#[test]
fn gpu_rays_match_the_cpu_twin() {
    let (device, queue) = device();
    let grid = Grid::fit(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), 32, Vec3::ZERO).expect("fits");
    let Traced { gi, cones, found: traced } = trace(&device, &queue, GiConfig::new(grid));
    let list = gi.voxels().expect("there are voxels");
    let count = list.face_count as usize;
    let radiance = gi.face_radiance().expect("there is light");
    let twin = RayTwin {
        grid,
        faces: read(&device, &queue, &list.faces, count),
        radiance: read(&device, &queue, radiance, count),
    };
    // At the border of a face's cover, rounding decides whether a ray hits.
    let (mut blocked, mut open, mut different) = (0, 0, 0);
    for (ray, traced) in cones.iter().zip(&traced) {
        let expected = twin.trace(ray);
        let is_same = (*traced - expected).abs().max_element()
            < 0.002 * (1.0 + expected.truncate().max_element());
        different += usize::from(!is_same);
        blocked += usize::from(expected.w < 0.5);
        open += usize::from(expected.w > 0.5);
    }
    println!("{blocked} blocked, {open} open, {different} different");
    assert!(blocked > 50 && open > 5, "{blocked} blocked and {open} open rays test little");
    assert!(different <= cones.len() / 100, "{different} of {} rays differ", cones.len());
}

/// An unphysical model: samples of coarse levels show more, those of wide cones less.
#[derive(Debug)]
struct Stylized;

impl ConeModel for Stylized {
    fn name(&self) -> &'static str {
        "stylized"
    }

    fn module(&self) -> &'static str {
        "
fn place_in_cell(drawn: vec2f, cell: u32, cell_count: u32, values: vec4f) -> vec2f { return drawn; }
fn glossy_half_vector(drawn: vec3f, values: vec4f) -> vec3f { return drawn; }
fn start_of_cones(above: vec3f, normal: vec3f, level: u32, values: vec4f) -> vec3f { return above; }
fn shown_share(taken: f32, transmittance: f32, level: u32, width: f32, values: vec4f) -> f32 {
    return min(taken * (1.0 + f32(level) * values.y), max(transmittance, taken))
        * max(1.0 - values.x * width, 0.0);
}"
    }
}

#[test]
fn marching_with_a_cone_model_matches_the_cpu_twin() {
    // The values are those of CONES_WGSL.
    assert_marches_like_its_twin(Arc::new(Stylized), |taken, transmittance, level, width| {
        (taken * (1.0 + 2.0 * level as f32)).min(transmittance.max(taken))
            * (1.0 - 0.5 * width).max(0.0)
    });
}

fn assert_marches_like_its_twin(model: Arc<dyn ConeModel>, shown_share: ShownShare) {
    // As in CONES_WGSL.
    let settings = &TraceSettings {
        voxel_per_diameter: 0.25,
        min_transmittance: 0.004,
        ..TraceSettings::default()
    };
    let (device, queue) = device();
    let grid = Grid::fit(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), 32, Vec3::ZERO).expect("fits");
    let config = GiConfig { cones: Some(model), ..GiConfig::new(grid) };
    let Traced { gi, cones, found: traced } = trace(&device, &queue, config);
    let twin = VolumeTwin { grid, levels: read_levels(&device, &queue, &gi) };
    let (mut blocked, mut open, mut worst) = (0, 0, 0.0_f32);
    for (cone, traced) in cones.iter().zip(&traced) {
        let expected = twin.trace(cone, settings, shown_share);
        // Worst on lavapipe: 1e-5. Other GPUs filter with weights of 8 bits, over up to 50 samples
        // a cone.
        let error = (*traced - expected).abs().max_element();
        assert!(
            error < 0.01 * (1.0 + expected.max_element()),
            "{cone:?}: {traced}, not {expected}"
        );
        blocked += usize::from(expected.w <= 0.0);
        open += usize::from(expected.w >= 1.0);
        worst = worst.max(error);
    }
    println!("worst error of a cone: {worst}");
    assert!(
        blocked > 50 && open > 5,
        "the cones are too much alike: {blocked} blocked, {open} open"
    );
}

const CELLS_WGSL: &str = "
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::random::random_pair;
import package::cones::hemisphere::{basis, cell_cone, cell_jitter};
@group(0) @binding(0) var<storage, read_write> directions: array<vec4f>;
@group(0) @binding(1) var<uniform> cell_count: vec4u;
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&directions) { return; }
    let jitter = cell_jitter(random_pair(7u, 9u), id.x / cell_count.x);
    let cone = cell_cone(id.x % cell_count.x, cell_count.x, jitter);
    let normal = normalize(vec3f(0.3, -0.8, -0.5));
    directions[id.x] = vec4f(basis(normal) * cone.direction, cone.tan_half_angle);
}";

/// Over the frames the directions have the cosine's density about the normal: the mean of the
/// cosine is 2/3, of its square 1/2, and the mean direction is along the normal. The cells' solid
/// angles add up to 2 pi.
#[test]
fn cells_cover_the_hemisphere_by_cosine() {
    let (device, queue) = device();
    let mut shaders = crate::shaders::library();
    shaders.add("test::cells", CELLS_WGSL);
    let layout = LayoutBuilder::compute().storage_mut().uniform().build(&device, "test cells");
    let kernel = Kernel::new(&device, &shaders, "test::cells", "main", &[&layout]).expect("links");
    let normal = Vec3::new(0.3, -0.8, -0.5).normalize();
    for cell_count in [6_u32, 9, 12] {
        let count = 4096 * cell_count;
        let output = storage_buffer(&device, "directions", u64::from(count) * 16);
        let uniform = crate::gpu::uniform_buffer(&device, "cells", &[cell_count, 0, 0, 0]);
        let group = BindGroupBuilder::new(&layout)
            .buffer(&output)
            .buffer(&uniform)
            .build(&device, "test cells");
        let mut recorder = Recorder::new(&device, &queue);
        kernel.run_linear(&mut recorder, &[&group], u64::from(count));
        recorder.submit();
        let directions: Vec<Vec4> = read(&device, &queue, &output, count as usize);

        let mean = |f: &dyn Fn(Vec3) -> f64| {
            directions.iter().map(|d| f(d.truncate())).sum::<f64>() / f64::from(count)
        };
        let cosine = mean(&|d| f64::from(d.dot(normal)));
        let square = mean(&|d| f64::from(d.dot(normal)).powi(2));
        assert!((cosine - 2.0 / 3.0).abs() < 1e-3, "{cell_count} cells: mean cosine {cosine}");
        assert!((square - 0.5).abs() < 1e-3, "{cell_count} cells: mean square {square}");
        let sum: Vec3 = directions.iter().map(|d| d.truncate()).sum();
        let off = 1.0 - (sum.normalize().dot(normal));
        assert!(off < 1e-4, "{cell_count} cells lean away from the normal: {off}");
        let solid_angle: f64 = directions[..cell_count as usize]
            .iter()
            .map(|d| std::f64::consts::TAU * (1.0 - 1.0 / (1.0 + f64::from(d.w).powi(2)).sqrt()))
            .sum();
        assert!(
            (solid_angle - std::f64::consts::TAU).abs() < 1e-3,
            "{cell_count} cells have a solid angle of {solid_angle}"
        );
    }
}
