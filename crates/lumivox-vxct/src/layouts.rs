//! Rust's and WGSL's structs have the same layout, as naga reflects it, and every shader is valid: without a GPU.

use std::mem::offset_of;

use lumivox::gpu::ShaderLibrary;
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, OctreeOptions, VolumeKind};

use super::records::{VxctDraw, VxctLight};
use super::{VxctCone, VxctUniform};

fn library_of(kind: VolumeKind) -> ShaderLibrary {
    let volume = library_with_volume(kind, Directionality::Isotropic);
    super::library(&lumivox_render::shaders::library(&volume))
}

/// Asserts that a Rust struct has the size of a WGSL struct and each field the offset of the member of the
/// same name; all members but padding must be listed.
macro_rules! assert_layout {
    ($library:expr, $module:literal, $name:literal, $rust:ty { $($field:ident),* $(,)? }) => {{
        let layout = $library.struct_layout($module, $name).expect("the struct is there");
        let rust = vec![$((stringify!($field).to_owned(), offset_of!($rust, $field) as u32)),*];
        let is_padding = |name: &str| name.starts_with("padding");
        let wgsl = layout.members.into_iter().filter(|(name, _)| !is_padding(name));
        assert_eq!(wgsl.collect::<Vec<_>>(), rust, "offsets of {}", $name);
        assert_eq!(layout.size as usize, size_of::<$rust>(), "size of {}", $name);
    }};
}

#[test]
fn structs_lie_in_memory_alike() {
    let library = library_of(VolumeKind::Dense);
    assert_layout!(
        library,
        "vxct::uniform",
        "VxctCone",
        VxctCone { width, offset, step_per_diameter }
    );
    assert_layout!(
        library,
        "vxct::uniform",
        "VxctUniform",
        VxctUniform {
            clip_from_world,
            camera_in_world,
            white,
            center_in_world,
            unit_m,
            background,
            has_environment,
            diffuse,
            occlusion,
            specular,
            shown,
            terms,
            light_count,
            resolution,
            origin_offset,
            shadow_strength,
            shininess_falloff,
            level,
        }
    );
    assert_layout!(
        library,
        "vxct::material",
        "VxctDraw",
        VxctDraw {
            color,
            ambient,
            diffuse,
            specular,
            shininess,
            kind,
            first_index,
            base_vertex,
            first_triangle,
            attribute_words,
            is_rounded,
            is_voxelized,
        }
    );
    assert_layout!(
        library,
        "vxct::lights",
        "VxctLight",
        VxctLight {
            position,
            is_parallel,
            color,
            spot_scale,
            spot_direction,
            spot_offset,
            attenuation,
        }
    );
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
