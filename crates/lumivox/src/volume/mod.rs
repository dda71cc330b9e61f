//! The scene for cones, whose rays hit the faces of the voxel list (`surface.rs`). The radiance of
//! the faces may also be stored in cells and filtered into a pyramid, for views, and for a caller's
//! own cone model, whose cones march through it.
//!
//! All kinds of cells are filled from the same [`VoxelList`](crate::voxels::VoxelList) and have one
//! interface: in Rust the methods of [`Volume`] that match on [`CellVolume`], in shaders the module
//! `package::volume` with `probe_volume`, `is_empty`, `is_oblique`, `sample_probe`, `wall_coverage`
//! and `load_cell`, bound as group 0. That module is `six_lobes.wgsl` or `isotropic.wgsl`. Each
//! kind of volume has a module `package::volume::cells`, which defines where cells are stored
//! (`place_at`, `parts_at`, `fetch`, `load_part`). `docs/recipes.md` lists the steps to add a kind.

mod budget;
pub(crate) mod changes;
mod dense;
mod octree;
mod surface;

use crate::gpu::{BindGroup, Buffer, LayoutBuilder, Pipelines, Recorder, ShaderLibrary, Texture};
use crate::settings::{Choice, Choices};
use crate::voxels::VoxelList;
use crate::{CascadeOptions, Cascades, GiError, Grid};

use changes::ChangedCells;
use dense::DenseVolume;
#[cfg(test)]
pub(crate) use dense::{Level, MaskLevels, read_levels};
#[cfg(test)]
pub(crate) use octree::{Needs as TreeNeeds, OldAtlas, TreeUniform, read_nodes};
pub use octree::{OctreeBuilder, OctreeBuilding, OctreeParts, OctreeStats, TreeToBuild};
pub(crate) use octree::{OctreeVolume, ShownList};
pub(crate) use surface::Surface;

/// Format of the textures that store cells.
const CELL_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Maximum number of parts of a cell (`parts.wgsl`): those of six lobes.
const CELL_PARTS: u32 = 9;

/// How cells are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VolumeKind {
    /// 3D textures over the whole grid: the fastest look-ups; memory grows with the third power of
    /// the resolution.
    Dense,
    /// 3D textures for the boxes of a clipmap around the camera; only for a [`Grid::cascades`].
    Cascades,
    /// A sparse octree with bricks: memory grows with the surface.
    Octree,
}

impl Default for VolumeKind {
    /// Dense.
    fn default() -> Self {
        Self::Dense
    }
}

/// How the light of a voxel depends on the direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Directionality {
    /// Six lobes with vector areas: each side of a wall has its own light and coverage.
    #[default]
    SixLobes,
    /// One value per voxel, the same from all directions: a ninth of the memory, but surfaces light
    /// and shadow themselves.
    Isotropic,
}

impl Choices for Directionality {
    const VALUES: &'static [Self] = &[Self::SixLobes, Self::Isotropic];
    const CHOICES: &'static [Choice] = &[
        Choice::new("six_lobes", "a radiance for each of six directions"),
        Choice::new("isotropic", "one radiance a voxel"),
    ];
}

/// GPU memory of a dense volume in bytes, computed without creating it.
pub fn dense_volume_bytes(grid: &Grid, directionality: Directionality) -> u64 {
    dense::bytes(grid, directionality)
}

impl CascadeOptions {
    /// GPU memory of the volume in bytes, computed without creating it.
    ///
    /// # Errors
    /// As [`Grid::cascades`].
    pub fn bytes(&self, directionality: Directionality) -> Result<u64, GiError> {
        let grid = Grid::cascades(glam::Vec3::ZERO, self, glam::Vec3::ZERO)?;
        Ok(dense_volume_bytes(&grid, directionality))
    }
}

/// Checks that the kind of volume matches the grid.
fn check(grid: &Grid, kind: VolumeKind) -> Result<(), GiError> {
    if (kind == VolumeKind::Cascades) == grid.cascades.is_some() {
        return Ok(());
    }
    Err(GiError::Setting {
        name: "volume",
        value: format!("{kind:?}"),
        expected: "Cascades for a grid made by Grid::cascades, and Dense or Octree for any other"
            .to_owned(),
    })
}

/// Defines the constants that Rust and the shaders of volumes share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    octree::add_constants(library);
    library
        .constant_u32("CELL_PARTS", CELL_PARTS)
        .constant_u32("PATCH_TEXELS", surface::PATCH_TEXELS)
        .constant_u32("BLOCK_LEVEL", surface::BLOCK_LEVEL)
        .constant_u32("MASK_LEVELS", dense::MASK_LEVELS as u32);
}

/// Adds a kind of volume as `package::volume` and `package::volume::cells`.
pub(crate) fn mount(shaders: &mut ShaderLibrary, kind: VolumeKind, directionality: Directionality) {
    let volume = match directionality {
        Directionality::SixLobes => "volume::six_lobes",
        Directionality::Isotropic => "volume::isotropic",
    };
    let cells = match kind {
        VolumeKind::Dense | VolumeKind::Cascades => "volume::dense::cells",
        VolumeKind::Octree => "volume::octree::cells",
    };
    shaders
        .fill(crate::gpu::implementation(volume))
        .fill(crate::gpu::implementation(cells))
        .constant_u32("ISOTROPIC", u32::from(directionality == Directionality::Isotropic))
        // Placeholders until there is a volume.
        .constant_u32("HAS_CELLS", 1)
        .constant_u32("OCTREE_STEPS", 0);
    if kind == VolumeKind::Cascades {
        let some = Cascades::stored([2, 16]);
        crate::cascades::add_constants(shaders, Some(&some));
    }
}

/// Group 0 of everything that samples a volume: the grid, the volume's uniforms, its masks or
/// nodes, its texture, the sampler, and the emitters (`crate::emitters`).
fn globals_layout(device: &Pipelines) -> wgpu::BindGroupLayout {
    LayoutBuilder::compute()
        .uniform()
        .uniform()
        .storage()
        .texture_3d()
        .sampler()
        .storage()
        .build(device, "globals")
}

/// A sampler that does not blend levels: the tracer chooses one at random for each sample.
fn sampler(device: &wgpu::Device) -> wgpu::Sampler {
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("volume"),
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    })
}

/// The scene on the GPU for cones: all surfaces, unless cones march; and cells, if needed.
#[derive(Debug)]
pub(crate) struct Volume {
    pub(crate) cells: Option<CellVolume>,
    surface: Option<Surface>,
}

/// Storage of the cells.
#[derive(Debug)]
pub(crate) enum CellVolume {
    /// 3D textures over the whole grid.
    Dense(Box<DenseVolume>),
    /// Nodes and bricks only where there are surfaces.
    Octree(Box<OctreeVolume>),
}

impl Volume {
    /// Creates an empty volume over a grid, and mounts its shaders. Returns an error if dense cells
    /// exceed `budget` bytes; an octree is checked once there are voxels. Its nodes are built by
    /// the caller's builder, or by ranks. Unless cones march, the volume also contains all
    /// surfaces.
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &mut ShaderLibrary,
        grid: &Grid,
        (kind, directionality): (VolumeKind, Directionality),
        building: Option<&dyn OctreeBuilding>,
        (budget, marches, has_cells): (Option<u64>, bool, bool),
        emitters: &Buffer,
    ) -> Result<Self, GiError> {
        check(grid, kind)?;
        mount(shaders, kind, directionality);
        shaders.constant_u32("HAS_CELLS", u32::from(has_cells));
        crate::cascades::add_constants(shaders, grid.cascades.as_ref());
        let cells = has_cells.then(|| match kind {
            VolumeKind::Dense | VolumeKind::Cascades => {
                DenseVolume::new(device, shaders, grid, (directionality, budget), emitters)
                    .map(|dense| CellVolume::Dense(Box::new(dense)))
            }
            VolumeKind::Octree => {
                OctreeVolume::new(device, shaders, grid, (building, budget), emitters)
                    .map(|octree| CellVolume::Octree(Box::new(octree)))
            }
        });
        let cells = cells.transpose()?;
        let surface = (!marches).then(|| Surface::new(device, shaders, grid, emitters));
        Ok(Self { cells, surface: surface.transpose()? })
    }

    /// Binds another list of emitters.
    pub(crate) fn bind_emitters(&mut self, device: &wgpu::Device, emitters: &Buffer) {
        if let Some(surface) = &mut self.surface {
            surface.bind_emitters(device, emitters);
        }
        match &mut self.cells {
            None => {}
            Some(CellVolume::Dense(dense)) => dense.bind_emitters(device, emitters),
            Some(CellVolume::Octree(octree)) => octree.bind_emitters(device, emitters),
        }
    }

    /// Uses the moved boxes of a clipmap for later commands.
    pub(crate) fn move_to(&mut self, device: &Pipelines, grid: &Grid, emitters: &Buffer) {
        if let Some(surface) = &mut self.surface {
            surface.move_to(device, grid, emitters);
        }
        match &mut self.cells {
            Some(CellVolume::Dense(dense)) => dense.move_to(device, grid, emitters),
            None | Some(CellVolume::Octree(_)) => {}
        }
    }

    /// The octree, the only volume whose buffers can overflow; `None` for other volumes.
    pub(crate) fn octree(&self) -> Option<&OctreeVolume> {
        match &self.cells {
            Some(CellVolume::Octree(octree)) => Some(octree),
            None | Some(CellVolume::Dense(_)) => None,
        }
    }

    /// As [`Self::octree`].
    pub(crate) fn octree_mut(&mut self) -> Option<&mut OctreeVolume> {
        match &mut self.cells {
            Some(CellVolume::Octree(octree)) => Some(octree),
            None | Some(CellVolume::Dense(_)) => None,
        }
    }

    /// Binds another list, or the same one after its buffers were resized, the radiance of its
    /// faces, and, if there are cells, the lists of cells that will be passed to [`Self::update`]
    /// and [`Self::show`].
    pub(crate) fn bind(
        &mut self,
        device: &wgpu::Device,
        light: (&VoxelList, &Buffer),
        changed: Option<[&ChangedCells; 2]>,
    ) {
        if let Some(surface) = &mut self.surface {
            surface.bind(device, light);
        }
        match (&mut self.cells, changed) {
            (Some(CellVolume::Dense(dense)), Some(changed)) => dense.bind(device, light, changed),
            (Some(CellVolume::Octree(octree)), _) => octree.unbind(),
            _ => {}
        }
    }

    /// `true` if [`Self::show`] needs a list of the cells with changed surface; an octree lists its
    /// own nodes.
    pub(crate) fn clears_cells(&self) -> bool {
        matches!(self.cells, Some(CellVolume::Dense(_)))
    }

    /// Shows the surface of a list to rays. [`Self::show_light`] shows its light.
    pub(crate) fn show_surface(&self, recorder: &mut Recorder<'_>) {
        if let Some(surface) = &self.surface {
            surface.show(recorder);
        }
    }

    /// Shows a list in cells: discards those with changed surface, which `wrong` lists if
    /// [`Self::clears_cells`]. [`Self::update`] stores the radiance. An octree that overflows keeps
    /// showing the earlier list.
    ///
    /// # Errors
    /// [`GiError::Limit`] and [`GiError::Budget`] if an octree does not fit.
    pub(crate) fn show(
        &mut self,
        recorder: &mut Recorder<'_>,
        shown: ShownList<'_>,
        wrong: &ChangedCells,
    ) -> Result<(), GiError> {
        match &mut self.cells {
            None => {}
            Some(CellVolume::Dense(dense)) => dense.show(recorder, wrong),
            Some(CellVolume::Octree(octree)) => octree.show(recorder, shown)?,
        }
        Ok(())
    }

    /// Stores the changed radiance of the faces in cells and filters it into the pyramid.
    pub(crate) fn update(&self, recorder: &mut Recorder<'_>, changed: &ChangedCells) {
        match &self.cells {
            None => {}
            Some(CellVolume::Dense(dense)) => dense.update(recorder, changed),
            Some(CellVolume::Octree(octree)) => octree.update(recorder, changed),
        }
    }

    /// Shows the radiance of the faces to rays.
    pub(crate) fn show_light(&self, recorder: &mut Recorder<'_>) {
        if let Some(surface) = &self.surface {
            surface.show_light(recorder);
        }
    }

    /// All surfaces for rays; `None` if cones march.
    pub(crate) fn surface(&self) -> Option<&Surface> {
        self.surface.as_ref()
    }

    /// Shows the far light of the faces.
    pub(crate) fn show_far(&self, recorder: &mut Recorder<'_>, far: &Texture) {
        if let Some(surface) = &self.surface {
            surface.show_far(recorder, far);
        }
    }

    /// `true` if cones march through the cells.
    pub(crate) fn is_marched(&self) -> bool {
        self.surface.is_none()
    }

    /// Group 0 of everything that traces cones; replaced when buffers grow.
    pub(crate) fn globals(&self) -> &BindGroup {
        let surface = self.surface.as_ref().map(Surface::globals);
        surface.or_else(|| self.cell_globals()).expect("cones meet surface or cells")
    }

    /// The layout of [`Self::globals`].
    pub(crate) fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        let surface = self.surface.as_ref().map(Surface::globals_layout);
        surface.or_else(|| self.cell_globals_layout()).expect("cones meet surface or cells")
    }

    /// Group 0 of everything that samples cells: the grid and the cells. It is replaced when an
    /// octree grows.
    pub(crate) fn cell_globals(&self) -> Option<&BindGroup> {
        self.cells.as_ref().map(|cells| match cells {
            CellVolume::Dense(dense) => dense.globals(),
            CellVolume::Octree(octree) => octree.globals(),
        })
    }

    /// The layout of [`Self::cell_globals`].
    pub(crate) fn cell_globals_layout(&self) -> Option<&wgpu::BindGroupLayout> {
        self.cells.as_ref().map(|cells| match cells {
            CellVolume::Dense(dense) => dense.globals_layout(),
            CellVolume::Octree(octree) => octree.globals_layout(),
        })
    }

    /// Bytes on the GPU, by use.
    pub(crate) fn memory(&self) -> Vec<(&'static str, u64)> {
        let mut memory = match &self.cells {
            None => Vec::new(),
            Some(CellVolume::Dense(dense)) => dense.memory(),
            Some(CellVolume::Octree(octree)) => octree.memory(),
        };
        memory.extend(self.surface.iter().flat_map(Surface::memory));
        memory
    }
}
