//! How voxels are made and where their light is stored, and the comparison of the ways to make them.

use std::path::PathBuf;

use clap::Args;
use glam::{UVec2, Vec3};
use lumivox::{
    Directionality, Duplication, GiConfig, Grid, Mipmapping, OctreeBuilder, OctreeOptions,
    VolumeKind,
};

use lumivox_render::classics::VoxelizerChoice;

use super::{GpuArgs, SceneArg};
use crate::args::camera::{self, CameraChoice};
use crate::args::choices::{self, VolumeChoice};
use crate::args::{load, number, size};

/// How voxels are made.
#[derive(Args, Debug)]
#[command(next_help_heading = "Voxels")]
pub struct VoxelArgs {
    /// Voxels along the scene's longest axis: a multiple of 8 from 16 to 1024
    ///
    /// Higher resolves finer detail and leaks less. Memory grows with the cube in a dense volume (169 MiB at
    /// 128 for a cube-shaped scene; `lumivox info` tells what fits), with the square in an octree; time
    /// with the square.
    #[arg(long, value_name = "VOXELS", value_parser = number::resolution)]
    #[arg(default_value = "128", allow_negative_numbers = true)]
    pub resolution: u32,

    /// Shift of the grid against the scene in voxels, each from 0 to below 1
    ///
    /// Errors of voxels depend on where walls fall in the grid; measurements try several.
    #[arg(long, value_name = "X,Y,Z", value_parser = number::grid_offset)]
    #[arg(default_value = "0,0,0", allow_hyphen_values = true)]
    pub grid_offset: Vec3,

    /// Keep one radiance a voxel instead of one for each of six directions [default: off; presets
    /// report and vxct: on]
    ///
    /// A ninth of a dense volume's memory, half of an octree's; surfaces light and shadow themselves, thin walls
    /// leak.
    #[arg(long, conflicts_with = "six_lobes")]
    pub isotropic: bool,

    /// Keep a radiance for each of six directions [default: on; presets report and vxct: off]
    #[arg(long)]
    pub six_lobes: bool,

    /// Where the voxels' light is stored for the cones [default: dense; preset report: octree]
    ///
    /// The picture is the same to 0.2 % in the mean. A dense volume is faster below 256 voxels (docs/octree.md has
    /// figures) and takes memory with the cube of the resolution; an octree takes it with the surface.
    #[arg(long, value_name = "KIND", value_parser = choices::volume())]
    pub volume: Option<VolumeChoice>,

    /// How the nodes of an octree come into being [default: ranks]
    ///
    /// Each option of the octree asks for one, if --volume is not given.
    #[arg(long, value_name = "HOW", value_parser = choices::octree_builder())]
    #[arg(hide_short_help = true)]
    pub octree_builder: Option<OctreeBuilder>,

    /// How the texels of an octree's bricks that belong to their neighbours are found [default: ranks]
    #[arg(long, value_name = "HOW", value_parser = choices::octree_duplication())]
    #[arg(hide_short_help = true)]
    pub octree_duplication: Option<Duplication>,

    /// Over which cells an octree's coarser levels are filtered [default: occupied]
    #[arg(long, value_name = "CELLS", value_parser = choices::octree_mipmaps())]
    #[arg(hide_short_help = true)]
    pub octree_mipmaps: Option<Mipmapping>,

    /// The most memory that the volume may take, as in 512MiB [default: what the GPU has]
    ///
    /// What does not fit is refused before it is allocated, with both numbers.
    #[arg(long, value_name = "SIZE", value_parser = load::bytes, allow_hyphen_values = true)]
    pub volume_memory: Option<u64>,
    /// How triangles become voxels
    ///
    /// All but the exact way use the GPU's rasterizer, and are there to be compared with it
    /// (`lumivox voxels SCENE --compare-voxelizers`).
    #[arg(long, value_name = "METHOD", value_parser = choices::voxelizer())]
    #[arg(default_value = "exact")]
    pub voxelizer: VoxelizerChoice,
}

impl VoxelArgs {
    /// The library's word for it, if the command line says so.
    pub fn directionality(&self) -> Option<Directionality> {
        match (self.isotropic, self.six_lobes) {
            (true, _) => Some(Directionality::Isotropic),
            (_, true) => Some(Directionality::SixLobes),
            _ => None,
        }
    }

    /// Where cells are stored; `default` where the command line says nothing of it.
    pub fn volume(&self, default: VolumeChoice) -> VolumeKind {
        let has_octree_option = self.octree_builder.is_some()
            || self.octree_duplication.is_some()
            || self.octree_mipmaps.is_some();
        let default = if has_octree_option { VolumeChoice::Octree } else { default };
        match self.volume.unwrap_or(default) {
            VolumeChoice::Dense => {
                if has_octree_option {
                    tracing::warn!("a dense volume has no use for the options of an octree");
                }
                VolumeKind::Dense
            }
            VolumeChoice::Octree => VolumeKind::Octree(OctreeOptions {
                builder: self.octree_builder.unwrap_or_default(),
                duplication: self.octree_duplication.unwrap_or_default(),
                mipmapping: self.octree_mipmaps.unwrap_or_default(),
            }),
        }
    }

    /// What the library is made for.
    pub fn config(&self, grid: Grid) -> GiConfig {
        GiConfig {
            directionality: self.directionality().unwrap_or_default(),
            volume: self.volume(VolumeChoice::Dense),
            memory_budget: self.volume_memory,
            voxelizer: self.voxelizer.clone(),
            ..GiConfig::new(grid)
        }
    }
}

/// The arguments of `voxels`.
#[derive(Args, Debug)]
pub struct VoxelsArgs {
    /// The scene.
    #[command(flatten)]
    pub scene: SceneArg,

    /// The voxels.
    #[command(flatten)]
    pub voxels: VoxelArgs,

    /// Share of the triangles that moves, 0.0001 to 1: measure what it saves to keep the others
    /// [default: measure one voxelization of everything]
    ///
    /// Small things are chosen first, and moved by up to three voxels at a time. Each move is voxelized
    /// and lit once as a whole and once keeping what is static, and both must give the same voxels and the
    /// same light of them, to the bit.
    #[arg(long, value_name = "SHARE", value_parser = number::number(0.0001..=1.0))]
    #[arg(help_heading = "Measurement", allow_negative_numbers = true)]
    #[arg(conflicts_with = "compare_voxelizers")]
    pub dynamic_share: Option<f32>,

    /// Number of moves for --dynamic-share, 1 to 1000
    #[arg(long, value_name = "MOVES", value_parser = number::whole(1..=1000))]
    #[arg(help_heading = "Measurement", default_value = "8", allow_negative_numbers = true)]
    #[arg(requires = "dynamic_share")]
    pub moves: u32,

    /// The comparison.
    #[command(flatten)]
    pub comparison: VoxelizersArgs,

    /// Print one JSON object instead of text [default: off]
    #[arg(long, help_heading = "Messages")]
    pub json: bool,

    /// The GPU.
    #[command(flatten)]
    pub gpu: GpuArgs,
}

/// The comparison of all ways to make voxels.
#[derive(Args, Debug)]
#[command(next_help_heading = "Comparison")]
pub struct VoxelizersArgs {
    /// Voxelize in every way that there is, and tell how far each is from the exact one [default: off]
    ///
    /// Voxels found, missing and too many; the share of the surface that is missed; the error of
    /// colours; and the time.
    #[arg(long, conflicts_with = "voxelizer")]
    pub compare_voxelizers: bool,

    /// A picture's file, .png: what each way finds as cubes, what it misses in magenta, what it finds
    /// too many in cyan [default: none]
    ///
    /// A file of that name is replaced once the picture is complete, never half.
    #[arg(short, long, value_name = "FILE", requires = "compare_voxelizers")]
    pub output: Option<PathBuf>,

    /// Width and height of each way's part of the picture in pixels, each from 1 to 32768
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size::size, requires = "output")]
    #[arg(default_value = "400x300", allow_hyphen_values = true)]
    pub size: UVec2,

    /// Where from: a camera's name or number, or position and target in metres [default: the
    /// scene's first camera, else `framing`, the view that shows it best]
    ///
    /// As of `lumivox render`.
    #[arg(long, value_name = "NAME|NUMBER|PX,PY,PZ,TX,TY,TZ[,FOV]", value_parser = camera::camera)]
    #[arg(allow_hyphen_values = true, requires = "output")]
    pub camera: Option<CameraChoice>,
}
