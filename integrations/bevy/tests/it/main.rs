//! Lumivox through Bevy, on the software GPU: pictures, changes and limits.

#[path = "../../examples/common/mod.rs"]
mod common;

mod baked;
mod changes;
mod deforming;
mod examples;
mod forward;
mod limits;
mod stage;
mod truth;
mod worlds;
