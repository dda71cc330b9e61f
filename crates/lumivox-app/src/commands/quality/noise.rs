//! Noise of first frames: the difference between a picture of few frames and the mean of many.

use std::fmt::Write as _;

use lumivox::Preset;
use lumivox_render::compare::{ErrorFigures, LinearPicture};
use lumivox_render::{Gpu, PresetChoice, RenderProgress, RenderSettings, Renderer};
use lumivox_scene::Scene;
use lumivox_scene::rooms::{Kind, RoomLight};
use serde::{Deserialize, Serialize};

use crate::cli::QualityArgs;
use crate::commands::kept::Kept;
use crate::commands::rooms::room_of;
use crate::commands::settings;
use crate::progress::ProgressDisplay;
use crate::quality::{Truth, check_wish};

const PRESETS: [Preset; 2] = [Preset::Balanced, Preset::Realtime];
/// Numbers of frames whose noise is measured.
const FRAMES: [u32; 3] = [1, 4, 16];
/// Frames of the mean that they are compared with.
const MANY: u32 = 192;
/// The edge of a block, in pixels.
const BLOCK: usize = 8;
/// Pixels darker than this share of the median luminance count as that bright.
const DARK: f32 = 0.02;
/// A pixel that is off by this share is a dot.
const DOT: f32 = 0.5;
/// Rooms with daylight.
const ROOMS: usize = 8;

/// The noise of a mean of frames, in percent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Noise {
    /// The root mean square of the relative difference in blocks of 8 x 8 pixels: the median block,
    /// and the one that 95 % of the blocks stay below.
    median: f64,
    p95: f64,
    /// The share of the pixels that are half as bright again, or half as dark.
    dots: f64,
}

impl Noise {
    /// Compares the luminances of two pictures.
    fn new(few: &[f32], many: &[f32], width: usize) -> Self {
        let mut sorted = many.to_vec();
        sorted.sort_by(f32::total_cmp);
        let least = (DARK * sorted[sorted.len() / 2]).max(f32::MIN_POSITIVE);
        let relative: Vec<f32> =
            few.iter().zip(many).map(|(few, many)| (few - many) / many.max(least)).collect();
        let height = relative.len() / width;
        let mut blocks = Vec::new();
        for top in (0..height / BLOCK).map(|row| row * BLOCK) {
            for left in (0..width / BLOCK).map(|column| column * BLOCK) {
                let rows = (top..top + BLOCK).flat_map(|y| &relative[y * width + left..][..BLOCK]);
                let squares: f32 = rows.map(|error| error * error).sum();
                blocks.push(f64::from(squares / (BLOCK * BLOCK) as f32).sqrt());
            }
        }
        blocks.sort_by(f64::total_cmp);
        let at = |share: f64| {
            blocks.get((share * blocks.len() as f64) as usize).map_or(0.0, |error| 100.0 * error)
        };
        let dots = relative.iter().filter(|error| error.abs() > DOT).count();
        let dots = 100.0 * dots as f64 / relative.len() as f64;
        Self { median: at(0.5), p95: at(0.95), dots }
    }
}

/// A scene with a preset.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FirstFrames {
    /// After each of [`FRAMES`].
    noise: [Noise; 3],
    /// The errors of the first frame and of the mean against paths; `None` without a reference.
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

    /// Measures rooms at random with daylight, from this seed on.
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
        // ITU-R BT.709-6, section 3.2.
        let luminance = |&[r, g, b, _]: &[f32; 4]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let luminances: Vec<Vec<f32>> =
            means.iter().map(|mean| mean.iter().map(luminance).collect()).collect();
        let noise = |index: usize| Noise::new(&luminances[index], &luminances[3], size.x as usize);
        let errors = |truth: &Truth| {
            let layers = &truth.layers;
            let reference = layers.layer(&layers.radiance);
            let error = |mean: &[[f32; 4]]| {
                let rgb = mean.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
                let ours = LinearPicture { size, rgb };
                ErrorFigures::new(&reference, Some(&layers.radiance_variance), &ours)
            };
            anyhow::Ok([error(&means[0])?, error(&means[3])?])
        };
        Ok(FirstFrames {
            noise: [noise(0), noise(1), noise(2)],
            errors: truth.map(errors).transpose()?,
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
         edge, whose pixels a first frame samples eight times (*balanced*). Rooms at random have daylight.\n\n\
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Twelve blocks of brightness 2: one has an error of 10 % in all pixels, one a dot.
    #[test]
    fn noise_is_measured_by_blocks() {
        let (width, height) = (32, 24);
        let many = vec![2.0; width * height];
        let mut few = many.clone();
        for y in 0..BLOCK {
            for pixel in &mut few[y * width..][..BLOCK] {
                *pixel = 2.2;
            }
        }
        few[width * height - 1] = 4.0;
        let noise = Noise::new(&few, &many, width);
        assert!(noise.median <= 0.0, "{noise:?}");
        // The worst block: a dot of 100 % in one of 64 pixels.
        assert!((noise.p95 - 12.5).abs() < 1e-3, "{noise:?}");
        assert!((noise.dots - 100.0 / 768.0).abs() < 1e-6, "{noise:?}");
    }
}
