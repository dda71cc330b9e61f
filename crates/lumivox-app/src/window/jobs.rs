//! Background jobs: reading scenes, and tracing references.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::Instant;

use glam::UVec2;
use lumivox_console::{OpenedScene, SceneRequest};
use lumivox_render::reference::{PathTracer, ReferenceProgress, ReferenceSettings};
use lumivox_render::{Gpu, RenderSettings, ToneMap};
use lumivox_scene::{Camera, Environment, Instance, Light, Material, Scene};

use super::reload::Watched;
use crate::progress::{ProgressDisplay, ProgressReader};

/// A scene that is being read.
#[derive(Debug)]
pub struct Loading {
    /// The job's number.
    pub number: u64,
    /// Its progress.
    pub watch: ProgressReader,
    /// The scene's source.
    pub title: String,
    /// `true` if the scene is the one that is already shown.
    pub is_reload: bool,
    /// The watcher of the scene's files; `None` if they are not watched.
    pub watched: Option<Watched>,
}

/// The result of reading a scene.
#[derive(Debug)]
pub struct Loaded {
    /// The number of the job, as in [`Loading`].
    pub number: u64,
    /// The scene, or why it could not be read.
    pub result: anyhow::Result<OpenedScene>,
}

/// Reads a scene on its own thread, which calls `done` with the result. Loaders cannot be stopped:
/// a cancelled one still delivers its result, which is then dropped.
pub fn load(
    number: u64,
    opening: SceneRequest,
    is_reload: bool,
    done: impl FnOnce(Loaded) + Send + 'static,
) -> Loading {
    let progress = ProgressDisplay::silent("reading");
    let (watch, title) = (progress.watch(), opening.source.to_string());
    let work = move || {
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            crate::opening::load(opening, &progress)
        }));
        let result =
            result.unwrap_or_else(|_| Err(anyhow::anyhow!("the loader failed; see the terminal")));
        done(Loaded { number, result });
    };
    std::thread::spawn(work);
    Loading { number, watch, title, is_reload, watched: None }
}

/// Everything that a reference depends on.
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
    /// The key of a scene with its camera and settings.
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

    /// Whether the key matches this scene, camera and size.
    pub fn is_of(&self, scene: &Scene, camera: &Camera, size: UVec2) -> bool {
        self.camera == *camera
            && self.size == size
            && self.instances == scene.instances
            && self.materials == scene.materials
            && self.lights == scene.lights
            && self.environment == scene.environment
    }
}

/// A reference that is being traced.
#[derive(Debug)]
pub struct Tracing {
    /// The inputs of the reference.
    pub key: ReferenceKey,
    /// The job's number.
    pub number: u64,
    /// When tracing began.
    pub since: Instant,
    shared: Arc<Shared>,
    /// `true` if all samples are traced, or tracing failed.
    pub is_over: bool,
}

#[derive(Debug, Default)]
struct Shared {
    is_stopped: AtomicBool,
    /// Samples so far, in thousandths.
    samples: AtomicU32,
}

/// An intermediate or final reference.
#[derive(Debug)]
pub struct Reference {
    /// Width and height, px.
    pub size: UVec2,
    /// Radiance and coverage of each pixel.
    pub hdr: Vec<[f32; 4]>,
    /// Samples per pixel.
    pub samples: u32,
    /// Exposure in stops and tone curve with which the reference was last shown; `None` if never
    /// shown.
    pub shown: Option<(f32, ToneMap)>,
}

/// An intermediate or final result of tracing.
#[derive(Debug)]
pub struct Traced {
    /// The number of the job, as in [`Tracing`].
    pub number: u64,
    /// The reference so far, or why tracing failed.
    pub result: anyhow::Result<Reference>,
    /// `true` if no more results follow.
    pub is_last: bool,
}

impl Tracing {
    /// Samples per pixel so far.
    pub fn samples(&self) -> f32 {
        self.shared.samples.load(Ordering::Relaxed) as f32 / 1000.0
    }

    /// Samples per pixel when finished.
    pub fn total(&self) -> u32 {
        self.key.samples
    }
}

impl Drop for Tracing {
    fn drop(&mut self) {
        self.shared.is_stopped.store(true, Ordering::Relaxed);
    }
}

/// Traces a reference on its own thread, which calls `done` with each result, until the returned
/// [`Tracing`] is dropped.
pub fn trace(
    number: u64,
    gpu: Gpu,
    scene: Scene,
    key: ReferenceKey,
    done: impl Fn(Traced) + Send + 'static,
) -> Tracing {
    let shared = Arc::new(Shared::default());
    let since = Instant::now();
    let tracing =
        Tracing { key: key.clone(), number, since, shared: shared.clone(), is_over: false };
    std::thread::spawn(move || {
        let send = |result, is_last| done(Traced { number, result, is_last });
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
        // Reading back a small picture takes longer than a batch: send it at growing intervals.
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
