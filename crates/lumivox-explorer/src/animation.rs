//! What a scene plays.

use lumivox_scene::{AnimationChoice, Instance, InstanceBounds};
use web_time::Instant;

use crate::opened::PreparedScene;
use crate::{Explorer, ExplorerError};

/// An animation that plays, or stands still.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Playback {
    /// What plays; `None` where nothing moves.
    pub animation: Option<AnimationChoice>,
    /// Whether time goes on.
    pub is_playing: bool,
    /// The moment that is shown, s.
    pub time_s: f32,
    /// Whether a moment was asked for: the scene as its file shows it need not be that of any time.
    pub is_moved: bool,
    /// When it starts again, s.
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
    /// What plays.
    pub fn playback(&self) -> Playback {
        self.playback
    }

    /// Starts or stops what plays.
    pub fn play(&mut self, is_playing: bool) {
        self.playback.is_playing = is_playing && self.playback.animation.is_some();
        self.ticked = Instant::now();
    }

    /// Chooses what plays, from its start.
    ///
    /// # Errors
    /// When the scene has no such animation, or nothing is left of it there.
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

    /// Shows a moment, s; beyond the end it starts again.
    ///
    /// # Errors
    /// When nothing of the scene is left at that time.
    pub fn seek(&mut self, time_s: f32) -> Result<(), ExplorerError> {
        let Playback { animation, duration_s, .. } = self.playback;
        let (Some(animation), Some(opened)) = (animation, &mut self.opened) else { return Ok(()) };
        // The end itself is shown.
        let is_within = time_s <= duration_s || duration_s <= 0.0;
        let time_s = if is_within { time_s } else { time_s.rem_euclid(duration_s) };
        let kind = |i: &Instance| (i.world_from_local, i.is_hidden, i.mesh);
        let before: Vec<_> = opened.scene.instances.iter().map(kind).collect();
        opened.scene.pose(animation, time_s)?;
        opened.posed = opened.scene.instances.iter().map(|i| i.world_from_local).collect();
        opened.apply_edits();
        self.playback.time_s = time_s;
        self.playback.is_moved = true;
        if opened.scene.is_deformed() || before.len() != opened.scene.instances.len() {
            self.boxes = InstanceBounds::of(&opened.scene);
            self.pending.shapes = true;
        } else {
            let after = opened.scene.instances.iter().map(kind);
            let moved = before.into_iter().zip(after).enumerate();
            let moved: Vec<usize> =
                moved.filter(|(_, (before, after))| before != after).map(|(i, _)| i).collect();
            for object in moved {
                self.note_moved(object);
            }
        }
        Ok(())
    }

    /// Lets time go on for what plays.
    ///
    /// # Errors
    /// As [`Self::seek`].
    pub fn advance(&mut self, seconds: f32) -> Result<(), ExplorerError> {
        if self.playback.is_playing { self.seek(self.playback.time_s + seconds) } else { Ok(()) }
    }
}
