//! The structs of this stage lie in memory alike in Rust and WGSL.

use lumivox_reflect::check_struct;

use super::VoxelFaces;
use super::batch::{ItemRun, SplitCounts, SplitParams};
use super::input::{DrawRecord, TexturePlace};
use super::union::{ResolveParams, Room, UnitedVoxel, Verdict};
use crate::voxels::FaceRecord;

#[test]
fn structs_lie_in_memory_alike() {
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
    check_struct::<Room>(library, "voxelize::verdict", "Room");
    check_struct::<Verdict>(library, "voxelize::verdict", "Verdict");
    // The sums of a face are stored in the place of the face's means.
    check_struct::<FaceRecord>(library, "voxelize::face_sums", "FaceSlot");
}
