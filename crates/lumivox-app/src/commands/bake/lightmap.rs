//! A lightmap: the light on surfaces as an image.

use std::path::Path;

use lumivox_console::Failure;
use lumivox_console::report::AdapterReport;
use lumivox_render::lightmap::{Lightmap, LightmapPlan, Resolution};
use serde_json::{Value, json};

use super::{Bake, ending, write};
use crate::cli::BakeArgs;
use crate::host::Host;

/// Bakes, writes and reports.
pub(super) fn run(args: &BakeArgs, host: &Host) -> anyhow::Result<()> {
    let kind = ending(&args.output);
    if !["exr", "ktx2"].contains(&kind.as_str()) {
        let file = args.output.display();
        let reason = format!("{file}: unknown kind of file; end the name in .exr or .ktx2");
        return Err(Failure::input(reason).into());
    }
    let bake = Bake::prepare(args, host)?;
    bake.progress.set("looking around texels", 0, 1);
    let resolution = args.density.map_or(Resolution::Texels(args.size), Resolution::Density);
    let plan = LightmapPlan::new(&bake.scene, args.uv, resolution)
        .map_err(|error| Failure::input(format!("{}: {error}", args.scene.scene)))?;
    if plan.left_out() > 0 {
        tracing::warn!(
            "{} things that an animation moves have no part of the map",
            plan.left_out()
        );
    }
    let irradiance = bake.irradiance(plan.places(), args.direct)?;
    bake.progress.set("writing", 0, 1);
    let map = plan.map(&irradiance);
    let (bytes, intensity) = if kind == "exr" { (map.to_exr()?, 1.0) } else { map.to_ktx2() };
    write(&args.output, "lightmap", &bytes)?;
    let (seconds, adapter) = bake.figures();
    let Bake { scene, progress, .. } = bake;
    drop(progress);
    let report = Report {
        scene: &scene.name,
        file: &args.output,
        uv: args.uv,
        plan: &plan,
        map: &map,
        bytes: bytes.len(),
        intensity,
        seconds,
        adapter,
    };
    if args.json { host.print_json(&report.json()) } else { host.print(&report.text()) }
}

/// The figures of a lightmap.
struct Report<'a> {
    scene: &'a str,
    file: &'a Path,
    uv: u32,
    plan: &'a LightmapPlan,
    map: &'a Lightmap,
    bytes: usize,
    intensity: f32,
    seconds: f64,
    adapter: AdapterReport,
}

impl Report<'_> {
    fn json(&self) -> Value {
        let Self { plan, .. } = self;
        let seams = self.map.seams();
        let node = |node: &lumivox_render::lightmap::LightmapNode| {
            json!({
                "name": node.name,
                "instances": node.instances,
                "rect": node.rect,
                "texels_per_metre": node.texels_per_metre,
            })
        };
        json!({
            "scene": self.scene,
            "output": self.file.display().to_string(),
            "size": [plan.edge(), plan.edge()],
            "uv": self.uv,
            "covered": plan.covered(),
            "buried": plan.buried(),
            "left_out": plan.left_out(),
            "seams": { "edges": seams.edges, "before": seams.before, "after": seams.after },
            "bytes": self.bytes,
            "intensity": self.intensity,
            "nodes": plan.nodes().iter().map(node).collect::<Vec<_>>(),
            "seconds": self.seconds,
            "adapter": self.adapter,
        })
    }

    fn text(&self) -> String {
        let Self { plan, .. } = self;
        let (edge, seams) = (plan.edge(), self.map.seams());
        let mut text = format!(
            "{}: {edge} x {edge} texels, {} of them on surfaces, {} in solid things, {} KiB, {:.1} s\n",
            self.file.display(),
            plan.covered(),
            plan.buried(),
            self.bytes.div_ceil(1024),
            self.seconds,
        );
        if seams.edges > 0 {
            text += &format!(
                "{} seams: their sides differed by {:.1} %, now by {:.1} %\n",
                seams.edges,
                100.0 * seams.before,
                100.0 * seams.after
            );
        }
        if plan.is_packed() {
            text += &format!(
                "{} nodes share texture coordinates, so each has its own part of the map: `rect` in --json\n",
                plan.nodes().len()
            );
        }
        let name = self.file.file_name().unwrap_or_default().to_string_lossy();
        let [u0, v0, u1, v1] = plan.nodes().first().map_or([0.0, 0.0, 1.0, 1.0], |node| node.rect);
        text + &if ending(self.file) == "ktx2" {
            format!(
                "\nIn Bevy, on each mesh and its material:\n\n\
                 Lightmap {{ image: assets.load({name:?}), uv_rect: Rect::new({u0:?}, {v0:?}, {u1:?}, {v1:?}), ..default() }}\n\
                 StandardMaterial {{ lightmap_exposure: {:?}, ..default() }}\n",
                self.intensity
            )
        } else {
            let part = if plan.is_packed() {
                format!(
                    "lightMap.offset.set({u0:?}, {v0:?});\nlightMap.repeat.set({:?}, {:?});\n",
                    u1 - u0,
                    v1 - v0
                )
            } else {
                String::new()
            };
            format!(
                "\nIn three.js, for each mesh:\n\n\
                 const lightMap = await new EXRLoader().loadAsync({name:?});\n\
                 lightMap.flipY = true;\nlightMap.channel = {};\n{part}\
                 material.lightMap = lightMap;\nmaterial.lightMapIntensity = Math.PI;\n",
                self.uv
            )
        }
    }
}
