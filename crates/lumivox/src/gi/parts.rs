//! Accessors for the parts of a [`Gi`] that callers link against, bind or measure.

use super::{Gi, GiConfig};
use crate::Grid;
#[cfg(test)]
use crate::emitters::Emitters;
use crate::gpu::{BindGroup, Buffer, Pipelines, ShaderLibrary};
use crate::light::Injector;
#[cfg(test)]
use crate::volume::CellVolume;
use crate::volume::changes::Changes;
use crate::volume::{OctreeStats, OctreeVolume};
use crate::voxels::VoxelList;

impl Gi {
    /// The shader modules, with `package::volume` bound to this object's volume: link your own
    /// shaders against them to sample the volume yourself.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::Vec3;
    /// # use lumivox::{Gi, GiConfig, Grid};
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// let mut shaders = gi.shaders().clone();
    /// shaders.add(
    ///     "engine::fog",
    ///     "import package::volume::is_clear;
    ///      @group(1) @binding(0) var<storage, read_write> clear: u32;
    ///      @compute @workgroup_size(1)
    ///      fn main() {
    ///          clear = u32(is_clear(vec3f(8.0), 0u));
    ///      }",
    /// );
    /// let wgsl = shaders.link("engine::fog")?.source;
    /// assert!(wgsl.contains("is_clear"));
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    pub fn shaders(&self) -> &ShaderLibrary {
        &self.shaders
    }

    /// The device's pipeline cache: create your own pipelines there.
    pub fn pipelines(&self) -> &Pipelines {
        &self.device
    }

    /// The configuration; its grid moves with [`Self::center_on`].
    pub fn config(&self) -> &GiConfig {
        &self.config
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.config.grid
    }

    /// The list of voxels; `None` before the first voxelization.
    pub fn voxels(&self) -> Option<&VoxelList> {
        self.scene.list()
    }

    /// Statistics of the octree; `None` for other volumes, and before there are voxels.
    pub fn octree_stats(&self) -> Option<OctreeStats> {
        self.volume.octree().and_then(OctreeVolume::stats)
    }

    #[cfg(test)]
    pub(crate) fn emitters(&self) -> &Emitters {
        &self.emitters
    }

    #[cfg(test)]
    pub(crate) fn cells(&self) -> Option<&CellVolume> {
        self.volume.cells.as_ref()
    }

    /// The hits of the faces' rays (`turn.wgsl`).
    #[cfg(test)]
    pub(crate) fn face_hits(&self) -> Option<&Buffer> {
        self.lighting.hits()
    }

    /// The radiance that each face of the list sends out (`array<vec4f>`, rgb); `None` before there
    /// is a list.
    pub fn face_radiance(&self) -> Option<&Buffer> {
        self.lighting.radiance()
    }

    /// The injector that [`GiConfig::injection`] created, to query it.
    pub fn injector(&self) -> Option<&dyn Injector> {
        self.lighting.injector()
    }

    /// Bind group 0 of everything that traces cones: the grid, all surface and the emitters. Query
    /// it again after each voxelization: it is recreated when a buffer grows.
    pub fn globals(&self) -> &BindGroup {
        self.volume.globals()
    }

    /// The layout of [`Self::globals`].
    pub fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        self.volume.globals_layout()
    }

    /// Bind group 0 of everything that samples cells (`package::volume`): the grid, the cells and
    /// the emitters. Query it again after each voxelization: it is recreated when an octree or the
    /// list of emitters grows.
    ///
    /// # Panics
    /// Without [`GiConfig::has_cells`].
    pub fn cell_globals(&self) -> &BindGroup {
        self.volume.cell_globals().expect("GiConfig::has_cells")
    }

    /// The layout of [`Self::cell_globals`].
    ///
    /// # Panics
    /// Without [`GiConfig::has_cells`].
    pub fn cell_globals_layout(&self) -> &wgpu::BindGroupLayout {
        self.volume.cell_globals_layout().expect("GiConfig::has_cells")
    }

    /// The layout of group 2: lights and shadow maps.
    pub fn lights_layout(&self) -> &wgpu::BindGroupLayout {
        &self.lights_layout
    }

    /// The layout of group 3: the camera and the G-buffer.
    pub fn gbuffer_layout(&self) -> &wgpu::BindGroupLayout {
        &self.gbuffer_layout
    }

    /// Bytes on the GPU, by purpose, without the buffers that only a voxelization needs.
    pub fn memory(&self) -> Vec<(&'static str, u64)> {
        let mut memory = self.volume.memory();
        memory.extend(self.changes.iter().flat_map(Changes::memory));
        memory.extend(self.lighting.memory());
        memory.push(("light: emitters", self.emitters.bytes()));
        if let Some(voxels) = self.scene.list() {
            memory.extend(voxels.memory());
        }
        if self.scene.kept_bytes() > 0 {
            memory.push(("voxels: kept of static draws", self.scene.kept_bytes()));
        }
        memory
    }
}
