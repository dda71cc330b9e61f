//! Every struct that Rust and WGSL share lies in memory alike, and every shader is valid, without a GPU.

use crate::cones::ConeSettings;
use crate::emitters::{EmitterRecord, RunEmitters, Sorting, TreePart};
use crate::environment::{CubeLevel, CubeLight};
use crate::gpu::ShaderLibrary;
use crate::light::{BounceSettings, LightGlobals, LightRecord, ShadowLayerRecord};
use crate::points::{GatheredPoint, PointSettings};
use crate::trace::{CameraViewUniform, ScreenSettings};
use crate::volume::changes::{LevelWords, ListParams};
use crate::volume::{MaskLevels, OldAtlas, TreeUniform, TreeVerdict};
use crate::voxels::{FaceRecord, NodeRecord};
use crate::{Directionality, OctreeOptions, VolumeKind, shaders};

fn libraries() -> Vec<ShaderLibrary> {
    let octree = VolumeKind::Octree(OctreeOptions::default());
    let kinds = [VolumeKind::Dense, octree, VolumeKind::Cascades];
    let directionalities = [Directionality::SixLobes, Directionality::Isotropic];
    let pairs = kinds.into_iter().flat_map(|kind| directionalities.map(|d| (kind, d)));
    pairs.map(|(kind, d)| shaders::library_with_volume(kind, d)).collect()
}

#[test]
fn structs_lie_in_memory_alike() {
    let library = &libraries()[0];
    library.check_struct::<NodeRecord>("voxels::list", "Node").unwrap();
    library.check_struct::<FaceRecord>("voxels::list", "Face").unwrap();
    library.check_struct::<TreeUniform>("volume::octree::tree", "Tree").unwrap();
    library.check_struct::<TreeVerdict>("volume::octree::verdict", "Verdict").unwrap();
    library.check_struct::<OldAtlas>("volume::octree::resettle", "OldAtlas").unwrap();
    library.check_struct::<crate::grid::GridUniform>("grid", "Grid").unwrap();
    library.check_struct::<LightRecord>("light::lights", "Light").unwrap();
    library.check_struct::<LightGlobals>("light::lights", "LightGlobals").unwrap();
    library.check_struct::<ShadowLayerRecord>("light::shadow_map", "ShadowLayer").unwrap();
    library.check_struct::<CubeLight>("environment::cubed", "CubeLight").unwrap();
    library.check_struct::<CubeLevel>("environment::cubed", "CubeLevel").unwrap();
    library.check_struct::<BounceSettings>("light::turn", "BounceSettings").unwrap();
    library.check_struct::<EmitterRecord>("emitters::emitter", "Emitter").unwrap();
    library.check_struct::<RunEmitters>("emitters::list", "RunEmitters").unwrap();
    library.check_struct::<Sorting>("emitters::order", "Sorting").unwrap();
    library.check_struct::<TreePart>("emitters::tree", "TreePart").unwrap();
    library.check_struct::<ConeSettings>("cones::cone", "ConeSettings").unwrap();
    library.check_struct::<PointSettings>("points::gather", "PointSettings").unwrap();
    library.check_struct::<GatheredPoint>("points::gather", "GatheredPoint").unwrap();
    library.check_struct::<ScreenSettings>("trace::screen", "ScreenSettings").unwrap();
    library.check_struct::<CameraViewUniform>("trace::view", "CameraView").unwrap();
    library.check_struct::<ListParams>("volume::changes::list", "ListParams").unwrap();
    library.check_struct::<LevelWords>("volume::changes::cells", "LevelWords").unwrap();
    library.check_struct::<MaskLevels>("volume::dense::masks", "MaskLevels").unwrap();
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
