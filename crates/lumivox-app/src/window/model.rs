//! The snapshot for the panels, which the worker makes after each change.

use std::sync::Arc;
use std::time::Instant;

use glam::{Mat4, Vec2, Vec3};
use lumivox_console::{Console, Names};
use lumivox_explorer::{Explorer, Pacing, Placement, Playback, Revoxelize};
use lumivox_render::{
    Histogram, MemoryUse, Photometry, PresetChoice, RenderSettings, TraceFigures,
};
use lumivox_scene::{Bounds, Camera, Light, Material};

/// The stages whose times are shown, by the renderer's names; times of other stages are added to
/// the last.
pub const STAGES: [&str; 8] =
    ["upload", "voxelize", "light", "G-buffer", "direct light", "trace", "voxel view", "picture"];

/// Name of the worker's usual activity.
pub const RENDERING: &str = "rendering";

/// Number of frames whose times are shown.
pub const KEPT_FRAMES: usize = 200;

/// The snapshot for the panels.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// Descriptions of the next steps of `undo` and `redo`; `None` if there is none.
    pub history: [Option<String>; 2],
    /// Luminance histogram of the picture, and its exposure in stops.
    pub histogram: Option<(Histogram, f32)>,
    /// The scene; `None` before anything was opened.
    pub scene: Option<Arc<SceneModel>>,
    /// The requested settings.
    pub settings: RenderSettings,
    /// The preset's settings, which resets restore.
    pub usual: RenderSettings,
    /// The preset that the settings started from.
    pub preset: PresetChoice,
    /// The picture's camera.
    pub camera: Camera,
    /// `true` for each position that is stored (`pos1`, `pos2`).
    pub has_position: [bool; 2],
    /// The animation's playback.
    pub playback: Playback,
    /// Control of the picture's resolution while something moves.
    pub pacing: Pacing,
    /// When voxels are rebuilt.
    pub revoxelize: Revoxelize,
    /// The selected object or light.
    pub selected: Option<Selected>,
    /// Number of scenes opened so far.
    pub opened: u64,
    /// Number of the last camera from the window that was set.
    pub cameras_done: u64,
    /// Number of changes of the selection.
    pub selections: u64,
    /// World position of the last click on the scene.
    pub picked_at: Option<Vec3>,
    /// The picture's counterpart at the split slider.
    pub comparand: Comparand,
    /// Figures of the voxels.
    pub voxels: VoxelModel,
    /// GPU memory by use.
    pub memory: Vec<MemoryUse>,
    /// Times of the last frames.
    pub frames: Arc<Vec<FrameTime>>,
    /// Cone samples of the last frame, and length of its history.
    pub figures: Option<TraceFigures>,
    /// Number of averaged frames.
    pub frame_count: u32,
    /// Jobs in progress.
    pub jobs: Vec<JobModel>,
    /// The last error, with its number; `None` once closed.
    pub error: Option<(u64, String)>,
    /// The console's lines.
    pub log: Arc<Vec<LogLine>>,
    /// Description of the device.
    pub gpu: String,
    /// Names for completion.
    pub names: Names,
    /// Number of the last line from the window that is done.
    pub lines_done: u64,
    /// The command line that reproduces the picture, and its number; `None` until requested.
    pub command_line: Option<(u64, String)>,
}

/// A selection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Selected {
    /// An object, by its name.
    Object(String),
    /// A light, by its name.
    Light(String),
}

impl Selected {
    pub fn name(&self) -> &str {
        match self {
            Self::Object(name) | Self::Light(name) => name,
        }
    }
}

/// The picture's counterpart at the split slider.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Comparand {
    /// Nothing.
    #[default]
    Nothing,
    /// Another view of the same scene.
    View(lumivox_render::View),
    /// The path-traced reference, with this number of samples when finished.
    Reference(u32),
}

/// The scene.
#[derive(Clone, Debug, Default)]
pub struct SceneModel {
    pub name: String,
    /// Its source, as an argument of `load`.
    pub source: String,
    /// Its objects.
    pub objects: Vec<ObjectModel>,
    /// Its materials, each with a unique name.
    pub materials: Vec<(String, Material)>,
    /// Its lights, each with a unique name.
    pub lights: Vec<(String, Light)>,
    /// Uniform radiance of the environment, cd/m².
    pub environment: Vec3,
    /// The panorama's name; `None` if there is none.
    pub panorama: Option<String>,
    /// `true` if emissive surfaces are the only light, so that the scene may look dark.
    pub is_emission_alone: bool,
    /// Its cameras' names.
    pub cameras: Vec<String>,
    /// Its animations' names and durations in seconds.
    pub animations: Vec<(String, f32)>,
    /// The bounds of its shown objects.
    pub bounds: Bounds,
    /// Number of triangles of its shown objects.
    pub triangles: usize,
}

/// An object.
#[derive(Clone, Debug)]
pub struct ObjectModel {
    pub name: String,
    /// `true` if it is hidden.
    pub is_hidden: bool,
    /// `true` if it is marked as static.
    pub is_static: bool,
    /// Number of its triangles.
    pub triangles: usize,
    /// Index of its material.
    pub material: usize,
    /// Its placement.
    pub placement: Placement,
    /// Its whole transform, which may shear.
    pub world_from_local: Mat4,
    /// Its bounds in local coordinates.
    pub local_bounds: Bounds,
}

impl ObjectModel {
    /// Its bounds in the world.
    pub fn bounds(&self) -> Bounds {
        let corners = self.local_bounds.corners();
        Bounds::from_points(corners.map(|corner| self.world_from_local.transform_point3(corner)))
    }
}

/// Figures of the voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VoxelModel {
    /// Voxels that contain surface.
    pub voxels: u32,
    /// Faces of these voxels.
    pub faces: u32,
    /// The grid's size in voxels.
    pub dimensions: [u32; 3],
    /// Number of cascades, each with this grid; 0 for a single box.
    pub cascades: u32,
    /// Edge of a voxel, m.
    pub edge_m: f32,
    /// Levels of the pyramid.
    pub levels: u32,
    /// `true` if objects have moved but their voxels are not updated.
    pub are_stale: bool,
}

/// Times of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameTime {
    /// The total, ms.
    pub total_ms: f32,
    /// The time of each of [`STAGES`], ms; 0 if not measured.
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
    /// The light; `None` if it could not be measured.
    pub light: Option<Photometry>,
}

/// The worker's current activity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doing {
    /// Its description.
    pub words: String,
    /// When it began.
    pub since: Instant,
}

/// A job in progress.
#[derive(Clone, Debug, PartialEq)]
pub struct JobModel {
    /// Its description and progress.
    pub words: String,
    /// When it began; `None` to show no time.
    pub since: Option<Instant>,
    /// The finished share, 0 to 1; `None` if unknown.
    pub share: Option<f32>,
    /// The job to cancel; `None` if it cannot be cancelled.
    pub cancel: Option<Job>,
}

/// A job that can be cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Job {
    /// Reading a scene.
    Loading,
    /// Lines that wait for frames.
    Lines,
    /// Tracing the reference.
    Reference,
    /// A long command.
    Command,
}

/// The kind of a console line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogKind {
    /// A command.
    Command,
    /// Output of a command.
    Reply,
    /// An error.
    Error,
    /// A message of the window.
    Note,
}

/// A line of the console.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// Its kind.
    pub kind: LogKind,
    /// The text, which may have several lines.
    pub text: Arc<str>,
}

/// The meshes' bounds in local coordinates; computed once per scene.
pub fn mesh_bounds(explorer: &Explorer) -> Vec<Bounds> {
    let Some(scene) = explorer.scene() else { return Vec::new() };
    scene.meshes.iter().map(|mesh| Bounds::from_points(mesh.positions.iter().copied())).collect()
}

/// A snapshot of the scene; `None` if none is open.
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

/// Figures of the voxels.
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
        are_stale: renderer.has_stale_voxels(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pass_times_are_added_to_their_stages() {
        let mut time = FrameTime::default();
        time.add("trace", 2.0);
        time.add("trace", 1.0);
        time.add("something new", 0.5);
        assert_eq!(time.stages_ms[5], 3.0);
        assert_eq!(time.stages_ms[7], 0.5);
    }

    #[test]
    fn object_bounds_follow_the_transform() {
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
