//! Lumivox through Bevy, on the software GPU: pictures and changes.

mod changes;
mod common;
mod stage;
mod truth;
