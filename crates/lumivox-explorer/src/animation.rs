//! Playback of the scene's animations.

use lumivox_scene::{AnimationChoice, Camera, InstanceBounds, Places};
use web_time::Instant;

use crate::opened::PreparedScene;
use crate::{Explorer, ExplorerError};

/// The state of playback: which animation, and whether it runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Playback {
    /// The animation that plays; `None` if the scene has none.
    pub animation: Option<AnimationChoice>,
    /// Whether time advances.
    pub is_playing: bool,
    /// The time that is shown, s.
    pub time_s: f32,
    /// Whether a time was requested. Until then the scene has the pose of its file, which may not
    /// be its pose at any time.
    pub is_moved: bool,
    /// Length of the animation, after which it starts again, s.
    pub duration_s: f32,
}

impl Playback {
    pub(crate) fn of(opened: &PreparedScene) -> Self {
        let animations = opened.scene.animations();
        let first = animations.first();
        Self {
            animation: first.map(|_| AnimationChoice::One(0)),
            is_playing: false,
            is_moved: false,
            time_s: 0.0,
            duration_s: first.map_or(0.0, |animation| animation.duration_s),
        }
    }
}

impl Explorer {
    /// Returns the state of playback.
    pub fn playback(&self) -> Playback {
        self.playback
    }

    /// Starts or pauses the animation.
    pub fn play(&mut self, is_playing: bool) {
        self.playback.is_playing = is_playing && self.playback.animation.is_some();
        self.ticked = Instant::now();
    }

    /// Chooses the animation, and shows its start.
    ///
    /// # Errors
    /// When the scene has no such animation, or has no triangles left at its start.
    pub fn set_animation(&mut self, animation: AnimationChoice) -> Result<(), ExplorerError> {
        let Some(scene) = self.scene() else { return Ok(()) };
        let mut durations = scene.animations().into_iter().map(|a| a.duration_s);
        self.playback.duration_s = match animation {
            AnimationChoice::All => durations.fold(0.0, f32::max),
            AnimationChoice::One(number) => durations.nth(number).unwrap_or(0.0),
        };
        self.playback.animation = Some(animation);
        self.seek(0.0)
    }

    /// Shows a time, s; beyond the end the animation starts again. If the camera is one of the
    /// scene's, it is animated, too.
    ///
    /// # Errors
    /// When the scene has no triangles left at that time.
    pub fn seek(&mut self, time_s: f32) -> Result<(), ExplorerError> {
        let Playback { animation, duration_s, .. } = self.playback;
        let (Some(animation), Some(opened)) = (animation, &mut self.opened) else { return Ok(()) };
        // The end itself is shown, not the start.
        let is_within = time_s <= duration_s || duration_s <= 0.0;
        let time_s = if is_within { time_s } else { time_s.rem_euclid(duration_s) };
        let before = Places::of(&opened.scene);
        let followed = followed(&self.camera, &opened.scene.cameras);
        opened.scene.pose(animation, time_s)?;
        if let Some(number) = followed {
            let moved = &opened.scene.cameras[number];
            self.camera =
                Camera { vertical_fov_rad: self.camera.vertical_fov_rad, ..moved.clone() };
        }
        opened.posed = opened.scene.instances.iter().map(|i| i.world_from_local).collect();
        opened.apply_edits();
        self.playback.time_s = time_s;
        self.playback.is_moved = true;
        let moved = before.moved(&opened.scene);
        self.pending.lights |= moved.lights;
        if moved.shapes {
            self.boxes = InstanceBounds::of(&opened.scene);
            self.pending.shapes = true;
        }
        for object in moved.instances {
            self.note_moved(object);
        }
        Ok(())
    }

    /// Whether the camera is one of the scene's, and so moves with the animation.
    pub fn follows_camera(&self) -> bool {
        self.scene().is_some_and(|scene| followed(&self.camera, &scene.cameras).is_some())
    }

    /// Advances the animation if it plays.
    ///
    /// # Errors
    /// As [`Self::seek`].
    pub fn advance(&mut self, seconds: f32) -> Result<(), ExplorerError> {
        if self.playback.is_playing { self.seek(self.playback.time_s + seconds) } else { Ok(()) }
    }
}

/// The number of the scene's camera with this camera's name, position and direction. The angle of
/// view may differ, since a narrow window widens it.
fn followed(camera: &Camera, cameras: &[Camera]) -> Option<usize> {
    /// Rounding of a page's numbers, in m and of unit vectors.
    const ROUNDING: f32 = 1e-4;
    cameras.iter().position(|other| {
        other.name == camera.name
            && other.position.abs_diff_eq(camera.position, ROUNDING)
            && other.forward.abs_diff_eq(camera.forward, ROUNDING)
    })
}
