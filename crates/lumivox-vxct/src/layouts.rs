//! Rust's and WGSL's structs have the same layout, as naga reflects it, and every shader is valid: without a GPU.

use lumivox::gpu::ShaderLibrary;
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, OctreeOptions, VolumeKind};

use super::records::{VxctDraw, VxctLight};
use super::{VxctCone, VxctUniform};

fn library_of(kind: VolumeKind) -> ShaderLibrary {
    let volume = library_with_volume(kind, Directionality::Isotropic);
    super::library(&lumivox_render::shaders::library(&volume))
}

#[test]
fn structs_lie_in_memory_alike() {
    let library = library_of(VolumeKind::Dense);
    library.check_struct::<VxctCone>("vxct::uniform", "VxctCone").unwrap();
    library.check_struct::<VxctUniform>("vxct::uniform", "VxctUniform").unwrap();
    library.check_struct::<VxctDraw>("vxct::material", "VxctDraw").unwrap();
    library.check_struct::<VxctLight>("vxct::lights", "VxctLight").unwrap();
}

#[test]
fn every_shader_is_valid() {
    for kind in [VolumeKind::Dense, VolumeKind::Octree(OctreeOptions::default())] {
        let library = library_of(kind);
        for path in library.paths().filter(|path| path.starts_with("vxct::")) {
            let (module, _) = library.reflect(path).unwrap_or_else(|error| panic!("{error}"));
            // Nothing validates what linking drops.
            let source = library.source(path).expect("it is listed");
            let stages = ["@compute", "@vertex", "@fragment"];
            let declared: usize = stages.iter().map(|stage| source.matches(stage).count()).sum();
            assert_eq!(module.entry_points.len(), declared, "entry points of {path}");
        }
    }
}
