//! Renders views of a built-in scene to PNG files:
//! `cargo run --example views -- SCENE FOLDER [VIEW[,VIEW...]] [FRAMES] [RESOLUTION] [VOXEL_LEVEL]
//! [WIDTHxHEIGHT]`.

use std::path::PathBuf;

use lumivox::gpu::Timing;
use lumivox_render::{Gpu, GpuOptions, RenderSettings, Renderer, View};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let argument = |index: usize, default: &str| {
        arguments.get(index).cloned().unwrap_or_else(|| default.to_owned())
    };
    let scene_name = argument(0, "cornell");
    let folder = PathBuf::from(argument(1, "."));
    let wanted = argument(2, "final");
    let size = argument(6, "640x360");
    let (width, height) = size.split_once('x').ok_or("the size is WIDTHxHEIGHT")?;
    let base = RenderSettings {
        frames: argument(3, "16").parse()?,
        resolution: argument(4, "128").parse()?,
        size: (width.parse()?, height.parse()?).into(),
        timing: Timing::SubmitAndWait,
        ..RenderSettings::default()
    };
    let voxel_level = argument(5, "0").parse()?;
    pollster::block_on(async {
        let gpu = Gpu::new(&GpuOptions::default()).await?;
        println!("{}", lumivox_render::describe(&gpu.adapter_info));
        let scene = lumivox_scene::builtin::scene(&scene_name)?;
        let mut renderer = Renderer::new(&gpu, &scene, None, base, &mut |_| {}).await?;
        for view in View::ALL {
            if wanted != "all" && !wanted.split(',').any(|name| name == view.name()) {
                continue;
            }
            renderer.set_view(view, voxel_level)?;
            let picture = renderer.render(&mut |_| {}).await?;
            picture.write(&folder.join(format!("{scene_name}-{}.png", view.name())))?;
        }
        for time in renderer.times() {
            println!("{:>14} {:<34} {:>9.3?}", time.stage, time.pass, time.duration);
        }
        for used in renderer.memory() {
            println!("{:>32} {:>9.3} MiB", used.name, used.bytes as f64 / f64::from(1 << 20));
        }
        Ok(())
    })
}
