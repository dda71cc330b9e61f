//! The structs of this stage have the same layout in Rust and WGSL.

use lumivox_reflect::check_struct;

use super::VoxelFaces;
use super::batch::{ItemRun, SplitCounts, SplitParams};
use super::input::{DrawRecord, TexturePlace};
use super::union::{Capacity, Needs, ResolveParams, UnitedVoxel};
use crate::voxels::FaceRecord;

#[test]
fn rust_and_wgsl_structs_have_the_same_layout() {
    let library = &crate::shaders::library();
    check_struct::<DrawRecord>(library, "voxelize::triangles", "Draw");
    check_struct::<TexturePlace>(library, "voxelize::triangles", "TexturePlace");
    check_struct::<SplitParams>(library, "voxelize::split", "SplitParams");
    check_struct::<SplitCounts>(library, "voxelize::split", "SplitCounts");
    check_struct::<ItemRun>(library, "voxelize::items", "ItemRun");
    check_struct::<VoxelFaces>(library, "voxelize::faces", "VoxelFaces");
    check_struct::<VoxelFaces>(library, "voxelize::planes", "AtomicVoxelFaces");
    check_struct::<ResolveParams>(library, "voxelize::resolve", "ResolveParams");
    check_struct::<UnitedVoxel>(library, "voxelize::unite", "UnitedVoxel");
    check_struct::<Capacity>(library, "voxelize::needs", "Capacity");
    check_struct::<Needs>(library, "voxelize::needs", "Needs");
    // The sums of a face are stored in the place of the face's means.
    check_struct::<FaceRecord>(library, "voxelize::face_sums", "FaceSlot");
}
