//! Opening another scene: choosing its view, showing it coarsely at once, then as requested.

use lumivox_console::values::camera::CameraChoice;
use lumivox_console::{SceneRequest, SceneSource};
use lumivox_explorer::{ExposureMeter, first_look};
use lumivox_render::RenderSettings;
use lumivox_scene::Scene;

use crate::error::WebError;
use crate::listener::Listener;
use crate::load::Loaded;
use crate::session::{Session, no_scene, tell_of};
use crate::staged::Staged;
use crate::types::{Camera, SceneInfo, SceneOptions};

impl Session {
    /// Shows another scene, unless loading is cancelled before the last scene is closed.
    ///
    /// # Errors
    /// When the scene does not fit, or the device fails. The last scene is closed then: both
    /// together might not fit.
    pub async fn open(
        &mut self,
        loaded: Loaded,
        asked: SceneOptions,
        listener: &Listener,
    ) -> Result<SceneInfo, WebError> {
        let Loaded { mut scene, name, panorama, notes } = loaded;
        if let Some(map) = panorama {
            scene.environment = map.into();
        }
        let mut opening = SceneRequest::plain(SceneSource::named(&name), self.aspect());
        opening.light.surroundings = Some(asked.surroundings.into());
        opening.camera = asked.from.map(|from| CameraChoice::Name(from.name().to_owned()));
        self.show_as(scene, opening, notes, Some(asked.camera), listener).await?;
        self.info().ok_or_else(no_scene)
    }

    /// Width over height of the picture.
    pub(crate) fn aspect(&self) -> f32 {
        let size = self.console.explorer.settings().size;
        size.x as f32 / size.y as f32
    }

    /// Shows a scene as requested. `Some(Some(camera))` sets the camera, `Some(None)` the scene's
    /// own; with `None` the console decides.
    ///
    /// # Errors
    /// As [`Self::open`].
    pub async fn show_as(
        &mut self,
        scene: Scene,
        opening: SceneRequest,
        notes: Vec<String>,
        place: Option<Option<Camera>>,
        listener: &Listener,
    ) -> Result<(), WebError> {
        let before = (scene.instances.len(), scene.lights.len());
        let scene = opening.prepare(scene, &mut tell_of(listener))?;
        let opened = &scene.prepared;
        let first = opened.camera().clone();
        let place = match place {
            None => None,
            Some(None) => Some(first),
            Some(Some(place)) => Some(place.to_scene(&first)?),
        };
        listener.check().await?;
        self.staged = Staged::of(opened.scene(), before);
        self.notes.clone_from(&opened.scene().notes.warnings);
        self.notes.extend(notes);
        self.notes
            .extend(opened.notes().iter().map(|note| format!("{}: {}", note.about, note.text)));
        self.console.open(scene);
        if let Some(place) = place {
            self.console.explorer.set_camera(place);
        }
        self.meter = ExposureMeter::default();
        self.console.explorer.pacing.scene_opened();
        self.picker = None;
        self.follow_light();
        self.change();
        let shown = self.preview(listener).await;
        self.console.explorer.pacing.first_shown();
        shown?;
        self.update(listener).await
    }

    /// Renders a first picture of few pixels and voxels, since the full one takes time.
    async fn preview(&mut self, listener: &Listener) -> Result<(), WebError> {
        let asked = RenderSettings { view: self.view, ..self.console.explorer.settings().clone() };
        let size = self.console.explorer.pacing.next_size(self.full_size());
        let coarse = RenderSettings { size, ..first_look(&asked, self.console.explorer.scene()) };
        if !self.view.is_light() || self.console.explorer.set_settings(coarse).is_err() {
            return Ok(());
        }
        let shown = async {
            self.update(listener).await?;
            self.render_view(self.view).await?;
            let Some(renderer) = self.console.explorer.renderer() else { return Ok(()) };
            self.presenter.show(self.console.explorer.gpu(), renderer.screen_texture(), None)
        };
        let shown = shown.await;
        self.console.explorer.set_settings(asked)?;
        shown
    }
}
