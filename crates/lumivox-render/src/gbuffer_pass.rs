//! The G-buffer: what is visible at each pixel, 28 bytes of it.
//!
//! | target | format | holds |
//! | --- | --- | --- |
//! | depth | `Depth32Float` | reversed, without a far plane |
//! | normals | `Rgba16Float` | octahedral shading normal and geometric normal |
//! | diffuse | `Rgba8UnormSrgb` | diffuse albedo |
//! | specular | `Rgba8UnormSrgb` | reflectance at normal incidence, perceptual roughness (linear) |
//! | emission | `Rgba16Float` | emitted radiance |
//!
//! The geometric normal is that of the triangle's plane, from the derivatives of the position: it
//! decides from where cones start and which side light comes from, where an interpolated normal would
//! lie.

use bytemuck::{Pod, Zeroable};
use glam::camera::rh::proj::directx::perspective_infinite_reverse;
use glam::{Mat4, UVec2, Vec2, Vec3};
use lumivox::GBufferViews;
use lumivox::gpu::{BindGroupBuilder, LayoutBuilder, Recorder, ShaderError, ShaderLibrary};
use lumivox_scene::Camera;

use crate::raster::{self, RasterPipeline};
use crate::textures::ScreenTextures;
use crate::upload::GpuScene;

/// Formats of the colour targets, in the order of their locations.
const FORMATS: [wgpu::TextureFormat; 4] = [
    wgpu::TextureFormat::Rgba16Float,
    wgpu::TextureFormat::Rgba8UnormSrgb,
    wgpu::TextureFormat::Rgba8UnormSrgb,
    wgpu::TextureFormat::Rgba16Float,
];

/// `RasterView` of `gbuffer_pass.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct RasterView {
    pub(crate) clip_from_world: Mat4,
    pub(crate) position_in_world: [f32; 3],
    padding: u32,
}

/// Renders the G-buffer.
#[derive(Debug)]
pub struct GBufferPass {
    /// Without and with back sides.
    pipelines: [wgpu::RenderPipeline; 2],
    view: wgpu::Buffer,
    layout: wgpu::BindGroupLayout,
    group: wgpu::BindGroup,
}

/// The textures of one G-buffer.
#[derive(Debug)]
pub struct GBufferTargets {
    depth: wgpu::TextureView,
    normals: wgpu::TextureView,
    diffuse: wgpu::TextureView,
    specular: wgpu::TextureView,
    emission: wgpu::TextureView,
}

impl GBufferTargets {
    pub(crate) fn new(textures: &mut ScreenTextures<'_>) -> Self {
        Self {
            depth: textures.target("depth", raster::DEPTH_FORMAT),
            normals: textures.target("normals", FORMATS[0]),
            diffuse: textures.target("diffuse albedo", FORMATS[1]),
            specular: textures.target("specular reflectance", FORMATS[2]),
            emission: textures.target("emission", FORMATS[3]),
        }
    }

    /// The textures as the library reads them.
    pub fn views(&self) -> GBufferViews<'_> {
        GBufferViews {
            depth: &self.depth,
            normals: &self.normals,
            diffuse: &self.diffuse,
            specular: &self.specular,
            emission: &self.emission,
        }
    }
}

impl GBufferPass {
    /// Makes the pipelines for a scene.
    ///
    /// # Errors
    /// When the shader does not link.
    pub fn new(
        device: &wgpu::Device,
        shaders: &ShaderLibrary,
        scene: &GpuScene,
    ) -> Result<Self, ShaderError> {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = LayoutBuilder::new(stages).uniform().storage().build(device, "raster view");
        let (module, _) = shaders.create(device, "render::gbuffer_pass")?;
        let targets = FORMATS.map(|format| Some(format.into()));
        let pipelines = [Some(wgpu::Face::Back), None].map(|cull_mode| {
            RasterPipeline {
                label: "G-buffer",
                module: &module,
                vertex: "vertex_main",
                fragment: Some("fragment_main"),
                targets: &targets,
                vertex_buffers: &raster::ALL_STREAMS,
                groups: &[&layout, &scene.material_layout],
                cull_mode,
            }
            .create(device)
        });
        let view = lumivox::gpu::uniform_buffer(device, "raster view", &RasterView::zeroed());
        let group = bind(device, &layout, &view, scene);
        Ok(Self { pipelines, view, layout, group })
    }

    /// Takes up another pose of the scene that it was made for.
    pub(crate) fn set_scene(&mut self, device: &wgpu::Device, scene: &GpuScene) {
        self.group = bind(device, &self.layout, &self.view, scene);
    }

    /// Renders a scene. The camera takes effect at the next submission: one frame per recorder.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        scene: &GpuScene,
        targets: &GBufferTargets,
        clip_from_world: Mat4,
        position_in_world: Vec3,
    ) {
        let position_in_world = position_in_world.to_array();
        let view = RasterView { clip_from_world, position_in_world, padding: 0 };
        recorder.queue().write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
        let colors = [&targets.normals, &targets.diffuse, &targets.specular, &targets.emission];
        let colors = colors.map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        });
        let depth = raster::depth_attachment(&targets.depth);
        recorder.render("gbuffer_pass", &colors, Some(depth), |pass| {
            pass.set_bind_group(0, &self.group, &[]);
            for (pipeline, is_double_sided) in self.pipelines.iter().zip([false, true]) {
                pass.set_pipeline(pipeline);
                for (number, draw) in scene.draws.iter().enumerate() {
                    let material = &scene.materials[draw.material];
                    if material.is_double_sided != is_double_sided {
                        continue;
                    }
                    let batch = &scene.batches[draw.batch];
                    pass.set_bind_group(1, &material.group, &[]);
                    pass.set_vertex_buffer(0, batch.positions.slice(..));
                    pass.set_vertex_buffer(1, batch.texcoords.slice(..));
                    pass.set_vertex_buffer(2, batch.shading.slice(..));
                    raster::draw(pass, batch, draw, number as u32);
                }
            }
        });
    }
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    view: &wgpu::Buffer,
    scene: &GpuScene,
) -> wgpu::BindGroup {
    let builder = BindGroupBuilder::new(layout).buffer(view).buffer(&scene.draw_records);
    builder.build(device, "raster view")
}

/// From the world to clip space: reversed depth without a far plane, moved by `jitter` pixels.
pub fn clip_from_world(camera: &Camera, size: UVec2, jitter: Vec2) -> Mat4 {
    let size = size.as_vec2();
    let projection =
        perspective_infinite_reverse(camera.vertical_fov_rad, size.x / size.y, camera.near_m);
    // Pixels count downwards, clip space upwards.
    let shift = 2.0 * jitter * Vec2::new(1.0, -1.0) / size;
    Mat4::from_translation(shift.extend(0.0)) * projection * camera.camera_from_world()
}

/// Where in its pixel frame `frame` of `frames` looks, from the centre, in pixels: points of Halton's
/// sequence in the bases 2 and 3 (Halton 1960), so that the mean over frames is a box filter of one
/// pixel. A single frame looks at the centre.
pub fn jitter(frame: u32, frames: u32) -> Vec2 {
    if frames <= 1 {
        return Vec2::ZERO;
    }
    // The sequence's first point, the corner, is left out.
    Vec2::new(radical_inverse(frame + 1, 2), radical_inverse(frame + 1, 3)) - 0.5
}

fn radical_inverse(mut index: u32, base: u32) -> f32 {
    let (mut inverse, mut digit_value) = (0.0_f64, 1.0 / f64::from(base));
    while index > 0 {
        inverse += f64::from(index % base) * digit_value;
        index /= base;
        digit_value /= f64::from(base);
    }
    inverse as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_covers_the_pixel_evenly() {
        assert_eq!(jitter(0, 1), Vec2::ZERO);
        let frames = 36;
        let points: Vec<Vec2> = (0..frames).map(|frame| jitter(frame, frames)).collect();
        let mean = points.iter().sum::<Vec2>() / frames as f32;
        assert!(mean.abs().max_element() < 0.05, "{mean}");
        assert!(points.iter().all(|p| p.abs().max_element() <= 0.5));
    }

    #[test]
    fn a_jitter_moves_the_picture_by_that_part_of_a_pixel() {
        let camera = Camera::look_at(Vec3::new(0.0, 1.0, 3.0), Vec3::ZERO, 0.8);
        let size = UVec2::new(200, 100);
        let pixel_of = |jitter| {
            let ndc = clip_from_world(&camera, size, jitter).project_point3(Vec3::ZERO);
            assert!(ndc.z > 0.0 && ndc.z < 1.0);
            size.as_vec2() * (0.5 + 0.5 * ndc.truncate() * Vec2::new(1.0, -1.0))
        };
        let jitter = Vec2::new(0.25, -0.5);
        let moved = pixel_of(jitter) - pixel_of(Vec2::ZERO);
        assert!((moved - jitter).length() < 1e-4, "{moved}");
    }
}
