//! What runs beside the frames: reading scenes, and tracing references. Results come to the worker as orders.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::Sender;
use std::time::Instant;

use glam::UVec2;
use lumivox_console::{OpenedScene, SceneRequest};
use lumivox_render::reference::{PathTracer, ReferenceProgress, ReferenceSettings};
use lumivox_render::{Gpu, RenderSettings, ToneMap};
use lumivox_scene::{Camera, Environment, Instance, Light, Material, Scene};

use super::orders::Order;
use super::reload::Watched;
use crate::progress::{ProgressDisplay, ProgressReader};

/// A scene that is being read.
#[derive(Debug)]
pub struct Loading {
    /// Tells it from others.
    pub number: u64,
    /// How far it is.
    pub watch: ProgressReader,
    /// What is read.
    pub title: String,
    /// Whether it is the scene that is shown already.
    pub is_reload: bool,
    /// Hears of changes of its files.
    pub watched: Option<Watched>,
}

/// A scene that was read, or not.
#[derive(Debug)]
pub struct Loaded {
    /// As in [`Loading`].
    pub number: u64,
    /// The scene.
    pub result: anyhow::Result<OpenedScene>,
}

/// Reads a scene on a thread of its own. Loaders cannot be stopped; what nobody waits for any more is dropped when it
/// comes.
pub fn load(number: u64, opening: SceneRequest, is_reload: bool, orders: Sender<Order>) -> Loading {
    let progress = ProgressDisplay::silent("reading");
    let (watch, title) = (progress.watch(), opening.source.to_string());
    let work = move || {
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            crate::opening::load(opening, &progress)
        }));
        let result =
            result.unwrap_or_else(|_| Err(anyhow::anyhow!("the loader failed; see the terminal")));
        // Nobody waits when the window is closed.
        let _ = orders.send(Order::Loaded(Box::new(Loaded { number, result })));
    };
    std::thread::spawn(work);
    Loading { number, watch, title, is_reload, watched: None }
}

/// All that a reference depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceKey {
    camera: Camera,
    size: UVec2,
    samples: u32,
    instances: Vec<Instance>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    environment: Environment,
}

impl ReferenceKey {
    /// Of a scene as it is seen.
    pub fn new(scene: &Scene, camera: &Camera, settings: &RenderSettings, samples: u32) -> Self {
        Self {
            camera: camera.clone(),
            size: settings.size,
            samples,
            instances: scene.instances.clone(),
            materials: scene.materials.clone(),
            lights: scene.lights.clone(),
            environment: scene.environment.clone(),
        }
    }

    /// Whether it is that of a scene as it is seen in this size.
    pub fn is_of(&self, scene: &Scene, camera: &Camera, size: UVec2) -> bool {
        self.camera == *camera
            && self.size == size
            && self.instances == scene.instances
            && self.materials == scene.materials
            && self.lights == scene.lights
            && self.environment == scene.environment
    }
}

/// A reference on its way.
#[derive(Debug)]
pub struct Tracing {
    /// Of what.
    pub key: ReferenceKey,
    /// Tells it from others.
    pub number: u64,
    /// When it was begun.
    pub since: Instant,
    shared: Arc<Shared>,
    /// Whether all samples are there, or it failed.
    pub is_over: bool,
}

#[derive(Debug, Default)]
struct Shared {
    is_stopped: AtomicBool,
    /// Samples so far, in thousandths.
    samples: AtomicU32,
}

/// A reference so far.
#[derive(Debug)]
pub struct Reference {
    /// Width and height, px.
    pub size: UVec2,
    /// Radiance and coverage of each pixel.
    pub hdr: Vec<[f32; 4]>,
    /// Samples of each.
    pub samples: u32,
    /// The stops and the curve by which it is shown, once it is.
    pub shown: Option<(f32, ToneMap)>,
}

/// News of a reference.
#[derive(Debug)]
pub struct Traced {
    /// As in [`Tracing`].
    pub number: u64,
    /// What there is; an error where the device failed.
    pub result: anyhow::Result<Reference>,
    /// Whether it is the last.
    pub is_last: bool,
}

impl Tracing {
    /// Samples of each pixel so far.
    pub fn samples(&self) -> f32 {
        self.shared.samples.load(Ordering::Relaxed) as f32 / 1000.0
    }

    /// Samples in the end.
    pub fn total(&self) -> u32 {
        self.key.samples
    }
}

impl Drop for Tracing {
    fn drop(&mut self) {
        self.shared.is_stopped.store(true, Ordering::Relaxed);
    }
}

/// Traces a reference on a thread of its own, until it is dropped.
pub fn trace(
    number: u64,
    gpu: Gpu,
    scene: Scene,
    key: ReferenceKey,
    orders: Sender<Order>,
) -> Tracing {
    let shared = Arc::new(Shared::default());
    let since = Instant::now();
    let tracing =
        Tracing { key: key.clone(), number, since, shared: shared.clone(), is_over: false };
    std::thread::spawn(move || {
        let send = |result, is_last| {
            let _ = orders.send(Order::Traced(Box::new(Traced { number, result, is_last })));
        };
        if let Err(error) = trace_all(&gpu, &scene, &key, &shared, &send) {
            send(Err(error), true);
        }
    });
    tracing
}

fn trace_all(
    gpu: &Gpu,
    scene: &Scene,
    key: &ReferenceKey,
    shared: &Shared,
    send: &dyn Fn(anyhow::Result<Reference>, bool),
) -> anyhow::Result<()> {
    let settings =
        ReferenceSettings { size: key.size, samples: key.samples, ..ReferenceSettings::default() };
    let tracer = PathTracer::new(gpu, scene, Some(&key.camera), settings);
    let mut tracer = pollster::block_on(tracer)?;
    let is_stopped = || shared.is_stopped.load(Ordering::Relaxed);
    let mut hear = |step: ReferenceProgress| {
        shared.samples.store((step.samples * 1000.0) as u32, Ordering::Relaxed);
        if is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let mut shown = 0;
    loop {
        let goes_on = pollster::block_on(tracer.render_batch(&mut hear))?;
        if is_stopped() {
            return Ok(());
        }
        // A picture costs more than a batch of a small one: they come in growing intervals.
        let samples = tracer.samples();
        if !goes_on || samples >= shown + shown / 4 {
            shown = samples;
            let hdr = tracer.layers().picture();
            send(Ok(Reference { size: key.size, hdr, samples, shown: None }), !goes_on);
        }
        if !goes_on {
            return Ok(());
        }
    }
}
