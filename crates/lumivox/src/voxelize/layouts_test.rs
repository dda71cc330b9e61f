//! The structs of this stage lie in memory alike in Rust and WGSL.

use super::batch::{ItemRun, SplitCounts, SplitParams};
use super::input::{DrawRecord, TexturePlace};
use super::whole::UnitedVoxel;
use super::{ResolveParams, VoxelFaces};
use crate::gpu::assert_layout;
use crate::voxels::FaceRecord;

#[test]
fn structs_lie_in_memory_alike() {
    let library = crate::shaders::library();
    assert_layout!(
        library,
        "voxelize::triangles",
        "Draw",
        DrawRecord {
            grid_from_local_x,
            grid_from_local_y,
            grid_from_local_z,
            reflectance,
            emission,
            first_triangle,
            first_index,
            base_vertex,
            flags,
            transmission,
            reflectance_place,
            emission_place,
            transmission_place,
            vertex_words,
            color_word,
            gloss,
        }
    );
    assert_layout!(
        library,
        "voxelize::triangles",
        "TexturePlace",
        TexturePlace { u_row, word, v_row }
    );
    assert_layout!(
        library,
        "voxelize::split",
        "SplitParams",
        SplitParams { triangle_count, draw_count }
    );
    assert_layout!(
        library,
        "voxelize::split",
        "SplitCounts",
        SplitCounts { items_overflow, items, degenerate, outside }
    );
    assert_layout!(
        library,
        "voxelize::items",
        "ItemRun",
        ItemRun { first_triangle, end_triangle, first_draw, end_draw }
    );
    assert_layout!(
        library,
        "voxelize::faces",
        "VoxelFaces",
        VoxelFaces { lobes, area_low, area_high, first_face }
    );
    assert_layout!(
        library,
        "voxelize::lobes",
        "AtomicVoxelFaces",
        VoxelFaces { lobes, area_low, area_high, first_face }
    );
    assert_layout!(
        library,
        "voxelize::resolve",
        "ResolveParams",
        ResolveParams { voxel_count, emission_scale }
    );
    assert_layout!(
        library,
        "voxelize::unite",
        "UnitedVoxel",
        UnitedVoxel { lobes, first_sums, scales }
    );
    // The sums of a face stand where the face's means will be.
    assert_layout!(
        library,
        "voxelize::face_sums",
        "FaceSlot",
        FaceRecord {
            position_in_world,
            voxel,
            vector_area,
            lobe,
            reflectance,
            visible_area,
            emission,
            gloss,
        }
    );
}
