//! Commands for voxels: when they are made, their number, their memory.

use glam::Vec3;
use lumivox_explorer::{Explorer, Revoxelize};
use lumivox_render::{RenderSettings, Renderer};
use lumivox_scene::Bounds;

use crate::arguments::{PLACE, commas, number, on_or_off, toggled, vector, wrong};
use crate::command::Run::{Now, Waits};
use crate::command::{Command, Group, PLAIN, Takes};
use crate::report::{
    GeometryReport, GridReport, MemoryReport, OctreeReport, count, counted, memory_table,
};
use crate::{Console, Failure, Reply, nothing_to_show, shown};

const VOXELS: Command = Command { group: Group::Voxels, takes: &[Takes::Anything], ..PLAIN };

/// The default seconds between voxelizations, as in VXCT.
const PERIOD_S: f32 = 0.5;
/// The range of the seconds between voxelizations: from the shortest frame to a day.
const PERIODS: std::ops::RangeInclusive<f32> = 1e-3..=LONGEST_S;
const LONGEST_S: f32 = 86_400.0;

pub const TABLE: &[Command] = &[
    Command {
        name: "vox",
        summary: "Voxelize once more, now",
        details: "Static objects as well; prints the number of voxels.",
        example: "vox",
        run: Waits(|console, _| {
            Box::pin(async {
                console.explorer.ask_for_voxels();
                console.update().await?;
                Ok(Reply::say(console.explorer.renderer().map(voxels).unwrap_or_default()))
            })
        }),
        ..VOXELS
    },
    Command {
        name: "dynamic",
        usage: "[on|off]",
        count: (0, 1),
        takes: &[Takes::Switch],
        summary: "Voxelize at an interval, every half second or as `vox_freq` says, or stop it",
        details: "Without a value it toggles, and prints the new state. Off is `revoxelize when_moved`; on restores the last interval.",
        example: "dynamic on",
        run: Now(dynamic),
        ..VOXELS
    },
    Command {
        name: "vox_freq",
        usage: "[SECONDS]",
        count: (0, 1),
        summary: "Set the seconds between voxelizations while `dynamic` is on, or print them",
        details: "From 0.001 to 86400; 0 voxelizes at every frame. The default is 0.5.",
        example: "vox_freq 0.25",
        run: Now(period),
        ..VOXELS
    },
    Command {
        name: "revoxelize",
        usage: "[when_moved|when_asked|every SECONDS|every_frame]",
        count: (0, 2),
        takes: &[
            Takes::Word(&["when_moved", "when_asked", "every", "every_frame"]),
            Takes::Anything,
        ],
        summary: "Choose when moved triangles are voxelized again, or print it",
        details: "SECONDS is from 0.001 to 86400. Default: when_moved. Changed materials are always voxelized at once.",
        example: "revoxelize every 0.5",
        run: Now(revoxelize),
        ..VOXELS
    },
    Command {
        name: "grid_bounds",
        usage: "[auto|[auto] X,Y,Z X,Y,Z]",
        count: (0, 3),
        takes: &[Takes::Word(&["auto"]), Takes::Anything],
        summary: "Fit the voxel grid to a box, given by two corners in metres, or to the scene, or print the box",
        details: "`auto` is the present box of the scene, or starts with the given corners: objects that leave it \
                  widen it. A box without `auto` never changes; surfaces outside it have no voxels.",
        example: "grid_bounds -1,-1,-1 1,1,1",
        run: Now(grid_bounds),
        ..VOXELS
    },
    Command {
        name: "stats",
        aliases: &["info"],
        summary: "Print the numbers of triangles, voxels and frames, and the grid",
        example: "stats",
        run: Waits(|console, _| Box::pin(stats(console))),
        ..VOXELS
    },
    Command {
        name: "memory",
        summary: "Print the GPU memory by buffer",
        example: "memory",
        run: Waits(|console, _| Box::pin(memory(console))),
        ..VOXELS
    },
];

async fn memory(console: &mut Console) -> anyhow::Result<Reply> {
    console.update().await?;
    let memory = console.explorer.renderer().map(Renderer::memory).unwrap_or_default();
    let memory: Vec<MemoryReport> = memory.into_iter().map(Into::into).collect();
    Ok(Reply::say(memory_table(&memory).trim_end()))
}

fn voxels(renderer: &Renderer) -> String {
    let stats = renderer.voxel_stats();
    let voxels = counted(stats.voxels as usize, "voxel", "voxels");
    format!("{voxels} with {}", counted(stats.faces as usize, "face", "faces"))
}

/// Checks that the displayed level exists.
///
/// # Errors
/// When it does not.
pub fn check_level(explorer: &Explorer, settings: &RenderSettings) -> Result<(), Failure> {
    let Some(scene) = explorer.scene() else { return Ok(()) };
    let bounds = settings.grid_bounds.unwrap_or_else(|| scene.voxel_bounds());
    let grid = settings.grid(bounds, Vec3::ZERO);
    let most = grid.map_or(u32::MAX, |grid| settings.last_level(&grid));
    if settings.voxel_level <= most {
        return Ok(());
    }
    let (level, resolution) = (settings.voxel_level, settings.resolution);
    Err(Failure::input(format!(
        "level is a whole number from 0 to {most} with {resolution} voxels; got {level} (`level 0` shows the finest)"
    )))
}

fn in_words(revoxelize: Revoxelize) -> String {
    match revoxelize {
        Revoxelize::WhenMoved => "when_moved".to_owned(),
        Revoxelize::WhenAsked => "when_asked".to_owned(),
        Revoxelize::Every(seconds) => format!("every {seconds}"),
        Revoxelize::EveryFrame => "every_frame".to_owned(),
    }
}

/// The command that sets this policy.
pub fn revoxelize_line(revoxelize: Revoxelize) -> String {
    format!("revoxelize {}", in_words(revoxelize))
}

fn dynamic(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let now = console.explorer.revoxelize;
    let was_on = matches!(now, Revoxelize::Every(_) | Revoxelize::EveryFrame);
    let is_on = toggled(arguments, "dynamic", was_on)?;
    if is_on && !was_on {
        console.explorer.revoxelize = console.dynamic.unwrap_or(Revoxelize::Every(PERIOD_S));
    } else if was_on && !is_on {
        console.dynamic = Some(now);
        console.explorer.revoxelize = Revoxelize::WhenMoved;
    }
    let how = in_words(console.explorer.revoxelize);
    Ok(Reply::say(format!("dynamic {}: revoxelize {how}", on_or_off(is_on))))
}

fn period(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let Some(text) = arguments.first() else {
        let period_s = |revoxelize| match revoxelize {
            Revoxelize::Every(seconds) => Some(seconds),
            Revoxelize::EveryFrame => Some(0.0),
            Revoxelize::WhenMoved | Revoxelize::WhenAsked => None,
        };
        let seconds = period_s(console.explorer.revoxelize);
        let seconds = seconds.or_else(|| console.dynamic.and_then(period_s)).unwrap_or(PERIOD_S);
        return Ok(Reply::say(format!("vox_freq {seconds}")));
    };
    let what = "the time in seconds";
    let chosen = if number(text, what, 0.0..=LONGEST_S)? == 0.0 {
        Revoxelize::EveryFrame
    } else {
        Revoxelize::Every(number(text, what, PERIODS)?)
    };
    console.dynamic = Some(chosen);
    if matches!(console.explorer.revoxelize, Revoxelize::Every(_) | Revoxelize::EveryFrame) {
        console.explorer.revoxelize = chosen;
    }
    Ok(Reply::default())
}

fn revoxelize(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    const FORMS: &str = "when_moved, when_asked, every SECONDS or every_frame";
    console.explorer.revoxelize = match arguments {
        [] => return Ok(Reply::say(revoxelize_line(console.explorer.revoxelize))),
        ["when_moved"] => Revoxelize::WhenMoved,
        ["when_asked"] => Revoxelize::WhenAsked,
        ["every_frame"] => Revoxelize::EveryFrame,
        ["every", seconds] => Revoxelize::Every(number(seconds, "the time in seconds", PERIODS)?),
        words => return Err(wrong("revoxelize", FORMS, &words.join(" ")).into()),
    };
    Ok(Reply::default())
}

fn grid_bounds(console: &mut Console, arguments: &[&str]) -> anyhow::Result<Reply> {
    let scene = console.explorer.scene().ok_or_else(nothing_to_show)?;
    let bounds = match arguments {
        [] => {
            let bounds =
                console.explorer.settings().grid_bounds.unwrap_or_else(|| scene.voxel_bounds());
            return Ok(Reply::say(bounds_line(bounds, false)));
        }
        ["auto"] => scene.grid_bounds.is_none().then(|| scene.bounds()),
        ["auto", min, max] | [min, max] => {
            let what = "a corner in metres";
            let (min, max) = (vector(&[min], what, PLACE)?, vector(&[max], what, PLACE)?);
            if !min.cmple(max).all() || min == max {
                return Err(
                    Failure::input("the first corner must have the smaller coordinates").into()
                );
            }
            Some(Bounds { min, max })
        }
        words => {
            return Err(wrong("grid_bounds", "auto or two corners X,Y,Z", &words.join(" ")).into());
        }
    };
    console.change(|settings| settings.grid_bounds = bounds)?;
    console.explorer.set_grid_widens(arguments.first() == Some(&"auto"));
    Ok(Reply::default())
}

/// The command that sets this box.
pub fn bounds_line(bounds: Bounds, widens: bool) -> String {
    let auto = if widens { "auto " } else { "" };
    format!("grid_bounds {auto}{} {}", commas(bounds.min), commas(bounds.max))
}

async fn stats(console: &mut Console) -> anyhow::Result<Reply> {
    console.update().await?;
    let explorer = &console.explorer;
    let (Some(scene), Some(renderer)) = (explorer.scene(), explorer.renderer()) else {
        return Err(nothing_to_show().into());
    };
    let grid = renderer.gi().grid();
    let size: Vec3 = explorer.bounds().size();
    let shown = scene.shown().count();
    let settings = explorer.settings();
    let mut lines = vec![
        format!(
            "scene    {}: {}, {} of {} shown, {:.3} x {:.3} x {:.3} m",
            shown::line(&scene.name),
            counted(scene.triangle_count(), "triangle", "triangles"),
            shown,
            counted(scene.instances.len(), "object", "objects"),
            size.x,
            size.y,
            size.z
        ),
        format!(
            "voxels   {} in {}, {} levels",
            voxels(renderer),
            GridReport::new(grid).size(),
            grid.levels
        ),
        format!(
            "work     {} triangles given, {} walked over, {} left out, {} outside",
            count(renderer.voxel_stats().triangles),
            count(renderer.voxel_stats().walked),
            count(renderer.voxel_stats().skipped),
            count(renderer.voxel_stats().outside)
        ),
        format!(
            "picture  {}x{}, view {}, {} of {}",
            settings.size.x,
            settings.size.y,
            settings.view.name(),
            renderer.frame_count(),
            counted(settings.frames as usize, "frame", "frames")
        ),
        format!("GPU      {}", lumivox_render::describe(&explorer.gpu().adapter_info)),
    ];
    if let Some(geometry) = GeometryReport::new(renderer) {
        lines.insert(1, format!("geometry {}", geometry.line()));
    }
    if let Some(report) = OctreeReport::new(renderer.gi()) {
        lines.insert(2, report.line());
    }
    Ok(Reply::say(lines.join("\n")))
}
