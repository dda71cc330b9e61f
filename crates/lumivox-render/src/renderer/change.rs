//! Changes to a renderer's settings, scene and materials.
//!
//! Each change redoes only what depends on it, so that the picture afterwards is the one that a new
//! renderer would make. The mean over frames starts again if the picture changes.

use std::collections::HashSet;
use std::sync::Arc;

use lumivox::Voxelized;
use lumivox::gpu::Recorder;
use lumivox_scene::Scene;

use super::passes::Passes;
use super::prepare::{
    bind_lights, compile, environment_map, global_illumination, upload, voxelize,
};
use super::updates::Updates;
use super::{RenderProgress, Renderer, validate, validate_level};
use crate::look::LookScene;
use crate::parameters::{PARAMETERS, Redoes};
use crate::scene::{Lighting, radiance_unit_within, suits};
use crate::{Exposure, RenderError, RenderSettings, View};

/// The work that a change of settings requires, the most expensive first.
#[allow(clippy::struct_excessive_bools)] // One for each thing that is redone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Redo {
    /// The volume, the voxels and all passes linked against them.
    volume: bool,
    /// All textures of the picture's size.
    targets: bool,
    /// The light of the voxels, and the shadow maps.
    light: bool,
    /// The mean over frames.
    mean: bool,
}

impl Redo {
    /// Compares settings; `is_same_volume` is `true` if both have the same grid and the volume
    /// stores all cells that are shown.
    fn between(old: &RenderSettings, new: &RenderSettings, is_same_volume: bool) -> Self {
        let changed = PARAMETERS.iter().filter(|row| row.get(old) != row.get(new));
        let changed: HashSet<Redoes> = changed.map(|row| row.redoes).collect();
        // Another cone model needs other shaders; other values of the same model do not.
        let model = |settings: &RenderSettings| settings.cone_model.as_ref().map(|m| m.name());
        let are_same_hooks = old.voxelizer == new.voxelizer
            && old.injection == new.injection
            && old.octree_builder == new.octree_builder
            && model(old) == model(new);
        let volume = !is_same_volume || !are_same_hooks || changed.contains(&Redoes::Voxels);
        let targets = volume || changed.contains(&Redoes::Targets) || old.size != new.size;
        let light = volume
            || changed.contains(&Redoes::Light)
            || (new.cone_model.is_some() && changed.contains(&Redoes::MarchedLight))
            || old.cone_model != new.cone_model
            || (old.shown_look().is_some() && new.shown_look().is_none())
            || old.voxel_bounces() != new.voxel_bounces();
        let mean = targets
            || light
            || [Redoes::Frames, Redoes::MarchedLight].iter().any(|redo| changed.contains(redo))
            || old.look != new.look
            || old.beside != new.beside;
        Self { volume, targets, light, mean }
    }
}

impl Renderer {
    /// Changes the settings, and redoes what depends on the difference: a new size recreates
    /// textures, another resolution voxelizes again, another exposure only changes how frames are
    /// shown. `progress` is called with the stages `voxelize` and `light`.
    ///
    /// # Errors
    /// As [`Renderer::new`]. The renderer is then unchanged, except if a new volume did not fit in
    /// memory together with the old one.
    pub async fn set_settings(
        &mut self,
        settings: RenderSettings,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        if settings == self.settings {
            return Ok(());
        }
        validate(&settings, &self.gpu)?;
        if settings.geometry_budget != self.settings.geometry_budget {
            return Err(RenderError::Setting {
                name: "geometry_budget",
                value: "another one".to_owned(),
                expected: "the one that the renderer was made with: make a new renderer".to_owned(),
            });
        }
        let bounds = settings.grid_bounds.unwrap_or(self.scene_bounds);
        let grid = settings.grid(bounds, self.camera.position)?;
        validate_level(&settings, &grid)?;
        let lacks_cells = settings.shows_cells() && !self.gi.config().has_cells();
        let is_same_volume = grid == *self.gi.grid() && !lacks_cells;
        let redo = Redo::between(&self.settings, &settings, is_same_volume);
        // Resizing the picture keeps the light of earlier frames.
        let is_resized =
            RenderSettings { size: self.settings.size, ..settings.clone() } == self.settings;
        if redo.volume {
            let mut gi = global_illumination(&self.gpu, settings.gi_config(grid)).await?;
            let passes = Passes::new(&self.gpu, &gi, &self.scene, &settings)?;
            let targets = passes.targets(&self.gpu, &gi, &self.scene, &settings).await?;
            compile(&self.gpu, (&gi, &self.scene.geometry), &settings, progress).await?;
            progress(RenderProgress { stage: "voxelize", done: 0, total: 1 });
            let (geometry, timing) = (&self.scene.geometry, settings.timing);
            let voxelized = voxelize(&mut gi, geometry, timing, self.may_be_empty).await?;
            self.gpu.check("voxelizing")?;
            self.store_voxels(voxelized);
            (self.gi, self.passes, self.targets) = (gi, passes, targets);
            self.grid_bounds = bounds;
            self.scene.bounds = bounds.union(self.shown_bounds);
            // The look is linked against the old volume's library.
            self.look = None;
            progress(RenderProgress { stage: "voxelize", done: 1, total: 1 });
        } else {
            if redo.targets {
                let Self { gpu, gi, scene, passes, .. } = self;
                let mut targets = passes.targets(gpu, gi, scene, &settings).await?;
                if is_resized {
                    targets.view.take_past(&self.targets.view);
                }
                self.targets = targets;
            }
            if settings.shadows != self.settings.shadows {
                self.passes.set_shadows(&self.gpu, &self.scene, settings.shadows)?;
            }
            compile(&self.gpu, (&self.gi, &self.scene.geometry), &settings, progress).await?;
        }
        let was = std::mem::replace(&mut self.settings, settings);
        if let Some(model) = &self.settings.cone_model {
            self.gi.set_cone_values(model.values());
        }
        self.drop_look_of(&was);
        if let Some(pass) = self.targets.overlay.take_if(|_| !self.settings.overlay.is_on()) {
            self.targets.bytes -= pass.bytes;
        }
        self.prepare_view().await?;
        if redo.light {
            self.relight(progress).await?;
        }
        if redo.mean && !is_resized {
            // Start like a renderer created with these settings.
            self.targets.forget();
            self.start_like_new();
        }
        self.gpu.check("taking other settings")
    }

    /// Shows the same scene in another pose, under other lights, with other instances; the mean
    /// starts again. The camera does not change.
    ///
    /// Vertices and transforms are uploaded, voxelized and lit again; the voxels of static
    /// instances that have not changed are kept. Everything else is kept as well: pipelines,
    /// textures, targets, the grid and the unit of radiance. So a scene that moves out of the grid
    /// loses the part outside; set [`RenderSettings::grid_bounds`] to avoid that. `progress` is
    /// called with the stages `upload`, `voxelize` and `light`.
    ///
    /// # Errors
    /// When it is another scene, or has other materials; when no part of it is in the grid, when
    /// something does not fit the device, or when the device fails.
    pub async fn set_scene(
        &mut self,
        scene: &Scene,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        progress(RenderProgress { stage: "upload", done: 0, total: 1 });
        self.take_pose(scene)?;
        progress(RenderProgress { stage: "upload", done: 1, total: 1 });
        self.update(true, progress).await
    }

    /// Like [`Self::set_scene`], for a scene in which only the instances with the indices `moved`
    /// have moved: the cost is proportional to their number, not to the scene.
    ///
    /// # Errors
    /// As [`Self::set_scene`].
    pub async fn move_instances(
        &mut self,
        scene: &Scene,
        moved: &[usize],
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        progress(RenderProgress { stage: "upload", done: 0, total: 1 });
        self.take_moved(scene, moved)?;
        progress(RenderProgress { stage: "upload", done: 1, total: 1 });
        self.update(true, progress).await
    }

    /// Like [`Self::set_scene`], but voxels and their light are not updated until
    /// [`Self::revoxelize`]: only surfaces and the shadows on them move.
    ///
    /// # Errors
    /// As [`Self::set_scene`].
    pub async fn place(&mut self, scene: &Scene) -> Result<(), RenderError> {
        self.take_pose(scene)?;
        self.voxels_are_stale = true;
        let mut recorder = self.recorder();
        self.bind_lights(&mut recorder);
        self.times.add(recorder.finish().await?);
        self.gpu.check("uploading the scene")?;
        self.targets.accumulate.reset();
        Ok(())
    }

    /// Shows the same triangles with other materials, and applies all changes that
    /// [`Self::set_scene`] allows.
    ///
    /// Materials that refer to the same textures as before keep them; if any material refers to
    /// other textures, all textures are uploaded again. `progress` is called with the stages
    /// `upload`, `voxelize` and `light`.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub async fn set_materials(
        &mut self,
        scene: &Scene,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        progress(RenderProgress { stage: "upload", done: 0, total: 1 });
        let lighting = Lighting::of(scene);
        let unit = radiance_unit_within(self.grid_bounds, scene, &lighting);
        let is_same_unit = unit.to_bits() == self.scene.radiance_unit.to_bits();
        let was_tinted = self.scene.is_tinted();
        let keeps_textures = is_same_unit && self.scene.set_materials(&self.gpu, scene, &lighting);
        if !keeps_textures {
            let place = self.camera.position;
            self.scene = upload(&self.gpu, scene, &lighting, unit, &self.settings, place).await?;
            self.passes = Passes::new(&self.gpu, &self.gi, &self.scene, &self.settings)?;
        }
        if !keeps_textures || was_tinted != self.scene.is_tinted() {
            let Self { gpu, gi, scene, passes, settings, .. } = self;
            self.targets = passes.targets(gpu, gi, scene, settings).await?;
        }
        compile(&self.gpu, (&self.gi, &self.scene.geometry), &self.settings, progress).await?;
        self.look_scene = LookScene::of(scene);
        // The layout of materials may differ, too.
        self.look = None;
        self.take_pose(scene)?;
        self.changed(true);
        self.complete_updates(progress).await
    }

    /// Shows the same scene under other lights or surroundings; the mean starts again.
    /// `progress` is called with the stage `light`.
    ///
    /// # Errors
    /// When something does not fit the device, or the device fails.
    pub async fn set_lights(
        &mut self,
        scene: &Scene,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        let lighting = Lighting::of(scene);
        let (unit, bounds) = (self.scene.radiance_unit, self.grid_bounds);
        let is_suited = if self.settings.updates_by_frame() {
            // Keep the unit if a lamp is switched off: it may be switched on again.
            suits(unit, bounds, scene, &lighting)
        } else {
            radiance_unit_within(bounds, scene, &lighting).to_bits() == unit.to_bits()
        };
        if !is_suited {
            return self.set_materials(scene, progress).await;
        }
        self.take_lighting(scene)?;
        self.update(false, progress).await
    }

    /// Voxelizes everything again, including objects that are static or have not moved. The mean
    /// starts again if something has moved. `progress` is called with the stages `voxelize` and
    /// `light`.
    ///
    /// # Errors
    /// When something does not fit the device, or the device fails.
    pub async fn revoxelize(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        let were_stale = self.voxels_are_stale;
        self.scene.geometry.invalidate();
        self.updates.surfaces = true;
        self.complete_updates(progress).await?;
        if were_stale {
            self.targets.accumulate.reset();
        }
        Ok(())
    }

    /// Whether objects have moved but their voxels have not ([`Self::place`]).
    pub fn has_stale_voxels(&self) -> bool {
        self.voxels_are_stale && !self.updates.surfaces
    }

    /// Changes the view; the mean starts again. `voxel_level` is the level for views of voxels.
    ///
    /// # Errors
    /// [`RenderError::Setting`] when the level does not exist, or when the volume lacks the view's
    /// data.
    pub fn set_view(&mut self, view: View, voxel_level: u32) -> Result<(), RenderError> {
        let settings = RenderSettings { view, voxel_level, ..self.settings.clone() };
        validate_level(&settings, self.gi.grid())?;
        settings.validate(&self.gpu.device.limits())?;
        let was = std::mem::replace(&mut self.settings, settings);
        let was_lit =
            was.shown_look().is_none() && was.voxel_bounces() == self.settings.voxel_bounces();
        if self.settings.shown_look().is_none() && !was_lit {
            let mut recorder = Recorder::new(&self.gpu.device, &self.gpu.queue);
            let Self { settings, gi, lights, .. } = self;
            gi.light(&mut recorder, lights, settings.voxel_bounces(), &settings.trace)?;
            recorder.submit();
            self.gpu.check("lighting the voxels")?;
        }
        self.targets.accumulate.forget();
        Ok(())
    }

    /// Drops the look of the previous settings, unless it is still used.
    fn drop_look_of(&mut self, was: &RenderSettings) {
        if was.look_name() != self.settings.look_name() {
            self.look = None;
        }
        if self.settings.shown_look().is_some() {
            // A look does not update the volume's light.
            self.gi.forget_light();
        }
    }

    /// Changes the exposure of later pictures; the frames so far are kept.
    pub fn set_exposure(&mut self, exposure: Exposure) {
        self.settings.exposure = exposure;
    }

    /// Uploads the transforms of the instances with the indices `moved`, and the lights.
    pub(super) fn take_moved(&mut self, scene: &Scene, moved: &[usize]) -> Result<(), RenderError> {
        if self.scene.move_instances(&self.gpu, scene, moved) {
            self.take_places(scene)
        } else {
            self.take_pose(scene)
        }
    }

    /// Uploads moved geometry and the lights.
    pub(super) fn take_pose(&mut self, scene: &Scene) -> Result<(), RenderError> {
        self.scene.repose(&self.gpu, scene)?;
        self.passes.set_scene(&self.gpu, &self.scene)?;
        if let Some(look) = &mut self.look {
            look.set_scene(&self.look_scene);
        }
        self.take_places(scene)
    }

    /// Updates the bounds of the scene, and its lights.
    pub(super) fn take_places(&mut self, scene: &Scene) -> Result<(), RenderError> {
        self.shown_bounds = self.scene.bounds_of(scene);
        self.scene_bounds = scene.grid_bounds.unwrap_or(self.shown_bounds);
        self.scene.bounds = self.grid_bounds.union(self.shown_bounds);
        self.take_lighting(scene)?;
        self.gpu.check("uploading the scene")
    }

    /// Updates the lights and surroundings from a scene; a new map is uploaded.
    fn take_lighting(&mut self, scene: &Scene) -> Result<(), RenderError> {
        let lighting = Lighting::of(scene);
        let maps = [&lighting, &self.lighting].map(|lighting| lighting.environment.map.as_ref());
        if maps[0].map(Arc::as_ptr) != maps[1].map(Arc::as_ptr) {
            self.environment = environment_map(&self.gpu, &lighting)?;
        }
        // Update the look only for new lights: its white must not change when objects move.
        let is_new = lighting.lights != self.lighting.lights;
        self.lighting = lighting;
        if is_new {
            self.look_scene = LookScene::of(scene);
            if let Some(look) = &mut self.look {
                look.set_scene(&self.look_scene);
            }
        }
        Ok(())
    }

    pub(super) async fn voxelize(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        compile(&self.gpu, (&self.gi, &self.scene.geometry), &self.settings, progress).await?;
        progress(RenderProgress { stage: "voxelize", done: 0, total: 1 });
        let timing = self.settings.timing;
        let voxelized = self.gi.voxelize_dynamic(&self.scene.geometry, timing).await?;
        self.store_voxels(voxelized);
        self.gpu.check("voxelizing")?;
        progress(RenderProgress { stage: "voxelize", done: 1, total: 1 });
        Ok(())
    }

    pub(super) fn store_voxels(&mut self, voxelized: Voxelized) {
        self.voxels = voxelized.stats;
        self.voxels_are_stale = false;
        (self.updates.surfaces, self.updates.is_pending) = (false, false);
        self.times.add(voxelized.times);
    }

    /// Renders the shadow maps, and lights the voxels.
    pub(super) async fn relight(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<(), RenderError> {
        progress(RenderProgress { stage: "light", done: 0, total: 1 });
        let mut recorder = self.recorder();
        self.bind_lights(&mut recorder);
        let Self { gpu, settings, gi, look, .. } = self;
        if let Some(look) = look {
            look.relight();
        }
        if settings.shown_look().is_none() {
            recorder.stage("light");
            gi.light(&mut recorder, &self.lights, settings.voxel_bounces(), &settings.trace)?;
        }
        let Updates { surfaces, is_pending, .. } = self.updates;
        self.updates = Updates { surfaces, is_pending, ..Updates::default() };
        self.times.add(recorder.finish().await?);
        gpu.wait("lighting the voxels")?;
        progress(RenderProgress { stage: "light", done: 1, total: 1 });
        Ok(())
    }

    /// Renders the shadow maps and binds the lights.
    pub(super) fn bind_lights(&mut self, recorder: &mut Recorder) {
        self.mapped_grid = *self.gi.grid();
        (self.lights, self.near_shadows, self.shadow_bytes) = bind_lights(
            &self.gpu,
            recorder,
            self.passes.shadows.as_ref(),
            &self.scene,
            (&self.lighting, self.environment.as_ref()),
            &self.gi,
            &self.settings,
        );
    }

    pub(super) fn recorder(&self) -> Recorder<'static> {
        Recorder::with_timing(&self.gpu.device, &self.gpu.queue, self.settings.timing)
    }
}
