//! Tests of the public interface, in one program, so that shared shaders are linked and compiled
//! once.

mod cascades;
mod changes;
mod common;
mod determinism;
mod environment;
mod first_frames;
mod furnace;
mod lightmap;
mod mirrors;
mod moving;
mod octree;
mod overlay;
mod photometry;
mod pipelines;
mod render;
mod scale;
mod shown;
mod snapshots;
mod streaming;
mod surfaces;
mod temporal;
mod truth;
mod two_rooms;
