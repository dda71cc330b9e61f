//! Our figures beside published figures of other renderers, for global illumination in motion.

use std::fmt::Write as _;

use super::report::{AtStop, Case};
use crate::cli::MotionArgs;

/// Published figures of a renderer, from the benchmark three-ss-fidelity by B. Houston, 2026,
/// docs/CONVERGENCE.md, "First results".
struct Published {
    renderer: &'static str,
    scenes: &'static str,
    /// RMSE in display values at the stop, 16 frames after it, and at rest.
    rmse: [Option<f64>; 3],
    bias_percent: f64,
    flicker: Option<f64>,
}

const PUBLISHED: &[Published] = &[
    Published {
        renderer: "three.js, screen space (`three-new-ssr-rt`)",
        scenes: "38 scenes",
        rmse: [Some(0.0703), Some(0.0699), Some(0.0699)],
        bias_percent: -6.9,
        flicker: Some(0.0025),
    },
    Published {
        renderer: "three.js, screen space (`three-new-ssgi`)",
        scenes: "38 scenes",
        rmse: [Some(0.0802), Some(0.0800), Some(0.0803)],
        bias_percent: -7.0,
        flicker: Some(0.0024),
    },
    Published {
        renderer: "three.js, screen space (`three-new-ssr-rt`)",
        scenes: "9 rooms lit indirectly",
        rmse: [None, None, Some(0.1473)],
        bias_percent: -25.2,
        flicker: None,
    },
];

/// The section of the page; empty unless a sequence stops.
pub fn beside(args: &MotionArgs, cases: &[Case]) -> String {
    let mut rows = String::new();
    for Case { preset, report, .. } in cases {
        let errors: Vec<_> = report.at_stop.iter().filter_map(|stop| stop.on_screen).collect();
        let (Some(rest), Some(last)) = (errors.last(), report.at_stop.last()) else { continue };
        let of = |after: u32| {
            let found = report.at_stop.iter().find(|stop: &&AtStop| stop.after == after);
            found.and_then(|stop| stop.on_screen).map(|error| error.rmse)
        };
        let rmse = [of(0), of(16), Some(rest.rmse)];
        let renderer = format!("Lumivox, `{preset}`, at rest after {} frames", last.after);
        let flicker = Some(rest.change_rmse);
        row(&mut rows, (&renderer, &report.scene), rmse, (rest.bias_percent, flicker));
    }
    if rows.is_empty() {
        return rows;
    }
    for Published { renderer, scenes, rmse, bias_percent, flicker } in PUBLISHED {
        row(&mut rows, (renderer, scenes), *rmse, (*bias_percent, *flicker));
    }
    let [width, height] = args.size.to_array();
    let samples = args.samples;
    format!(
        "## Beside published figures\n\n\
         The benchmark [three-ss-fidelity](https://github.com/bhouston/three-ss-fidelity/blob/main/docs/CONVERGENCE.md) \
         measures a like orbit of 15 degrees in 90 frames and the stop after it. All figures are of display values from 0 to 1: the RMSE, the bias of the mean at rest, \
         and the flicker, which is the RMSE from one picture at rest to the next. \
         The conditions differ, so this is no ranking: theirs are means over scenes of their own, whose camera slows down before it stops, at rest after 256 frames, \
         beside a path tracer with 4096 samples, by their tone mapping; ours are one scene, whose camera stops at once, at {width} x {height} pixels, where edges are many, \
         beside our own path tracer with {samples} samples, whose noise is taken out, at the exposure of the brightest step.\n\n\
         | renderer | scene | at stop | +16 | at rest | bias | flicker |\n| --- | --- | --: | --: | --: | --: | --: |\n{rows}\n"
    )
}

fn row(
    rows: &mut String,
    (renderer, scene): (&str, &str),
    rmse: [Option<f64>; 3],
    (bias_percent, flicker): (f64, Option<f64>),
) {
    let shown = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.4}"));
    let [stop, after, rest] = rmse.map(shown);
    let flicker = shown(flicker);
    let _ = writeln!(
        rows,
        "| {renderer} | {scene} | {stop} | {after} | {rest} | {bias_percent:+.1} % | {flicker} |"
    );
}
