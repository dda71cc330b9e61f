//! Commands for pictures: screenshots, references, and the error against a reference.

use std::path::Path;

use lumivox_render::compare::{ErrorFigures, LinearPicture};
use lumivox_render::reference::{
    PathTracer, ReferenceLayers, ReferenceProgress, ReferenceSettings,
};
use lumivox_render::{ImageFormat, Picture, RenderProgress, View};

use crate::arguments::number;
use crate::command::Run::{Now, Waits};
use crate::command::{Command, Edits, Group, PLAIN, Takes};
use crate::report::counted;
use crate::{Comparison, Console, Failure, Reply, nothing_to_show};

const FILES: Command = Command { group: Group::Files, ..PLAIN };

/// Default samples a pixel of a reference.
const SAMPLES: u32 = 64;

pub const TABLE: &[Command] = &[
    Command {
        name: "screenshot",
        usage: "FILE",
        count: (1, 1),
        takes: &[Takes::File],
        summary: "Write the picture to a file, .png or .exr, once all its frames are rendered",
        details: "Missing frames are rendered first. A relative path starts at the working folder; a file of \
                  that name is replaced.",
        example: "screenshot hall.png",
        edits: Edits::Nothing,
        needs_all_frames: true,
        run: Waits(|console, arguments| Box::pin(screenshot(console, arguments))),
        ..FILES
    },
    Command {
        name: "size",
        usage: "[WIDTHxHEIGHT]",
        count: (0, 1),
        takes: &[Takes::Anything],
        summary: "Set the size of the picture in pixels, or print it",
        details: "Width and height are from 1 to 32768, or to the GPU's own limit if that is less.",
        example: "size 1280x720",
        sets: Some(1),
        edits: Edits::Nothing,
        run: Now(super::parameters::size),
        ..FILES
    },
    Command {
        name: "reference",
        usage: "FILE [SAMPLES]",
        count: (1, 2),
        takes: &[Takes::File, Takes::Anything],
        summary: "Path-trace a reference of the present picture, and write it to a file, .png or .exr",
        details: "SAMPLES is the samples a pixel, from 1 to 1048576 (64 by default). As `lumivox reference`; .exr has all layers.",
        example: "reference truth.exr 256",
        run: Waits(|console, arguments| Box::pin(reference(console, arguments))),
        ..FILES
    },
    Command {
        name: "compare",
        usage: "[SAMPLES]",
        count: (0, 1),
        takes: &[Takes::Anything],
        summary: "Path-trace a reference of the present picture, and print the errors against it",
        details: "Bias, RMSE, 95th percentile and FLIP, as `lumivox compare`. SAMPLES is the samples a pixel, from 1 to 1048576 (64 \
                  by default). The view must be `final`.",
        example: "compare 128",
        edits: Edits::Nothing,
        needs_all_frames: true,
        run: Waits(|console, arguments| Box::pin(compare(console, arguments))),
        ..FILES
    },
];

async fn screenshot(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let file = arguments.first().copied().unwrap_or_default();
    let format = console.picture_file(file)?;
    console.update().await?;
    let picture = console.picture().await?;
    console.outside.write(file, &picture.encode(format)?)?;
    let (size, frames) = (picture.size, console.explorer.settings().frames);
    let frames = counted(frames as usize, "frame", "frames");
    Ok(Reply::say(format!("{file}: {}x{}, {frames}", size.x, size.y)))
}

impl Console {
    /// Checks that the file can be written, and returns its format.
    fn picture_file(&self, file: &str) -> anyhow::Result<ImageFormat> {
        let format = ImageFormat::from_path(Path::new(file))?;
        self.outside.check_output(file)?;
        Ok(format)
    }

    /// The picture with all its frames.
    async fn picture(&mut self) -> anyhow::Result<Picture> {
        let Self { explorer, listener, .. } = self;
        let mut progress = |step| {
            let _ = listener.progress(step);
        };
        let picture = explorer.picture(&mut progress).await?;
        Ok(picture.ok_or_else(nothing_to_show)?)
    }
}

fn samples(text: Option<&&str>) -> Result<u32, Failure> {
    text.map_or(Ok(SAMPLES), |text| number(text, "samples", 1..=1 << 20))
}

/// Path-traces the present view.
async fn trace(console: &mut Console, samples: u32) -> anyhow::Result<ReferenceLayers> {
    let Console { explorer, listener, .. } = console;
    let scene = explorer.scene().filter(|scene| scene.shown().next().is_some());
    let scene = scene.ok_or_else(nothing_to_show)?;
    let settings = ReferenceSettings {
        size: explorer.settings().size,
        samples,
        occlusion_distance_m: explorer.settings().trace.occlusion_distance_m,
        ..ReferenceSettings::default()
    };
    let mut tracer =
        PathTracer::new(explorer.gpu(), scene, Some(explorer.camera()), settings).await?;
    let mut is_broken_off = false;
    let mut progress = |step: ReferenceProgress| {
        let step =
            RenderProgress { stage: "path sample", done: step.samples as u32, total: step.total };
        let goes_on = listener.progress(step);
        is_broken_off |= goes_on.is_break();
        goes_on
    };
    tracer.render(&mut progress).await?;
    if is_broken_off {
        return Err(Failure::input("the reference was cancelled").into());
    }
    Ok(tracer.layers())
}

async fn reference(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let file = arguments.first().copied().unwrap_or_default();
    let format = console.picture_file(file)?;
    let samples = samples(arguments.get(1))?;
    let layers = trace(console, samples).await?;
    let bytes = layers.encode(console.explorer.gpu(), format).await?;
    console.outside.write(file, &bytes)?;
    let size = layers.size;
    Ok(Reply::say(format!("{file}: {}x{}, {samples} samples a pixel", size.x, size.y)))
}

async fn compare(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let samples = samples(arguments.first())?;
    let view = console.explorer.settings().view;
    if view != View::Final {
        return Err(Failure::input(format!(
            "compare needs the view final, not {}; `view final` shows it",
            view.name()
        ))
        .into());
    }
    console.update().await?;
    let layers = trace(console, samples).await?;
    let picture = console.picture().await?;
    let truth = layers.layer(&layers.radiance);
    let variance = layers.radiance_variance.as_slice();
    // With too few samples the variance is unknown.
    let variance = variance.iter().all(|value| value.is_finite()).then_some(variance);
    let figures = ErrorFigures::new(&truth, variance, &LinearPicture::from(&picture))?;
    let comparison = Comparison {
        size: picture.size.to_array(),
        final_picture: Some(figures),
        ..Comparison::default()
    };
    Ok(Reply::say(comparison.table().trim_end()))
}
