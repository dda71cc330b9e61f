//! The engine: its scene, and a frame of it with Lumivox's light.

use glam::{Mat4, UVec2, Vec3};
use lumivox::gpu::{BindGroup, BindGroupBuilder, Kernel, LayoutBuilder, Recorder};
use lumivox::{
    CameraView, Draw, Frame, Geometry, GeometryBatch, Gi, GiConfig, GiError, GiView, Grid, Light,
    LightSource, Lights, Preset, Shadow, SurfaceMaterial, TraceSettings,
};
use wgpu::util::TextureBlitter;

use crate::raster::{Camera, Mesh, Raster, texture};

/// The faces that gather light in a frame, of some 20 000.
const FACES_PER_FRAME: u32 = 5000;

const PICTURE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

pub struct Engine {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    raster: Raster,
    // Lumivox.
    gi: Gi,
    geometry: Geometry,
    lights: Lights,
    view: GiView,
    // The shading, and its picture in the window.
    shade: Kernel,
    layout: wgpu::BindGroupLayout,
    group: BindGroup,
    picture: wgpu::TextureView,
    blitter: TextureBlitter,
}

impl Engine {
    /// Uploads the scene. `format` is that of the targets of [`Self::frame`], `size` their pixels.
    pub fn new(
        device: wgpu::Device,
        queue: wgpu::Queue,
        format: wgpu::TextureFormat,
        size: UVec2,
    ) -> Result<Self, GiError> {
        // The engine's scene: every quad has a colour of its own.
        let mesh = room();
        let raster = Raster::new(&device, &mesh, size);

        // Lumivox reads the same triangles from the engine's buffers.
        let (min, max) = mesh.bounds();
        let config = GiConfig::new(Grid::fit(min, max, 64, Vec3::ZERO)?);
        let gi = Gi::new(&device, &queue, config)?;
        // Static draws are voxelized once.
        let draw =
            |quad| Draw { is_static: quad < mesh.first_moving, ..Draw::new(6 * quad, 6, quad) };
        let (positions, indices) = raster.geometry();
        let draws = (0..mesh.colors.len() as u32).map(draw).collect();
        let materials = mesh.colors.iter().map(|color| SurfaceMaterial {
            reflectance: color.extend(1.0),
            ..SurfaceMaterial::default()
        });
        let batch = GeometryBatch::new(positions, indices, draws);
        let geometry = Geometry::new(vec![batch], materials.collect());
        let lights = gi.bind_lights(&[lamp_at(0.0)], Vec3::ZERO, None);
        let view = gi.view(raster.views(), size, &TraceSettings::preset(Preset::Realtime));

        // The engine's shading kernel, linked against Lumivox's shader modules.
        let mut shaders = gi.shaders().clone();
        shaders.add("engine::shade", include_str!("shade.wgsl"));
        let layout = LayoutBuilder::compute()
            .texture_2d_unfilterable()
            .storage_texture(wgpu::TextureViewDimension::D2, PICTURE)
            .build(gi.pipelines(), "shade");
        let layouts = [gi.globals_layout(), &layout, gi.lights_layout(), gi.gbuffer_layout()];
        let shade = Kernel::new(gi.pipelines(), &shaders, "engine::shade", "shade", &layouts)?;
        let (picture, group) = target(&device, &layout, &view, size);
        let blitter = TextureBlitter::new(&device, format);
        Ok(Self {
            device,
            queue,
            raster,
            gi,
            geometry,
            lights,
            view,
            shade,
            layout,
            group,
            picture,
            blitter,
        })
    }

    pub fn resize(&mut self, size: UVec2) {
        self.raster.resize(&self.device, size);
        self.view = self.gi.view(self.raster.views(), size, &self.view.settings);
        (self.picture, self.group) = target(&self.device, &self.layout, &self.view, size);
    }

    /// Draws the scene at a time in seconds.
    pub fn frame(&mut self, time: f32, target: &wgpu::TextureView) -> Result<(), GiError> {
        let Self { device, queue, gi, geometry, lights, view, .. } = self;
        let size = view.size();
        view.set_camera(queue, camera(size));
        lights.update(queue, &[lamp_at(time)], Vec3::ZERO, None);
        for draw in geometry.batches[0].draws.iter_mut().filter(|draw| !draw.is_static) {
            draw.world_from_local = screen_at(time);
        }
        // One encoder a frame: the engine's passes and Lumivox's.
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let world_from_local = [Mat4::IDENTITY, screen_at(time)];
        let camera = Camera { clip_from_world: view.clip_from_world(), world_from_local };
        self.raster.draw(&mut encoder, queue, camera);
        let mut recorder = Recorder::on(device, queue, &mut encoder);
        let faces_per_frame = Some(FACES_PER_FRAME);
        let frame = Frame::new(geometry, lights, &view.settings);
        gi.frame(&mut recorder, Frame { faces_per_frame, ..frame })?;
        gi.trace(&mut recorder, view, lights)?;
        let groups = [gi.globals(), &self.group, &lights.group, view.group()];
        self.shade.run(&mut recorder, &groups, [size.x, size.y, 1]);
        drop(recorder);
        self.blitter.copy(device, &mut encoder, &self.picture, target);
        queue.submit([encoder.finish()]);
        Ok(())
    }
}

/// The picture that the shading writes, and its bind group.
fn target(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    view: &GiView,
    size: UVec2,
) -> (wgpu::TextureView, BindGroup) {
    let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING;
    let picture = texture(device, size, PICTURE, usage);
    let group =
        BindGroupBuilder::new(layout).view(view.irradiance()).view(&picture).build(device, "shade");
    (picture, group)
}

fn camera(size: UVec2) -> CameraView {
    let position = Vec3::new(0.0, 1.0, 3.6);
    let clip_from_view = glam::camera::rh::proj::directx::perspective_infinite_reverse(
        45_f32.to_radians(),
        size.x as f32 / size.y as f32,
        0.1,
    );
    let view_from_world =
        glam::camera::rh::view::look_at_mat4(position, Vec3::new(0.0, 1.0, 0.0), Vec3::Y);
    CameraView::new(clip_from_view * view_from_world, position)
}

/// The lamp, on a circle below the ceiling. Its shadows are traced through the voxels.
fn lamp_at(time: f32) -> Light {
    let (sine, cosine) = (0.9 * time).sin_cos();
    let source = LightSource::Point {
        position: Vec3::new(-0.3 - 0.3 * cosine, 1.6, 0.3 + 0.4 * sine),
        intensity: Vec3::splat(2.0),
        radius_m: 0.05,
        range_m: None,
    };
    Light { source, shadow: Shadow::Cone }
}

/// The transform of the screen, which slides.
fn screen_at(time: f32) -> Mat4 {
    Mat4::from_translation(Vec3::new(0.25 * (1.3 * time).sin(), 0.0, 0.1 * time.sin()))
}

/// A white room with a red and a blue wall, and a screen between them.
fn room() -> Mesh {
    let white = Vec3::splat(0.75);
    let (red, blue) = (Vec3::new(0.7, 0.1, 0.08), Vec3::new(0.1, 0.2, 0.7));
    let (x, y, z) = (Vec3::X * 2.0, Vec3::Y * 2.0, Vec3::Z * 2.0);
    let corner = Vec3::new(-1.0, 0.0, -1.0);
    let mut mesh = Mesh::default();
    mesh.quad(corner, z, x, white); // floor
    mesh.quad(corner + y, x, z, white); // ceiling
    mesh.quad(corner, x, y, white); // back
    mesh.quad(corner, y, z, red); // left
    mesh.quad(corner + x, z, y, blue); // right
    // The screen: a box of a few voxels' thickness, its front sides outside.
    mesh.first_moving = mesh.colors.len() as u32;
    let (low, size) = (Vec3::new(0.15, 0.0, -0.5), Vec3::new(0.12, 1.3, 1.2));
    let (sx, sy, sz) = (Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z);
    mesh.quad(low, sz, sy, white);
    mesh.quad(low + sx, sy, sz, white);
    mesh.quad(low + sy, sz, sx, white);
    mesh.quad(low, sy, sx, white);
    mesh.quad(low + sz, sx, sy, white);
    mesh
}
