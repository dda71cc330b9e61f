//! Shared by examples and tests: an app without a window that makes frames and pictures on request,
//! and Lumivox's built-in scenes as entities.
#![allow(dead_code, reason = "every program uses another part of it")]

#[cfg(not(feature = "window"))]
pub mod headless;
pub mod run;
pub mod scene;
