//! The classics against closed forms, definitions and Lumivox's own ways.

mod photons;
#[allow(dead_code)] // Lumivox's own tests use the rest.
#[path = "../../../lumivox/src/testing.rs"]
mod testing;
