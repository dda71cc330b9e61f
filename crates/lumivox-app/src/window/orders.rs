//! Between the window and the worker: orders go there, and what is published comes back.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use glam::{UVec2, Vec2};
use lumivox_render::{Gpu, GpuId};
use lumivox_scene::Camera;

use super::jobs::{Loaded, Traced};
use super::lines::Line;
use super::model::{Doing, Job, JobModel, LightAt, LogKind, Model, Shown};

/// Wakes the window.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// A message to the worker.
#[derive(Debug)]
pub enum Order {
    /// Run this.
    Line(Line),
    /// The camera is being moved by hand, in the scene of this number.
    Camera(Camera, u64),
    /// There is room for a picture of this size, px.
    Size(UVec2),
    /// Choose what is at this place of the picture, as shares of its width and height.
    Pick(Vec2),
    /// Measure the light there.
    Probe(Vec2),
    /// Take times of stages, or not.
    Timed(bool),
    /// The window draws with this device.
    Device(GpuId),
    /// The window shows the pictures up to this number.
    Shown(u64),
    /// The user wants the command line that reproduces the picture.
    CommandLine,
    /// A scene was read.
    Loaded(Box<Loaded>),
    /// A reference has more samples.
    Traced(Box<Traced>),
    /// Files of the scene have changed.
    FilesChanged,
    /// Stop this, or all that is under way.
    Cancel(Option<Job>),
    /// The error was read.
    CloseError(u64),
    /// Something for the console from elsewhere.
    Say(LogKind, String),
    /// End.
    Quit,
}

/// State that the worker publishes for the window.
#[derive(Clone, Debug, Default)]
pub struct Published {
    /// The worker's device; `None` before it starts.
    pub gpu: Option<Gpu>,
    /// For the panels.
    pub model: Arc<Model>,
    /// The picture.
    pub picture: Option<Arc<Shown>>,
    /// The picture that it is compared with.
    pub other: Option<Arc<Shown>>,
    /// The light at a place of the picture.
    pub light: Option<LightAt>,
    /// The present work of the worker, and since when.
    pub doing: Option<Doing>,
    /// The next thing that the window itself has to do.
    pub request: Option<WindowRequest>,
    /// The worker has published a model.
    pub has_model: bool,
    /// The worker has ended, however that came.
    pub has_ended: bool,
}

/// Something that only the window can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindowRequest {
    /// Lose the device that it draws with.
    LoseDevice,
    /// Take all of the screen, or no longer.
    FullScreen,
}

/// The window's end of the worker.
#[derive(Clone, Debug, Default)]
pub struct Shared {
    published: Arc<Mutex<Published>>,
    /// The program is to end, or a command that takes long.
    stop: Arc<AtomicBool>,
}

impl Shared {
    /// The published state.
    pub fn get(&self) -> Published {
        let mut published = self.published.lock().unwrap_or_else(PoisonError::into_inner);
        let copy = published.clone();
        published.request = None;
        copy
    }

    /// The number of the newest picture that was published; 0 before there is one.
    pub fn newest(&self) -> u64 {
        let published = self.published.lock().unwrap_or_else(PoisonError::into_inner);
        let pictures = [&published.picture, &published.other].into_iter().flatten();
        pictures.map(|picture| picture.serial).max().unwrap_or(0)
    }

    /// Whether the worker has ended.
    pub fn has_ended(&self) -> bool {
        self.published.lock().unwrap_or_else(PoisonError::into_inner).has_ended
    }

    /// Breaks off a command that takes long. The order that says what is wanted follows: the worker
    /// cannot receive it before.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Whether that is wanted.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Commands may take long again.
    pub fn go_on(&self) {
        self.stop.store(false, Ordering::Relaxed);
    }

    /// Publishes something.
    pub fn change(&self, change: impl FnOnce(&mut Published)) {
        change(&mut self.published.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Published {
    /// Says what keeps the worker.
    pub fn under_way(&mut self, job: JobModel) {
        let mut model = (*self.model).clone();
        model.jobs = vec![job];
        self.model = Arc::new(model);
    }
}
