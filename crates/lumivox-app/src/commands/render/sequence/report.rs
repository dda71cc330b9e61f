//! The report on a sequence.

use lumivox_console::report::{AdapterReport, SceneCounts, bytes, count, counted, memory_table};
use lumivox_console::shown;
use lumivox_render::RenderSettings;
use serde::Serialize;

use crate::commands::render::clock::Seconds;
use crate::commands::render::report::{NoteReport, RendererReport};
use crate::settings;

/// The report on a sequence.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The pictures' files, with # for the digits of the number.
    pub files: String,
    /// The index's file.
    pub index: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Pictures of the whole sequence.
    pub pictures: u32,
    /// Pictures that were rendered now; the others existed.
    pub rendered: usize,
    /// Pictures that existed and were rendered again, since later ones reuse their light.
    pub rendered_again: usize,
    /// Exposure in stops, if all pictures have the same.
    pub exposure: Option<f32>,
    /// Notes on what was chosen for the scene, and on problems with the light of the last picture.
    pub notes: Vec<NoteReport>,
    pub scene: SceneCounts,
    /// `None` if no picture had to be rendered.
    #[serde(flatten)]
    pub renderer: Option<RendererReport>,
    /// Wall-clock times.
    pub seconds: Seconds,
    #[serde(serialize_with = "settings::serialize")]
    pub settings: RenderSettings,
    pub adapter: AdapterReport,
}

impl Report {
    /// The report for people; `is_verbose` adds times and memory.
    pub fn text(&self, is_verbose: bool) -> String {
        let Self { files, scene, seconds, settings, .. } = self;
        let [width, height] = self.size;
        let pictures = counted(self.pictures as usize, "picture", "pictures");
        let mut text =
            format!("{files}: {pictures} of {width}x{height}, view {}", settings.view.name());
        if let Some(stops) = self.exposure {
            text += &format!(", exposure {stops:.2}");
        }
        let there = (self.pictures as usize).saturating_sub(self.rendered);
        if there > 0 {
            text += &format!("; {} of them were there already", count(there as u64));
        }
        if self.rendered_again > 0 {
            let again = count(self.rendered_again as u64);
            text += &format!(", {again} rendered again for the light in those after them");
        }
        text += &format!("\n  index    {}\n", self.index);
        text += &format!(
            "  scene    {}: {}, {}, {}\n",
            shown::line(&scene.name),
            counted(scene.triangles, "triangle", "triangles"),
            counted(scene.materials, "material", "materials"),
            counted(scene.lights, "light", "lights"),
        );
        text += &self.notes.iter().map(NoteReport::line).collect::<String>();
        if let Some(renderer) = &self.renderer {
            text += &format!(
                "  voxels   {} in {}\n  memory   {} on the GPU\n",
                count(renderer.voxels.into()),
                renderer.grid.size(),
                bytes(renderer.memory_bytes)
            );
        }
        text += &format!(
            "  time     {:.2} s: loading {:.2}, preparing {:.2}, rendering {:.2}, writing {:.2}",
            seconds.total, seconds.loading, seconds.preparing, seconds.rendering, seconds.writing
        );
        if self.rendered > 0 {
            let each = (seconds.total - seconds.loading) / self.rendered as f64;
            text += &format!("; {each:.2} a picture");
        }
        text += &format!("\n  GPU      {}\n", self.adapter.description);
        if let Some(renderer) = self.renderer.as_ref().filter(|_| is_verbose) {
            text.push('\n');
            text += &renderer.times.table("stage and pass (of a frame: mean)");
            text.push('\n');
            text += &memory_table(&renderer.memory);
        }
        text
    }
}
