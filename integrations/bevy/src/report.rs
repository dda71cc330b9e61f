//! What the render world tells the app: messages, and a line in the log for each.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::platform::collections::HashSet;
use bevy::prelude::*;

/// What an app may want to know. Each is also a line in the log; limits are told once.
#[derive(Message, Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LumivoxEvent {
    /// Voxels of a volume are there. They light the pictures from now on, or, where they take the place of another volume, some
    /// frames later.
    Ready,
    /// A volume could not be made, or a frame not be recorded: the message says why and what would help. Until
    /// it is there, the camera's former volume lights it, or else Bevy's own ambient light.
    Failed {
        /// The error, with its remedy.
        error: String,
    },
    /// The device cannot run it.
    Unsupported {
        /// The feature or limit that is missing, and what helps.
        missing: String,
    },
    /// Meshes are left out of the voxels.
    MeshLeftOut {
        /// Why, and what would help.
        reason: String,
    },
    /// Light of a kind that voxels do not get.
    LightLeftOut {
        /// Its type.
        kind: &'static str,
    },
    /// In a browser something is drawn forward, and gets no indirect light: Bevy binds no irradiance volumes there. The voxels
    /// know it.
    ForwardNotLit,
}

/// Shared by both worlds.
#[derive(Resource, Clone, Default)]
pub(crate) struct Reports(Arc<Mutex<Told>>);

#[derive(Default)]
struct Told {
    waiting: Vec<LumivoxEvent>,
    last_failure: Option<LumivoxEvent>,
    once: HashSet<LumivoxEvent>,
}

impl Reports {
    /// Tells it, unless it is the failure that was told last: what fails in each frame is told once.
    pub(crate) fn tell(&self, event: LumivoxEvent) {
        let mut told = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let LumivoxEvent::Failed { .. } = event {
            if told.last_failure.as_ref() == Some(&event) {
                return;
            }
            told.last_failure = Some(event.clone());
        }
        told.waiting.push(event);
    }

    /// Tells it the first time.
    pub(crate) fn once(&self, event: LumivoxEvent) {
        let mut told = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if !told.once.contains(&event) {
            told.once.insert(event.clone());
            told.waiting.push(event);
        }
    }
}

impl LumivoxEvent {
    fn log(&self) {
        match self {
            Self::Ready => info!("Lumivox is ready."),
            Self::Failed { error } => error!("Lumivox: {error}"),
            Self::Unsupported { missing } => error!("Lumivox does not run here: {missing}"),
            Self::MeshLeftOut { reason } => {
                warn!("Lumivox leaves meshes out of the voxels: {reason}")
            }
            Self::LightLeftOut { kind } => {
                warn!(
                    "Lumivox gives no light of {kind} to the voxels: only its direct light is seen."
                );
            }
            Self::ForwardNotLit => warn!(
                "Lumivox lights no transparent things and forward materials in browsers: draw them deferred where they should be lit."
            ),
        }
    }
}

/// Hands to the app what the render world has told.
pub(crate) fn deliver(reports: Res<Reports>, mut messages: MessageWriter<LumivoxEvent>) {
    let mut told = reports.0.lock().unwrap_or_else(PoisonError::into_inner);
    for event in told.waiting.drain(..) {
        event.log();
        messages.write(event);
    }
}
