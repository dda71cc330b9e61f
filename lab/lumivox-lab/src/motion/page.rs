//! The page about motion, docs/generated/motion.md.

use std::fmt::Write as _;

use lumivox_console::report::bytes;
use lumivox_render::compare::ErrorFigures;

use super::figures::{CostSpread, Spread};
use super::pictures::{AGAINST_COST, BY_STEP, film_name, strip_name};
use super::published;
use super::report::{Case, ErrorSpread, SequenceReport};
use crate::cli::MotionArgs;

/// The folder of the pictures, below the page's folder.
pub const PICTURES: &str = "images/motion";
/// The width at which an animation is shown, px.
const SHOWN_WIDTH: u32 = 640;

/// Writes the page. `machine` describes the GPU and the processor, and `resolution` is the number
/// of voxels along the longest axis.
pub fn page(args: &MotionArgs, machine: &str, resolution: u32, cases: &[Case]) -> String {
    let [width, height] = args.size.to_array();
    let samples = args.samples;
    let mut page = format!(
        "# How far from the truth in motion\n\n\
         Lumivox measures itself while something moves, too. This page is the output of one command, `lumivox-lab motion --doc docs/generated`; nothing in it is written by hand. \
         A sequence is a row of steps, each with a pose of camera, lights and things that follows from its number. \
         **One frame is rendered for each step**, through the path that the window takes, and compared with what the path tracer answers for the same pose: \
         nothing of a later step is known, and nothing is averaged that would not be on screen. \
         {width} x {height} pixels, {samples} samples a pixel for the truth of every pose, {resolution} voxels along the longest axis, on {machine}.\n\n\
         *Full* is the irradiance on visible surfaces by all light but that straight from lamps, *picture* the finished picture. \
         Bias, RMSE, p95 and FLIP are those of [quality](quality.md), in per cent of the mean of the truth of the same step, whose noise is taken out of the RMSE. \
         A single frame has one sample a pixel: on edges its error is that of jagged edges, the larger the fewer pixels a picture has. \
         Steps whose truth has less than a hundredth of the brightest one's light have no relative errors. \
         A figure over steps is given as *median / worst*, over the steps in which something moves; in `switch`, where nothing does, over the first 16 frames after each change.\n\n"
    );
    page += "| sequence | scene | what moves | steps |\n| --- | --- | --- | --: |\n";
    for case in cases.iter().filter(|case| case.is_shown) {
        let SequenceReport { sequence, scene, moves, steps, .. } = &case.report;
        let _ = writeln!(page, "| {sequence} | {scene} | {moves} | {steps} |");
    }
    page += "\n";
    page += &in_motion(cases);
    page += &at_stop(cases);
    page += &published::beside(args, cases);
    page += &flicker(cases);
    page += &disoccluded(cases);
    page += &after_changes(cases);
    page += &leaks(cases);
    page += &cost(cases);
    page += &pictures(cases);
    page
}

fn pair(spread: Option<Spread>, shown: impl Fn(f64) -> String) -> String {
    spread.map_or("-".to_owned(), |s| format!("{} / {}", shown(s.median), shown(s.worst)))
}

fn percent(value: f64) -> String {
    format!("{value:.1}")
}

fn rmse(figures: Option<ErrorFigures>) -> String {
    figures.map_or("-".to_owned(), |figures| percent(figures.rmse_percent))
}

fn in_motion(cases: &[Case]) -> String {
    let mut text = "## Error in motion\n\n\
        The last columns set the RMSE in proportion to that of the same pose when it has stood still for 32 frames of `balanced`: \
        that still RMSE, and the RMSE in motion divided by it, at the marked steps (the middle and the end of a motion). \
        *Off still* is the root mean square of the relative difference from that still picture in blocks of 8 x 8 pixels, for the median block and the one that 95 % of the blocks stay below.\n\n\
        | sequence | preset | of | bias | RMSE | p95 | FLIP | noise | RMSE still | of still | off still: median | 95 % |\n\
        | --- | --- | --- | --: | --: | --: | --: | --: | --: | --: | --: | --: |\n"
        .to_owned();
    for Case { preset, report, .. } in cases {
        for (of, spread) in [("full", report.in_motion.full), ("picture", report.in_motion.picture)]
        {
            let Some(spread) = spread else { continue };
            let off_still = report.in_motion.off_still.filter(|_| of == "picture");
            let ErrorSpread { bias_percent, rmse_percent, p95_percent, flip, .. } = spread;
            let _ = writeln!(
                text,
                "| {} | {preset} | {of} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
                report.sequence,
                pair(Some(bias_percent), |value| format!("{value:+.1}")),
                pair(Some(rmse_percent), percent),
                pair(Some(p95_percent), percent),
                pair(flip, |value| format!("{value:.3}")),
                spread.noise_percent.map_or("-".to_owned(), |noise| percent(noise.median)),
                spread.still_rmse_percent.map_or("-".to_owned(), |still| percent(still.median)),
                pair(spread.rmse_of_still, |ratio| format!("{ratio:.1}")),
                pair(off_still.map(|both| both[0]), percent),
                pair(off_still.map(|both| both[1]), percent),
            );
        }
    }
    let _ = write!(
        text,
        "\n![RMSE of full at each step, for each preset]({PICTURES}/{BY_STEP})\n\n\
         Error in motion against cost: the median RMSE of *full* against the median milliseconds and cone samples of a step in which something moves.\n\n\
         ![Error in motion against milliseconds and cone samples of a step]({PICTURES}/{AGAINST_COST})\n\n"
    );
    text
}

fn at_stop(cases: &[Case]) -> String {
    let stops: Vec<&Case> = cases.iter().filter(|case| !case.report.at_stop.is_empty()).collect();
    let Some(first) = stops.first() else { return String::new() };
    let mut text =
        "## At the stop\n\nThe RMSE when the camera stops, and some frames after, in per cent.\n\n\
                    | sequence | preset | of |"
            .to_owned();
    for stop in &first.report.at_stop {
        let name = if stop.after == 0 { "at stop".to_owned() } else { format!("+{}", stop.after) };
        let _ = write!(text, " {name} |");
    }
    text += "\n| --- | --- | --- |";
    text += &" --: |".repeat(first.report.at_stop.len());
    text += "\n";
    for Case { preset, report, .. } in stops {
        for of in ["full", "picture"] {
            let _ = write!(text, "| {} | {preset} | {of} |", report.sequence);
            for stop in &report.at_stop {
                let figures = if of == "full" { stop.full } else { stop.picture };
                let _ = write!(text, " {} |", rmse(figures));
            }
            text += "\n";
        }
    }
    text + "\n"
}

fn flicker(cases: &[Case]) -> String {
    let mut text = "## Flicker\n\n\
        The mean over pixels of the change from step to step that the truth does not have: in per cent of the truth's mean for linear light, \
        and in display values from 0 to 1 at the exposure of the brightest step. What the truth's own noise adds is taken out; the columns *with it* have it. \
        Rare bright samples make the noise look larger than it is, and the flicker too small: where the two columns are far apart, trust the second as a bound.\n\n\
        | sequence | preset | full | with it | picture | with it | on screen | with it |\n\
        | --- | --- | --: | --: | --: | --: | --: | --: |\n"
        .to_owned();
    for Case { preset, report, .. } in cases {
        let Some(flicker) = &report.flicker else { continue };
        let share = |value: f64| format!("{value:.2}");
        let shown = |value: f64| format!("{value:.4}");
        let noise =
            |value: Option<f64>, shown: &dyn Fn(f64) -> String| value.map_or("-".to_owned(), shown);
        let _ = writeln!(
            text,
            "| {} | {preset} | {} | {} | {} | {} | {} | {} |",
            report.sequence,
            pair(flicker.full_percent, share),
            noise(flicker.with_noise.full_percent, &share),
            pair(flicker.picture_percent, share),
            noise(flicker.with_noise.picture_percent, &share),
            pair(flicker.display, shown),
            noise(flicker.with_noise.display, &shown),
        );
    }
    text + "\n"
}

fn disoccluded(cases: &[Case]) -> String {
    let mut text = "## What has just become visible\n\n\
        Pixels whose surface was hidden or off screen in the step before, in their first step: their share of all pixels, \
        and their own errors, in per cent of their own mean. *Of still* is their RMSE over the median RMSE of whole pictures that have stood still.\n\n\
        | sequence | preset | share of pixels | full: bias | RMSE | of still | picture: bias | RMSE | of still |\n\
        | --- | --- | --: | --: | --: | --: | --: | --: | --: |\n"
        .to_owned();
    for Case { preset, report, .. } in cases {
        let Some(new) = &report.disoccluded else { continue };
        let bias = |figures: Option<ErrorFigures>| {
            figures.map_or("-".to_owned(), |figures| format!("{:+.1}", figures.bias_percent))
        };
        let ratio =
            |ratio: Option<f64>| ratio.map_or("-".to_owned(), |ratio| format!("{ratio:.1}"));
        let _ = writeln!(
            text,
            "| {} | {preset} | {:.2} | {} | {} | {} | {} | {} | {} |",
            report.sequence,
            new.percent_of_pixels,
            bias(new.full),
            rmse(new.full),
            ratio(new.full_of_still),
            bias(new.picture),
            rmse(new.picture),
            ratio(new.picture_of_still)
        );
    }
    text + "\n"
}

fn after_changes(cases: &[Case]) -> String {
    let mut text = "## After a change\n\n\
        **Latency** is the share of the change of mean *full* irradiance that is there after a number of frames, in per cent; \
        the whole change is that between pictures of before and after that have stood still for 32 frames, and the last column sets it in proportion to the truth's. \
        Changes of less than a tenth of the light are left out.\n\n\
        | sequence | change | preset | 1 frame | 2 | 4 | 8 | 16 | whole change |\n\
        | --- | --- | --- | --: | --: | --: | --: | --: | --: |\n"
        .to_owned();
    for Case { preset, report, .. } in cases {
        for latency in &report.latency {
            let _ = write!(text, "| {} | {} | {preset} |", report.sequence, latency.change.name);
            for share in &latency.there {
                let _ = write!(text, " {} |", percent(share.percent));
            }
            let whole = latency.whole_of_truth_percent.map_or("-".to_owned(), percent);
            let _ = writeln!(text, " {whole} |");
        }
    }
    text += "\nThe **trail** is what is left of the picture before: the least-squares share, in per cent, of the difference of *full* between the still pictures of before and after \
        that the present frame still shows. The noise of a frame may make it negative.\n\n\
        | sequence | change | preset | 1 frame | 5 | 20 |\n| --- | --- | --- | --: | --: | --: |\n";
    for Case { preset, report, .. } in cases {
        for trail in &report.trail {
            let _ = write!(text, "| {} | {} | {preset} |", report.sequence, trail.change.name);
            for left in &trail.left {
                // Not "-0.0".
                let _ = write!(text, " {:.1} |", (10.0 * left.percent).round() / 10.0 + 0.0);
            }
            text += "\n";
        }
    }
    text + "\n"
}

fn leaks(cases: &[Case]) -> String {
    let mut rows = String::new();
    for Case { preset, report, .. } in cases {
        let Some(leak) = report.leak_percent else { continue };
        let shown = pair(Some(leak), |value| format!("{value:.2}"));
        let _ = writeln!(rows, "| {} | {preset} | {shown} |", report.sequence);
    }
    if rows.is_empty() {
        return rows;
    }
    format!(
        "## Light where there is none\n\n\
         In steps whose truth is nearly black: the mean of *full* beyond the truth's, in per cent of that of the brightest step. It came through walls, or has stayed.\n\n\
         | sequence | preset | leak |\n| --- | --- | --: |\n{rows}\n"
    )
}

fn cost(cases: &[Case]) -> String {
    let mut text = "## Cost\n\n\
        Steps in which something moves, as *median / 95th percentile / worst*: wall-clock time of the changes and the frame; samples of the volume that a pixel's cones take \
        (those between voxels are not counted); how often the CPU waits for the GPU, the wait at the frame's end included; and bytes of buffers and textures made.\n\n\
        | sequence | preset | ms | cone samples | waits | allocated |\n| --- | --- | --: | --: | --: | --: |\n"
        .to_owned();
    for Case { preset, report, .. } in cases {
        let Some(cost) = &report.cost else { continue };
        let three = |cost: CostSpread, shown: &dyn Fn(f64) -> String| {
            format!("{} / {} / {}", shown(cost.median), shown(cost.p95), shown(cost.worst))
        };
        let _ = writeln!(
            text,
            "| {} | {preset} | {} | {} | {} | {} |",
            report.sequence,
            three(cost.ms, &|ms| format!("{ms:.0}")),
            three(cost.samples_per_pixel, &|count| format!("{count:.0}")),
            three(cost.waits, &|count| format!("{count:.0}")),
            three(cost.allocated_bytes, &|count| bytes(count as u64)),
        );
    }
    text + "\n"
}

fn pictures(cases: &[Case]) -> String {
    let mut text = "## The sequences\n\n\
        Animations have ours on the left and the path tracer's answer on the right, both at the exposure of the brightest step. \
        Strips have the path tracer's answer, ours, and where ours is too dark or too bright.\n\n"
        .to_owned();
    for Case { preset, report, .. } in cases.iter().filter(|case| case.is_shown) {
        let SequenceReport { sequence, moves, .. } = report;
        let (film, strip) = (film_name(sequence), strip_name(sequence));
        let _ = write!(
            text,
            "### {sequence}\n\n{moves} With `{preset}`.\n\n\
             <img src=\"{PICTURES}/{film}\" width=\"{SHOWN_WIDTH}\" alt=\"{sequence}: ours and the truth, step by step\">\n\n\
             ![{sequence}: truth, ours and error at marked steps]({PICTURES}/{strip})\n\n"
        );
    }
    text.truncate(text.trim_end().len());
    text + "\n"
}
