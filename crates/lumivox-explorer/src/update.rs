//! Bringing the renderer up to date with the requested state.

use std::collections::BTreeSet;

use lumivox::GiError;
use lumivox_render::{RenderError, RenderProgress, Renderer};
use lumivox_scene::Scene;

use crate::{Explorer, ExplorerError, Revoxelize};

/// Changes of the scene that the renderer has not seen yet.
#[allow(clippy::struct_excessive_bools)] // One for each thing that may have changed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Pending {
    /// Whether lights or surroundings changed.
    pub(crate) lights: bool,
    /// Whether shapes of objects changed.
    pub(crate) shapes: bool,
    /// Objects that moved, or were hidden or shown.
    pub(crate) objects: BTreeSet<usize>,
    /// Whether materials changed.
    pub(crate) materials: bool,
    /// Whether voxels are made again even if nothing moved.
    pub(crate) voxels: bool,
}

impl Pending {
    /// Whether the picture changes. New voxels do not count, since they may be made every frame.
    fn changes_the_picture(&self) -> bool {
        self.lights || self.shapes || self.materials || !self.objects.is_empty()
    }
}

impl Explorer {
    /// Requests new voxels at the next update.
    pub fn ask_for_voxels(&mut self) {
        self.pending.voxels = true;
    }

    /// Requests new voxels if another policy has left stale ones.
    pub(crate) fn catch_up(&mut self) {
        let has_stale_voxels = self.renderer.as_ref().is_some_and(Renderer::has_stale_voxels);
        self.pending.voxels |= self.revoxelize == Revoxelize::WhenMoved && has_stale_voxels;
    }

    /// Brings the renderer up to date with all changes since the last call; does nothing without a
    /// scene, or with an empty one. `progress` is called at each step.
    ///
    /// # Errors
    /// When the renderer refuses. Refused settings are replaced by the previous ones.
    pub async fn update(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), ExplorerError> {
        let Some(opened) = &self.opened else { return Ok(()) };
        let has_grid = opened.scene.grid_bounds.is_some();
        if opened.scene.shown().next().is_none() && !has_grid {
            self.renderer = None;
            return Ok(());
        }
        self.fit_grid();
        self.bring(progress).await
    }

    async fn bring(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), ExplorerError> {
        let Some(opened) = &self.opened else { return Ok(()) };
        let scene = &opened.scene;
        // Another budget keeps other vertices on the GPU, so the renderer is made again.
        let budget = self.settings.geometry_budget;
        self.renderer.take_if(|renderer| renderer.settings().geometry_budget != budget);
        let Some(renderer) = &mut self.renderer else {
            // An object that is hidden or moved later must not change the grid: light would
            // flicker.
            if scene.grid_bounds.is_none() && self.settings.grid_bounds.is_none() {
                self.fitted = Some(self.boxes.all(scene));
                self.settings.grid_bounds = self.fitted;
            }
            let (camera, settings) = (Some(&self.camera), self.settings.clone());
            match Renderer::new(&self.gpu, scene, camera, settings, progress).await {
                Ok(renderer) => self.renderer = Some(renderer),
                Err(error) => {
                    self.settings = self.accepted.clone();
                    self.preset = self.accepted_preset;
                    self.history.refuse_settings();
                    return Err(error.into());
                }
            }
            self.pending = Pending::default();
            self.accept();
            return Ok(());
        };
        if *renderer.settings() != self.settings
            && let Err(error) = renderer.set_settings(self.settings.clone(), progress).await
        {
            let is_fitted = self.settings.grid_bounds == self.fitted;
            self.settings = renderer.settings().clone();
            self.preset = self.accepted_preset;
            self.history.refuse_settings();
            if is_fitted {
                self.fitted = self.settings.grid_bounds;
            }
            return Err(error.into());
        }
        self.accepted = self.settings.clone();
        self.accepted_preset = self.preset;
        self.history.accept();
        let pending = std::mem::take(&mut self.pending);
        if pending.changes_the_picture() || *renderer.camera() != self.camera {
            self.pacing.scene_changed();
        }
        if let Err(error) = show(renderer, scene, pending, self.revoxelize, progress).await {
            // The renderer may be in any state now: the next one is made from the present scene.
            self.renderer = None;
            let is_empty = matches!(error, RenderError::Gi(GiError::NothingToVoxelize { .. }));
            if is_empty && scene.grid_bounds.is_some() {
                return Box::pin(self.bring(progress)).await;
            }
            return Err(error.into());
        }
        if *renderer.camera() != self.camera {
            renderer.set_camera(self.camera.clone());
        }
        Ok(())
    }

    fn accept(&mut self) {
        self.accepted = self.settings.clone();
        self.accepted_preset = self.preset;
        self.history.accept();
    }

    /// Widens the grid if something has left it, unless the scene or the user set its box. Motion
    /// within it does not change the grid, since light would flicker.
    fn fit_grid(&mut self) {
        let (Some(renderer), Some(scene)) = (&self.renderer, self.scene()) else { return };
        let has_cascades = renderer.gi().grid().cascades.is_some();
        if scene.grid_bounds.is_some() || has_cascades || !self.has_fitted_grid() {
            return;
        }
        let bounds = self.bounds();
        let grid = renderer.gi().grid();
        let (low, high) = (grid.origin_in_world, grid.max_in_world());
        if bounds.min.cmplt(low).any() || bounds.max.cmpgt(high).any() {
            let fitted = self.settings.grid_bounds.unwrap_or(bounds).union(bounds);
            self.fit_grid_to(Some(fitted));
        }
    }
}

/// Applies the pending changes of the scene.
async fn show(
    renderer: &mut Renderer,
    scene: &Scene,
    pending: Pending,
    revoxelize: Revoxelize,
    progress: &mut dyn FnMut(RenderProgress),
) -> Result<(), RenderError> {
    let follows = revoxelize == Revoxelize::WhenMoved || pending.voxels;
    if pending.materials {
        return renderer.set_materials(scene, progress).await;
    }
    let has_moved = pending.shapes || !pending.objects.is_empty();
    if has_moved && follows {
        if pending.shapes {
            return renderer.set_scene(scene, progress).await;
        }
        let moved: Vec<usize> = pending.objects.into_iter().collect();
        return renderer.move_instances(scene, &moved, progress).await;
    }
    if has_moved {
        renderer.place(scene).await?;
    }
    if pending.lights {
        renderer.set_lights(scene, progress).await?;
    }
    if pending.voxels { renderer.revoxelize(progress).await } else { Ok(()) }
}
