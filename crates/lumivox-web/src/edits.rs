//! What a page changes of a scene, and what it asks where.

use std::sync::Arc;

use glam::Vec2;
use lumivox_scene::{Bounds, EnvironmentMap, Picker};

use crate::error::WebError;
use crate::session::{Session, no_scene, out_of_range};
use crate::types::{
    EnvironmentChange, EnvironmentInfo, Light, Material, MaterialChange, Picked, of_panorama,
};

impl Session {
    /// Changes the lights by their list.
    ///
    /// # Errors
    /// What `edit` has to say; then nothing has changed.
    pub fn edit_lights<T>(
        &mut self,
        edit: impl FnOnce(&mut Vec<lumivox_scene::Light>) -> Result<T, WebError>,
    ) -> Result<T, WebError> {
        let mut lights = self.explorer.scene().ok_or_else(no_scene)?.lights.clone();
        let result = edit(&mut lights)?;
        self.explorer.edit_lights(|scene| scene.lights = lights);
        self.change();
        Ok(result)
    }

    /// Changes one.
    ///
    /// # Errors
    /// When there is none of that number, or it cannot be so.
    pub fn set_light(&mut self, number: usize, light: &Light) -> Result<(), WebError> {
        self.edit_lights(|lights| {
            let count = lights.len();
            let place =
                lights.get_mut(number).ok_or_else(|| out_of_range("light", number, count))?;
            *place = light.to_scene(place.attenuation)?;
            Ok(())
        })
    }

    /// Removes one.
    ///
    /// # Errors
    /// When there is none of that number.
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
    /// When there is none of that number.
    pub fn set_hidden(&mut self, object: usize, is_hidden: bool) -> Result<(), WebError> {
        let count = self.explorer.scene().ok_or_else(no_scene)?.instances.len();
        if object >= count {
            return Err(out_of_range("object", object, count));
        }
        self.explorer.set_hidden(object, is_hidden);
        self.picker = None;
        self.change();
        Ok(())
    }

    /// The materials.
    ///
    /// # Errors
    /// Without a scene.
    pub fn materials(&self) -> Result<Vec<Material>, WebError> {
        let scene = self.explorer.scene().ok_or_else(no_scene)?;
        Ok(scene.materials.iter().map(Material::from).collect())
    }

    /// Changes one.
    ///
    /// # Errors
    /// When there is none of that number, or it cannot be so.
    pub fn set_material(&mut self, number: usize, change: &MaterialChange) -> Result<(), WebError> {
        let materials = &self.explorer.scene().ok_or_else(no_scene)?.materials;
        let present = materials
            .get(number)
            .ok_or_else(|| out_of_range("material", number, materials.len()))?;
        let changed = change.of(present)?;
        self.explorer.edit_material(number, |material| *material = changed);
        self.change();
        Ok(())
    }

    /// What is around the scene.
    ///
    /// # Errors
    /// Without a scene.
    pub fn environment(&self) -> Result<EnvironmentInfo, WebError> {
        Ok((&self.explorer.scene().ok_or_else(no_scene)?.environment).into())
    }

    /// Changes it.
    ///
    /// # Errors
    /// When it cannot be so.
    pub fn set_environment(&mut self, change: &EnvironmentChange) -> Result<(), WebError> {
        let changed = change.of(&self.explorer.scene().ok_or_else(no_scene)?.environment)?;
        self.explorer.edit_lights(|scene| scene.environment = changed);
        self.change();
        Ok(())
    }

    /// Puts a panorama around the scene, in the place of what was put around it before.
    ///
    /// # Errors
    /// Without a scene.
    pub fn surround(&mut self, map: Arc<EnvironmentMap>) -> Result<EnvironmentInfo, WebError> {
        self.explorer.scene().ok_or_else(no_scene)?;
        let staged = std::mem::take(&mut self.staged);
        for object in staged.objects() {
            self.explorer.set_hidden(object, true);
        }
        self.explorer.edit_lights(|scene| {
            scene.environment = of_panorama(map);
            scene.lights.retain(|light| !staged.has_light(light));
        });
        self.picker = None;
        self.change();
        self.environment()
    }

    /// What is at a place of the picture, from 0 to 1 from its upper left corner to its lower right one.
    ///
    /// # Errors
    /// When the place is outside, or there is no scene.
    pub fn pick(&mut self, at: Vec2) -> Result<Option<Picked>, WebError> {
        let is_inside = at.to_array().iter().all(|share| (0.0..=1.0).contains(share));
        if !is_inside {
            return Err(WebError::value(format!(
                "the place is {}, {}, but both must be from 0 to 1",
                at.x, at.y
            )));
        }
        let scene = self.explorer.scene().ok_or_else(no_scene)?;
        let picker = self.picker.get_or_insert_with(|| Picker::new(scene));
        let size = self.explorer.size();
        let (eye, direction) = self.explorer.camera().ray(at * size.as_vec2(), size);
        let Some(pick) = picker.pick(eye, direction) else { return Ok(None) };
        let Some(instance) = scene.instances.get(pick.instance) else { return Ok(None) };
        let mesh = scene.meshes.get(instance.mesh);
        let corners = mesh.iter().flat_map(|mesh| &mesh.positions);
        let place = instance.world_from_local;
        let bounds = Bounds::from_points(corners.map(|corner| place.transform_point3(*corner)));
        Ok(Some(Picked {
            object: pick.instance,
            material: instance.material,
            position: pick.position,
            normal: pick.normal,
            distance_m: pick.distance_m,
            bounds: bounds.into(),
        }))
    }
}
