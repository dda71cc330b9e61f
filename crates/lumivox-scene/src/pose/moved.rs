//! The difference between two poses of a scene.

use glam::Mat4;

use crate::{Instance, Light, Scene};

/// The transforms of a scene's parts, for comparison with later ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Places {
    /// The transform of each instance, whether it is hidden, and its mesh.
    instances: Vec<(Mat4, bool, usize)>,
    lights: Vec<Light>,
}

/// The parts of a scene that have moved from one pose to another.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Moved {
    /// `true` if meshes or the list of instances may differ, so that everything must be checked
    /// again.
    pub shapes: bool,
    /// The numbers of the instances that differ, in order; empty if `shapes` is true.
    pub instances: Vec<usize>,
    /// `true` if any light differs.
    pub lights: bool,
}

impl Places {
    /// The current transforms of a scene's parts.
    pub fn of(scene: &Scene) -> Self {
        Self {
            instances: scene.instances.iter().map(place).collect(),
            lights: scene.lights.clone(),
        }
    }

    /// The parts of the same scene that have moved since then. Meshes that an animation deforms
    /// always count as moved.
    pub fn moved(&self, now: &Scene) -> Moved {
        let lights = self.lights != now.lights;
        if now.is_deformed() || self.instances.len() != now.instances.len() {
            return Moved { shapes: true, instances: Vec::new(), lights };
        }
        let pairs = self.instances.iter().zip(&now.instances).enumerate();
        let instances = pairs.filter(|(_, (before, now))| **before != place(now));
        Moved { shapes: false, instances: instances.map(|(number, _)| number).collect(), lights }
    }
}

fn place(instance: &Instance) -> (Mat4, bool, usize) {
    (instance.world_from_local, instance.is_hidden, instance.mesh)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn moved_reports_exactly_what_differs() {
        let rest = crate::builtin::scene("cornell").unwrap();
        let places = Places::of(&rest);
        assert_eq!(places.moved(&rest), Moved::default());
        let mut scene = rest.clone();
        scene.instances[2].world_from_local *= Mat4::from_translation(Vec3::X);
        scene.instances[4].is_hidden = true;
        assert_eq!(places.moved(&scene), Moved { instances: vec![2, 4], ..Moved::default() });
        let mut scene = rest.clone();
        scene.lights[0].position.x += 0.1;
        assert_eq!(places.moved(&scene), Moved { lights: true, ..Moved::default() });
        scene.instances.pop();
        assert_eq!(places.moved(&scene), Moved { shapes: true, lights: true, ..Moved::default() });
    }
}
