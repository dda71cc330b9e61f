//! The state of a page: an open scene, the canvas that shows it, and the right side of a split.

mod frames;

use glam::UVec2;
use lumivox_console::Console;
use lumivox_explorer::parameters::{PRESETS, find_preset};
use lumivox_explorer::{Explorer, ExposureMeter, LONGEST_BUDGET_MS};
use lumivox_render::{Gpu, GpuOptions, PresetChoice, RenderSettings, View};
use lumivox_scene::Picker;

use crate::beside::{Beside, Right};
use crate::browser::{Browser, Written};
use crate::error::WebError;
use crate::listener::Listener;
use crate::present::{Canvas, Presenter};
use crate::settings::{self, Settings};
use crate::staged::Staged;
use crate::types::{Camera, MemoryInfo, SceneInfo, Split};

/// Everything behind one canvas.
#[derive(Debug)]
pub struct Session {
    /// The console that runs a page's lines, with the explorer.
    pub(crate) console: Console,
    /// Files that the console has written.
    pub(crate) written: Written,
    pub(crate) presenter: Presenter,
    /// Width and height of the picture when nothing moves, px.
    full_size: UVec2,
    pub(crate) meter: ExposureMeter,
    /// The exposure of the last drawn picture, in stops.
    stops: f32,
    /// The view on the left. The explorer's view differs while the right side is rendered.
    pub(crate) view: View,
    pub(crate) beside: Option<Beside>,
    pub(crate) notes: Vec<String>,
    /// The surroundings that were added because the scene's file has none.
    pub(crate) staged: Staged,
    /// The triangles of the present scene; `None` before the first pick.
    pub(crate) picker: Option<Picker>,
    /// `true` if the scene's own emission is its only light.
    is_emission_alone: bool,
    /// The time of the last frame, ms.
    frame_ms: f64,
}

impl Session {
    /// A session for a canvas at its present size.
    ///
    /// # Errors
    /// When the browser has no device, or the canvas no context.
    pub async fn new(canvas: Canvas) -> Result<Self, WebError> {
        let gpu = Gpu::new(&GpuOptions::default()).await?;
        let presenter = Presenter::new(&gpu, canvas)?;
        let size = presenter.canvas().size().max(UVec2::ONE);
        let settings = RenderSettings { size, ..RenderSettings::default() };
        let view = settings.view;
        let explorer = Explorer::new(gpu, settings, PresetChoice::default());
        let written = Written::default();
        let console = Console::new(explorer, Box::new(Browser::new(written.clone())));
        Ok(Self {
            console,
            written,
            presenter,
            full_size: size,
            meter: ExposureMeter::default(),
            stops: 0.0,
            view,
            beside: None,
            notes: Vec::new(),
            staged: Staged::default(),
            picker: None,
            is_emission_alone: false,
            frame_ms: 0.0,
        })
    }

    /// The device.
    pub fn gpu(&self) -> &Gpu {
        self.console.explorer.gpu()
    }

    /// Continues with a new device after this one was lost.
    ///
    /// # Errors
    /// When the browser has no other device.
    pub async fn restore(&mut self, listener: &Listener) -> Result<(), WebError> {
        let gpu = Gpu::new(&GpuOptions::default()).await?;
        self.presenter = Presenter::new(&gpu, self.presenter.canvas().clone())?;
        self.console.explorer.set_gpu(gpu);
        self.start_again();
        // The right side has resources on the lost device.
        self.beside = self.beside.take().map(|beside| Beside::new(beside.right, beside.at));
        self.update(listener).await
    }

    /// The properties of the scene; `None` before one is opened.
    pub fn info(&self) -> Option<SceneInfo> {
        let scene = self.console.explorer.scene()?;
        let objects = self.console.explorer.object_names();
        let voxels = self.console.explorer.renderer().map(|renderer| renderer.voxel_stats().voxels);
        let camera = self.console.explorer.opened()?.camera();
        Some(SceneInfo::new(scene, camera, &objects, voxels, self.notes.clone()))
    }

    /// All settings by name.
    pub fn settings(&self) -> Settings {
        settings::all(&RenderSettings {
            view: self.view,
            ..self.console.explorer.settings().clone()
        })
    }

    /// Changes settings; those that are not named stay.
    ///
    /// # Errors
    /// When one is unknown, out of range or refused by the device; then nothing changes.
    pub async fn set(&mut self, changes: &Settings, listener: &Listener) -> Result<(), WebError> {
        let mut asked =
            RenderSettings { view: self.view, ..self.console.explorer.settings().clone() };
        settings::change(&mut asked, changes)?;
        self.take(asked, self.console.explorer.preset(), listener).await
    }

    /// Applies a preset; picture, view and resolution stay.
    ///
    /// # Errors
    /// As [`Self::set`].
    pub async fn set_preset(&mut self, name: &str, listener: &Listener) -> Result<(), WebError> {
        let Some(preset) = find_preset(name) else {
            let known: Vec<&str> = PRESETS.iter().map(|preset| preset.name()).collect();
            return Err(WebError::value(format!(
                "there is no preset \"{name}\"; there are {}",
                known.join(", ")
            )));
        };
        let asked = RenderSettings { view: self.view, ..self.console.explorer.settings_of(preset) };
        self.take(asked, preset, listener).await
    }

    async fn take(
        &mut self,
        asked: RenderSettings,
        preset: PresetChoice,
        listener: &Listener,
    ) -> Result<(), WebError> {
        let view = asked.view;
        let mut tell = tell_of(listener);
        // If the settings are refused, the explorer must keep the left side's view.
        self.start_again();
        self.show_view_of_left()?;
        self.console.explorer.try_settings(asked, preset, &mut tell).await?;
        self.console.explorer.note_change();
        self.view = view;
        Ok(())
    }

    /// Sets the explorer's view to that of the left side.
    pub(crate) fn show_view_of_left(&mut self) -> Result<(), WebError> {
        let settings =
            RenderSettings { view: self.view, ..self.console.explorer.settings().clone() };
        Ok(self.console.explorer.set_settings(settings)?)
    }

    /// Updates `is_emission_alone` from the scene.
    pub(crate) fn follow_light(&mut self) {
        self.is_emission_alone = self
            .console
            .explorer
            .scene()
            .is_some_and(lumivox_scene::Scene::is_lit_by_emission_alone);
    }

    /// Sets the size of canvas and picture, px.
    ///
    /// # Errors
    /// When the size is zero, or more than the device allows; then nothing changes.
    pub async fn resize(&mut self, size: UVec2, listener: &Listener) -> Result<(), WebError> {
        let picture = self.console.explorer.pacing.next_size(size);
        RenderSettings { size, ..self.console.explorer.settings().clone() }
            .validate(&self.gpu().device.limits())?;
        self.fit(picture, listener).await?;
        self.full_size = size;
        Ok(())
    }

    /// Sets canvas and picture to the size of the next frame, px.
    pub(crate) async fn fit(&mut self, size: UVec2, listener: &Listener) -> Result<(), WebError> {
        let explorer = &mut self.console.explorer;
        if explorer.settings().size != size {
            explorer.set_settings(RenderSettings { size, ..explorer.settings().clone() })?;
            explorer.update(&mut tell_of(listener)).await?;
            self.change();
        }
        if self.presenter.size() != size {
            self.presenter.resize(self.console.explorer.gpu(), size);
        }
        Ok(())
    }

    /// Adopts the picture's size if a command has changed it.
    pub(crate) fn follow_size(&mut self, before: UVec2) {
        let size = self.console.explorer.settings().size;
        if size != before {
            self.full_size = size;
            self.presenter.resize(self.console.explorer.gpu(), size);
        }
    }

    /// Width and height of the picture when nothing moves, px.
    pub(crate) fn full_size(&self) -> UVec2 {
        self.full_size
    }

    /// The camera of the picture.
    pub fn camera(&self) -> Camera {
        self.console.explorer.camera().into()
    }

    /// Moves the camera. While it `is_moving`, pictures may be coarser.
    ///
    /// # Errors
    /// When the camera has no direction.
    pub fn set_camera(&mut self, camera: &Camera, is_moving: bool) -> Result<(), WebError> {
        let camera = camera.to_scene(self.console.explorer.camera())?;
        if is_moving {
            self.console.explorer.pacing.camera_dragged();
        }
        if camera != *self.console.explorer.camera() {
            self.console.explorer.set_camera(camera);
            self.change();
        }
        Ok(())
    }

    /// Sets the milliseconds that a frame may take while something moves; 0: never coarser.
    ///
    /// # Errors
    /// When it is out of range.
    pub fn set_frame_budget(&mut self, budget_ms: f32) -> Result<(), WebError> {
        if !(0.0..=LONGEST_BUDGET_MS).contains(&budget_ms) {
            return Err(WebError::value(format!(
                "the frame budget is from 0 to {LONGEST_BUDGET_MS} ms; got {budget_ms}"
            )));
        }
        self.console.explorer.pacing.budget_ms = budget_ms;
        Ok(())
    }

    /// Plays the animation of this number, or stops.
    ///
    /// # Errors
    /// When there is no such animation.
    pub fn play(&mut self, animation: Option<usize>) -> Result<(), WebError> {
        let Some(number) = animation else {
            self.console.explorer.play(false);
            return Ok(());
        };
        let count = self.console.explorer.scene().ok_or_else(no_scene)?.animations().len();
        if number >= count {
            return Err(out_of_range("animation", number, count));
        }
        let choice = lumivox_scene::AnimationChoice::One(number);
        if self.console.explorer.playback().animation != Some(choice) {
            self.console.explorer.set_animation(choice)?;
        }
        self.console.explorer.play(true);
        self.picker = None;
        self.change();
        Ok(())
    }

    /// Shows a time of the animation, s.
    ///
    /// # Errors
    /// When it is negative.
    pub fn seek(&mut self, time_s: f32) -> Result<(), WebError> {
        if !(time_s >= 0.0 && time_s.is_finite()) {
            return Err(WebError::value(format!("the time is {time_s} s, but must be at least 0")));
        }
        self.console.explorer.seek(time_s)?;
        self.picker = None;
        self.change();
        Ok(())
    }

    /// Shows another view or the reference on the right, or nothing.
    ///
    /// # Errors
    /// When there is no such view, or the place is out of range.
    pub fn set_split(&mut self, split: Option<&Split>) -> Result<(), WebError> {
        let Some(split) = split else {
            self.beside = None;
            self.start_again();
            return Ok(());
        };
        let right = Right::named(split)?;
        if let Right::View(view) = right {
            let asked = RenderSettings { view, ..self.console.explorer.settings().clone() };
            asked.validate(&self.gpu().device.limits())?;
        }
        match &mut self.beside {
            Some(beside) if beside.right == right => beside.at = split.at,
            _ => {
                self.beside = Some(Beside::new(right, split.at));
                self.start_again();
            }
        }
        Ok(())
    }

    /// Resets metering, the right side and the reference.
    pub(crate) fn change(&mut self) {
        self.start_again();
        self.forget_truth();
    }

    /// Resets metering and the right side.
    fn start_again(&mut self) {
        self.meter.start_again();
        if let Some(beside) = &mut self.beside {
            beside.start_again();
        }
    }

    /// Discards the reference: scene or camera have changed.
    fn forget_truth(&mut self) {
        if let Some(beside) = &mut self.beside {
            beside.forget();
        }
    }

    /// Applies all changes, so that errors are thrown here and not at the next frame.
    pub(crate) async fn update(&mut self, listener: &Listener) -> Result<(), WebError> {
        Ok(self.console.explorer.update(&mut tell_of(listener)).await?)
    }

    /// GPU memory by use.
    pub fn memory(&self) -> Vec<MemoryInfo> {
        let memory = self.console.explorer.renderer().map(lumivox_render::Renderer::memory);
        memory.iter().flatten().map(MemoryInfo::from).collect()
    }

    /// The view on the left.
    pub(crate) fn view(&self) -> View {
        self.view
    }

    /// The exposure of the picture, in stops.
    pub(crate) fn stops(&self) -> f32 {
        self.meter.stops()
    }
}

impl Drop for Session {
    /// Destroys the device. Browsers keep a device, and everything on it, until they collect
    /// garbage.
    fn drop(&mut self) {
        self.gpu().device.destroy();
    }
}

/// Reports the renderer's progress to a page.
pub(crate) fn tell_of(listener: &Listener) -> impl FnMut(lumivox_render::RenderProgress) {
    let listener = listener.clone();
    move |step| listener.tell(step.stage, step.done.into(), step.total.into())
}

/// The error that no scene is open.
pub(crate) fn no_scene() -> WebError {
    WebError::value("no scene is open; call loadScene first")
}

/// The error that nothing has this number.
pub(crate) fn out_of_range(what: &str, number: usize, count: usize) -> WebError {
    let there_are = match count {
        0 => "there are none".to_owned(),
        count => format!("they are numbered from 0 to {}", count - 1),
    };
    WebError::value(format!("there is no {what} {number}; {there_are}"))
}
