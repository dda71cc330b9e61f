//! What the panels show: a snapshot of the explorer, made by the worker whenever something has changed.

use std::sync::Arc;
use std::time::Instant;

use glam::{Mat4, UVec2, Vec2, Vec3};
use lumivox_console::{Console, Names};
use lumivox_explorer::{Explorer, Pacing, Placement, Playback, Revoxelize};
use lumivox_render::{
    Histogram, MemoryUse, Photometry, PresetChoice, RenderSettings, TraceFigures,
};
use lumivox_scene::{Bounds, Camera, Light, Material};

use super::screen::Pixels;

/// The stages whose times are shown, as the renderer names them; what is none of these is added to the last.
pub const STAGES: [&str; 8] =
    ["upload", "voxelize", "light", "G-buffer", "direct light", "trace", "voxel view", "picture"];

/// What the worker is busy with most of the time.
pub const RENDERING: &str = "rendering";

/// Frames whose times are shown.
pub const KEPT_FRAMES: usize = 200;

/// All that the panels show.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// What `undo` would take back, and what `redo` would do again, in words.
    pub history: [Option<String>; 2],
    /// How bright the picture's pixels are, and the stops that it is shown with.
    pub histogram: Option<(Histogram, f32)>,
    /// The scene; `None` before anything was opened.
    pub scene: Option<Arc<SceneModel>>,
    /// The settings that are asked for.
    pub settings: RenderSettings,
    /// What the preset would have.
    pub usual: RenderSettings,
    /// The preset that the settings started from.
    pub preset: PresetChoice,
    /// Where the picture is taken from.
    pub camera: Camera,
    /// Which positions to come back to there are.
    pub has_position: [bool; 2],
    /// What plays.
    pub playback: Playback,
    /// The picture's size in motion.
    pub pacing: Pacing,
    /// When voxels are made anew.
    pub revoxelize: Revoxelize,
    /// Which object or light is chosen.
    pub selected: Option<Selected>,
    /// Counts scenes that were opened.
    pub opened: u64,
    /// Counts lines that have moved the camera.
    pub camera_moves: u64,
    /// Counts changes of the selection.
    pub selections: u64,
    /// Where the last click met the scene.
    pub picked_at: Option<Vec3>,
    /// With what the picture is compared.
    pub comparand: Comparand,
    /// What was voxelized.
    pub voxels: VoxelModel,
    /// GPU memory by what it holds.
    pub memory: Vec<MemoryUse>,
    /// Times of the last frames.
    pub frames: Arc<Vec<FrameTime>>,
    /// Cone samples and length of the history of the last frame.
    pub figures: Option<TraceFigures>,
    /// Frames in the mean.
    pub frame_count: u32,
    /// What is under way.
    pub jobs: Vec<JobModel>,
    /// The last error that nobody has closed, and its number.
    pub error: Option<(u64, String)>,
    /// What the console shows.
    pub log: Arc<Vec<LogLine>>,
    /// The device.
    pub gpu: String,
    /// What can be completed.
    pub names: Names,
    /// The newest of the window's lines that was done.
    pub lines_done: u64,
    /// The command line that reproduces the picture, and its number, once somebody has asked.
    pub command_line: Option<(u64, String)>,
}

/// What is chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Selected {
    /// An object, by its name.
    Object(String),
    /// A light, by its name.
    Light(String),
}

impl Selected {
    /// The name.
    pub fn name(&self) -> &str {
        match self {
            Self::Object(name) | Self::Light(name) => name,
        }
    }
}

/// What is beside the picture, behind the split slider.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Comparand {
    /// Nothing.
    #[default]
    Nothing,
    /// Another view of the same scene.
    View(lumivox_render::View),
    /// The path-traced truth, with this number of samples in the end.
    Reference(u32),
}

/// The scene.
#[derive(Clone, Debug, Default)]
pub struct SceneModel {
    /// Its name.
    pub name: String,
    /// Where it came from, as `load` takes it.
    pub source: String,
    /// Its objects.
    pub objects: Vec<ObjectModel>,
    /// Its materials, each with a name of its own.
    pub materials: Vec<(String, Material)>,
    /// Its lights, each with a name of its own.
    pub lights: Vec<(String, Light)>,
    /// What shines from all around, cd/m².
    pub environment: Vec3,
    /// The name of a panorama.
    pub panorama: Option<String>,
    /// Whether what it emits itself is all the light that there is: it looks dark for a reason.
    pub is_emission_alone: bool,
    /// Its cameras' names.
    pub cameras: Vec<String>,
    /// Its animations' names and durations in seconds.
    pub animations: Vec<(String, f32)>,
    /// The box around it.
    pub bounds: Bounds,
    /// Triangles that are shown.
    pub triangles: usize,
}

/// An object.
#[derive(Clone, Debug)]
pub struct ObjectModel {
    /// Its name.
    pub name: String,
    /// Whether it is not shown.
    pub is_hidden: bool,
    /// Whether it is marked as static.
    pub is_static: bool,
    /// Its triangles.
    pub triangles: usize,
    /// The number of its material.
    pub material: usize,
    /// Where it stands.
    pub placement: Placement,
    /// The same, with what shears.
    pub world_from_local: Mat4,
    /// The box around it, in its own axes.
    pub local_bounds: Bounds,
}

impl ObjectModel {
    /// The box around it in the world.
    pub fn bounds(&self) -> Bounds {
        let corners = self.local_bounds.corners();
        Bounds::from_points(corners.map(|corner| self.world_from_local.transform_point3(corner)))
    }
}

/// The voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VoxelModel {
    /// Voxels with surface.
    pub voxels: u32,
    /// Their faces.
    pub faces: u32,
    /// The grid's voxels along its axes.
    pub dimensions: [u32; 3],
    /// How many cascades of that there are; 0 for one box.
    pub cascades: u32,
    /// The edge of one, m.
    pub edge_m: f32,
    /// Levels of the pyramid.
    pub levels: u32,
    /// Voxels stand where objects no longer are.
    pub are_stale: bool,
}

/// Times of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameTime {
    /// All of it, ms.
    pub total_ms: f32,
    /// Of each of [`STAGES`], ms; zero where they are not taken.
    pub stages_ms: [f32; STAGES.len()],
}

impl FrameTime {
    /// Adds the time of a stage.
    pub fn add(&mut self, stage: &str, ms: f32) {
        let known = STAGES.iter().position(|name| *name == stage);
        self.stages_ms[known.unwrap_or(STAGES.len() - 1)] += ms;
    }
}

/// The light at a place of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightAt {
    /// The place, as shares of the picture's width and height.
    pub at: Vec2,
    /// The light.
    pub light: Option<Photometry>,
}

/// What the worker is busy with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doing {
    /// In words.
    pub words: String,
    /// When it has begun.
    pub since: Instant,
}

/// Something under way.
#[derive(Clone, Debug, PartialEq)]
pub struct JobModel {
    /// What it is, and how far.
    pub words: String,
    /// When it has begun, where the words do not tell how long it takes.
    pub since: Option<Instant>,
    /// The share that is done, where it is known.
    pub share: Option<f32>,
    /// What to cancel, where it can be.
    pub cancel: Option<Job>,
}

/// What can be cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Job {
    /// Reading a scene.
    Loading,
    /// Lines that wait for frames.
    Lines,
    /// Tracing what the picture is compared with.
    Reference,
    /// A command that takes long.
    Command,
}

/// What a line of the console is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogKind {
    /// A command that was given.
    Command,
    /// What a command says.
    Reply,
    /// What went wrong.
    Error,
    /// What the window says.
    Note,
}

/// A line of the console.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// What it is.
    pub kind: LogKind,
    /// The words; more than one line where a command says much.
    pub text: Arc<str>,
}

/// A picture for the screen.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Counts pictures.
    pub serial: u64,
    /// Width and height, px.
    pub size: UVec2,
    /// Its pixels: on the CPU, or a texture of the shared device.
    pub pixels: Pixels,
    /// Frames in the mean, or samples of the reference.
    pub frames: u32,
}

/// The boxes around meshes in their own axes: found once a scene.
pub fn mesh_bounds(explorer: &Explorer) -> Vec<Bounds> {
    let Some(scene) = explorer.scene() else { return Vec::new() };
    scene.meshes.iter().map(|mesh| Bounds::from_points(mesh.positions.iter().copied())).collect()
}

/// The scene as it is.
pub fn scene_model(console: &Console, mesh_bounds: &[Bounds]) -> Option<SceneModel> {
    let explorer = &console.explorer;
    let scene = explorer.scene()?;
    let names = explorer.object_names();
    let object = |(instance, name): (&lumivox_scene::Instance, String)| ObjectModel {
        name,
        is_hidden: instance.is_hidden,
        is_static: instance.is_static,
        triangles: scene.meshes.get(instance.mesh).map_or(0, lumivox_scene::Mesh::triangle_count),
        material: instance.material,
        placement: Placement::of(instance.world_from_local),
        world_from_local: instance.world_from_local,
        local_bounds: mesh_bounds.get(instance.mesh).copied().unwrap_or_default(),
    };
    let objects: Vec<ObjectModel> = scene.instances.iter().zip(names).map(object).collect();
    let shown = objects.iter().filter(|object| !object.is_hidden);
    let bounds = shown.clone().map(ObjectModel::bounds).fold(Bounds::EMPTY, Bounds::union);
    let triangles = shown.map(|object| object.triangles).sum();
    let (material_names, light_names) = (explorer.material_names(), explorer.light_names());
    let animations = scene.animations();
    Some(SceneModel {
        name: scene.name.clone(),
        source: console.scene_request().map(|o| o.source.to_string()).unwrap_or_default(),
        objects,
        materials: material_names.into_iter().zip(scene.materials.iter().cloned()).collect(),
        lights: light_names.into_iter().zip(scene.lights.iter().cloned()).collect(),
        environment: scene.environment.radiance,
        panorama: scene.environment.map.as_ref().map(|map| map.name.clone()),
        is_emission_alone: scene.is_lit_by_emission_alone(),
        cameras: scene.cameras.iter().map(|camera| camera.name.clone()).collect(),
        animations: animations.into_iter().map(|a| (a.name.clone(), a.duration_s)).collect(),
        bounds,
        triangles,
    })
}

/// What was voxelized.
pub fn voxel_model(explorer: &Explorer) -> VoxelModel {
    let Some(renderer) = explorer.renderer() else { return VoxelModel::default() };
    let (stats, grid) = (renderer.voxel_stats(), renderer.gi().grid());
    VoxelModel {
        voxels: stats.voxels,
        faces: stats.faces,
        dimensions: grid.box_dimensions().to_array(),
        cascades: grid.cascades.map_or(0, |cascades| cascades.count),
        edge_m: grid.voxel_size_m,
        levels: grid.levels,
        are_stale: explorer.has_stale_voxels(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_go_to_their_stages() {
        let mut time = FrameTime::default();
        time.add("trace", 2.0);
        time.add("trace", 1.0);
        time.add("something new", 0.5);
        assert_eq!(time.stages_ms[5], 3.0);
        assert_eq!(time.stages_ms[7], 0.5);
    }

    #[test]
    fn boxes_follow_their_objects() {
        let object = ObjectModel {
            name: String::new(),
            is_hidden: false,
            is_static: false,
            triangles: 12,
            material: 0,
            placement: Placement::of(Mat4::IDENTITY),
            world_from_local: Mat4::from_scale_rotation_translation(
                Vec3::new(2.0, 1.0, 1.0),
                glam::Quat::from_rotation_z(std::f32::consts::FRAC_PI_2),
                Vec3::new(0.0, 0.0, 5.0),
            ),
            local_bounds: Bounds { min: Vec3::ZERO, max: Vec3::ONE },
        };
        let bounds = object.bounds();
        assert!(bounds.min.abs_diff_eq(Vec3::new(-1.0, 0.0, 5.0), 1e-5), "{bounds:?}");
        assert!(bounds.max.abs_diff_eq(Vec3::new(0.0, 2.0, 6.0), 1e-5), "{bounds:?}");
    }
}
