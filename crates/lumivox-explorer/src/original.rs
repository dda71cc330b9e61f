//! The scene before it was changed: scripts that repeat the changes start from it.

use lumivox_scene::{Camera, Environment, Light, Material, Scene};

use crate::Explorer;

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

impl Explorer {
    /// Lights and materials of the scene when it was opened.
    pub fn original(&self) -> Option<&Original> {
        self.opened.as_ref().map(|opened| &opened.original)
    }

    /// Notes on the choices made when the scene was opened:
    /// [`PreparedScene::notes`](crate::PreparedScene::notes).
    pub fn notes(&self) -> &[lumivox_scene::Note] {
        self.opened.as_ref().map_or(&[], |opened| opened.notes())
    }

    /// The camera that the scene was opened with.
    pub fn original_camera(&self) -> Option<&Camera> {
        self.opened.as_ref().map(|opened| &opened.camera)
    }

    /// Camera 0 or 1 of the stored positions, as the scene has it.
    pub fn original_position(&self, number: usize) -> Option<Camera> {
        self.opened.as_ref().and_then(|opened| opened.positions().into_iter().nth(number)?)
    }
}
