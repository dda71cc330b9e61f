//! A page's questions about the picture: the surface and the light at a place.

use glam::{UVec2, Vec2};
use lumivox_scene::{Bounds, Picker};

use crate::error::WebError;
use crate::session::{Session, no_scene};
use crate::types::{HistogramInfo, LightHere, Picked};

impl Session {
    /// The surface at a place of the picture, from (0, 0) in its upper left corner to (1, 1) in its
    /// lower right one.
    ///
    /// # Errors
    /// When the place is outside the picture, or no scene is open.
    pub fn pick(&mut self, at: Vec2) -> Result<Option<Picked>, WebError> {
        check(at)?;
        let scene = self.console.explorer.scene().ok_or_else(no_scene)?;
        let picker = self.picker.get_or_insert_with(|| Picker::new(scene));
        let size = self.console.explorer.settings().size;
        let (eye, direction) = self.console.explorer.camera().ray(at * size.as_vec2(), size);
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

    /// The light at a place of the picture; `None` with a split, in views without light, and before
    /// the first frame.
    ///
    /// # Errors
    /// When the place is outside the picture, or the device fails.
    pub async fn probe(&self, at: Vec2) -> Result<Option<LightHere>, WebError> {
        check(at)?;
        if self.beside.is_some() {
            return Ok(None);
        }
        let size = self.console.explorer.settings().size;
        let pixel = (at * size.as_vec2()).as_uvec2().min(size.saturating_sub(UVec2::ONE));
        let Some(renderer) = self.console.explorer.renderer() else { return Ok(None) };
        Ok(renderer.photometry(pixel).await?.map(LightHere::from))
    }

    /// The histogram of the picture when it was last exposed.
    pub fn histogram(&self) -> Option<HistogramInfo> {
        let (histogram, stops) = self.meter.histogram()?;
        Some(HistogramInfo::new(&histogram, stops))
    }
}

fn check(at: Vec2) -> Result<(), WebError> {
    if at.to_array().iter().all(|share| (0.0..=1.0).contains(share)) {
        return Ok(());
    }
    let Vec2 { x, y } = at;
    Err(WebError::value(format!("the place is {x}, {y}, but both must be from 0 to 1")))
}
