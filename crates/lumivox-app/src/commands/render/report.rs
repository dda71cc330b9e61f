//! The report on one picture.

use std::path::Path;

use lumivox_console::report::{
    AdapterReport, GeometryReport, GridReport, MemoryReport, SceneCounts, TimesReport, bytes,
    count, counted, memory_table, total_bytes,
};
use lumivox_console::shown;
use lumivox_render::{ExposureWarning, Gpu, Picture, RenderSettings, Renderer};
use lumivox_scene::{Camera, Note, Scene};
use serde::Serialize;

use super::clock::Seconds;
use crate::light::REMEDY;
use crate::settings;

/// The report on one picture: its settings and its cost.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The picture's file.
    file: String,
    /// Width and height in pixels.
    size: [u32; 2],
    scene: SceneCounts,
    camera: CameraReport,
    #[serde(flatten)]
    renderer: RendererReport,
    /// Wall-clock times.
    seconds: Seconds,
    /// Noise at which rendering stopped early: the relative error that 95 % of the picture's blocks
    /// stay below. `None` if all frames were rendered.
    noise: Option<f32>,
    /// Exposure in stops, metered if `auto`. `None` for views without exposure.
    exposure: Option<f32>,
    /// Notes on what was chosen for the scene, and on problems with its light.
    notes: Vec<NoteReport>,
    #[serde(serialize_with = "settings::serialize")]
    settings: RenderSettings,
    adapter: AdapterReport,
}

/// A note about a picture for the user.
#[derive(Clone, Debug, Serialize)]
pub struct NoteReport {
    /// `camera`, `light`, `grid`, `shadows` or `warning`.
    about: &'static str,
    text: String,
    /// The option that overrides the choice; `None` for warnings, which name it themselves.
    option: Option<&'static str>,
}

impl NoteReport {
    /// All notes on a picture.
    pub fn all(notes: &[Note], warning: Option<ExposureWarning>) -> Vec<Self> {
        let warning = warning.map(|warning| Self {
            about: "warning",
            text: format!("{warning}: {REMEDY}"),
            option: None,
        });
        let of = |note: &Note| Self {
            about: note.about,
            text: note.text.clone(),
            option: Some(note.option),
        };
        notes.iter().map(of).chain(warning).collect()
    }

    /// The note as a line for people.
    pub fn line(&self) -> String {
        let option = self.option.map(|option| format!(" ({option})")).unwrap_or_default();
        format!("  {:<8} {}{option}\n", self.about, self.text)
    }
}

/// The voxels, memory and GPU times of a renderer after a picture.
#[derive(Clone, Debug, Serialize)]
pub struct RendererReport {
    pub grid: GridReport,
    /// Occupied voxels.
    pub voxels: u32,
    /// Faces: lobes of voxels that have surface.
    pub faces: u32,
    /// `None` without a budget of geometry.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub geometry: Option<GeometryReport>,
    pub memory: Vec<MemoryReport>,
    pub memory_bytes: u64,
    /// GPU times in ms; for passes of frames the mean per frame.
    #[serde(flatten)]
    pub times: TimesReport,
}

impl RendererReport {
    /// The report on a renderer.
    pub fn new(renderer: &Renderer) -> Self {
        let memory: Vec<MemoryReport> = renderer.memory().into_iter().map(Into::into).collect();
        Self {
            grid: GridReport::new(renderer.gi().grid()),
            voxels: renderer.voxel_stats().voxels,
            faces: renderer.voxel_stats().faces,
            geometry: GeometryReport::new(renderer),
            memory_bytes: total_bytes(&memory),
            memory,
            times: TimesReport::new(&renderer.times()),
        }
    }
}

/// The camera of a picture.
#[derive(Clone, Debug, Serialize)]
pub struct CameraReport {
    name: String,
    position: [f64; 3],
    forward: [f32; 3],
    up: [f32; 3],
    vertical_fov_deg: f32,
}

impl CameraReport {
    /// The report on a camera.
    pub fn new(scene: &Scene, camera: &Camera) -> Self {
        Self {
            name: camera.name.clone(),
            position: scene.to_file(camera.position).to_array(),
            forward: camera.forward.to_array(),
            up: camera.up.to_array(),
            vertical_fov_deg: camera.vertical_fov_rad.to_degrees(),
        }
    }
}

impl Report {
    /// The report on a picture.
    pub fn new(
        file: &Path,
        gpu: &Gpu,
        scene: &Scene,
        renderer: &Renderer,
        picture: &Picture,
        seconds: Seconds,
        notes: &[Note],
    ) -> Self {
        let settings = renderer.settings();
        let metering = settings.view.is_light().then(|| settings.exposure.meter(&picture.hdr));
        Self {
            file: file.display().to_string(),
            size: picture.size.to_array(),
            scene: SceneCounts::new(scene),
            camera: CameraReport::new(scene, renderer.camera()),
            renderer: RendererReport::new(renderer),
            seconds,
            noise: None,
            exposure: metering.map(|metering| metering.stops),
            notes: NoteReport::all(notes, metering.and_then(|metering| metering.warning)),
            settings: RenderSettings { frames: renderer.frame_count(), ..settings.clone() },
            adapter: AdapterReport::new(&gpu.adapter_info),
        }
    }

    /// The report on a picture that stopped at this noise.
    pub fn with_noise(self, noise: Option<f32>) -> Self {
        Self { noise, ..self }
    }

    /// The report for people.
    pub fn text(&self, is_verbose: bool) -> String {
        let Self { file, scene, renderer, seconds, settings, .. } = self;
        let RendererReport { grid, voxels, faces, .. } = renderer;
        let [width, height] = self.size;
        let frames = counted(settings.frames as usize, "frame", "frames");
        let frame_ms = seconds.rendering * 1e3 / f64::from(settings.frames);
        let mut text = format!("{file}: {width}x{height}, view {}, {frames}", settings.view.name());
        if let Some(noise) = self.noise {
            text += &format!(" (noise {:.1} %; --frames for more)", 100.0 * noise);
        }
        if let Some(stops) = self.exposure {
            text += &format!(", exposure {stops:.2}");
        }
        text += &format!(
            "\n  scene    {}: {}, {}, {}; camera {}\n",
            shown::line(&scene.name),
            counted(scene.triangles, "triangle", "triangles"),
            counted(scene.materials, "material", "materials"),
            counted(scene.lights, "light", "lights"),
            shown::line(&self.camera.name),
        );
        text += &self.notes.iter().map(NoteReport::line).collect::<String>();
        text += &format!(
            "  voxels   {} with {} in {}\n",
            count((*voxels).into()),
            counted(*faces as usize, "face", "faces"),
            grid.size()
        );
        if let Some(geometry) = &renderer.geometry {
            text += &format!("  geometry {}\n", geometry.line());
        }
        text += &format!("  memory   {} on the GPU\n", bytes(renderer.memory_bytes));
        text += &format!(
            "  time     {:.2} s: loading {:.2}, preparing {:.2}, rendering {:.2} \
             ({frame_ms:.1} ms a frame), writing {:.2}\n",
            seconds.total, seconds.loading, seconds.preparing, seconds.rendering, seconds.writing
        );
        text += &format!("  GPU      {}\n", self.adapter.description);
        if is_verbose {
            text.push('\n');
            text += &renderer.times.table("stage and pass (of a frame: mean)");
            text.push('\n');
            text += &memory_table(&renderer.memory);
        }
        text
    }
}
