//! The rasterizer's ways from triangles to voxels, with the scenes and the twin of Lumivox's own
//! tests.

#[path = "../../../../lumivox/tests/it/voxelize/panels.rs"]
mod panels;
mod raster;
#[path = "../../../../lumivox/tests/it/voxelize/read.rs"]
mod read;
#[path = "../../../../lumivox/tests/it/voxelize/scenes.rs"]
mod scenes;
#[path = "../../../../lumivox/tests/it/voxelize/textures.rs"]
mod textures;
#[path = "../../../../lumivox/tests/it/voxelize/twin.rs"]
mod twin;
