//! Pictures: screenshots, references, and how far the one is from the other.

use std::ops::ControlFlow;
use std::path::Path;

use lumivox_render::compare::{ErrorFigures, LinearPicture};
use lumivox_render::reference::{
    PathTracer, ReferenceLayers, ReferenceProgress, ReferenceSettings,
};
use lumivox_render::{Progress, View};

use crate::args::output;
use crate::console::arguments::whole;
use crate::console::command::{Command, Group, PLAIN, Takes};
use crate::console::{Console, Reply, nothing_to_show};
use crate::exit::Failure;
use crate::quality::Comparison;

const FILES: Command = Command { group: Group::Files, ..PLAIN };

/// Samples of a reference where none are asked for.
const SAMPLES: u32 = 64;

pub const TABLE: &[Command] = &[
    Command {
        name: "screenshot",
        usage: "FILE",
        count: (1, 1),
        takes: &[Takes::File],
        summary: "Write the picture to a file, .png or .exr, once all its frames are rendered",
        details: "Frames that are missing are rendered first. A relative path is relative to the working folder; a file of \
                  that name is replaced.",
        example: "screenshot hall.png",
        run: screenshot,
        ..FILES
    },
    Command {
        name: "size",
        usage: "[WIDTHxHEIGHT]",
        count: (0, 1),
        takes: &[Takes::Anything],
        summary: "Set the size of the picture in pixels, or print it",
        details: "Each from 1 to 32768, or less, as the GPU allows.",
        example: "size 1280x720",
        run: super::parameters::size,
        ..FILES
    },
    Command {
        name: "reference",
        usage: "FILE [SAMPLES]",
        count: (1, 2),
        takes: &[Takes::File, Takes::Anything],
        summary: "Path-trace the picture from here, as it ought to look, and write it to a file, .png or .exr",
        details: "SAMPLES a pixel, from 1 to 1048576; 64 where none are given. As `lumivox reference`; .exr has all layers.",
        example: "reference truth.exr 256",
        run: reference,
        ..FILES
    },
    Command {
        name: "compare",
        usage: "[SAMPLES]",
        count: (0, 1),
        takes: &[Takes::Anything],
        summary: "Path-trace the picture from here, and print how far the present one is from it",
        details: "Bias, RMSE, 95th percentile and FLIP, as `lumivox compare`. SAMPLES a pixel, from 1 to 1048576; 64 where \
                  none are given. The view must be `final`.",
        example: "compare 128",
        run: compare,
        ..FILES
    },
];

fn screenshot(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let file = Path::new(arguments.first().copied().unwrap_or_default());
    output::check(file)?;
    console.update()?;
    let Console { explorer, hear, .. } = console;
    let picture = pollster::block_on(explorer.picture(&mut |progress| {
        let _ = hear(progress);
    }))?;
    let picture = picture.ok_or_else(nothing_to_show)?;
    picture.write(file)?;
    let (size, frames) = (picture.size, explorer.settings().frames);
    let frames = crate::report::counted(frames as usize, "frame", "frames");
    Ok(Reply::say(format!("{}: {}x{}, {frames}", file.display(), size.x, size.y)))
}

fn samples(text: Option<&&str>) -> Result<u32, Failure> {
    text.map_or(Ok(SAMPLES), |text| whole(text, "samples", 1..=1 << 20))
}

/// Traces the present view.
fn trace(console: &mut Console, samples: u32) -> anyhow::Result<ReferenceLayers> {
    let Console { explorer, hear, .. } = console;
    let scene = explorer.scene().filter(|scene| scene.shown().next().is_some());
    let scene = scene.ok_or_else(nothing_to_show)?;
    let settings = ReferenceSettings {
        size: explorer.size(),
        samples,
        occlusion_distance_m: explorer.settings().trace.occlusion_distance_m,
        ..ReferenceSettings::default()
    };
    let tracer = PathTracer::new(explorer.gpu(), scene, Some(explorer.camera()), settings);
    let mut tracer = pollster::block_on(tracer)?;
    let mut is_broken_off = false;
    let mut tell = |step: ReferenceProgress| {
        let told =
            hear(Progress { stage: "path sample", done: step.samples as u32, total: step.total });
        is_broken_off |= told.is_break();
        told
    };
    pollster::block_on(tracer.render(&mut tell))?;
    if is_broken_off {
        return Err(Failure::input("the reference was broken off").into());
    }
    Ok(tracer.layers())
}

fn reference(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let file = Path::new(arguments.first().copied().unwrap_or_default());
    output::check(file)?;
    let samples = samples(arguments.get(1))?;
    let layers = trace(console, samples)?;
    crate::commands::reference::write(&layers, console.explorer.gpu(), file)?;
    let size = layers.size;
    Ok(Reply::say(format!("{}: {}x{}, {samples} samples a pixel", file.display(), size.x, size.y)))
}

fn compare(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let samples = samples(arguments.first())?;
    let view = console.explorer.settings().view;
    if view != View::Final {
        return Err(Failure::input(format!(
            "compare is about the view final, not {}; `view final` shows it",
            view.name()
        ))
        .into());
    }
    console.update()?;
    let layers = trace(console, samples)?;
    let Console { explorer, hear, .. } = console;
    let mut tell = |progress| {
        let _: ControlFlow<()> = hear(progress);
    };
    let picture = pollster::block_on(explorer.picture(&mut tell))?;
    let picture = picture.ok_or_else(nothing_to_show)?;
    let truth = layers.layer(&layers.radiance);
    let variance = layers.radiance_variance.as_slice();
    // Few samples do not tell their variance.
    let variance = variance.iter().all(|value| value.is_finite()).then_some(variance);
    let figures = ErrorFigures::new(&truth, variance, &LinearPicture::from(&picture))?;
    let comparison = Comparison {
        size: picture.size.to_array(),
        final_picture: Some(figures),
        ..Comparison::default()
    };
    Ok(Reply::say(comparison.table().trim_end()))
}
