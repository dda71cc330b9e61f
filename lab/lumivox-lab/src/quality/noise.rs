//! Noise of first frames: the difference between the means of few frames and of many.

use std::fmt::Write as _;

use lumivox::Preset;
use lumivox_app::parts::{Kept, ProgressDisplay, Truth, check_wish, settings};
use lumivox_render::compare::{ErrorFigures, LinearPicture};
use lumivox_render::{Gpu, PresetChoice, RenderProgress, RenderSettings, Renderer};
use lumivox_scene::Scene;
use serde::{Deserialize, Serialize};

use crate::block_noise::{BLOCK, BlockNoise};
use crate::cli::QualityArgs;
use crate::rooms::random::{Kind, RoomLight};
use crate::rooms::room_of;

const PRESETS: [Preset; 2] = [Preset::Balanced, Preset::Realtime];
/// Numbers of frames whose noise is measured.
const FRAMES: [u32; 3] = [1, 4, 16];
/// Frames of the mean with which they are compared.
const MANY: u32 = 192;
/// Number of rooms with daylight.
const ROOMS: usize = 8;

/// The noise and errors of a scene with a preset.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FirstFrames {
    /// The noise after each of [`FRAMES`].
    noise: [BlockNoise; 3],
    /// The errors of the first frame and of the mean; `None` without a reference.
    errors: Option<[ErrorFigures; 2]>,
}

/// The rows of the table, each with its name.
pub type Rows = Vec<(String, Preset, FirstFrames)>;

/// Measures first frames, or reads them from the cache.
pub struct Meter<'a> {
    args: &'a QualityArgs,
    gpu: &'a Gpu,
    progress: &'a ProgressDisplay,
    store: Kept<FirstFrames>,
    rows: Rows,
}

impl<'a> Meter<'a> {
    /// # Errors
    /// When the cache cannot be used.
    pub fn open(
        args: &'a QualityArgs,
        gpu: &'a Gpu,
        progress: &'a ProgressDisplay,
    ) -> anyhow::Result<Self> {
        let folder = args.cache.as_ref().map(|cache| cache.join("noise"));
        let [width, height] = args.size.to_array();
        let words = format!(
            "{width} x {height} pixels, {MANY} frames, version {}",
            env!("CARGO_PKG_VERSION")
        );
        let store = Kept::open(folder.as_deref(), words)?;
        Ok(Self { args, gpu, progress, store, rows: Rows::new() })
    }

    /// Measures a scene with each preset; `truth` is its reference at the same size.
    ///
    /// # Errors
    /// When rendering fails, or the user stops it.
    pub fn measure(
        &mut self,
        name: &str,
        scene: &dyn Fn() -> anyhow::Result<Scene>,
        truth: Option<&Truth>,
    ) -> anyhow::Result<()> {
        for preset in PRESETS {
            let choice = PresetChoice::Cones(preset);
            let key = format!("{name} {}", choice.name());
            if self.store.get(&key).is_none() && !self.args.kept {
                let resolution = super::cases::middle(&self.args.resolutions);
                let settings = settings::of(choice, self.args.size, &[])?;
                let settings = RenderSettings { resolution, frames: MANY, ..settings };
                let frames = self.first_frames(&scene()?, settings, truth)?;
                self.store.put(key.clone(), frames)?;
            }
            let frames = self.store.get(&key).cloned();
            self.rows.extend(frames.map(|frames| (name.to_owned(), preset, frames)));
        }
        Ok(())
    }

    /// Measures random rooms with daylight; `seed` is the first seed.
    ///
    /// # Errors
    /// As [`Self::measure`].
    pub fn measure_rooms(&mut self, seed: u32) -> anyhow::Result<()> {
        let is_lit_by_day = |seed: &u32| -> anyhow::Result<bool> {
            let light = room_of(*seed, &Kind::ALL)?.light;
            Ok(matches!(light, RoomLight::Sky | RoomLight::Day))
        };
        let mut seeds = Vec::new();
        for seed in (0..).map(|index| seed.wrapping_add(index)) {
            if seeds.len() == ROOMS {
                break;
            }
            if is_lit_by_day(&seed)? {
                seeds.push(seed);
            }
        }
        for seed in seeds {
            let room = || Ok(room_of(seed, &Kind::ALL)?.scene);
            self.measure(&format!("room {seed}"), &room, None)?;
        }
        Ok(())
    }

    fn first_frames(
        &self,
        scene: &Scene,
        settings: RenderSettings,
        truth: Option<&Truth>,
    ) -> anyhow::Result<FirstFrames> {
        let size = settings.size;
        let camera = scene.cameras.first();
        let mut renderer =
            pollster::block_on(Renderer::new(self.gpu, scene, camera, settings, &mut tell))?;
        let mut means: Vec<Vec<[f32; 4]>> = Vec::new();
        for frame in 1..=MANY {
            check_wish(self.progress)?;
            self.progress.set("first frames", frame, MANY);
            pollster::block_on(renderer.render_frame())?;
            if FRAMES.contains(&frame) || frame == MANY {
                means.push(pollster::block_on(renderer.read_mean())?);
            }
        }
        let pictures: Vec<LinearPicture> = means
            .iter()
            .map(|mean| LinearPicture {
                size,
                rgb: mean.iter().map(|&[r, g, b, _]| [r, g, b]).collect(),
            })
            .collect();
        let noise = |index: usize| BlockNoise::new(&pictures[index], &pictures[3]);
        let errors = |truth: &Truth| {
            let layers = &truth.layers;
            let reference = layers.layer(&layers.radiance);
            // A dark room has no relative errors.
            if reference.rgb.as_flattened().iter().all(|value| *value <= 0.0) {
                return Ok(None);
            }
            let error = |ours: &LinearPicture| {
                ErrorFigures::new(&reference, Some(&layers.radiance_variance), ours)
            };
            anyhow::Ok(Some([error(&pictures[0])?, error(&pictures[3])?]))
        };
        Ok(FirstFrames {
            noise: [noise(0), noise(1), noise(2)],
            errors: truth.map(errors).transpose()?.flatten(),
        })
    }

    /// The rows that were measured.
    pub fn into_rows(self) -> Rows {
        self.rows
    }
}

fn tell(_: RenderProgress) {}

/// The section of the page; empty without rows.
pub fn section(rows: &Rows) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "## Noise of first frames\n\nHow far a mean of few frames is from the same settings' mean of {MANY}: the root mean \
         square of the relative difference in blocks of {BLOCK} x {BLOCK} pixels, in per cent, for the median block and the \
         one that 95 % of the blocks stay below. *Dots* are pixels half as bright again or half as dark. Beside it the \
         bias and RMSE of first frame and mean against paths. Antialiasing counts: in so few pixels most blocks have an \
         edge, whose pixels a first frame samples 16 times (*balanced*). Rooms at random have daylight.\n\n\
         | scene | preset | 1 frame: median | 95 % | dots | 4 frames: median | 95 % | 16 frames: median | 95 % \
         | bias: 1 frame | mean | RMSE: 1 frame | mean |\n\
         | --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n"
    );
    for (name, preset, FirstFrames { noise: [first, fourth, last], errors }) in rows {
        let pair = |of: &dyn Fn(&ErrorFigures) -> String| {
            let shown =
                |index: usize| errors.as_ref().map_or("-".to_owned(), |both| of(&both[index]));
            format!("{} | {}", shown(0), shown(1))
        };
        let _ = writeln!(
            text,
            "| {name} | {} | {:.1} | {:.1} | {:.2} | {:.1} | {:.1} | {:.1} | {:.1} | {} | {} |",
            PresetChoice::Cones(*preset).name(),
            first.median,
            first.p95,
            first.dots,
            fourth.median,
            fourth.p95,
            last.median,
            last.p95,
            pair(&|figures| format!("{:+.1}", figures.bias_percent)),
            pair(&|figures| format!("{:.1}", figures.rmse_percent)),
        );
    }
    text + "\n"
}
