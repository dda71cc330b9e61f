//! The page: tables, strips and a chart.

use std::fmt::Write as _;

use lumivox::Preset;
use lumivox_render::PresetChoice;
use lumivox_render::compare::{ErrorFigures, LayerFigures};

use super::cases::{Case, Entry, PICTURES, Rotation, Store, middle};
use super::materials;
use super::noise;
use super::rooms::Rooms;
use crate::charts::{Point, error_against_cost};
use crate::cli::QualityArgs;

/// The goals for irradiance after one gather: preset `high`, 128 voxels, no settings for single
/// scenes. `balanced` may have twice the error; rotated scenes 5 % of bias and 1.3 times the RMSE.
const GOALS: [Goal; 10] = [
    Goal { scene: "cornell", bias: 3.0, rmse: Some(8.0) },
    Goal { scene: "furnace", bias: 3.0, rmse: Some(4.0) },
    Goal { scene: "panel", bias: 3.0, rmse: Some(10.0) },
    Goal { scene: "atrium", bias: 4.0, rmse: Some(22.0) },
    Goal { scene: "two-rooms", bias: 3.0, rmse: Some(8.0) },
    Goal { scene: "furnished", bias: 4.0, rmse: None },
    Goal { scene: "window", bias: 4.0, rmse: None },
    Goal { scene: "glow", bias: 4.0, rmse: None },
    Goal { scene: "clutter", bias: 4.0, rmse: None },
    Goal { scene: "lacquer", bias: 4.0, rmse: None },
];
/// The goal for the bias of rotated scenes, in per cent.
const TURNED_BIAS: f64 = 5.0;
/// The goal for the RMSE of rotated scenes, divided by that of unrotated scenes.
const TURNED_RMSE: f64 = 1.3;
/// The goal for the bias after all bounces, in per cent.
const FULL_BIAS: f64 = 5.0;
/// The goal for light through walls, in per cent.
const LEAK: f64 = 1.0;
/// The goal for the change of the mean between resolutions, in per cent.
const CHANGE: f64 = 3.0;
/// The goal for FLIP of mirrors.
const MIRROR_FLIP: f64 = 0.05;
/// The goal for the RMSE of metals with a roughness of at least 0.2, in per cent.
const METAL_RMSE: f64 = 10.0;

struct Goal {
    scene: &'static str,
    bias: f64,
    rmse: Option<f64>,
}

/// The chart of error against cost, as SVG.
///
/// # Errors
/// When nothing was measured.
pub fn chart(cases: &[Case], store: &Store) -> anyhow::Result<String> {
    let straight = cases.iter().filter(|case| case.rotation == Rotation::NONE);
    let point = |case: &Case| {
        let entry = store.get(&case.key())?;
        Some(Point {
            scene: case.scene.clone(),
            preset: case.preset.name().to_owned(),
            resolution: case.resolution,
            ms: entry.cost.frame_ms,
            samples: entry.cost.samples_per_pixel,
            error_percent: entry.figures.full?.rmse_percent,
        })
    };
    error_against_cost(&straight.filter_map(point).collect::<Vec<_>>())
}

/// The page in Markdown.
pub fn page(
    args: &QualityArgs,
    machine: &str,
    cases: &[Case],
    store: &Store,
    rooms: Option<&Rooms>,
    materials: Option<&materials::Rows>,
    noise: &noise::Rows,
) -> String {
    let page = Page { args, cases, store };
    let mut text = page.head(machine);
    if let Some(rooms) = rooms {
        text += &rooms.section();
    }
    text += &page.goals();
    text += &page.mirrors();
    text += &page.turned();
    text += &page.leaks();
    text += &page.resolutions();
    text += &materials.map(materials::section).unwrap_or_default();
    text += &noise::section(noise);
    text += &page.scenes();
    text
}

struct Page<'a> {
    args: &'a QualityArgs,
    cases: &'a [Case],
    store: &'a Store,
}

impl Page<'_> {
    fn head(&self, machine: &str) -> String {
        let args = self.args;
        format!(
            "# How far from the truth\n\n\
             Lumivox measures itself. This page is the output of one command, `lumivox-lab quality docs/generated`; nothing in it \
             is written by hand. Each scene is rendered with the defaults of a preset, path-traced \
             (`lumivox reference`), and compared (`lumivox compare`): {} x {} pixels, at least {} samples a pixel \
             for the references, {} frames, on {machine}. What is held against goals along the grid is the mean over \
             {} places of the grid, the rest is measured in one.\n\n\
             *One bounce* is the irradiance on visible surfaces that one gather finds, *all bounces* all but what \
             comes straight from lamps, *picture* the finished picture, *first frame* the picture after one \
             frame. **Bias** is the difference of the mean, \
             **RMSE** the root of the mean squared difference, both in per cent of the reference's mean; the \
             reference's own **noise**, told beside them, is taken out of the RMSE. **p95** is the relative error \
             that 95 % of the pixels stay below, noise included, and **FLIP** what a viewer sees who flips between \
             the two pictures. [How light travels](../light.md) explains what is measured, \
             [notebook](../notebook.md) what was tried.\n\n",
            args.size.x, args.size.y, args.samples, args.frames, args.offsets
        )
    }

    fn entry(
        &self,
        scene: &str,
        rotation: Rotation,
        preset: Preset,
        resolution: u32,
    ) -> Option<&Entry> {
        let preset = PresetChoice::Cones(preset);
        let case = Case { scene: scene.to_owned(), rotation, preset, resolution };
        self.store.get(&case.key())
    }

    /// The scenes, in order.
    fn scene_names(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.cases.iter().map(|case| case.scene.as_str()).collect();
        names.dedup();
        names
    }

    fn goals(&self) -> String {
        let resolution = middle(&self.args.resolutions);
        let mut text = format!(
            "## Goals\n\n{resolution} voxels, one set of defaults for all. `balanced` may be off by twice as much \
             as `high`; after all bounces the bias may be {FULL_BIAS} %.\n\n\
             | scene | preset | one bounce: bias | goal | RMSE | goal | noise | all bounces: bias | |\n\
             | --- | --- | --: | --: | --: | --: | --: | --: | --- |\n"
        );
        for goal in &GOALS {
            for (preset, factor) in [(Preset::High, 1.0), (Preset::Balanced, 2.0)] {
                let Some(entry) = self.entry(goal.scene, Rotation::NONE, preset, resolution) else {
                    continue;
                };
                let Some((one, full)) = entry.figures.one_bounce.zip(entry.figures.full) else {
                    continue;
                };
                let bias = factor * goal.bias;
                let rmse = goal.rmse.map(|rmse| factor * rmse);
                let is_met = one.bias_percent.abs() <= bias
                    && rmse.is_none_or(|rmse| one.rmse_percent <= rmse)
                    && full.bias_percent.abs() <= factor * FULL_BIAS;
                let _ = writeln!(
                    text,
                    "| {} | {} | {:+.1} | {bias} | {:.1} | {} | {} | {:+.1} | {} |",
                    goal.scene,
                    PresetChoice::Cones(preset).name(),
                    one.bias_percent,
                    one.rmse_percent,
                    rmse.map_or("-".to_owned(), |rmse| rmse.to_string()),
                    noise(&one),
                    full.bias_percent,
                    met(is_met)
                );
            }
        }
        text + "\n"
    }

    fn mirrors(&self) -> String {
        let resolution = middle(&self.args.resolutions);
        let mut text = format!(
            "## Mirrors and metals\n\nThe picture at {resolution} voxels. Goals: FLIP of mirrors {MIRROR_FLIP}, RMSE of metals \
             {METAL_RMSE} %. RMSE can be that of a few pixels with highlights; p95 and FLIP are not.\n\n\
             | scene | preset | bias | RMSE | p95 | FLIP | noise | |\n| --- | --- | --: | --: | --: | --: | --: | --- |\n"
        );
        for scene in ["mirrors", "metals"] {
            for preset in [Preset::High, Preset::Balanced] {
                let entry = self.entry(scene, Rotation::NONE, preset, resolution);
                let Some(figures) = entry.and_then(|entry| entry.figures.picture) else { continue };
                let flip = figures.flip.unwrap_or(f64::INFINITY);
                let is_met = if scene == "mirrors" {
                    flip <= MIRROR_FLIP
                } else {
                    figures.rmse_percent <= METAL_RMSE
                };
                let _ = writeln!(
                    text,
                    "| {scene} | {} | {:+.1} | {} | {:.1} | {flip:.3} | {} | {} |",
                    PresetChoice::Cones(preset).name(),
                    figures.bias_percent,
                    rmse(&figures),
                    figures.p95_percent,
                    noise(&figures),
                    met(is_met)
                );
            }
        }
        text + "\n"
    }

    fn turned(&self) -> String {
        let resolution = middle(&self.args.resolutions);
        let [x, y, z] = Rotation::ODD.degrees;
        let mut text = format!(
            "## Turned against the grid\n\nThe same scenes and cameras, turned together by {x}, {y} and {z} degrees \
             about x, y and z, so that nothing may change in the picture; {resolution} voxels. The goal for `high` is \
             a bias of {TURNED_BIAS} % and {TURNED_RMSE} times the RMSE above, for `balanced` twice that.\n\n\
             | scene | preset | one bounce: bias | RMSE | goal | all bounces: bias | |\n\
             | --- | --- | --: | --: | --: | --: | --- |\n"
        );
        for goal in &GOALS {
            for (preset, factor) in [(Preset::High, 1.0), (Preset::Balanced, 2.0)] {
                let Some(entry) = self.entry(goal.scene, Rotation::ODD, preset, resolution) else {
                    continue;
                };
                let Some((one, full)) = entry.figures.one_bounce.zip(entry.figures.full) else {
                    continue;
                };
                let rmse = goal.rmse.map(|rmse| factor * TURNED_RMSE * rmse);
                let is_met = one.bias_percent.abs() <= factor * TURNED_BIAS
                    && rmse.is_none_or(|rmse| one.rmse_percent <= rmse);
                let _ = writeln!(
                    text,
                    "| {} | {} | {:+.1} | {:.1} | {} | {:+.1} | {} |",
                    goal.scene,
                    PresetChoice::Cones(preset).name(),
                    one.bias_percent,
                    one.rmse_percent,
                    rmse.map_or("-".to_owned(), |rmse| format!("{rmse:.1}")),
                    full.bias_percent,
                    met(is_met)
                );
            }
        }
        text + "\n"
    }

    fn leaks(&self) -> String {
        let mut text = format!(
            "## Light through walls\n\nTwo rooms with a wall of 5 mm between them, thinner than a voxel. What the \
             dark room has too much of, in per cent of the mean in the lit room; with the doorway closed all of it \
             leaked, and the goal for `high` is {LEAK} %. With the doorway open the noise of the reference counts \
             where it is too dark.\n\n| scene | turned by | preset | voxels | one bounce | all bounces |\n\
             | --- | --- | --- | --: | --: | --: |\n"
        );
        for case in self.cases {
            let Some(leak) = self.store.get(&case.key()).and_then(|entry| entry.leak) else {
                continue;
            };
            let [x, y, z] = case.rotation.degrees;
            let _ = writeln!(
                text,
                "| {} | {x}, {y}, {z} | {} | {} | {:.2} | {:.2} |",
                case.scene,
                case.preset.name(),
                case.resolution,
                leak.one_bounce_percent,
                leak.full_percent
            );
        }
        text + "\n"
    }

    fn resolutions(&self) -> String {
        let mut sorted = self.args.resolutions.clone();
        sorted.sort_unstable();
        let list: Vec<String> = sorted.iter().map(ToString::to_string).collect();
        let mut text = format!(
            "## From coarse to fine\n\nBrightness must not depend on the resolution. The mean irradiance, in per \
             cent of the reference's, with {} voxels, preset `high`; the goal is a change of at most {CHANGE} %.\n\n\
             | scene | one bounce | change | all bounces | change | |\n| --- | --- | --: | --- | --: | --- |\n",
            list.join(", ")
        );
        for scene in self.scene_names() {
            let means = |of: fn(&LayerFigures) -> Option<ErrorFigures>| -> Option<Vec<f64>> {
                let mean = |resolution: &u32| {
                    let entry = self.entry(scene, Rotation::NONE, Preset::High, *resolution)?;
                    Some(100.0 + of(&entry.figures)?.bias_percent)
                };
                sorted.iter().map(mean).collect()
            };
            let pair = means(|figures| figures.one_bounce).zip(means(|figures| figures.full));
            let Some((one, full)) = pair else { continue };
            let words = |means: &[f64]| {
                means.iter().map(|mean| format!("{mean:.1}")).collect::<Vec<_>>().join(", ")
            };
            let _ = writeln!(
                text,
                "| {scene} | {} | {:.1} | {} | {:.1} | {} |",
                words(&one),
                change(&one),
                words(&full),
                change(&full),
                met(change(&one) <= CHANGE)
            );
        }
        text + "\n"
    }

    fn scenes(&self) -> String {
        let mut text = format!(
            "## Error against cost\n\nRMSE of the irradiance after all bounces against the time of a frame and against \
             the cone samples of a pixel. What is hollow is beaten in both error and cost by something else.\n\n\
             ![error against cost]({PICTURES}/error-against-cost.svg)\n\n## Scene by scene\n\n\
             `lumivox compare builtin:NAME --preset high --size {}x{} --samples {} --frames {} --offsets {} -o NAME.png` \
             makes a picture below: the truth, ours and the error.\n\n",
            self.args.size.x,
            self.args.size.y,
            self.args.samples,
            self.args.frames,
            self.args.offsets
        );
        for scene in self.scene_names() {
            let _ = writeln!(text, "### {scene}\n\n![{scene}]({PICTURES}/{scene}.png)\n");
            text += "| voxels | preset | layer | bias | RMSE | p95 | FLIP | noise | ms a frame | samples |\n\
                     | --: | --- | --- | --: | --: | --: | --: | --: | --: | --: |\n";
            let own = |case: &&Case| case.scene == scene && case.rotation == Rotation::NONE;
            for case in self.cases.iter().filter(own) {
                let Some(entry) = self.store.get(&case.key()) else { continue };
                text += &rows(case, entry);
            }
            text.push('\n');
        }
        text
    }
}

fn rows(case: &Case, entry: &Entry) -> String {
    let mut text = String::new();
    for (layer, figures) in [
        ("one bounce", &entry.figures.one_bounce),
        ("all bounces", &entry.figures.full),
        ("picture", &entry.figures.picture),
        ("first frame", &entry.figures.first_frame),
    ] {
        let Some(figures) = figures else { continue };
        let flip = figures.flip.map_or("-".to_owned(), |flip| format!("{flip:.3}"));
        let _ = writeln!(
            text,
            "| {} | {} | {layer} | {:+.1} | {} | {:.1} | {flip} | {} | {:.1} | {:.0} |",
            case.resolution,
            case.preset.name(),
            figures.bias_percent,
            rmse(figures),
            figures.p95_percent,
            noise(figures),
            entry.cost.frame_ms,
            entry.cost.samples_per_pixel
        );
    }
    text
}

/// The range of the means, in per cent of the reference's mean.
fn change(means: &[f64]) -> f64 {
    let most = means.iter().copied().fold(f64::MIN, f64::max);
    most - means.iter().copied().fold(f64::MAX, f64::min)
}

/// The RMSE, or a note if the reference's noise explains the whole difference.
fn rmse(figures: &ErrorFigures) -> String {
    if figures.rmse_percent > 0.0 {
        format!("{:.1}", figures.rmse_percent)
    } else {
        "below noise".to_owned()
    }
}

fn noise(figures: &ErrorFigures) -> String {
    figures.noise_percent.map_or("-".to_owned(), |noise| format!("{noise:.1}"))
}

fn met(is_met: bool) -> &'static str {
    if is_met { "met" } else { "**missed**" }
}
