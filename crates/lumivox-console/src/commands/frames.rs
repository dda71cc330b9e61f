//! Commands for frames and their times.

use std::time::Duration;

use lumivox_explorer::LONGEST_BUDGET_MS;
use lumivox_render::RenderProgress;
use web_time::Instant;

use crate::arguments::{number, on_or_off, toggled};
use crate::command::Run::{Now, Waits};
use crate::command::{Command, Edits, Group, PLAIN, Takes};
use crate::report::TimesReport;
use crate::{Console, Effect, Failure, Reply};

/// The longest time for which `avgf` renders missing frames.
const LONGEST_MEASUREMENT: Duration = Duration::from_secs(1);

/// The most frames that a script may wait for at once.
const LONGEST_WAIT: u32 = 65_536;

const FRAMES: Command = Command { group: Group::Frames, ..PLAIN };

pub const TABLE: &[Command] = &[
    Command {
        name: "wait",
        usage: "FRAMES",
        count: (1, 1),
        takes: &[Takes::Anything],
        summary: "Render a number of frames before the next command",
        details: "From 0 to 65536. Each frame of a script lasts 1/30 s for animations and for the time between \
                  voxelizations. A complete picture renders no more frames.",
        example: "wait 4",
        edits: Edits::Nothing,
        run: Now(|_, arguments| {
            let text = arguments.first().copied().unwrap_or_default();
            Ok(Reply::ask(Effect::Wait(number(text, "frames", 0..=LONGEST_WAIT)?)))
        }),
        ..FRAMES
    },
    Command {
        name: "frame_budget",
        usage: "[MS]",
        count: (0, 1),
        takes: &[Takes::Anything],
        summary: "Set the milliseconds that a frame may take while something moves, or print them",
        details: "From 0 to 10000; at 0 pictures are never coarser. The default is 33. If frames take longer, the window and the page \
                  show pictures of half as many pixels, or a quarter, an eighth, a sixteenth, until nothing has moved for 0.3 s. No \
                  effect on other pictures.",
        example: "frame_budget 16",
        sets: Some(1),
        edits: Edits::Nothing,
        run: Now(|console, arguments| {
            let budget_ms = &mut console.explorer.pacing.budget_ms;
            let Some(text) = arguments.first() else {
                return Ok(Reply::say(format!("frame_budget {budget_ms}")));
            };
            *budget_ms = number(text, "the time in milliseconds", 0.0..=LONGEST_BUDGET_MS)?;
            Ok(Reply::default())
        }),
        ..FRAMES
    },
    Command {
        name: "sfMode",
        aliases: &["sfmode"],
        usage: "[on|off]",
        count: (0, 1),
        takes: &[Takes::Switch],
        summary: "Render frames one by one, on demand, or continuously",
        details: "Without a value it toggles, and prints the new state. In scripts frames are always on demand.",
        example: "sfMode on",
        run: Now(|console, arguments| {
            let is_on = toggled(arguments, "sfMode", console.explorer.is_single_frame)?;
            console.explorer.is_single_frame = is_on;
            Ok(Reply::say(format!("sfMode {}", on_or_off(is_on))))
        }),
        ..FRAMES
    },
    Command {
        name: "sf",
        usage: "[FALLOFF]",
        count: (0, 1),
        takes: &[Takes::Anything],
        summary: "Render one frame; with a value, set the shininess falloff",
        details: "Without a value it renders one more frame of the picture, and prints its number and time. With a value it sets \
                  `shininess_falloff`.",
        example: "sf",
        run: Waits(|console, arguments| Box::pin(step(console, arguments))),
        ..FRAMES
    },
    Command {
        name: "avgf",
        summary: "Print the mean time of the last 100 frames in milliseconds",
        details: "`clearf` forgets them. If there are fewer, more frames are rendered only to \
                  be timed, for a second at most.",
        example: "avgf",
        run: Waits(|console, _| Box::pin(average(console))),
        ..FRAMES
    },
    Command {
        name: "clearf",
        summary: "Forget the times of the frames so far",
        example: "clearf",
        run: Now(|console, _| {
            console.explorer.times.clear();
            Ok(Reply::default())
        }),
        ..FRAMES
    },
    Command {
        name: "lastframes",
        usage: "FRAMES",
        count: (1, 1),
        takes: &[Takes::Anything],
        summary: "Print the times of the last frames in milliseconds, the newest last",
        details: "From 1 to 4096, or as many as there are.",
        example: "lastframes 8",
        run: Now(|console, arguments| {
            let text = arguments.first().copied().unwrap_or_default();
            let count = number(text, "frames", 1..=4096)? as usize;
            let times: Vec<String> = console.explorer.times.last(count).map(ms).collect();
            Ok(Reply::say(match times.as_slice() {
                [] => "no frame has been rendered yet".to_owned(),
                times => times.join("\n"),
            }))
        }),
        ..FRAMES
    },
    Command {
        name: "draw_block",
        usage: "[on|off]",
        count: (0, 1),
        takes: &[Takes::Switch],
        summary: "Wait for the GPU at the end of each frame, or at the beginning of the next one",
        details: "On: each time is that of one frame. Off: the CPU works ahead, and times are from frame to \
                  frame. Without a value it toggles, and prints the new state.",
        example: "draw_block on",
        run: Now(|console, arguments| {
            let is_on = toggled(arguments, "draw_block", console.explorer.waits_for_gpu)?;
            console.explorer.waits_for_gpu = is_on;
            Ok(Reply::say(format!("draw_block {}", on_or_off(is_on))))
        }),
        ..FRAMES
    },
    Command {
        name: "timing",
        usage: "[on|off]",
        count: (0, 1),
        takes: &[Takes::Switch],
        summary: "Measure the times of all stages from now on, for `times`",
        details: "Without GPU timestamps every pass is waited for, which costs time. Without a value it \
                  toggles.",
        example: "timing on",
        run: Now(timing),
        ..FRAMES
    },
    Command {
        name: "times",
        usage: "[passes]",
        count: (0, 1),
        takes: &[Takes::Word(&["passes"])],
        summary: "Print the mean time of each stage in a frame, in milliseconds",
        details: "Needs `timing on` before. With `passes` it lists the passes of each stage as well.",
        example: "times",
        edits: Edits::Nothing,
        run: Now(times),
        ..FRAMES
    },
];

fn ms(time: Duration) -> String {
    format!("{:.2}", time.as_secs_f64() * 1e3)
}

fn frames(count: usize) -> String {
    crate::report::counted(count, "frame", "frames")
}

async fn step(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    if !arguments.is_empty() {
        return super::parameters::run(console, "shininess_falloff", arguments);
    }
    console.update().await?;
    let Console { explorer, listener, .. } = console;
    let is_new = explorer
        .frame(&mut |step| {
            let _ = listener.progress(step);
        })
        .await?;
    let total = explorer.settings().frames;
    let done = explorer.renderer().map_or(0, lumivox_render::Renderer::frame_count);
    let time = explorer.times.last(1).next().unwrap_or_default();
    Ok(Reply::say(if is_new {
        format!("frame {done} of {total}, {} ms", ms(time))
    } else {
        format!("frame {done} of {total}: the picture is complete")
    }))
}

/// The number of frames over which `avgf` takes the mean.
const MEASURED: usize = 100;

async fn average(console: &mut Console) -> anyhow::Result<Reply> {
    console.update().await?;
    let Console { explorer, listener, .. } = console;
    let start = Instant::now();
    while explorer.times.count() < MEASURED {
        explorer.rehearse().await?;
        let done = explorer.times.count() as u32;
        let step = RenderProgress { stage: "render", done, total: MEASURED as u32 };
        if listener.progress(step).is_break() || start.elapsed() > LONGEST_MEASUREMENT {
            break;
        }
    }
    let times: Vec<Duration> = explorer.times.last(MEASURED).collect();
    let mean = times.iter().sum::<Duration>() / (times.len() as u32).max(1);
    Ok(Reply::say(format!("{} ms, mean of {}", ms(mean), frames(times.len()))))
}

fn timing(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    use lumivox::gpu::Timing;
    let was_on = console.explorer.settings().timing != Timing::Off;
    let is_on = toggled(arguments, "timing", was_on)?;
    let device = &console.explorer.gpu().device;
    let timing = if is_on { Timing::for_device(device) } else { Timing::Off };
    console.change(|settings| settings.timing = timing)?;
    Ok(Reply::say(format!("timing {}", on_or_off(is_on))))
}

fn times(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let has_passes = match arguments {
        [] => false,
        ["passes", ..] => true,
        [other, ..] => {
            return Err(Failure::input(format!(
                "times takes passes or no argument; got \"{other}\""
            ))
            .into());
        }
    };
    if console.explorer.settings().timing == lumivox::gpu::Timing::Off {
        return Err(
            Failure::input("stages are not timed; `timing on` times them from now on").into()
        );
    }
    let times = console.explorer.renderer().map(lumivox_render::Renderer::times);
    let mut times = TimesReport::new(&times.unwrap_or_default());
    if times.stages.is_empty() {
        return Ok(Reply::say("no frame has been rendered yet"));
    }
    if !has_passes {
        times.passes.clear();
    }
    Ok(Reply::say(times.table("stage").trim_end()))
}
