//! Choices among a few names, each explained in the help.

use clap::builder::TypedValueParser;
use lumivox::{Duplication, Mipmapping, OctreeBuilder, Preset, VolumeKind};
use lumivox_console::values::choices::among;
use lumivox_render::classics::{self, INJECTIONS, InjectionChoice, VOXELIZERS, VoxelizerChoice};
use lumivox_render::{PresetChoice, ShadowMethod, ToneMap, View, Wireframe, Wires};

/// What the picture shows.
pub fn view() -> impl TypedValueParser<Value = View> {
    among(&View::ALL, |view| {
        let help = match view {
            View::Final => "all light",
            View::Direct => "emission, and what lamps and sun send without a detour",
            View::Indirect => "what came by way of other surfaces or from the environment",
            View::Diffuse => "indirect light as a white diffuse surface would reflect it",
            View::Specular => "indirect light that is reflected glossily",
            View::Occlusion => "ambient visibility: 1 in the open, 0 where no sky is seen",
            View::Shadow => "share of the lamps' and the sun's light that arrives",
            View::Albedo => "share of light that is reflected diffusely; metals are black",
            View::Normal => "shading normals; -1 to 1 along x, y, z as red, green, blue",
            View::Depth => "distance from the camera; metres in OpenEXR, near is white in PNG",
            View::Cost => "cone samples a pixel, from violet (none) to yellow (512 and more)",
            View::Voxels => "the voxels of one level (--level) as cubes, in their light",
            View::Lit => {
                "which voxels of one level get direct light (yellow), and which not (grey)"
            }
            View::Nodes => "the octree's nodes round the voxels of one level, as wire boxes",
            View::Bricks => "these nodes' bricks, texels pulled apart; neighbours' are orange",
            View::Lod => "light that the volume holds of one level (--level), on the surfaces",
            View::WireVoxels => {
                "the voxels of one level as wire cubes in the colours of their light"
            }
        };
        (view.name(), help)
    })
}

/// Which edges of triangles are drawn over a picture.
pub fn wireframe() -> impl TypedValueParser<Value = Wireframe> {
    among(&[Wireframe::Off, Wireframe::Over, Wireframe::Through], |wireframe| {
        let help = match wireframe {
            Wireframe::Off => "none",
            Wireframe::Over => "those of visible surfaces",
            Wireframe::Through => "all, seen through surfaces",
        };
        (wireframe.name(), help)
    })
}

/// Which wire cubes of voxels are drawn over a picture.
pub fn wire_voxels() -> impl TypedValueParser<Value = Wires> {
    among(&[Wires::Off, Wires::Over, Wires::Through], |wires| {
        let help = match wires {
            Wires::Off => "none",
            Wires::Over => "those in front of surfaces",
            Wires::Through => "all, seen through surfaces",
        };
        (wires.name(), help)
    })
}

/// How triangles become voxels.
pub fn voxelizer() -> impl TypedValueParser<Value = VoxelizerChoice> {
    let names = among(&VOXELIZERS, |name| {
        let help = match name {
            "dominant-axis" => "rasterized along the normal's largest axis: has gaps",
            "conservative" => "the same, every pixel touched: some voxels too many",
            "three-plane" => "rasterized along all three axes: fewer gaps",
            _ => "every voxel that is touched, with the surface in it",
        };
        (name, help)
    });
    names.map(|name| classics::voxelizer(name))
}

/// How much is spent on the cones.
pub fn preset() -> impl TypedValueParser<Value = Preset> {
    among(&[Preset::Fast, Preset::Balanced, Preset::High, Preset::Report], |preset| {
        (preset_name(preset), PresetChoice::Cones(preset).summary())
    })
}

/// A preset of the cones, or a look.
pub fn preset_or_look() -> impl TypedValueParser<Value = PresetChoice> {
    among(&PresetChoice::ALL, |choice| (choice.name(), choice.summary()))
}

/// The name of a preset of the cones.
pub const fn preset_name(preset: Preset) -> &'static str {
    PresetChoice::Cones(preset).name()
}

/// Something that is on or off.
pub fn switch() -> impl TypedValueParser<Value = bool> {
    among(&[true, false], |on| if on { ("on", "yes") } else { ("off", "no") })
}

/// How light comes into the voxels.
pub fn injection() -> impl TypedValueParser<Value = InjectionChoice> {
    let names = among(&INJECTIONS, |name| {
        let help = match name {
            "photons" => "each texel of a shadow map carries its share of the light's flux",
            _ => "each face of a voxel asks each light",
        };
        (name, help)
    });
    names.map(|name| classics::injection(name))
}

/// The curve from radiance to the screen.
pub fn tone_map() -> impl TypedValueParser<Value = ToneMap> {
    among(&ToneMap::ALL, |tone_map| {
        let help = match tone_map {
            ToneMap::Neutral => "Khronos PBR Neutral: colours stay, highlights are compressed",
            ToneMap::Aces => "the ACES film curve: more contrast, hues shift in highlights",
            ToneMap::Linear => "none: what is brighter than 1 is clipped",
            ToneMap::Raw => "not even the screen's encoding: for display values, as in preset vxct",
        };
        (tone_map.name(), help)
    })
}

/// A kind of volume, without its options.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VolumeChoice {
    /// 3D textures over the whole grid.
    Dense,
    /// Nodes and bricks where there is surface.
    Octree,
}

impl VolumeChoice {
    /// That of a volume.
    pub fn of(kind: VolumeKind) -> Self {
        match kind {
            VolumeKind::Dense => Self::Dense,
            VolumeKind::Octree(_) => Self::Octree,
        }
    }
}

/// Where cells are stored.
pub fn volume() -> impl TypedValueParser<Value = VolumeChoice> {
    among(&[VolumeChoice::Dense, VolumeChoice::Octree], |kind| match kind {
        VolumeChoice::Dense => ("dense", "3D textures over the whole grid"),
        VolumeChoice::Octree => ("octree", "nodes and bricks where there is surface"),
    })
}

/// The name of a kind of volume, as on the command line.
pub fn volume_name(kind: VolumeKind) -> &'static str {
    match kind {
        VolumeKind::Dense => "dense",
        VolumeKind::Octree(_) => "octree",
    }
}

/// How nodes come into being.
pub fn octree_builder() -> impl TypedValueParser<Value = OctreeBuilder> {
    among(&[OctreeBuilder::Ranks, OctreeBuilder::Locks], |builder| match builder {
        OctreeBuilder::Ranks => ("ranks", "numbered by ranks in bit masks"),
        OctreeBuilder::Locks => ("locks", "threads descend together and split nodes under locks"),
    })
}

/// How the texels of neighbours are found.
pub fn octree_duplication() -> impl TypedValueParser<Value = Duplication> {
    let all = &[Duplication::Ranks, Duplication::Pointers, Duplication::Search];
    among(all, |duplication| match duplication {
        Duplication::Ranks => ("ranks", "by ranks in the voxel list"),
        Duplication::Pointers => ("pointers", "by pointers from node to node, 20 bytes a node"),
        Duplication::Search => ("search", "by a search from the root for each texel"),
    })
}

/// Over which cells coarser levels are filtered.
pub fn octree_mipmaps() -> impl TypedValueParser<Value = Mipmapping> {
    among(&[Mipmapping::Occupied, Mipmapping::Every], |mipmapping| match mipmapping {
        Mipmapping::Occupied => ("occupied", "those that there are"),
        Mipmapping::Every => ("every", "all that there could be, most of them empty"),
    })
}

/// How shadows are found.
pub fn shadows() -> impl TypedValueParser<Value = ShadowMethod> {
    among(&[ShadowMethod::Map, ShadowMethod::Cone], |method| {
        let help = match method {
            ShadowMethod::Map => "depth maps: sharp, exact to a texel",
            ShadowMethod::Cone => "cones through the voxels: soft, as coarse as the voxels",
        };
        (shadows_name(method), help)
    })
}

/// The name of a way to find shadows, as on the command line.
pub fn shadows_name(method: ShadowMethod) -> &'static str {
    match method {
        ShadowMethod::Map => "map",
        ShadowMethod::Cone => "cone",
    }
}
