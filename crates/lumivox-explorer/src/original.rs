//! The scene before changes: scripts that repeat them start from it.

use lumivox_scene::{Environment, Light, Material, Scene};

/// Lights and materials of the scene when it was opened.
#[derive(Clone, Debug)]
pub struct Original {
    /// The lights.
    pub lights: Vec<Light>,
    /// The surroundings.
    pub environment: Environment,
    /// The materials.
    pub materials: Vec<Material>,
}

impl Original {
    pub(crate) fn of(scene: &Scene) -> Self {
        Self {
            lights: scene.lights.clone(),
            environment: scene.environment.clone(),
            materials: scene.materials.clone(),
        }
    }
}
