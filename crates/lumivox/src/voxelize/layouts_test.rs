//! The structs of this stage lie in memory alike in Rust and WGSL.

use super::VoxelFaces;
use super::batch::{ItemRun, SplitCounts, SplitParams};
use super::input::{DrawRecord, TexturePlace};
use super::union::{ResolveParams, Room, UnitedVoxel, Verdict};
use crate::voxels::FaceRecord;

#[test]
fn structs_lie_in_memory_alike() {
    let library = crate::shaders::library();
    library.check_struct::<DrawRecord>("voxelize::triangles", "Draw").unwrap();
    library.check_struct::<TexturePlace>("voxelize::triangles", "TexturePlace").unwrap();
    library.check_struct::<SplitParams>("voxelize::split", "SplitParams").unwrap();
    library.check_struct::<SplitCounts>("voxelize::split", "SplitCounts").unwrap();
    library.check_struct::<ItemRun>("voxelize::items", "ItemRun").unwrap();
    library.check_struct::<VoxelFaces>("voxelize::faces", "VoxelFaces").unwrap();
    library.check_struct::<VoxelFaces>("voxelize::lobes", "AtomicVoxelFaces").unwrap();
    library.check_struct::<ResolveParams>("voxelize::resolve", "ResolveParams").unwrap();
    library.check_struct::<UnitedVoxel>("voxelize::unite", "UnitedVoxel").unwrap();
    library.check_struct::<Room>("voxelize::verdict", "Room").unwrap();
    library.check_struct::<Verdict>("voxelize::verdict", "Verdict").unwrap();
    // The sums of a face stand where the face's means will be.
    library.check_struct::<FaceRecord>("voxelize::face_sums", "FaceSlot").unwrap();
}
