//! Communication of the window and the worker: orders to the worker, published state from it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use glam::{UVec2, Vec2};
use lumivox_render::{Gpu, GpuId};
use lumivox_scene::Camera;

use super::jobs::{Loaded, Traced};
use super::lines::Line;
use super::model::{Doing, Job, JobModel, LightAt, LogKind, Model};
use super::screen::Shown;

/// Wakes the window.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// A message to the worker.
#[derive(Debug)]
pub enum Order {
    /// Run this line.
    Line(Line),
    /// The user is moving the camera.
    Camera {
        /// The camera.
        camera: Camera,
        /// [`Model::opened`] of the camera's scene.
        scene: u64,
        /// The camera's number among the window's.
        number: u64,
    },
    /// Log this line, which sets the camera to where the user has moved it.
    CameraLine(String),
    /// Render pictures of this size, px.
    Size(UVec2),
    /// Select the object at this place of the picture, as shares of its width and height.
    Pick(Vec2),
    /// Measure the light at this place, as for `Pick`.
    Probe(Vec2),
    /// Measure stage times, or do not.
    Timed(bool),
    /// The window draws with this device.
    Device(GpuId),
    /// The window shows the pictures up to this number.
    Shown(u64),
    /// Publish the command line that reproduces the picture.
    CommandLine,
    /// A scene was read.
    Loaded(Box<Loaded>),
    /// A reference has more samples.
    Traced(Box<Traced>),
    /// Files of the scene have changed.
    FilesChanged,
    /// Cancel this job, or all jobs.
    Cancel(Option<Job>),
    /// Close the error of this number.
    CloseError(u64),
    /// Add this text to the console.
    Say(LogKind, String),
    /// End.
    Quit,
}

/// State that the worker publishes for the window.
#[derive(Clone, Debug, Default)]
pub struct Published {
    /// The worker's device; `None` before it starts.
    pub gpu: Option<Gpu>,
    /// The snapshot for the panels.
    pub model: Arc<Model>,
    /// The picture.
    pub picture: Option<Arc<Shown>>,
    /// The picture that `picture` is compared with.
    pub other: Option<Arc<Shown>>,
    /// The light at a place of the picture.
    pub light: Option<LightAt>,
    /// The worker's current activity; `None` if it is idle.
    pub doing: Option<Doing>,
    /// The next request to the window.
    pub request: Option<WindowRequest>,
    /// `true` once the worker has published a model.
    pub has_model: bool,
    /// `true` once the worker has ended, even by a panic.
    pub has_ended: bool,
}

/// A request that only the window can fulfil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindowRequest {
    /// Lose the window's device.
    LoseDevice,
    /// Toggle full screen.
    FullScreen,
}

/// State that the window and the worker share.
#[derive(Clone, Debug, Default)]
pub struct Shared {
    published: Arc<Mutex<Published>>,
    /// `true` if the running command is to stop.
    stop: Arc<AtomicBool>,
}

impl Shared {
    /// Returns the published state, and takes the request out of it.
    pub fn get(&self) -> Published {
        let mut published = self.published.lock().unwrap_or_else(PoisonError::into_inner);
        let copy = published.clone();
        published.request = None;
        copy
    }

    /// The number of the newest published picture; 0 before there is one.
    pub fn newest(&self) -> u64 {
        let published = self.published.lock().unwrap_or_else(PoisonError::into_inner);
        let pictures = [&published.picture, &published.other].into_iter().flatten();
        pictures.map(|picture| picture.serial).max().unwrap_or(0)
    }

    /// Whether the worker has ended.
    pub fn has_ended(&self) -> bool {
        self.published.lock().unwrap_or_else(PoisonError::into_inner).has_ended
    }

    /// Interrupts a long command. Send the order that needs this afterwards: the worker receives it
    /// once the command has stopped.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Whether the running command is to stop.
    pub fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Clears the request to stop.
    pub fn go_on(&self) {
        self.stop.store(false, Ordering::Relaxed);
    }

    /// Changes the published state.
    pub fn change(&self, change: impl FnOnce(&mut Published)) {
        change(&mut self.published.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Published {
    /// Shows `job` as the only job in progress.
    pub fn under_way(&mut self, job: JobModel) {
        let mut model = (*self.model).clone();
        model.jobs = vec![job];
        self.model = Arc::new(model);
    }
}
