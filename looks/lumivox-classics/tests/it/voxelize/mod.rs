//! The rasterizer's methods, with the scenes and the twin of Lumivox's own tests.

#[path = "../../../../../crates/lumivox/tests/it/voxelize/panels.rs"]
mod panels;
mod raster;
#[path = "../../../../../crates/lumivox/tests/it/voxelize/read.rs"]
mod read;
#[path = "../../../../../crates/lumivox/tests/it/voxelize/scenes.rs"]
mod scenes;
#[path = "../../../../../crates/lumivox/tests/it/voxelize/textures.rs"]
mod textures;
#[path = "../../../../../crates/lumivox/tests/it/voxelize/twin.rs"]
mod twin;
