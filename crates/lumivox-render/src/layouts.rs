//! Rust's and WGSL's structs have the same layout, as naga reflects it, and every shader is valid: without
//! a GPU.

use std::mem::offset_of;

use lumivox::gpu::ShaderLibrary;
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, OctreeOptions, VolumeKind};

fn libraries() -> Vec<ShaderLibrary> {
    let kinds = [VolumeKind::Dense, VolumeKind::Octree(OctreeOptions::default())];
    let directionalities = [Directionality::SixLobes, Directionality::Isotropic];
    let pairs = kinds.into_iter().flat_map(|kind| directionalities.map(|d| (kind, d)));
    pairs.map(|(kind, d)| crate::shaders::library(&library_with_volume(kind, d))).collect()
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
    use crate::passes::accumulate::AccumulateSettings;
    use crate::passes::composite::CompositeSettings;
    use crate::passes::gbuffer::RasterView;
    use crate::passes::shadow_maps::ShadowView;
    use crate::passes::voxel_view::VoxelViewSettings;
    use crate::picture::tone_map::ToneMapSettings;
    use crate::scene::{DrawRecord, MaterialRecord, TexturePlace};

    let library = &libraries()[0];
    assert_layout!(
        library,
        "render::passes::accumulate",
        "AccumulateSettings",
        AccumulateSettings { frames }
    );
    assert_layout!(
        library,
        "render::passes::composite",
        "CompositeSettings",
        CompositeSettings { shown, has_cones, frames }
    );
    assert_layout!(
        library,
        "render::passes::gbuffer",
        "RasterView",
        RasterView { clip_from_world, position_in_world, frame, jitter }
    );
    assert_layout!(
        library,
        "render::passes::shadow_maps",
        "ShadowView",
        ShadowView { clip_from_world }
    );
    assert_layout!(
        library,
        "render::picture::tone_map",
        "ToneMapSettings",
        ToneMapSettings { encoding, curve, scale, offset }
    );
    assert_layout!(
        library,
        "render::scene::draws",
        "DrawRecord",
        DrawRecord { world_from_local, normal_from_local }
    );
    assert_layout!(
        library,
        "render::scene::material",
        "Material",
        MaterialRecord {
            base_color,
            emission,
            normal_scale,
            dielectric_f0,
            roughness,
            sheen_color,
            sheen_roughness,
            metallic,
            has_normal_texture,
            mask_threshold,
            unlit_radiance,
            specular_factor,
            coat_strength,
            coat_roughness,
            transmission,
            is_blended,
            places,
        }
    );
    assert_layout!(
        library,
        "render::scene::material",
        "TexturePlace",
        TexturePlace { u_row, texcoord_set, v_row }
    );
    assert_layout!(
        library,
        "render::passes::voxel_view::view",
        "VoxelViewSettings",
        VoxelViewSettings { level, pixel_slope }
    );
}

#[test]
fn the_overlays_structs_lie_in_memory_alike() {
    use crate::passes::overlay::{EdgeRange, LineRecord, SegmentView, WireSettings};

    let library = &libraries()[0];
    assert_layout!(
        library,
        "render::passes::overlay::edges",
        "EdgeRange",
        EdgeRange { first_index, base_vertex, is_single_sided }
    );
    assert_layout!(
        library,
        "render::passes::overlay::lines",
        "Line",
        LineRecord { from_in_world, is_tested, to_in_world, width, color }
    );
    assert_layout!(
        library,
        "render::passes::overlay::segment",
        "SegmentView",
        SegmentView {
            clip_from_world,
            ray_middle,
            wire_is_tested,
            ray_across,
            wire_width,
            ray_up,
            size,
            wire_color,
        }
    );
    assert_layout!(
        library,
        "render::passes::overlay::voxels",
        "WireSettings",
        WireSettings { color, background, level, is_hidden_by_surfaces }
    );
}

#[test]
fn the_path_tracers_structs_lie_in_memory_alike() {
    use crate::reference::{
        EmitterRecord, FilmRecord, NodeRecord, PeakRecord, TileRecord, TracedMaterialRecord,
        TriangleRecord, VertexRecord, WorldRecord,
    };

    let library = &libraries()[0];
    assert_layout!(library, "render::reference::world", "Node", NodeRecord { low, link, high });
    assert_layout!(
        library,
        "render::reference::world",
        "Triangle",
        TriangleRecord { corner, vertex_0, edge_1, vertex_1, edge_2, vertex_2 }
    );
    assert_layout!(
        library,
        "render::reference::world",
        "Vertex",
        VertexRecord { normal, material, tangent, texcoords, color }
    );
    assert_layout!(
        library,
        "render::reference::world",
        "Tile",
        TileRecord { origin, size, layer, bits }
    );
    assert_layout!(
        library,
        "render::reference::world",
        "TracedMaterial",
        TracedMaterialRecord { shown, tiles, emitter_density, phong_exponent }
    );
    assert_layout!(
        library,
        "render::reference::world",
        "Emitter",
        EmitterRecord { triangle, cumulated }
    );
    assert_layout!(
        library,
        "render::reference::world",
        "Peak",
        PeakRecord { direction, cos_cap, around }
    );
    assert_layout!(
        library,
        "render::reference::world",
        "World",
        WorldRecord {
            camera,
            near_m,
            forward,
            light_count,
            right,
            emitter_count,
            up,
            seed,
            size,
            first_row,
            row_count,
            environment,
            most_gathers,
            environment_turn,
            peak_count,
            occlusion_distance_m,
            root,
            offset_m,
            first_sample,
            sample_count,
            peaks,
        }
    );
    assert_layout!(
        library,
        "render::reference::path",
        "Pixel",
        FilmRecord {
            picture,
            coverage,
            direct,
            depth_m,
            one_bounce,
            openness,
            full,
            albedo,
            normal,
        }
    );
}

/// How many entry points a module's own source declares.
fn declared_entry_points(source: &str) -> usize {
    let stages = ["@compute", "@vertex", "@fragment"];
    stages.iter().map(|stage| source.matches(stage).count()).sum()
}

#[test]
fn every_shader_is_valid() {
    for library in libraries() {
        let mut entry_points = 0;
        for path in library.paths().filter(|path| path.starts_with("render::")) {
            let (module, _) = library.reflect(path).unwrap_or_else(|error| panic!("{error}"));
            // Nothing validates what linking drops.
            let declared = declared_entry_points(library.source(path).expect("it is listed"));
            assert_eq!(module.entry_points.len(), declared, "entry points of {path}");
            entry_points += declared;
        }
        assert!(entry_points > 0, "the library has no entry points");
    }
}
