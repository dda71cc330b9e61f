//! Another scene in the place of the last: decided how it is seen, shown coarsely at once, then as it was asked for.

use std::cell::OnceCell;

use glam::UVec2;
use lumivox_explorer::{Opened, first_look};
use lumivox_render::RenderSettings;
use lumivox_scene::SightOptions;

use crate::error::WebError;
use crate::exposing::Exposing;
use crate::listener::Listener;
use crate::load::Loaded;
use crate::session::{Session, no_scene, tell_of};
use crate::staged::Staged;
use crate::types::{SceneInfo, SceneOptions, of_panorama};

/// The first picture of a scene has so many times fewer pixels along each edge.
const COARSE_SIZE: u32 = 4;

impl Session {
    /// Shows another scene, unless it is cancelled before the last one has to go.
    ///
    /// # Errors
    /// When it does not fit, or the device fails. The last one is gone then: both at once need not fit.
    pub async fn open(
        &mut self,
        loaded: Loaded,
        asked: SceneOptions,
        listener: &Listener,
    ) -> Result<SceneInfo, WebError> {
        let Loaded { mut scene, panorama, notes } = loaded;
        if let Some(map) = panorama {
            scene.environment = of_panorama(map);
        }
        let before = (scene.instances.len(), scene.lights.len());
        let size = self.explorer.size();
        let aspect = size.x as f32 / size.y as f32;
        let framing = OnceCell::new();
        let camera = asked.standpoint(&scene, aspect, &framing)?;
        let options = SightOptions { camera, aspect, staging: asked.surroundings.into() };
        let mut tell = tell_of(listener);
        let opened = Opened::surveyed(scene, &options, &framing, &mut tell)?;
        let place = asked.camera.map(|camera| camera.to_scene(opened.camera())).transpose()?;
        listener.check().await?;
        self.staged = Staged::of(opened.scene(), before);
        self.notes.clone_from(&opened.scene().notes.warnings);
        self.notes.extend(notes);
        self.notes
            .extend(opened.notes().iter().map(|note| format!("{}: {}", note.about, note.text)));
        self.explorer.open(opened);
        if let Some(place) = place {
            self.explorer.set_camera(place);
        }
        self.exposing = Exposing::default();
        self.picker = None;
        self.follow_light();
        self.change();
        self.preview(listener).await?;
        self.update(listener).await?;
        self.info().ok_or_else(no_scene)
    }

    /// A first picture of few pixels and voxels, while what is asked for takes its time.
    async fn preview(&mut self, listener: &Listener) -> Result<(), WebError> {
        let asked = RenderSettings { view: self.view, ..self.explorer.settings().clone() };
        let coarse = RenderSettings {
            size: (asked.size / COARSE_SIZE).max(UVec2::ONE),
            ..first_look(&asked)
        };
        if !self.view.is_light() || self.explorer.set_settings(coarse).is_err() {
            return Ok(());
        }
        let shown = async {
            self.update(listener).await?;
            self.render_view(self.view).await?;
            let Some(picture) = self.explorer.screen_texture() else { return Ok(()) };
            self.presenter.show(self.explorer.gpu(), picture, None)
        };
        let shown = shown.await;
        self.explorer.set_settings(asked)?;
        self.exposing.start_again();
        shown
    }
}
