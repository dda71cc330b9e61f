//! A page's changes of a scene, with undo.

use std::sync::Arc;

use lumivox_scene::EnvironmentMap;

use crate::error::WebError;
use crate::listener::Listener;
use crate::session::{Session, no_scene, out_of_range};
use crate::types::{EnvironmentChange, EnvironmentInfo, Light, Material, MaterialChange};

impl Session {
    /// Changes the list of lights.
    ///
    /// # Errors
    /// The error of `edit`; then nothing has changed.
    pub fn edit_lights<T>(
        &mut self,
        edit: impl FnOnce(&mut Vec<lumivox_scene::Light>) -> Result<T, WebError>,
    ) -> Result<T, WebError> {
        let mut lights = self.console.explorer.scene().ok_or_else(no_scene)?.lights.clone();
        let result = edit(&mut lights)?;
        self.console.explorer.edit_lights(|scene| scene.lights = lights);
        self.note();
        Ok(result)
    }

    /// Changes a light.
    ///
    /// # Errors
    /// When there is no light of that number, or a value is out of range.
    pub fn set_light(&mut self, number: usize, light: &Light) -> Result<(), WebError> {
        self.edit_lights(|lights| {
            let count = lights.len();
            let place =
                lights.get_mut(number).ok_or_else(|| out_of_range("light", number, count))?;
            *place = light.to_scene()?;
            Ok(())
        })
    }

    /// Removes a light.
    ///
    /// # Errors
    /// When there is no light of that number.
    pub fn remove_light(&mut self, number: usize) -> Result<(), WebError> {
        self.edit_lights(|lights| {
            if number >= lights.len() {
                return Err(out_of_range("light", number, lights.len()));
            }
            lights.remove(number);
            Ok(())
        })
    }

    /// Hides an object, or shows it.
    ///
    /// # Errors
    /// When there is no object of that number.
    pub fn set_hidden(&mut self, object: usize, is_hidden: bool) -> Result<(), WebError> {
        let count = self.console.explorer.scene().ok_or_else(no_scene)?.instances.len();
        if object >= count {
            return Err(out_of_range("object", object, count));
        }
        self.console.explorer.set_hidden(object, is_hidden);
        self.note();
        Ok(())
    }

    /// The materials.
    ///
    /// # Errors
    /// When no scene is open.
    pub fn materials(&self) -> Result<Vec<Material>, WebError> {
        let scene = self.console.explorer.scene().ok_or_else(no_scene)?;
        Ok(scene.materials.iter().map(Material::from).collect())
    }

    /// Changes a material.
    ///
    /// # Errors
    /// When there is no material of that number, or a value is out of range.
    pub fn set_material(&mut self, number: usize, change: &MaterialChange) -> Result<(), WebError> {
        let materials = &self.console.explorer.scene().ok_or_else(no_scene)?.materials;
        let present = materials
            .get(number)
            .ok_or_else(|| out_of_range("material", number, materials.len()))?;
        let changed = change.of(present)?;
        self.console.explorer.edit_material(number, |material| *material = changed);
        self.note();
        Ok(())
    }

    /// The surroundings of the scene.
    ///
    /// # Errors
    /// When no scene is open.
    pub fn environment(&self) -> Result<EnvironmentInfo, WebError> {
        Ok((&self.console.explorer.scene().ok_or_else(no_scene)?.environment).into())
    }

    /// Changes the surroundings.
    ///
    /// # Errors
    /// When a value is out of range.
    pub fn set_environment(&mut self, change: &EnvironmentChange) -> Result<(), WebError> {
        let changed =
            change.of(&self.console.explorer.scene().ok_or_else(no_scene)?.environment)?;
        self.console.explorer.edit_lights(|scene| scene.environment = changed);
        self.note();
        Ok(())
    }

    /// Puts a panorama around the scene, in place of the earlier surroundings.
    ///
    /// # Errors
    /// When no scene is open.
    pub fn surround(&mut self, map: Arc<EnvironmentMap>) -> Result<EnvironmentInfo, WebError> {
        self.console.explorer.scene().ok_or_else(no_scene)?;
        let staged = self.staged.clone();
        for object in staged.objects() {
            self.console.explorer.set_hidden(object, true);
        }
        self.console.explorer.edit_lights(|scene| {
            scene.environment = map.into();
            scene.lights.retain(|light| !staged.has_light(light));
        });
        self.note();
        self.environment()
    }

    /// Undoes the last step, or redoes it; returns its description.
    ///
    /// # Errors
    /// When there is no step, or the device refuses.
    pub async fn step(&mut self, is_back: bool) -> Result<String, WebError> {
        self.show_view_of_left()?;
        let words =
            if is_back { self.console.explorer.undo()? } else { self.console.explorer.redo()? };
        self.view = self.console.explorer.settings().view;
        self.picker = None;
        self.follow_light();
        self.change();
        self.update(&Listener::new(None)).await?;
        Ok(words)
    }

    /// Starts a new step for the following changes.
    pub fn end_gesture(&mut self) {
        self.console.explorer.end_gesture();
    }

    /// Makes an undo step of the changes so far.
    fn note(&mut self) {
        self.console.explorer.note_change();
        self.picker = None;
        self.follow_light();
        self.change();
    }
}
