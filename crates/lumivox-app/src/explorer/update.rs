//! Bringing the renderer up to date with what is asked for.

use lumivox_render::{Progress, RenderSettings, Renderer};

use super::{Explorer, Revoxelize};

/// What of the scene the renderer has not seen yet.
#[allow(clippy::struct_excessive_bools)] // One for each thing that may have changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Pending {
    /// Lights or surroundings.
    pub(super) lights: bool,
    /// Places of objects, or which are there.
    pub(super) objects: bool,
    /// Materials.
    pub(super) materials: bool,
    /// Voxels are to be made anew, whatever has changed.
    pub(super) voxels: bool,
    /// Objects have moved that the voxels have not followed.
    pub(super) stale_voxels: bool,
}

impl Explorer {
    /// Makes voxels anew at the next update.
    pub fn ask_for_voxels(&mut self) {
        self.pending.voxels = true;
    }

    /// Whether voxels stand where objects no longer are.
    pub fn has_stale_voxels(&self) -> bool {
        self.pending.stale_voxels
    }

    /// Brings the renderer up to date with all changes since the last call; without a scene, or with an empty one, there
    /// is nothing to bring. `tell` hears how far it is.
    ///
    /// # Errors
    /// When the renderer refuses. Settings that it refuses are those of before again.
    pub fn update(&mut self, tell: &mut dyn FnMut(Progress)) -> anyhow::Result<()> {
        let Some(opened) = &self.opened else { return Ok(()) };
        if opened.scene.shown().next().is_none() {
            self.renderer = None;
            return Ok(());
        }
        let pending = std::mem::take(&mut self.pending);
        self.fit_grid();
        pollster::block_on(self.bring(pending, tell))
    }

    async fn bring(
        &mut self,
        pending: Pending,
        tell: &mut dyn FnMut(Progress),
    ) -> anyhow::Result<()> {
        let Some(opened) = &self.opened else { return Ok(()) };
        let scene = &opened.scene;
        let Some(renderer) = &mut self.renderer else {
            // What is hidden or moved later must not change the grid: light would flicker.
            if scene.grid_bounds.is_none() && self.settings.grid_bounds.is_none() {
                self.settings.grid_bounds = Some(scene.bounds());
            }
            let (camera, settings) = (Some(&self.camera), self.settings.clone());
            self.renderer = Some(Renderer::new(&self.gpu, scene, camera, settings, tell).await?);
            return Ok(());
        };
        if *renderer.settings() != self.settings {
            let changed = renderer.set_settings(self.settings.clone(), tell).await;
            if let Err(error) = changed {
                self.settings = renderer.settings().clone();
                // What else was to be done comes with the next update.
                self.pending = pending;
                return Err(error.into());
            }
        }
        let follows = self.revoxelize == Revoxelize::WhenMoved || pending.voxels;
        if pending.materials {
            renderer.set_materials(scene, tell).await?;
        } else if pending.objects && follows {
            renderer.set_scene(scene, tell).await?;
        } else if pending.objects {
            renderer.place(scene).await?;
            self.pending.stale_voxels = true;
        } else if pending.lights {
            renderer.set_lights(scene, tell).await?;
        }
        if pending.voxels && !pending.objects && !pending.materials {
            renderer.revoxelize(tell).await?;
        }
        if !follows && !pending.materials {
            self.pending.stale_voxels |= pending.stale_voxels;
        }
        if *renderer.camera() != self.camera {
            renderer.set_camera(self.camera.clone());
        }
        Ok(())
    }

    /// Widens the grid if something has left it, unless the scene has one of its own; it does not follow what moves within, since light would flicker.
    fn fit_grid(&mut self) {
        let (Some(renderer), Some(scene)) = (&self.renderer, self.scene()) else { return };
        if scene.grid_bounds.is_some() {
            return;
        }
        let bounds = self.bounds();
        let grid = renderer.gi().grid();
        let (low, high) = (grid.origin_in_world, grid.max_in_world());
        if bounds.min.cmplt(low).any() || bounds.max.cmpgt(high).any() {
            let fitted = self.settings.grid_bounds.unwrap_or(bounds).union(bounds);
            self.settings = RenderSettings { grid_bounds: Some(fitted), ..self.settings.clone() };
        }
    }
}
