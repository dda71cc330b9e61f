//! The configuration of a [`Gi`](super::Gi).

use std::sync::Arc;

use crate::Grid;
use crate::cones::ConeModel;
use crate::light::Injection;
use crate::mounted::Mounted;
use crate::volume::{Directionality, OctreeBuilding, VolumeKind};
use crate::voxelize::Voxelization;

/// What a [`Gi`](super::Gi) is made for.
#[derive(Clone, Debug, PartialEq)]
pub struct GiConfig {
    /// Where the voxels are.
    pub grid: Grid,
    /// Six lobes (the default) or one value a voxel.
    pub directionality: Directionality,
    /// Where cells are stored.
    pub volume: VolumeKind,
    /// Whether the light of the faces is also stored in cells and filtered into a pyramid, for views of them. Default: false. Cells
    /// are there anyway with [`Self::cones`], which march through them, and in an octree.
    pub keeps_cells: bool,
    /// How an octree's nodes come into being; `None` (the default): numbered by ranks in bit masks, in the same order in
    /// every run. A dense volume has no nodes.
    pub octree_builder: Option<Arc<dyn OctreeBuilding>>,
    /// The most bytes that the cells may take; `None` (the default): as much as the device gives. While an octree grows,
    /// what it was is there besides.
    pub memory_budget: Option<u64>,
    /// How triangles become voxels; `None` (the default): every voxel that they touch, by the exact walk.
    pub voxelizer: Option<Arc<dyn Voxelization>>,
    /// How the light of lamps and suns comes into the voxels; `None` (the default): each face asks each light.
    pub injection: Option<Arc<dyn Injection>>,
    /// Where cones start and point, and what their samples show; `None` (the default): the physics.
    pub cones: Option<Arc<dyn ConeModel>>,
    /// The caller's G-buffer as it is: a module that takes the place of `package::trace::gbuffer`, with its functions
    /// `load_surface`, `load_specular` and `load_motion`, and bindings from 1 on of group 3. `None` (the default): the
    /// textures of [`GBufferViews`](crate::GBufferViews). docs/recipes.md has an example.
    pub gbuffer: Option<Mounted>,
    /// The caller's shadow maps as they are: a module that takes the place of `package::light::shadow_map`, with its
    /// function `shadow_map_visibility`, and bindings from 8 on of group 2. [`Shadow::Map`](crate::Shadow) then names
    /// whatever the module takes `first_layer` for, and where the function gives a negative number, because no map reaches
    /// there, a cone answers. `None` (the default): [`ShadowMaps`](crate::ShadowMaps).
    pub shadow_maps: Option<Mounted>,
}

impl GiConfig {
    /// Everything at its default, over a grid.
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

    /// Whether there are cells.
    pub fn has_cells(&self) -> bool {
        self.keeps_cells || self.cones.is_some() || matches!(self.volume, VolumeKind::Octree(_))
    }
}
