//! Publishing the model.

use std::sync::Arc;

use lumivox_render::{RenderSettings, Renderer};

use super::Worker;
use crate::window::model::{Model, voxel_model};

impl Worker {
    /// Publishes a new model.
    pub(super) fn publish(&mut self) {
        let jobs = self.job_models();
        let Self { session, messages, pictures, .. } = self;
        let scene = session.view.model(&self.console);
        session.selection.check(scene.as_deref());
        if let Some(names) = session.view.renew_names(&self.console) {
            messages.log.set_names(names);
        }
        let log = messages.log.snapshot();
        let explorer = &self.console.explorer;
        let settings = RenderSettings { size: pictures.full_size(), ..explorer.settings().clone() };
        let resolution = explorer.settings().resolution;
        let defaults = RenderSettings { resolution, ..Default::default() };
        let usual = defaults.with_preset(explorer.preset(), explorer.scene());
        let resolution = RenderSettings::default().resolution;
        let usual = RenderSettings { resolution, ..usual };
        let model = Model {
            history: [explorer.undoable(), explorer.redoable()].map(|step| step.map(str::to_owned)),
            histogram: pictures.meter.histogram(),
            scene,
            settings,
            usual,
            preset: explorer.preset(),
            camera: explorer.camera().clone(),
            has_position: [0, 1].map(|number| explorer.position(number).is_some()),
            playback: explorer.playback(),
            pacing: explorer.pacing,
            revoxelize: explorer.revoxelize,
            selected: session.selection.selected.clone(),
            opened: session.opened,
            cameras_done: session.cameras_done,
            selections: session.selection.changes,
            picked_at: session.selection.picked_at,
            comparand: pictures.comparand,
            voxels: voxel_model(explorer),
            memory: explorer.renderer().map(Renderer::memory).unwrap_or_default(),
            frames: Arc::new(pictures.times.frames()),
            figures: pictures.figures,
            frame_count: explorer.renderer().map_or(0, Renderer::frame_count),
            jobs,
            error: messages.error(),
            log,
            gpu: lumivox_render::describe(&explorer.gpu().adapter_info),
            names: session.view.names().clone(),
            lines_done: self.lines.done(),
            command_line: messages.command_line(),
        };
        self.publisher.publish(|published| {
            published.model = Arc::new(model);
            published.has_model = true;
        });
    }
}
