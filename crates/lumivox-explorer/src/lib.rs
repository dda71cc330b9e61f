//! A scene that is viewed and changed while it is rendered: the core of consoles, scripts, windows
//! and pages.
//!
//! [`Explorer`] holds the state: the scene with all its changes, the camera, the settings. A change
//! only changes this state, and is cheap; [`Explorer::update`] then brings the renderer up to date
//! with all changes at once. A change that the renderer refuses is taken back, so the state can
//! always be shown.
//!
//! The crate knows no windows, files, command lines or threads, so it works in browsers, too.
//! Functions that wait for the GPU are `async`. Await them to their end: a change that is dropped
//! halfway may be lost. [`PreparedScene::new`] needs no GPU, so a scene can be prepared while
//! another is rendered.
//!
//! ```no_run
//! # async fn show() -> Result<(), Box<dyn std::error::Error>> {
//! use lumivox_explorer::{Explorer, PreparedScene};
//! use lumivox_render::{Gpu, GpuOptions, PresetChoice, RenderSettings};
//! use lumivox_scene::SightOptions;
//!
//! let gpu = Gpu::new(&GpuOptions::default()).await?;
//! let mut explorer = Explorer::new(gpu, RenderSettings::default(), PresetChoice::default());
//! let scene = lumivox_scene::builtin::scene("cornell")?;
//! explorer.open(PreparedScene::new(scene, &SightOptions::default(), &mut |_| {})?);
//! while explorer.frame(&mut |_| {}).await? {
//!     let Some(renderer) = explorer.renderer_mut() else { break };
//!     let stops = renderer.meter().await?.stops;
//!     let pixels = renderer.screen(stops).await?; // show them
//! }
//! explorer.set_hidden(0, true); // the picture starts again
//! # drop(explorer);
//! # Ok(())
//! # }
//! ```
//!
//! | file | is |
//! | --- | --- |
//! | `opened.rs` | a scene prepared for rendering |
//! | `objects.rs` | the instances of a scene: finding, moving and hiding them |
//! | `history.rs` | undo and redo |
//! | `names.rs` | unique names of objects, materials and lights |
//! | `suggest.rs` | suggestions for misspelled names |
//! | `original.rs` | the scene when it was opened |
//! | `animation.rs` | which animation plays |
//! | `clock.rs` | advancing the time of the scene |
//! | `update.rs` | bringing the renderer up to date |
//! | `frames.rs` | rendering frame by frame, and their times |
//! | `pacing.rs` | the size of the next picture |
//! | `metering.rs` | when the exposure is measured |
//! | `split.rs` | which of two pictures side by side is rendered next |
//! | `coalesce.rs` | changes that supersede each other while they wait |
//! | `live.rs` | only for interactive front ends: reading a scene again, times of stages |

#![cfg_attr(
    test,
    allow(clippy::unwrap_used, clippy::float_cmp, reason = "in a test a panic is the message")
)]

mod animation;
mod clock;
mod coalesce;
mod error;
mod frames;
mod history;
mod live;
mod metering;
mod names;
mod objects;
mod opened;
mod original;
mod pacing;
pub mod parameters;
mod split;
pub mod suggest;
mod update;

use std::collections::BTreeMap;

use glam::Vec3;
use lumivox_render::{Gpu, PresetChoice, RenderProgress, RenderSettings, Renderer};
use lumivox_scene::{Bounds, Camera, InstanceBounds, Scene};
use web_time::Instant;

pub use animation::Playback;
pub use coalesce::{ChangeQueue, Ticket};
pub use error::ExplorerError;
pub use frames::FrameTimes;
use history::{History, Key};
pub use metering::ExposureMeter;
pub use names::NotFound;
pub use objects::Placement;
pub use opened::{PreparedScene, first_look};
pub use original::Original;
pub use pacing::{FRAME_BUDGET_MS, LONGEST_BUDGET_MS, Pacing, REST};
pub use split::{Side, SplitSchedule};
use update::Pending;

/// When moved triangles are voxelized again.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Revoxelize {
    /// Whenever something has moved.
    #[default]
    WhenMoved,
    /// Only on request ([`Explorer::ask_for_voxels`]).
    WhenAsked,
    /// At this interval in seconds, moved or not.
    Every(f32),
    /// At every frame, moved or not.
    EveryFrame,
}

/// Requested settings, with the preset that they started from.
#[derive(Clone, Debug)]
pub struct RequestedSettings {
    /// The settings.
    pub settings: RenderSettings,
    preset: PresetChoice,
    fitted: Option<Bounds>,
}

/// A scene that is viewed and changed while it is rendered.
#[derive(Debug)]
pub struct Explorer {
    gpu: Gpu,
    opened: Option<PreparedScene>,
    /// The requested settings; [`Explorer::update`] applies them.
    settings: RenderSettings,
    preset: PresetChoice,
    /// The settings that the renderer accepted last, or the first ones; restored if it refuses
    /// others.
    accepted: RenderSettings,
    /// Their preset.
    accepted_preset: PresetChoice,
    /// The grid's box if it was fitted here, not set by a user; such a box widens.
    fitted: Option<Bounds>,
    camera: Camera,
    /// Two cameras to return to.
    positions: [Option<Camera>; 2],
    /// Further stored cameras, by name.
    stored: BTreeMap<String, Camera>,
    /// When voxels are made again.
    pub revoxelize: Revoxelize,
    /// Whether frames are rendered one by one, on demand. Default: no.
    pub is_single_frame: bool,
    /// Whether to wait for a frame at its end instead of at the start of the next. Default: yes.
    pub waits_for_gpu: bool,
    /// The sizes of pictures while something moves, for front ends that use it.
    pub pacing: Pacing,
    playback: Playback,
    renderer: Option<Renderer>,
    pending: Pending,
    /// The objects' present bounds.
    boxes: InstanceBounds,
    history: History,
    /// The times of the last frames.
    pub times: FrameTimes,
    /// Seconds since voxels were last made at an interval.
    since_voxels_s: f32,
    /// The last call of [`Explorer::tick_clock`], or the start of playback.
    ticked: Instant,
    generation: u32,
}

impl Explorer {
    /// Makes an explorer without a scene. The settings were made from `preset`.
    pub fn new(gpu: Gpu, settings: RenderSettings, preset: PresetChoice) -> Self {
        Self {
            gpu,
            opened: None,
            accepted: settings.clone(),
            accepted_preset: preset,
            fitted: None,
            settings,
            preset,
            camera: Camera::default(),
            positions: [None, None],
            stored: BTreeMap::new(),
            revoxelize: Revoxelize::default(),
            is_single_frame: false,
            waits_for_gpu: true,
            pacing: Pacing::default(),
            playback: Playback::default(),
            renderer: None,
            pending: Pending::default(),
            boxes: InstanceBounds::default(),
            history: History::default(),
            times: FrameTimes::default(),
            since_voxels_s: 0.0,
            ticked: Instant::now(),
            generation: 0,
        }
    }

    /// Shows another scene from its camera. Settings stay; cameras stored for the last scene are
    /// forgotten.
    pub fn open(&mut self, mut opened: PreparedScene) {
        self.camera = opened.camera.clone();
        self.positions = opened.positions();
        self.stored.clear();
        self.playback = Playback::of(&opened);
        self.fitted = opened.grid_bounds.take();
        let last = self.opened.as_ref().map(|last| &last.scene);
        for settings in [&mut self.settings, &mut self.accepted] {
            settings.grid_bounds = self.fitted;
            settings.show_other(last, &opened.scene);
        }
        self.boxes = InstanceBounds::of(&opened.scene);
        self.opened = Some(opened);
        self.generation += 1;
        self.since_voxels_s = 0.0;
        self.renderer = None;
        self.pending = Pending::default();
        self.history = History::default();
        self.times.clear();
    }

    /// Closes the scene: nothing is shown.
    pub fn close(&mut self) {
        self.opened = None;
        self.positions = [None, None];
        self.stored.clear();
        self.playback = Playback::default();
        self.settings.grid_bounds = None;
        self.accepted.grid_bounds = None;
        self.fitted = None;
        self.generation += 1;
        self.since_voxels_s = 0.0;
        self.renderer = None;
        self.pending = Pending::default();
        self.history = History::default();
        self.times.clear();
    }

    /// The scene with all changes; `None` before one was opened.
    pub fn scene(&self) -> Option<&Scene> {
        self.opened.as_ref().map(|opened| &opened.scene)
    }

    /// The open scene, with and without edits.
    pub fn opened(&self) -> Option<&PreparedScene> {
        self.opened.as_ref()
    }

    /// A number that rises whenever a scene is opened or closed.
    pub fn generation(&self) -> u32 {
        self.generation
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Continues on another device after this one was lost: everything is uploaded again.
    pub fn set_gpu(&mut self, gpu: Gpu) {
        self.gpu = gpu;
        self.renderer = None;
    }

    /// The requested settings; those of the renderer once [`Self::update`] succeeded.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// Requests other settings.
    ///
    /// # Errors
    /// When one is out of range; then nothing changes.
    pub fn set_settings(&mut self, settings: RenderSettings) -> Result<(), ExplorerError> {
        settings.validate(&self.gpu.device.limits())?;
        self.settings = settings;
        Ok(())
    }

    /// The preset that the settings started from.
    pub fn preset(&self) -> PresetChoice {
        self.preset
    }

    /// Requests settings on behalf of the user, as a step for [`Self::undo`].
    /// [`Self::set_settings`] is for temporary ones.
    ///
    /// # Errors
    /// As [`Self::set_settings`].
    pub fn choose_settings(
        &mut self,
        settings: RenderSettings,
        preset: PresetChoice,
    ) -> Result<(), ExplorerError> {
        settings.validate(&self.gpu.device.limits())?;
        self.keep(Key::Settings);
        self.settings = settings;
        self.preset = preset;
        Ok(())
    }

    /// Requests settings as [`Self::choose_settings`] does, and applies them at once as
    /// [`Self::confirm`] does.
    ///
    /// # Errors
    /// As [`Self::choose_settings`] and [`Self::update`].
    pub async fn try_settings(
        &mut self,
        settings: RenderSettings,
        preset: PresetChoice,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), ExplorerError> {
        let before = self.asked();
        self.choose_settings(settings, preset)?;
        self.confirm(before, progress).await
    }

    /// The requested settings, for [`Self::confirm`].
    pub fn asked(&self) -> RequestedSettings {
        RequestedSettings {
            settings: self.settings.clone(),
            preset: self.preset,
            fitted: self.fitted,
        }
    }

    /// Applies the requested settings at once. If the renderer refuses them, those of `before` are
    /// requested again, and nothing else is lost. Without a renderer they stay requested.
    ///
    /// # Errors
    /// As [`Self::update`].
    pub async fn confirm(
        &mut self,
        before: RequestedSettings,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), ExplorerError> {
        if self.renderer.is_none() {
            return Ok(());
        }
        let updated = self.update(progress).await;
        if updated.is_err() {
            RequestedSettings {
                settings: self.settings,
                preset: self.preset,
                fitted: self.fitted,
            } = before;
        }
        updated
    }

    /// Sets whether the grid's box widens for objects that leave it, as the first box does.
    pub fn set_grid_widens(&mut self, widens: bool) {
        self.fitted = self.settings.grid_bounds.filter(|_| widens);
    }

    fn fit_grid_to(&mut self, bounds: Option<Bounds>) {
        self.settings.grid_bounds = bounds;
        self.fitted = bounds;
    }

    /// Whether the grid's box widens for objects that leave it; it does not if a user has set it.
    pub fn has_fitted_grid(&self) -> bool {
        self.settings.grid_bounds == self.fitted
    }

    /// The settings of a preset with the present picture, view and resolution.
    pub fn settings_of(&self, preset: PresetChoice) -> RenderSettings {
        self.settings.with_preset(preset, self.scene())
    }

    /// The camera of the picture.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Moves the camera.
    pub fn set_camera(&mut self, camera: Camera) {
        self.camera = camera;
    }

    /// Stored camera 0 or 1.
    pub fn position(&self, number: usize) -> Option<&Camera> {
        self.positions.get(number)?.as_ref()
    }

    /// Stores the present camera as number 0 or 1.
    pub fn store_position(&mut self, number: usize) {
        if let Some(position) = self.positions.get_mut(number) {
            *position = Some(self.camera.clone());
        }
    }

    /// The cameras stored under names, sorted by name.
    pub fn stored_cameras(&self) -> impl Iterator<Item = (&str, &Camera)> {
        self.stored.iter().map(|(name, camera)| (name.as_str(), camera))
    }

    /// Stores the present camera under a name, in place of an earlier one of that name.
    ///
    /// # Errors
    /// [`ExplorerError::CameraName`] when the name is empty or belongs to a camera of the scene.
    pub fn store_camera(&mut self, name: &str) -> Result<(), ExplorerError> {
        let cameras = self.scene().map_or(&[][..], |scene| &scene.cameras);
        let problem = if name.trim().is_empty() {
            Some("it has no letter")
        } else if cameras.iter().any(|camera| camera.name == name) {
            Some("a camera of the scene has it")
        } else {
            None
        };
        if let Some(problem) = problem {
            return Err(ExplorerError::CameraName { name: name.to_owned(), problem });
        }
        let camera = Camera { name: name.to_owned(), ..self.camera.clone() };
        self.stored.insert(name.to_owned(), camera);
        Ok(())
    }

    /// The renderer; `None` before the first frame.
    pub fn renderer(&self) -> Option<&Renderer> {
        self.renderer.as_ref()
    }

    /// The renderer, for reading pictures and figures. Change scene, camera and settings only
    /// through the explorer: the next [`Self::update`] overwrites the renderer's camera and
    /// settings.
    pub fn renderer_mut(&mut self) -> Option<&mut Renderer> {
        self.renderer.as_mut()
    }

    /// Changes lights and surroundings of the scene.
    pub fn edit_lights(&mut self, edit: impl FnOnce(&mut Scene)) {
        self.keep(Key::Lights);
        self.keep(Key::Environment);
        if let Some(opened) = &mut self.opened {
            edit(&mut opened.scene);
            self.pending.lights = true;
        }
    }

    /// Changes a material; returns `false` if it does not exist.
    pub fn edit_material(
        &mut self,
        number: usize,
        edit: impl FnOnce(&mut lumivox_scene::Material),
    ) -> bool {
        self.keep(Key::Material(number));
        let scene = self.opened.as_mut().map(|opened| &mut opened.scene);
        let Some(material) = scene.and_then(|scene| scene.materials.get_mut(number)) else {
            return false;
        };
        edit(material);
        self.pending.materials = true;
        true
    }

    /// The box around the present scene.
    pub fn bounds(&self) -> Bounds {
        let nothing = Bounds { min: Vec3::ZERO, max: Vec3::ZERO };
        self.scene().map_or(nothing, |scene| self.boxes.all(scene))
    }
}

#[cfg(test)]
mod history_tests;
#[cfg(test)]
mod tests;
