//! The selected object or light: its placement, and the camera around it.

use glam::Vec3;
use lumivox_console::quote;
use lumivox_explorer::Placement;
use lumivox_scene::{Bounds, Light};

use super::camera;
use super::gizmo::Mode;
use super::model::{Model, ObjectModel, SceneModel, Selected};
use super::outbox::Outbox;

/// Whether a light has a position.
pub fn is_lamp(light: &Light) -> bool {
    !light.kind.is_parallel()
}

/// The selected object.
pub fn object<'a>(scene: &'a SceneModel, outbox: &Outbox) -> Option<&'a ObjectModel> {
    let Some(Selected::Object(name)) = outbox.selected() else { return None };
    scene.objects.iter().find(|object| object.name == *name)
}

/// An object's pending placement, or else its current one.
pub fn placement(object: &ObjectModel, outbox: &Outbox) -> Placement {
    let Placement { position, rotation_deg, scale } = object.placement;
    // Matrices yield -0.0; adding zero gives 0.0.
    let [p, r, s] = [position, rotation_deg, scale].map(|v| v + Vec3::ZERO);
    let key = format!("place {}", quote(&object.name));
    let n = outbox.numbers(&key, [p.x, p.y, p.z, r.x, r.y, r.z, s.x, s.y, s.z]);
    Placement {
        position: Vec3::new(n[0], n[1], n[2]),
        rotation_deg: Vec3::new(n[3], n[4], n[5]),
        scale: Vec3::new(n[6], n[7], n[8]),
    }
}

/// Sends an object's new placement.
pub fn place(outbox: &mut Outbox, name: &str, placement: &Placement) {
    let Placement { position: p, rotation_deg: r, scale: s } = *placement;
    let key = format!("place {}", quote(name));
    let command =
        format!("{key} {} {} {} {} {} {} {} {} {}", p.x, p.y, p.z, r.x, r.y, r.z, s.x, s.y, s.z);
    outbox.set_numbers(&key, [p.x, p.y, p.z, r.x, r.y, r.z, s.x, s.y, s.z], command);
}

/// The placement and mode of the handles; `None` if the selection has none.
pub fn handles(scene: &SceneModel, mode: Mode, outbox: &Outbox) -> Option<(Placement, Mode)> {
    match outbox.selected()? {
        Selected::Object(_) => Some((placement(object(scene, outbox)?, outbox), mode)),
        Selected::Light(name) => {
            let (_, light) =
                scene.lights.iter().find(|(other, light)| other == name && is_lamp(light))?;
            let key = format!("light {} position", quote(name));
            let position = Vec3::from(outbox.numbers(&key, light.position.to_array()));
            Some((Placement { position, rotation_deg: Vec3::ZERO, scale: Vec3::ONE }, Mode::Move))
        }
    }
}

/// Sends the selection's new placement.
pub fn put(outbox: &mut Outbox, placement: &Placement) {
    match outbox.selected().cloned() {
        Some(Selected::Object(name)) => place(outbox, &name, placement),
        Some(Selected::Light(name)) => {
            let key = format!("light {} position", quote(&name));
            let [x, y, z] = placement.position.to_array();
            outbox.set_numbers(&key, [x, y, z], format!("{key} {x} {y} {z}"));
        }
        None => {}
    }
}

/// The point that the camera orbits.
pub fn pivot(model: &Model, outbox: &Outbox) -> Vec3 {
    let Some(scene) = &model.scene else { return Vec3::ZERO };
    let chosen = match (outbox.selected(), model.picked_at) {
        (None, _) => None,
        (Some(_), Some(at)) => Some(at),
        (Some(Selected::Object(_)), None) => {
            let bounds = object(scene, outbox).map(ObjectModel::bounds);
            bounds.filter(|bounds| !bounds.is_empty()).map(|bounds| bounds.center())
        }
        (Some(Selected::Light(name)), None) => {
            let light = scene.lights.iter().find(|(other, light)| other == name && is_lamp(light));
            light.map(|(_, light)| light.position)
        }
    };
    chosen.unwrap_or(scene.bounds.center())
}

/// Moves the camera so that the selection, or else the scene, fills the picture.
pub fn frame(model: &Model, outbox: &mut Outbox) {
    let Some(scene) = &model.scene else { return };
    let bounds = match outbox.selected() {
        Some(Selected::Object(_)) => object(scene, outbox).map(ObjectModel::bounds),
        Some(Selected::Light(name)) => {
            scene.lights.iter().find(|(other, _)| other == name).map(|(_, light)| {
                let reach = Vec3::splat(scene.bounds.radius_m() * 0.1);
                Bounds { min: light.position - reach, max: light.position + reach }
            })
        }
        None => None,
    };
    let bounds = bounds.unwrap_or(scene.bounds);
    if !bounds.is_empty() {
        let size = model.settings.size.as_vec2();
        outbox.move_camera(camera::frame(&outbox.camera(model), bounds, size.x / size.y));
    }
}
