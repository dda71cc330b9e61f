//! Light and objects that were added to a scene, and that a panorama can replace.

use std::ops::Range;

use lumivox_scene::{Light, Scene};

/// The added light and objects: the ground and the lights of a studio or of a clear day.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Staged {
    objects: Range<usize>,
    /// The names of the lights, since lights may be added and removed.
    lights: Vec<String>,
}

impl Staged {
    /// The additions to a scene whose file has this many `objects` and `lights`.
    pub fn of(scene: &Scene, (objects, lights): (usize, usize)) -> Self {
        let added = scene.lights.iter().skip(lights);
        Self {
            objects: objects..scene.instances.len(),
            lights: added.map(|light| light.name.clone()).collect(),
        }
    }

    /// The numbers of the added objects.
    pub fn objects(&self) -> Range<usize> {
        self.objects.clone()
    }

    /// Whether a light is one of the added ones.
    pub fn has_light(&self, light: &Light) -> bool {
        self.lights.contains(&light.name)
    }
}

#[cfg(test)]
mod tests {
    use lumivox_scene::{SightOptions, Staging, builtin};

    use super::*;

    #[test]
    fn staged_lights_and_objects_are_distinguished_from_own() {
        let mut scene = builtin::scene("cornell").unwrap();
        scene.lights.push(Light { name: "its own".to_owned(), ..Light::default() });
        let (objects, lights) = (scene.instances.len(), scene.lights.len());
        let own = scene.clone();
        scene.stage(&SightOptions { staging: Staging::Sky, ..SightOptions::default() });
        let staged = Staged::of(&scene, (objects, lights));
        assert!(!own.lights.iter().any(|light| staged.has_light(light)));
        assert_eq!(scene.lights.iter().filter(|light| staged.has_light(light)).count(), 1);
        assert_eq!(staged.objects(), objects..scene.instances.len());
        assert!(Staged::of(&own, (objects, lights)).objects().is_empty());
    }
}
