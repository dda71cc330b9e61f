//! A dropped renderer frees its GPU resources, and a change frees those that it replaces.
//!
//! In a separate program, because resources are counted for the whole process.

#[allow(dead_code, unused_imports)] // The tests of `it` use the rest.
#[path = "it/common/mod.rs"]
mod common;

use std::ops::ControlFlow;

use common::{builtin, gpu, picture, renderer};
use glam::{UVec2, Vec3};
use lumivox::gpu::{LiveResources, Timing};
use lumivox::{Directionality, VolumeKind};
use lumivox_render::reference::{PathTracer, ReferenceSettings};
use lumivox_render::{
    Gpu, GpuOptions, Overlay, RenderSettings, Renderer, ShadowMethod, View, Wireframe, Wires,
};
use lumivox_scene::{Instance, Scene};

const NOTHING: LiveResources = LiveResources { buffers: 0, textures: 0, buffer_bytes: 0 };

fn small() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(48, 32),
        resolution: 24,
        shadow_resolution: 128,
        frames: 2,
        ..RenderSettings::default()
    }
}

/// Settings that create other resources, by the name of the change.
fn variants() -> Vec<(&'static str, RenderSettings)> {
    let octree = VolumeKind::Octree;
    let overlay = Overlay {
        wireframe: Wireframe::Over,
        wire_voxels: Wires::Over,
        grid_box: true,
        ..Overlay::default()
    };
    let half = lumivox::TraceResolution::Half;
    let trace = lumivox::TraceSettings { resolution: half, ..small().trace };
    vec![
        ("a larger picture", RenderSettings { size: UVec2::new(64, 40), ..small() }),
        ("cones at half resolution", RenderSettings { trace, ..small() }),
        ("an octree", RenderSettings { volume: octree, ..small() }),
        (
            "isotropic voxels",
            RenderSettings { directionality: Directionality::Isotropic, ..small() },
        ),
        ("three bounces", RenderSettings { bounces: 3, ..small() }),
        ("cone shadows", RenderSettings { shadows: ShadowMethod::Cone, ..small() }),
        ("finer shadows", RenderSettings { shadow_resolution: 256, ..small() }),
        ("times", RenderSettings { timing: Timing::SubmitAndWait, ..small() }),
        ("a view of voxels", RenderSettings { view: View::Voxels, ..small() }),
        ("wire voxels", RenderSettings { view: View::WireVoxels, ..small() }),
        ("an overlay", RenderSettings { overlay, ..small() }),
        // A volume keeps the cells that were created for a view; a new volume has none.
        ("more voxels", RenderSettings { resolution: 32, ..small() }),
        ("the first ones", small()),
    ]
}

/// The resources of a new renderer once it has rendered.
fn held_by_a_new_one(gpu: &Gpu, scene: &Scene, settings: &RenderSettings) -> LiveResources {
    let mut renderer = renderer(gpu, scene, settings.clone());
    picture(&mut renderer);
    LiveResources::now()
}

fn set(renderer: &mut Renderer, settings: &RenderSettings) {
    let mut ignore = |_| {};
    let change = renderer.set_settings(settings.clone(), &mut ignore);
    pollster::block_on(change).expect("other settings");
}

/// Bytes of the process in memory; `None` if the system does not report them.
fn resident_bytes() -> Option<u64> {
    let pages = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(4096 * pages.split(' ').nth(1)?.parse::<u64>().ok()?)
}

/// Drivers may leak memory for each draw: if uniforms decide branches, Mesa 22.3 leaks 10 MB per
/// frame of this scene, but only with the device features that the command line enables, not within
/// WebGPU's limits.
fn frames_leave_nothing_in_memory() {
    let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).expect("a GPU adapter");
    for view in [View::Final, View::Normal] {
        let settings = RenderSettings { view, frames: 128, ..small() };
        let mut renderer = renderer(&gpu, &builtin("atrium"), settings);
        let mut sizes = Vec::new();
        let mut step = |step: lumivox_render::RenderProgress| {
            sizes.extend((step.done >= 64).then(resident_bytes).flatten());
            ControlFlow::Continue(())
        };
        pollster::block_on(renderer.render_until(&mut step)).expect("a picture");
        if let (Some(first), Some(last)) = (sizes.first(), sizes.last()) {
            let grown = last.saturating_sub(*first);
            assert!(grown < 16 << 20, "{view:?}: {grown} bytes in 64 frames");
        }
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn renderers_and_changed_settings_leak_no_gpu_resources() {
    let gpu = gpu();
    for name in ["cornell", "spheres", "panel"] {
        let held = held_by_a_new_one(&gpu, &builtin(name), &small());
        assert!(held.buffers > 20 && held.textures > 10 && held.buffer_bytes > 1000, "{held:?}");
        assert_eq!(LiveResources::now(), NOTHING, "of {name}");
    }

    frames_leave_nothing_in_memory();
    assert_eq!(LiveResources::now(), NOTHING);

    let scene = builtin("cornell");
    let fresh: Vec<_> = variants()
        .iter()
        .map(|(name, settings)| {
            let held = held_by_a_new_one(&gpu, &scene, settings);
            assert_eq!(LiveResources::now(), NOTHING, "with {name}");
            held
        })
        .collect();
    // One renderer with all settings in turn.
    let mut changing = renderer(&gpu, &scene, small());
    picture(&mut changing);
    for ((name, settings), fresh) in variants().iter().zip(&fresh) {
        set(&mut changing, settings);
        picture(&mut changing);
        let now = LiveResources::now();
        assert_eq!(now.textures, fresh.textures, "after {name}");
        // Targets keep a uniform buffer once cones were traced.
        let buffers = fresh.buffers..=fresh.buffers + 1;
        assert!(buffers.contains(&now.buffers), "after {name} {now:?}, a new one has {fresh:?}");
        let spare = now.buffer_bytes.abs_diff(fresh.buffer_bytes);
        assert!(spare <= 80, "after {name} {now:?}, a new one has {fresh:?}");
    }
    let once = LiveResources::now();

    // Objects move; materials and lights change.
    let moved = |step: u8| {
        let mut scene = scene.clone();
        let shift = glam::Mat4::from_translation(Vec3::X * 0.01 * f32::from(step));
        let instance: &mut Instance = scene.instances.last_mut().expect("an instance");
        instance.world_from_local = shift * instance.world_from_local;
        scene
    };
    for step in 1..4 {
        let mut ignore = |_| {};
        pollster::block_on(changing.set_scene(&moved(step), &mut ignore)).expect("another pose");
        pollster::block_on(changing.set_lights(&moved(step), &mut ignore)).expect("lights");
        pollster::block_on(changing.set_materials(&moved(step), &mut ignore)).expect("materials");
        picture(&mut changing);
        let now = LiveResources::now();
        assert_eq!((now.buffers, now.textures), (once.buffers, once.textures), "step {step}");
    }
    // All resources of the device must be counted: uncounted ones would leak unnoticed.
    gpu.wait("rendering").expect("a device");
    let live = LiveResources::now();
    if let Some(allocated) = allocations(&gpu) {
        let names = format!("{live:?}: {allocated:?}");
        assert_eq!(allocated.len() as u64, live.buffers + live.textures, "{names}");
    }
    drop(changing);
    assert_eq!(LiveResources::now(), NOTHING);

    let settings =
        ReferenceSettings { size: UVec2::new(16, 12), samples: 16, ..Default::default() };
    let tracer = PathTracer::new(&gpu, &scene, None, settings);
    let mut tracer = pollster::block_on(tracer).expect("a path tracer");
    pollster::block_on(tracer.render(&mut |_| ControlFlow::Continue(()))).expect("a picture");
    assert!(LiveResources::now().buffers > 5);
    drop(tracer);
    assert_eq!(LiveResources::now(), NOTHING);
    gpu.wait("ending").expect("a device");
    assert_eq!(allocations(&gpu).unwrap_or_default(), [""; 0]);
    gpu.check("testing").expect("nothing was refused");
}

/// The names of all buffers and textures of the device, except wgpu's own, if it keeps a list
/// (Vulkan and DX12).
fn allocations(gpu: &Gpu) -> Option<Vec<String>> {
    let report = gpu.device.generate_allocator_report()?;
    let names = report.allocations.into_iter().map(|allocation| allocation.name);
    Some(names.filter(|name| !name.starts_with("(wgpu internal)")).collect())
}
