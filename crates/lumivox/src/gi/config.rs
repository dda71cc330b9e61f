//! The configuration of a [`Gi`](super::Gi).

use std::sync::Arc;

use crate::Grid;
use crate::cones::ConeModel;
use crate::light::Injection;
use crate::mounted::Mounted;
use crate::volume::{Directionality, OctreeBuilding, VolumeKind};
use crate::voxelize::Voxelization;

/// Settings that a [`Gi`](super::Gi) is created with.
#[derive(Clone, Debug, PartialEq)]
pub struct GiConfig {
    /// The grid of the voxels.
    pub grid: Grid,
    /// Six lobes (the default) or one value a voxel.
    pub directionality: Directionality,
    /// How cells are stored.
    pub volume: VolumeKind,
    /// `true` to store the light of the faces also in cells and filter it into a pyramid, for views
    /// of them. Default: false. With an octree or [`Self::cones`] there are always cells.
    pub keeps_cells: bool,
    /// How an octree's nodes are built; `None` (the default): numbered by ranks in bit masks, in
    /// the same order in every run. Unused by dense volumes.
    pub octree_builder: Option<Arc<dyn OctreeBuilding>>,
    /// Maximum bytes of the cells; `None` (the default): as many as the device allows. While an
    /// octree grows, its old buffers exist in addition.
    pub memory_budget: Option<u64>,
    /// How triangles become voxels; `None` (the default): every voxel that they touch, by the exact
    /// walk.
    pub voxelizer: Option<Arc<dyn Voxelization>>,
    /// How the light of lamps and suns gets into the voxels; `None` (the default): each face
    /// evaluates each light.
    pub injection: Option<Arc<dyn Injection>>,
    /// The start, direction and samples of cones; `None` (the default): physically based cones.
    pub cones: Option<Arc<dyn ConeModel>>,
    /// Reads the caller's G-buffer in its own format: a module that replaces
    /// `package::trace::gbuffer`, with its functions `load_surface`, `load_specular` and
    /// `load_motion`, and bindings from 1 on of group 3. With `load_albedo`, mirrors show textures.
    /// `None` (the default): the textures of [`GBufferViews`](crate::GBufferViews).
    /// [`Gi::view`](crate::Gi::view) has an example.
    pub gbuffer: Option<Mounted>,
    /// Reads the caller's shadow maps in their own format: a module that replaces
    /// `package::light::shadow_map`, with its function `shadow_map_visibility`, and bindings from 8
    /// on of group 2. The module decides what the `first_layer` of [`Shadow::Map`](crate::Shadow)
    /// names. The function returns a negative number if no map covers the place; a cone is traced
    /// then. `None` (the default): [`ShadowMaps`](crate::ShadowMaps).
    pub shadow_maps: Option<Mounted>,
}

impl GiConfig {
    /// All defaults, for a grid.
    pub fn new(grid: Grid) -> Self {
        Self {
            grid,
            directionality: Directionality::default(),
            volume: VolumeKind::default(),
            keeps_cells: false,
            octree_builder: None,
            memory_budget: None,
            voxelizer: None,
            injection: None,
            cones: None,
            gbuffer: None,
            shadow_maps: None,
        }
    }

    /// `true` if the volume has cells.
    pub fn has_cells(&self) -> bool {
        self.keeps_cells || self.cones.is_some() || matches!(self.volume, VolumeKind::Octree)
    }
}
