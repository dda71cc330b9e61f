//! Irradiance probes on a grid in the box of the voxels, for what three.js draws after the opaque
//! materials: transparent and transmissive ones. They gather from the voxels, a batch in each
//! frame, and write ambient cubes into a texture.

use glam::{UVec3, Vec3};
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Recorder, Texture, storage_buffer,
    uniform_buffer,
};
use lumivox::{
    GatherPoints, GatherSettings, Gi, GiError, Lights, PROBE_SIDES, TraceSettings, wgpu,
};

/// Voxels along the edge of a probe's cell, at least.
const VOXELS_A_CELL: u32 = 4;
/// Cells are larger if there would be more probes. This many fit into 128 MiB, the storage binding
/// that every device of WebGPU has.
const MOST_PROBES: u32 = 1 << 20;
/// Frames that a probe gathers in its turn.
const FRAMES_A_TURN: u32 = 2;
/// Probes of a turn, at most.
const PROBES_A_TURN: u32 = 2048;
/// Bytes of `Probe` of the kernels.
const PROBE_BYTES: u64 = 112;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// `ProbeSettings` of the kernels, as words; the texture has the grid of the probes.
type Words = [u32; 20];

/// The probes of one box.
#[derive(Debug)]
pub struct Probes {
    low: Vec3,
    edge_m: f32,
    cells: UVec3,
    place: Kernel,
    take: Kernel,
    fill: Kernel,
    points: GatherPoints,
    /// Probes of a turn.
    batch: u32,
    settings: Buffer,
    group: BindGroup,
    texture: Texture,
    texture_group: BindGroup,
    next: u32,
    are_lit: bool,
    bytes: u64,
}

/// The edge of a cell, m, and the cells that cover a box of voxels.
fn cells_of(size: Vec3, voxel_size_m: f32) -> (f32, UVec3) {
    let mut voxels = VOXELS_A_CELL;
    loop {
        let edge_m = voxels as f32 * voxel_size_m;
        let cells = (size / edge_m - 1e-3).ceil().max(Vec3::ONE).as_uvec3();
        if cells.element_product() <= MOST_PROBES {
            return (edge_m, cells);
        }
        voxels += 1;
    }
}

impl Probes {
    /// Probes without light yet. Their kernels are compiled by
    /// [`Pipelines::compile`](lumivox::gpu::Pipelines::compile), or when first used.
    ///
    /// # Errors
    /// When a kernel does not link.
    pub fn new(gi: &Gi) -> Result<Self, GiError> {
        gi.prepare_gather()?;
        let pipelines = gi.pipelines();
        let device = pipelines.device();
        let grid = gi.grid();
        let (low, high) = (grid.min_in_world(), grid.max_in_world());
        let (edge_m, cells) = cells_of(high - low, grid.voxel_size_m);
        let count = cells.element_product();
        let batch = PROBES_A_TURN.min(count);

        let layout = LayoutBuilder::compute()
            .uniform()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .build(pipelines, "probes");
        let texture_layout = LayoutBuilder::compute()
            .storage_texture(wgpu::TextureViewDimension::D3, FORMAT)
            .build(pipelines, "texture of probes");
        let layouts = [gi.globals_layout(), &layout, &texture_layout];
        let kernel = |entry: &str, layouts: &[&wgpu::BindGroupLayout]| {
            Kernel::new(pipelines, gi.shaders(), "points::probes", entry, layouts)
        };
        let (place, take) = (kernel("place", &layouts[..2])?, kernel("take", &layouts[..2])?);
        let fill = kernel("fill", &layouts)?;

        let points = PROBE_SIDES * batch;
        let [positions, normals] = ["positions of probes", "normals of probes"]
            .map(|label| storage_buffer(device, label, 16 * u64::from(points)));
        let points = GatherPoints::new(device, &positions, &normals, points);
        let probes = storage_buffer(device, "probes", PROBE_BYTES * u64::from(count));
        // Only for grids that move.
        let former = storage_buffer(device, "former probes", PROBE_BYTES);
        let settings = uniform_buffer(device, "probes", &Words::default());
        let group = BindGroupBuilder::new(&layout)
            .buffer(&settings)
            .buffer(&positions)
            .buffer(&normals)
            .buffer(points.gathered())
            .buffer(&probes)
            .buffer(&former)
            .build(device, "probes");
        let size = cells * UVec3::new(1, 2, 3);
        let texture = Texture::new(
            device,
            &wgpu::TextureDescriptor {
                label: Some("light of probes"),
                size: wgpu::Extent3d {
                    width: size.x,
                    height: size.y,
                    depth_or_array_layers: size.z,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D3,
                format: FORMAT,
                // Tests copy it.
                usage: wgpu::TextureUsages::TEXTURE_BINDING
                    | wgpu::TextureUsages::STORAGE_BINDING
                    | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            },
        );
        let texture_group = BindGroupBuilder::new(&texture_layout)
            .view(&texture.view())
            .build(device, "texture of probes");
        let sums = positions.size() + normals.size() + points.gathered().size() + probes.size();
        let bytes = sums + 8 * u64::from(size.element_product());
        Ok(Self {
            low,
            edge_m,
            cells,
            place,
            take,
            fill,
            points,
            batch,
            settings,
            group,
            texture,
            texture_group,
            next: 0,
            are_lit: false,
            bytes,
        })
    }

    /// The radiance of white matt surfaces in each cell: six boxes of `cells`, of directions to
    /// +x and -x side by side along y, and those of y and z behind them along z.
    pub fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// The corner of least coordinates, m; the edge of a cell, m; cells along x, y and z.
    pub fn place(&self) -> [f32; 7] {
        let ([x, y, z], [a, b, c]) = (self.low.to_array(), self.cells.as_vec3().to_array());
        [x, y, z, self.edge_m, a, b, c]
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// Whether all probes have gathered.
    pub fn are_lit(&self) -> bool {
        self.are_lit
    }

    /// Records the turn of a frame, and the texture.
    ///
    /// # Errors
    /// When a setting of the cones is out of range.
    pub fn record(
        &mut self,
        (gi, lights): (&Gi, &Lights),
        cones: &TraceSettings,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), GiError> {
        let (count, batch) = (self.cells.element_product(), self.batch);
        let bytes: Vec<u8> = self.words().iter().flat_map(|word| word.to_le_bytes()).collect();
        recorder.queue().write_buffer(&self.settings, 0, &bytes);
        let groups = [gi.globals(), &self.group, &self.texture_group];
        self.place.run_linear(recorder, &groups[..2], batch.into());
        self.points.restart(recorder);
        let mut settings = GatherSettings::default();
        settings.cones = *cones;
        settings.frames = FRAMES_A_TURN;
        // three.js draws direct light itself.
        settings.direct = false;
        gi.record_gather(recorder, &self.points, lights, &settings)?;
        self.take.run_linear(recorder, &groups[..2], batch.into());
        self.fill.run_linear(recorder, &groups, count.into());
        self.are_lit |= self.next + batch >= count;
        self.next = (self.next + batch) % count;
        Ok(())
    }

    fn words(&self) -> Words {
        let [x, y, z, edge, ..] = self.place().map(f32::to_bits);
        let [a, b, c] = self.cells.to_array();
        let (first, batch) = (self.next, self.batch);
        [x, y, z, edge, a, b, c, first, x, y, z, edge, a, b, c, batch, 0, 0, 0, 0]
    }
}

#[cfg(test)]
mod tests {
    use lumivox::{GiConfig, Grid};

    use super::*;

    #[test]
    fn probes_link_and_cover_the_voxels() {
        let (device, queue) = pollster::block_on(lumivox::gpu::open_device()).unwrap();
        let grid = Grid::fit(Vec3::ZERO, Vec3::new(1.0, 0.5, 0.3), 32, Vec3::ZERO).unwrap();
        let gi = Gi::new(&device, &queue, GiConfig::new(grid)).unwrap();
        let probes = Probes::new(&gi).unwrap();
        let [x, y, z, edge, a, b, c] = probes.place();
        let high = Vec3::new(x, y, z) + edge * Vec3::new(a, b, c);
        assert!(high.cmpge(gi.grid().max_in_world() - 1e-4).all(), "{high}");
        assert!(a >= 8.0 && c < a, "{a} {b} {c}");
    }

    #[test]
    fn cells_grow_beyond_the_most_probes() {
        assert_eq!(cells_of(Vec3::splat(384.0), 1.0), (4.0, UVec3::splat(96)));
        let (edge, cells) = cells_of(Vec3::splat(1024.0), 1.0);
        assert_eq!((edge, cells), (11.0, UVec3::splat(94)));
        let limit = wgpu::Limits::default().max_storage_buffer_binding_size;
        assert!(PROBE_BYTES * u64::from(MOST_PROBES) <= limit, "{limit}");
    }

    #[test]
    fn all_probes_gather_after_some_turns() {
        let (device, queue) = pollster::block_on(lumivox::gpu::open_device()).unwrap();
        let size = Vec3::new(1.0, 0.5, 0.25);
        let grid = Grid::fit(Vec3::ZERO, size, 128, Vec3::ZERO).unwrap();
        let gi = Gi::new(&device, &queue, GiConfig::new(grid)).unwrap();
        let lights = gi.bind_lights(&[], Vec3::ONE, None);
        let mut probes = Probes::new(&gi).unwrap();
        let turns = probes.cells.element_product().div_ceil(PROBES_A_TURN);
        assert!(turns > 1 && probes.points.count() == PROBE_SIDES * PROBES_A_TURN);
        // Red of the texels of which a row has just the bytes that a copy needs.
        let texture = &probes.texture;
        let (row, rows) = (8 * texture.width(), texture.height() * texture.depth_or_array_layers());
        assert_eq!(row % wgpu::COPY_BYTES_PER_ROW_ALIGNMENT, 0);
        let read = storage_buffer(&device, "texels", u64::from(row * rows));
        let mut turn = || {
            let mut encoder =
                device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let mut recorder = Recorder::on(&device, &queue, &mut encoder);
            probes.record((&gi, &lights), &TraceSettings::default(), &mut recorder).unwrap();
            drop(recorder);
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: Some(probes.texture.height()),
            };
            let to = wgpu::TexelCopyBufferInfo { buffer: &read, layout };
            encoder.copy_texture_to_buffer(
                probes.texture.as_image_copy(),
                to,
                probes.texture.size(),
            );
            queue.submit([encoder.finish()]);
            let texels =
                lumivox::gpu::read_buffer::<[u16; 4]>(&device, &queue, &read, 0..read.size());
            // From 0.9 to 1.1 as half floats, whose bits have the order of their values.
            let is_one = |[red, ..]: &[u16; 4]| (0x3b33..0x3c66).contains(red);
            let texels = pollster::block_on(texels).unwrap();
            (probes.are_lit(), texels.iter().filter(|texel| is_one(texel)).count(), texels.len())
        };
        for at in 1..=turns {
            let (are_lit, lit, all) = turn();
            let is_last = at == turns;
            assert_eq!((are_lit, lit == all), (is_last, is_last), "{lit} of {all}, turn {at}");
        }
    }
}
