//! Tests without a GPU: Rust's and WGSL's structs have the same layout by naga's reflection, and
//! every shader is valid.

use lumivox::gpu::ShaderLibrary;
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, VolumeKind};
use lumivox_reflect::{check_modules, check_struct};

use super::records::{VxctDraw, VxctLight};
use super::{VxctCone, VxctUniform};

fn library_of(kind: VolumeKind) -> ShaderLibrary {
    let volume = library_with_volume(kind, Directionality::Isotropic);
    super::library(&lumivox_render::shaders::library(&volume))
}

#[test]
fn rust_and_wgsl_structs_have_the_same_layout() {
    let library = &library_of(VolumeKind::Dense);
    check_struct::<VxctCone>(library, "vxct::uniform", "VxctCone");
    check_struct::<VxctUniform>(library, "vxct::uniform", "VxctUniform");
    check_struct::<VxctDraw>(library, "vxct::material", "VxctDraw");
    check_struct::<VxctLight>(library, "vxct::lights", "VxctLight");
}

#[test]
fn every_shader_is_valid() {
    for kind in [VolumeKind::Dense, VolumeKind::Octree] {
        let library = library_of(kind);
        assert!(check_modules(&library, "vxct::") > 0, "the library has no entry points");
    }
}
