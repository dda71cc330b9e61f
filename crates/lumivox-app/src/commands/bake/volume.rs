//! A volume of indirect light at probes.

use std::path::Path;

use glam::Vec3;
use lumivox_console::Failure;
use lumivox_console::report::AdapterReport;
use lumivox_render::irradiance_volume::{DIRECTIONS, IrradianceVolume, ProbeGrid, buried};
use lumivox_scene::Scene;
use serde_json::{Value, json};

use super::{Bake, ending, write};
use crate::cli::BakeArgs;
use crate::host::Host;

/// The most probes of a volume.
const MOST: f64 = (1 << 18) as f64;
/// The longest edge of the texture, in texels, that every GPU supports.
const LONGEST: u32 = 2048;
/// Probes along the longest edge of a box if no spacing is given.
const CELLS: f32 = 24.0;
/// Margin around a whole scene's box of probes, as a share of its longest edge, so that the box
/// contains surfaces on its sides.
const MARGIN: f32 = 1e-3;

/// Bakes, writes and reports.
pub(super) fn run(args: &BakeArgs, host: &Host) -> anyhow::Result<()> {
    if ending(&args.output) != "ktx2" {
        let file = args.output.display();
        return Err(
            Failure::input(format!("{file}: unknown kind of file; end the name in .ktx2")).into()
        );
    }
    let bake = Bake::prepare(args, host)?;
    let grid = grid(&bake.scene, args)?;
    bake.progress.set("looking around probes", 0, 1);
    let probes = grid.probes();
    let buried = buried(&bake.scene, &probes);
    let places: Vec<(Vec3, Vec3)> =
        probes.iter().flat_map(|&probe| DIRECTIONS.map(|direction| (probe, direction))).collect();
    // Only indirect light: the renderer that uses the volume adds the direct light.
    let irradiance = bake.irradiance(&places, false)?;
    bake.progress.set("writing", 0, 1);
    let (sides, _) = irradiance.as_chunks::<6>();
    let volume = IrradianceVolume::new(grid, sides, &buried);
    let (bytes, intensity) = volume.to_ktx2();
    write(&args.output, "volume", &bytes)?;
    let (seconds, adapter) = bake.figures();
    let Bake { scene, progress, .. } = bake;
    drop(progress);
    let report = Report {
        scene: &scene.name,
        file: &args.output,
        grid,
        buried: buried.iter().filter(|is_buried| **is_buried).count(),
        bytes: bytes.len(),
        intensity,
        seconds,
        adapter,
    };
    if args.json { host.print_json(&report.json()) } else { host.print(&report.text()) }
}

/// The grid of probes that the arguments ask for.
fn grid(scene: &Scene, args: &BakeArgs) -> anyhow::Result<ProbeGrid> {
    let bounds = scene.bounds();
    let margin = MARGIN * (bounds.max - bounds.min).max_element();
    let (min, max) = args.corners.unwrap_or((bounds.min - margin, bounds.max + margin));
    let longest = (max - min).max_element();
    let spacing = args.spacing.unwrap_or(longest / CELLS);
    let cells = ((max - min) / spacing).round().max(Vec3::ONE);
    let count: f64 = cells.to_array().into_iter().map(f64::from).product();
    let refuse = |reason: String| -> anyhow::Error {
        Failure::input(format!(
            "--spacing {spacing}: {reason}; use a greater one, or a smaller --box"
        ))
        .into()
    };
    if count.is_nan() || count > MOST {
        return Err(refuse(format!(
            "the box would have {count:.0} probes, but at most {MOST} are baked"
        )));
    }
    let texels = (cells * Vec3::new(1.0, 2.0, 3.0)).as_uvec3();
    if texels.max_element() > LONGEST {
        return Err(refuse(format!(
            "the texture would have {} x {} x {} texels, but GPUs take {LONGEST} along an edge",
            texels.x, texels.y, texels.z
        )));
    }
    Ok(ProbeGrid::over(min, max, spacing))
}

/// The figures of a baked volume.
struct Report<'a> {
    scene: &'a str,
    file: &'a Path,
    grid: ProbeGrid,
    buried: usize,
    bytes: usize,
    intensity: f32,
    seconds: f64,
    adapter: AdapterReport,
}

impl Report<'_> {
    fn json(&self) -> Value {
        let ProbeGrid { size, cells, .. } = self.grid;
        json!({
            "scene": self.scene,
            "output": self.file.display().to_string(),
            "cells": cells.to_array(),
            "center_m": self.grid.center().to_array(),
            "size_m": size.to_array(),
            "probes": self.grid.count(),
            "buried": self.buried,
            "bytes": self.bytes,
            "intensity": self.intensity,
            "seconds": self.seconds,
            "adapter": self.adapter,
        })
    }

    fn text(&self) -> String {
        let ProbeGrid { size, cells, .. } = self.grid;
        // Round to tenths of millimetres, to hide rounding errors.
        let tidy = |place: Vec3| (place * 1e4).round() / 1e4;
        let (center, size) = (tidy(self.grid.center()), tidy(size));
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        format!(
            "{}: {} x {} x {} probes, {} of them in solid things, {} KiB, {:.1} s\n\n\
             In Bevy, where lights shine by themselves and the camera has no other indirect light:\n\n\
             commands.spawn((\n    IrradianceVolume {{\n        voxels: assets.load({name:?}),\n        \
             intensity: {:?},\n        ..default()\n    }},\n    Transform::from_xyz({:?}, {:?}, {:?}).with_scale(vec3({:?}, {:?}, {:?})),\n));\n",
            self.file.display(),
            cells.x,
            cells.y,
            cells.z,
            self.buried,
            self.bytes.div_ceil(1024),
            self.seconds,
            self.intensity,
            center.x,
            center.y,
            center.z,
            size.x,
            size.y,
            size.z,
        )
    }
}
