//! Rust's and WGSL's structs have the same layout, as naga reflects it, and every shader is valid: without
//! a GPU.

use lumivox::gpu::ShaderLibrary;
use lumivox::shaders::library_with_volume;
use lumivox::{Directionality, OctreeOptions, VolumeKind};

fn libraries() -> Vec<ShaderLibrary> {
    let octree = VolumeKind::Octree(OctreeOptions::default());
    let kinds = [VolumeKind::Dense, octree, VolumeKind::Cascades];
    let directionalities = [Directionality::SixLobes, Directionality::Isotropic];
    let pairs = kinds.into_iter().flat_map(|kind| directionalities.map(|d| (kind, d)));
    pairs.map(|(kind, d)| crate::shaders::library(&library_with_volume(kind, d))).collect()
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
    library
        .check_struct::<AccumulateSettings>("render::passes::accumulate", "AccumulateSettings")
        .unwrap();
    library
        .check_struct::<CompositeSettings>("render::passes::composite", "CompositeSettings")
        .unwrap();
    library.check_struct::<RasterView>("render::passes::gbuffer", "RasterView").unwrap();
    library.check_struct::<ShadowView>("render::passes::shadow_maps", "ShadowView").unwrap();
    library
        .check_struct::<ToneMapSettings>("render::picture::tone_map", "ToneMapSettings")
        .unwrap();
    library.check_struct::<DrawRecord>("render::scene::draws", "DrawRecord").unwrap();
    library.check_struct::<MaterialRecord>("render::scene::material", "Material").unwrap();
    library.check_struct::<TexturePlace>("render::scene::material", "TexturePlace").unwrap();
    library
        .check_struct::<VoxelViewSettings>("render::passes::voxel_view::view", "VoxelViewSettings")
        .unwrap();
}

#[test]
fn the_overlays_structs_lie_in_memory_alike() {
    use crate::passes::overlay::{EdgeRange, LineRecord, SegmentView, WireSettings};

    let library = &libraries()[0];
    library.check_struct::<EdgeRange>("render::passes::overlay::edges", "EdgeRange").unwrap();
    library.check_struct::<LineRecord>("render::passes::overlay::lines", "Line").unwrap();
    library.check_struct::<SegmentView>("render::passes::overlay::segment", "SegmentView").unwrap();
    library
        .check_struct::<WireSettings>("render::passes::overlay::voxels", "WireSettings")
        .unwrap();
}

#[test]
fn the_path_tracers_structs_lie_in_memory_alike() {
    use crate::reference::{
        EmitterRecord, FilmRecord, NodeRecord, PeakRecord, TileRecord, TracedMaterialRecord,
        TriangleRecord, VertexRecord, WorldRecord,
    };

    let library = &libraries()[0];
    library.check_struct::<NodeRecord>("render::reference::world", "Node").unwrap();
    library.check_struct::<TriangleRecord>("render::reference::world", "Triangle").unwrap();
    library.check_struct::<VertexRecord>("render::reference::world", "Vertex").unwrap();
    library.check_struct::<TileRecord>("render::reference::world", "Tile").unwrap();
    library
        .check_struct::<TracedMaterialRecord>("render::reference::world", "TracedMaterial")
        .unwrap();
    library.check_struct::<EmitterRecord>("render::reference::world", "Emitter").unwrap();
    library.check_struct::<PeakRecord>("render::reference::world", "Peak").unwrap();
    library.check_struct::<WorldRecord>("render::reference::world", "World").unwrap();
    library.check_struct::<FilmRecord>("render::reference::path", "Pixel").unwrap();
}

/// The number of entry points that a module's own source declares.
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
