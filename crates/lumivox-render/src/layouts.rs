//! Checks without a GPU that Rust's and WGSL's structs have the same layout, as reflected by naga,
//! and that every shader is valid.

use lumivox::gpu::ShaderLibrary;
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, VolumeKind};
use lumivox_reflect::{check_modules, check_struct};

fn libraries() -> Vec<ShaderLibrary> {
    let octree = VolumeKind::Octree;
    let kinds = [VolumeKind::Dense, octree, VolumeKind::Cascades];
    let directionalities = [Directionality::SixLobes, Directionality::Isotropic];
    let pairs = kinds.into_iter().flat_map(|kind| directionalities.map(|d| (kind, d)));
    pairs.map(|(kind, d)| crate::shaders::library(&library_with_volume(kind, d))).collect()
}

#[test]
fn rust_and_wgsl_structs_have_the_same_layout() {
    use crate::passes::accumulate::AccumulateSettings;
    use crate::passes::composite::CompositeSettings;
    use crate::passes::gbuffer::RasterView;
    use crate::passes::near_shadows::NearLayerRecord;
    use crate::passes::shadow_maps::ShadowView;
    use crate::passes::voxel_view::VoxelViewSettings;
    use crate::picture::tone_map::ToneMapSettings;
    use crate::scene::{DrawRecord, MaterialRecord, TexturePlace};

    let library = &libraries()[0];
    check_struct::<AccumulateSettings>(library, "render::passes::accumulate", "AccumulateSettings");
    check_struct::<CompositeSettings>(library, "render::passes::composite", "CompositeSettings");
    check_struct::<NearLayerRecord>(library, "render::passes::direct", "NearLayer");
    check_struct::<RasterView>(library, "render::passes::gbuffer", "RasterView");
    check_struct::<ShadowView>(library, "render::passes::shadow_maps", "ShadowView");
    check_struct::<ToneMapSettings>(library, "render::picture::tone_map", "ToneMapSettings");
    check_struct::<DrawRecord>(library, "render::scene::draws", "DrawRecord");
    check_struct::<MaterialRecord>(library, "render::scene::material", "Material");
    check_struct::<TexturePlace>(library, "render::scene::material", "TexturePlace");
    check_struct::<VoxelViewSettings>(
        library,
        "render::passes::voxel_view::view",
        "VoxelViewSettings",
    );
}

#[test]
fn overlay_structs_match_their_wgsl_layout() {
    use crate::passes::overlay::{EdgeRange, LineRecord, SegmentView, WireSettings};

    let library = &libraries()[0];
    check_struct::<EdgeRange>(library, "render::passes::overlay::edges", "EdgeRange");
    check_struct::<LineRecord>(library, "render::passes::overlay::lines", "Line");
    check_struct::<SegmentView>(library, "render::passes::overlay::segment", "SegmentView");
    check_struct::<WireSettings>(library, "render::passes::overlay::voxels", "WireSettings");
}

#[test]
fn path_tracer_structs_match_their_wgsl_layout() {
    use crate::reference::{
        EmitterRecord, FilmRecord, NodeRecord, PeakRecord, TileRecord, TracedMaterialRecord,
        TriangleRecord, VertexRecord, WorldRecord,
    };

    let library = &libraries()[0];
    check_struct::<NodeRecord>(library, "render::reference::world", "Node");
    check_struct::<TriangleRecord>(library, "render::reference::world", "Triangle");
    check_struct::<VertexRecord>(library, "render::reference::world", "Vertex");
    check_struct::<TileRecord>(library, "render::reference::world", "Tile");
    check_struct::<TracedMaterialRecord>(library, "render::reference::world", "TracedMaterial");
    check_struct::<EmitterRecord>(library, "render::reference::world", "Emitter");
    check_struct::<PeakRecord>(library, "render::reference::world", "Peak");
    check_struct::<WorldRecord>(library, "render::reference::world", "World");
    check_struct::<FilmRecord>(library, "render::reference::path", "Pixel");
}

#[test]
fn every_shader_is_valid() {
    for library in libraries() {
        assert!(check_modules(&library, "render::") > 0, "the library has no entry points");
    }
}
