//! Checks without a GPU that structs have the same layout in Rust and WGSL, and that every shader
//! is valid.

use lumivox_reflect::{check_modules, check_struct};

use crate::cones::ConeSettings;
use crate::emitters::{EmitterRecord, RunEmitters, Sorting, TreePart};
use crate::environment::{CubeLevel, CubeLight};
use crate::gpu::ShaderLibrary;
use crate::light::{BounceSettings, LightGlobals, LightRecord, ShadowLayerRecord};
use crate::points::{GatheredPoint, PointSettings};
use crate::trace::{CameraViewUniform, ScreenSettings};
use crate::volume::changes::{LevelWords, ListParams};
use crate::volume::{MaskLevels, OldAtlas, TreeNeeds, TreeUniform};
use crate::voxels::{FaceRecord, NodeRecord};
use crate::{Directionality, VolumeKind, shaders};

fn libraries() -> Vec<ShaderLibrary> {
    let octree = VolumeKind::Octree;
    let kinds = [VolumeKind::Dense, octree, VolumeKind::Cascades];
    let directionalities = [Directionality::SixLobes, Directionality::Isotropic];
    let pairs = kinds.into_iter().flat_map(|kind| directionalities.map(|d| (kind, d)));
    pairs.map(|(kind, d)| shaders::library_with_volume(kind, d)).collect()
}

#[test]
fn rust_and_wgsl_structs_have_the_same_layout() {
    let library = &libraries()[0];
    check_struct::<NodeRecord>(library, "voxels::list", "Node");
    check_struct::<FaceRecord>(library, "voxels::list", "Face");
    check_struct::<TreeUniform>(library, "volume::octree::tree", "Tree");
    check_struct::<TreeNeeds>(library, "volume::octree::needs", "Needs");
    check_struct::<OldAtlas>(library, "volume::octree::resettle", "OldAtlas");
    check_struct::<crate::grid::GridUniform>(library, "grid", "Grid");
    check_struct::<LightRecord>(library, "light::lights", "Light");
    check_struct::<LightGlobals>(library, "light::lights", "LightGlobals");
    check_struct::<ShadowLayerRecord>(library, "light::shadow_map", "ShadowLayer");
    check_struct::<CubeLight>(library, "environment::cubed", "CubeLight");
    check_struct::<CubeLevel>(library, "environment::cubed", "CubeLevel");
    check_struct::<BounceSettings>(library, "light::turn", "BounceSettings");
    check_struct::<EmitterRecord>(library, "emitters::emitter", "Emitter");
    check_struct::<RunEmitters>(library, "emitters::list", "RunEmitters");
    check_struct::<Sorting>(library, "emitters::order", "Sorting");
    check_struct::<TreePart>(library, "emitters::tree", "TreePart");
    check_struct::<ConeSettings>(library, "cones::cone", "ConeSettings");
    check_struct::<PointSettings>(library, "points::gather", "PointSettings");
    check_struct::<GatheredPoint>(library, "points::gather", "GatheredPoint");
    check_struct::<ScreenSettings>(library, "trace::screen", "ScreenSettings");
    check_struct::<CameraViewUniform>(library, "trace::view", "CameraView");
    check_struct::<ListParams>(library, "volume::changes::list", "ListParams");
    check_struct::<LevelWords>(library, "volume::changes::cells", "LevelWords");
    check_struct::<MaskLevels>(library, "volume::dense::masks", "MaskLevels");
}

#[test]
fn every_shader_is_valid() {
    for library in libraries() {
        assert!(check_modules(&library, "") > 50, "the library has few kernels");
    }
}
