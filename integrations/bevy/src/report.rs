//! Reports from the render world: each is a message to the app and a line in the log.

use std::sync::{Arc, Mutex, PoisonError};

use bevy::platform::collections::HashSet;
use bevy::prelude::*;

/// A report to the app, which is also written to the log. Limits are reported once.
#[derive(Message, Clone, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LumivoxEvent {
    /// The voxels of a volume are ready. They light the picture from now on, or some frames later
    /// if they replace another volume.
    Ready,
    /// A volume could not be made, or a frame could not be recorded. Until the volume is ready, the
    /// camera's previous volume or else Bevy's own ambient light lights it.
    Failed {
        /// The error, and what to do.
        error: String,
    },
    /// The device, or the format of an environment map, is not supported.
    Unsupported {
        /// The missing feature or limit, and what to do.
        missing: String,
    },
    /// Meshes are left out of the voxels.
    MeshLeftOut {
        /// The reason, and what to do.
        reason: String,
    },
    /// A kind of light that does not light the voxels.
    LightLeftOut {
        /// The light's type.
        kind: &'static str,
    },
    /// Something is drawn forward in a browser and gets no indirect light, since Bevy binds no
    /// irradiance volumes there. It is in the voxels nevertheless.
    ForwardNotLit,
}

/// Reports, shared by both worlds.
#[derive(Resource, Clone, Default)]
pub(crate) struct Reports(Arc<Mutex<Told>>);

#[derive(Default)]
struct Told {
    waiting: Vec<LumivoxEvent>,
    last_failure: Option<LumivoxEvent>,
    once: HashSet<LumivoxEvent>,
}

impl Reports {
    /// Sends a report unless it repeats the last failure: what fails every frame is reported once.
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

    /// Sends a report the first time only.
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

/// Delivers the render world's reports to the app.
pub(crate) fn deliver(reports: Res<Reports>, mut messages: MessageWriter<LumivoxEvent>) {
    let mut told = reports.0.lock().unwrap_or_else(PoisonError::into_inner);
    for event in told.waiting.drain(..) {
        event.log();
        messages.write(event);
    }
}
