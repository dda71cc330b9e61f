//! Pictures of a measurement: a strip of marked steps, an animation, and charts.

use std::path::Path;

use anyhow::Context as _;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{Rgb, RgbImage, imageops};
use lumivox_app::parts::{Row, output, strip};
use lumivox_render::compare::LinearPicture;

use super::measure::Measured;
use super::report::SequenceReport;
use crate::charts::{Point, StepPanel, error_against_cost, error_by_step};
use crate::film::film;

/// The most frames of an animation, apart from one that the last step may add.
const MOST_FRAMES: usize = 24;
/// The time for which an animation shows a frame, ms.
const DELAY_MS: u16 = 125;
/// Width of the gap between a frame's two pictures, px, and its colour.
const GAP: u32 = 2;
const GAP_COLOR: Rgb<u8> = Rgb([255; 3]);
/// Names of the charts.
pub const BY_STEP: &str = "error-by-step.svg";
pub const AGAINST_COST: &str = "error-against-cost.svg";

/// Writes the strip and the animation of a sequence into a folder: NAME-strip.png and NAME.png. The
/// strip shows the last `most` of the marked steps in which something moves.
///
/// # Errors
/// When a file cannot be written.
pub fn write(measured: &Measured, most: usize, folder: &Path) -> anyhow::Result<()> {
    let name = &measured.report.sequence;
    if let Some(strip) = strip_of(measured, most)? {
        let file = folder.join(strip_name(name));
        let mut png = Vec::new();
        let (best, adaptive) = (CompressionType::Best, FilterType::Adaptive);
        strip.write_with_encoder(PngEncoder::new_with_quality(&mut png, best, adaptive))?;
        output::write(&file, &png)?;
    }
    let frames = frames(measured);
    if !frames.is_empty() {
        output::write(&folder.join(film_name(name)), &film(&frames, DELAY_MS)?)?;
    }
    Ok(())
}

/// The file of a sequence's strip.
pub fn strip_name(sequence: &str) -> String {
    format!("{sequence}-strip.png")
}

/// The file of a sequence's animation.
pub fn film_name(sequence: &str) -> String {
    format!("{sequence}.png")
}

/// Writes the charts of several measurements, each with the name of its preset.
///
/// # Errors
/// When a file cannot be written.
pub fn write_charts(reports: &[(String, &SequenceReport)], folder: &Path) -> anyhow::Result<()> {
    let mut panels: Vec<StepPanel> = Vec::new();
    let mut points = Vec::new();
    for (preset, report) in reports {
        let line =
            report.by_step.iter().filter_map(|step| Some((step.step, step.full?.rmse_percent)));
        let line = (preset.clone(), line.collect());
        match panels.iter_mut().find(|panel| panel.name == report.sequence) {
            Some(panel) => panel.lines.push(line),
            None => panels.push(StepPanel { name: report.sequence.clone(), lines: vec![line] }),
        }
        if let (Some(full), Some(cost)) = (report.in_motion.full, report.cost) {
            points.push(Point {
                scene: report.sequence.clone(),
                preset: preset.clone(),
                resolution: report.settings.resolution,
                ms: cost.ms.median,
                samples: cost.samples_per_pixel.median,
                error_percent: full.rmse_percent.median,
            });
        }
    }
    let by_step = error_by_step("RMSE of irradiance at each step", &panels)?;
    output::write(&folder.join(BY_STEP), by_step.as_bytes())?;
    if !points.is_empty() {
        output::write(&folder.join(AGAINST_COST), error_against_cost(&points)?.as_bytes())?;
    }
    Ok(())
}

fn strip_of(measured: &Measured, most: usize) -> anyhow::Result<Option<RgbImage>> {
    let report = &measured.report;
    let shown: Vec<_> = measured
        .marked
        .iter()
        .map(|step| &report.by_step[*step as usize])
        .filter(|step| step.is_moving && step.picture.is_some())
        .collect();
    let first = shown.len().saturating_sub(most);
    let labels: Vec<String> =
        shown.iter().map(|step| format!("step {} ({})", step.step, step.phase)).collect();
    let rows = shown[first..].iter().zip(&labels[first..]).filter_map(|(step, label)| {
        let index = step.step as usize;
        Some(Row {
            label,
            reference: measured.truths[index].as_ref()?.picture().picture,
            ours: &measured.shown[index].picture,
            figures: step.picture.as_ref()?,
        })
    });
    let rows: Vec<Row<'_>> = rows.collect();
    if rows.is_empty() {
        return Ok(None);
    }
    let title = format!("{}: one frame a step", report.sequence);
    let strip = strip(&title, &rows).with_context(|| title.clone())?;
    Ok(Some(strip))
}

/// Frames with our picture on the left and the truth on the right, spread over all steps from the
/// first to the last. All have the exposure of the brightest truth. A step without a truth shows
/// the last truth before it.
fn frames(measured: &Measured) -> Vec<RgbImage> {
    let Some(stops) = measured.stops() else { return Vec::new() };
    let count = measured.shown.len();
    let stride = count.div_ceil(MOST_FRAMES).max(1);
    let mut steps: Vec<usize> = (0..count).step_by(stride).collect();
    if steps.last().is_some_and(|last| last + 1 < count) {
        steps.push(count - 1);
    }
    let frame = |step: usize| {
        let ours = screen(&measured.shown[step].picture, stops);
        let truth = measured.truths[..=step].iter().rev().flatten().next();
        let mut frame = RgbImage::from_pixel(2 * ours.width() + GAP, ours.height(), GAP_COLOR);
        imageops::replace(&mut frame, &ours, 0, 0);
        if let Some(truth) = truth {
            let truth = screen(truth.picture().picture, stops);
            imageops::replace(&mut frame, &truth, (ours.width() + GAP).into(), 0);
        }
        frame
    };
    steps.into_iter().map(frame).collect()
}

fn screen(picture: &LinearPicture, stops: f32) -> RgbImage {
    let codes = picture.to_screen(stops);
    let [width, height] = picture.size.to_array();
    RgbImage::from_fn(width, height, |x, y| Rgb(codes[(y * width + x) as usize]))
}
