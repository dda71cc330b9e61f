//! Every struct that Rust and WGSL share lies in memory alike, and every shader is valid, without a GPU.

use crate::cones::ConeSettings;
use crate::gpu::{ShaderLibrary, assert_layout};
use crate::light::{BounceSettings, LightGlobals, LightRecord, ShadowLayerRecord};
use crate::trace::{ScreenSettings, ViewUniform};
use crate::volume::changes::{LevelWords, ListParams, MovedParams};
use crate::volume::{LockPass, MaskLevels, NodeRange, TreeUniform};
use crate::voxels::{FaceRecord, NodeRecord};
use crate::{Directionality, OctreeOptions, VolumeKind, shaders};

fn libraries() -> Vec<ShaderLibrary> {
    let kinds = [VolumeKind::Dense, VolumeKind::Octree(OctreeOptions::default())];
    let directionalities = [Directionality::SixLobes, Directionality::Isotropic];
    let pairs = kinds.into_iter().flat_map(|kind| directionalities.map(|d| (kind, d)));
    pairs.map(|(kind, d)| shaders::library_with_volume(kind, d)).collect()
}

#[test]
fn structs_lie_in_memory_alike() {
    let library = &libraries()[0];
    assert_layout!(library, "voxels::list", "Node", NodeRecord { morton, lobes });
    assert_layout!(
        library,
        "voxels::list",
        "Face",
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
    assert_layout!(
        library,
        "volume::octree::tree",
        "Tree",
        TreeUniform { root_level, table_level, table_words, slots, inverse_size, row_bits, levels }
    );
    assert_layout!(
        library,
        "volume::octree::locks",
        "LockPass",
        LockPass { pass_number, item_count, capacity, level_starts }
    );
    assert_layout!(
        library,
        "grid",
        "Grid",
        crate::grid::GridUniform { origin_in_world, voxel_size_m, dimensions, levels }
    );
    assert_layout!(
        library,
        "light::lights",
        "Light",
        LightRecord {
            position_in_world,
            kind,
            direction,
            range_m,
            intensity,
            radius,
            spot_scale,
            spot_offset,
            shadow,
            shadow_layer,
        }
    );
    assert_layout!(
        library,
        "light::lights",
        "LightGlobals",
        LightGlobals { environment, light_count, environment_turn, mirror_alpha }
    );
    assert_layout!(
        library,
        "light::shadow_map",
        "ShadowLayer",
        ShadowLayerRecord { clip_from_world, texel_size, is_perspective }
    );
    assert_layout!(
        library,
        "light::bounce",
        "BounceSettings",
        BounceSettings { cones, cone_count }
    );
    assert_layout!(
        library,
        "cones::cone",
        "ConeSettings",
        ConeSettings {
            voxel_per_diameter,
            clearance,
            normal_offset,
            step_per_voxel,
            min_transmittance,
            occlusion_distance,
            model_values,
        }
    );
    assert_layout!(
        library,
        "trace::screen",
        "ScreenSettings",
        ScreenSettings { cones, diffuse_cones, scale, specular_share, gathers }
    );
    assert_layout!(
        library,
        "trace::gbuffer",
        "View",
        ViewUniform { clip_from_world, world_from_clip, position_in_world, frame, size }
    );
    assert_layout!(
        library,
        "volume::level_range",
        "NodeRange",
        NodeRange { level, first, count, first_mask_entry }
    );
    assert_layout!(
        library,
        "volume::changes::moved",
        "MovedParams",
        MovedParams { voxel_count, finest_words, all }
    );
    assert_layout!(library, "volume::changes::list", "ListParams", ListParams { only_occupied });
    assert_layout!(
        library,
        "volume::changes::cells",
        "LevelWords",
        LevelWords { level, first_word, end_word }
    );
    assert_layout!(library, "volume::dense::masks", "MaskLevels", MaskLevels { first_entry });
}

/// How many entry points a module's own source declares.
fn declared_entry_points(source: &str) -> usize {
    let stages = ["@compute", "@vertex", "@fragment"];
    stages.iter().map(|stage| source.matches(stage).count()).sum()
}

#[test]
fn every_shader_is_valid() {
    for library in libraries() {
        let mut kernels = 0;
        for path in library.paths() {
            let (module, _) = library.reflect(path).unwrap_or_else(|error| panic!("{error}"));
            // What linking drops, nothing validates.
            let declared = declared_entry_points(library.source(path).expect("it is listed"));
            assert_eq!(module.entry_points.len(), declared, "entry points of {path}");
            kernels += declared;
        }
        assert!(kernels > 0, "the library has no kernels");
    }
}
