//! The G-buffer: the visible surface of each pixel, in 36 bytes.
//!
//! | target | format | contains |
//! | --- | --- | --- |
//! | depth | `Depth32Float` | reversed, without a far plane |
//! | normals | `Rgba16Float` | octahedral shading normal and geometric normal |
//! | diffuse | `Rgba16Float` | diffuse albedo, 1 - the strength of a clear coat |
//! | specular | `Rgba16Float` | reflectance at normal incidence, perceptual roughness |
//! | emission | `Rgba16Float` | emitted radiance, the coat's perceptual roughness |
//!
//! The geometric normal is that of the triangle's plane, from the derivatives of the position. It
//! determines where cones start and which side light comes from; an interpolated normal would be
//! wrong for both.
//!
//! Materials without layers have shaders that only sample their four textures. A surface that
//! blends or transmits light exists in a share of the frames (`screen_door.wgsl`), where it is
//! opaque. In the other frames, if its glass has a colour, a second pass multiplies that colour
//! into the tint of the pixel.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use bytemuck::{Pod, Zeroable};
use glam::camera::rh::proj::directx::perspective_infinite_reverse;
use glam::{Mat4, UVec2, Vec2};
use lumivox::gpu::pipelines::{DrawPipeline, Shader};
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, Recorder, RenderPass,
    ShaderError, ShaderLibrary, Texture, TextureView,
};
use lumivox::{GBufferViews, GiView};
use lumivox_scene::Camera;

use wgpu::util::DeviceExt as _;

use crate::Gpu;
use crate::gpu::textures::ScreenTextures;
use crate::passes::motion::MOTION_FORMAT;
use crate::passes::raster::{self, RasterPipeline};
use crate::scene::{Attributes, GpuMaterial, GpuScene, SceneDraw};

/// The format of the normals.
pub const NORMALS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Formats of the colour targets, in the order of their locations.
const FORMATS: [wgpu::TextureFormat; 4] = [
    NORMALS_FORMAT,
    wgpu::TextureFormat::Rgba16Float,
    wgpu::TextureFormat::Rgba16Float,
    wgpu::TextureFormat::Rgba16Float,
];

/// The tint by panes in front of the visible surface, in linear light.
const TINT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// The tints of panes are multiplied, so their order does not matter.
const MULTIPLY: wgpu::BlendComponent = wgpu::BlendComponent {
    src_factor: wgpu::BlendFactor::Dst,
    dst_factor: wgpu::BlendFactor::Zero,
    operation: wgpu::BlendOperation::Add,
};

/// `RasterView` of `gbuffer.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct RasterView {
    pub(crate) clip_from_world: Mat4,
    pub(crate) position_in_world: [f32; 3],
    pub(crate) sample: u32,
    pub(crate) jitter: [f32; 2],
    pub(crate) padding: [f32; 2],
}

/// A kind of pipeline; draws are sorted in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Variant {
    is_double_sided: bool,
    is_layered: bool,
    attributes: Attributes,
}

/// Renders the G-buffer.
#[derive(Debug)]
pub struct GBufferPass {
    shader: Shader,
    /// The pipelines that the scene needs.
    pipelines: BTreeMap<Variant, DrawPipeline>,
    /// The pipelines of tinted surfaces.
    tint_pipelines: BTreeMap<Variant, DrawPipeline>,
    view: Buffer,
    layout: wgpu::BindGroupLayout,
    group: BindGroup,
}

/// The textures of one G-buffer.
#[derive(Debug)]
pub struct GBufferTargets {
    pub(crate) depth: TextureView,
    pub(crate) normals: TextureView,
    diffuse: TextureView,
    specular: TextureView,
    emission: TextureView,
    /// The tint of each pixel's light; one white texel if nothing is tinted.
    pub(crate) tint: TextureView,
    /// The motion of moving objects; `None` if light of earlier frames is not reprojected.
    pub(crate) motion: Option<TextureView>,
}

impl GBufferTargets {
    /// `is_tinted`: the scene has coloured glass. `has_motion`: motion is needed.
    pub(crate) fn new(
        gpu: &Gpu,
        textures: &mut ScreenTextures<'_>,
        [is_tinted, has_motion]: [bool; 2],
    ) -> Self {
        let tint = if is_tinted { textures.target("tint", TINT_FORMAT) } else { white(gpu) };
        Self {
            tint,
            motion: has_motion.then(|| textures.target("motion", MOTION_FORMAT)),
            depth: textures.target("depth", raster::DEPTH_FORMAT),
            normals: textures.target("normals", FORMATS[0]),
            diffuse: textures.target("diffuse albedo", FORMATS[1]),
            specular: textures.target("specular reflectance", FORMATS[2]),
            emission: textures.target("emission", FORMATS[3]),
        }
    }

    /// The textures in the library's form.
    pub fn views(&self) -> GBufferViews<'_> {
        GBufferViews {
            depth: &self.depth,
            normals: &self.normals,
            diffuse: &self.diffuse,
            specular: &self.specular,
            emission: &self.emission,
            motion: self.motion.as_deref(),
        }
    }
}

impl GBufferPass {
    /// Creates the pipelines for a scene.
    ///
    /// # Errors
    /// When the shader does not link.
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        scene: &GpuScene,
    ) -> Result<Self, ShaderError> {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layout = LayoutBuilder::new(stages).uniform().storage().build(device, "raster view");
        let shader = device.shader(shaders, "render::passes::gbuffer")?;
        let view = lumivox::gpu::uniform_buffer(device, "raster view", &RasterView::zeroed());
        let group = bind(device, &layout, &view, scene);
        let (pipelines, tint_pipelines) = (BTreeMap::new(), BTreeMap::new());
        let mut pass = Self { shader, pipelines, tint_pipelines, view, layout, group };
        pass.make_pipelines(device, scene)?;
        Ok(pass)
    }

    /// Updates to another pose of the same scene.
    ///
    /// # Errors
    /// When the shader lacks something that a material needs.
    pub(crate) fn set_scene(
        &mut self,
        pipelines: &Pipelines,
        scene: &GpuScene,
    ) -> Result<(), ShaderError> {
        self.group = bind(pipelines, &self.layout, &self.view, scene);
        // A hidden object may be visible now.
        self.make_pipelines(pipelines, scene)
    }

    /// Creates missing pipelines.
    fn make_pipelines(
        &mut self,
        pipelines: &Pipelines,
        scene: &GpuScene,
    ) -> Result<(), ShaderError> {
        let targets = FORMATS.map(|format| Some(format.into()));
        let tint_targets = [Some(wgpu::ColorTargetState {
            format: TINT_FORMAT,
            blend: Some(wgpu::BlendState { color: MULTIPLY, alpha: MULTIPLY }),
            write_mask: wgpu::ColorWrites::ALL,
        })];
        let (shader, layout) = (&self.shader, &self.layout);
        let create = |variant: Variant, is_tint: bool| {
            RasterPipeline {
                shader,
                vertex: variant.vertex(),
                fragment: Some(if is_tint { "tint_fragment" } else { variant.fragment() }),
                targets: if is_tint { &tint_targets } else { &targets },
                vertex_buffers: &raster::streams(variant.attributes),
                groups: &[layout, &scene.material_layout],
                cull_mode: (!variant.is_double_sided).then_some(wgpu::Face::Back),
                depth: if is_tint { raster::Depth::InFront } else { raster::Depth::Hides },
            }
            .create(pipelines)
        };
        for draw in &scene.draws {
            let variant = Variant::of(scene, draw);
            if let Entry::Vacant(slot) = self.pipelines.entry(variant) {
                slot.insert(create(variant, false)?);
            }
            if !scene.materials[draw.material].is_tinted {
                continue;
            }
            if let Entry::Vacant(slot) = self.tint_pipelines.entry(variant) {
                slot.insert(create(variant, true)?);
            }
        }
        Ok(())
    }

    /// Renders sample `sample` of each pixel of a scene. Settings take effect at the next
    /// submission, so record one sample per recorder.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        scene: &GpuScene,
        targets: &GBufferTargets,
        (view, sample): (&GiView, u32),
    ) {
        let view = RasterView {
            clip_from_world: view.clip_from_world(),
            position_in_world: view.camera().position.to_array(),
            sample,
            jitter: view.camera().jitter.to_array(),
            padding: [0.0; 2],
        };
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
            self.draw(pass, scene, &self.pipelines, |_| true);
        });
        if !self.tint_pipelines.is_empty() {
            self.record_tint(recorder, scene, targets);
        }
    }

    /// Renders the surfaces that tint the light from the visible surfaces.
    fn record_tint(&self, recorder: &mut Recorder, scene: &GpuScene, targets: &GBufferTargets) {
        let color = wgpu::RenderPassColorAttachment {
            view: &targets.tint,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::WHITE),
                store: wgpu::StoreOp::Store,
            },
        };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &targets.depth,
            depth_ops: None,
            stencil_ops: None,
        };
        recorder.render("gbuffer_pass::tint", &[Some(color)], Some(depth), |pass| {
            self.draw(pass, scene, &self.tint_pipelines, |material| material.is_tinted);
        });
    }

    /// Draws the selected records, each with the pipeline of its variant.
    fn draw(
        &self,
        pass: &mut RenderPass<'_>,
        scene: &GpuScene,
        pipelines: &BTreeMap<Variant, DrawPipeline>,
        is_wanted: impl Fn(&GpuMaterial) -> bool,
    ) {
        pass.bind(0, &self.group);
        for (variant, pipeline) in pipelines {
            pass.set_pipeline(pipeline);
            for records in &scene.runs {
                let draw = scene.draw_of(records.start);
                let material = &scene.materials[draw.material];
                if Variant::of(scene, draw) != *variant || !is_wanted(material) {
                    continue;
                }
                let batch = &scene.batches[draw.batch];
                pass.bind(1, &material.group);
                pass.set_vertex_buffer(0, batch.positions.slice(..));
                pass.set_vertex_buffer(1, batch.attributes.slice(..));
                pass.set_vertex_buffer(2, batch.shading.slice(..));
                raster::draw(pass, batch, draw, records.clone());
            }
        }
    }
}

/// A texture of one white texel.
fn white(gpu: &Gpu) -> TextureView {
    let size = wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 };
    let texture = Texture::own(gpu.device.create_texture_with_data(
        &gpu.queue,
        &wgpu::TextureDescriptor {
            label: Some("white"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TINT_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
        wgpu::util::TextureDataOrder::LayerMajor,
        &[255; 4],
    ));
    texture.view()
}

impl Variant {
    fn of(scene: &GpuScene, draw: &SceneDraw) -> Self {
        let material = &scene.materials[draw.material];
        Self {
            is_double_sided: material.is_double_sided,
            is_layered: material.is_layered,
            attributes: scene.batches[draw.batch].kind,
        }
    }

    fn vertex(self) -> &'static str {
        match self.attributes {
            Attributes::Texcoords => "plain_vertex",
            Attributes::All => "colored_vertex",
        }
    }

    fn fragment(self) -> &'static str {
        match (self.is_layered, self.attributes) {
            (true, _) => "layered_fragment",
            (false, Attributes::All) => "colored_fragment",
            (false, Attributes::Texcoords) => "plain_fragment",
        }
    }
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    view: &Buffer,
    scene: &GpuScene,
) -> BindGroup {
    let builder = BindGroupBuilder::new(layout).buffer(view).buffer(&scene.draw_records);
    builder.build(device, "raster view")
}

/// The matrix from the world to clip space: reversed depth without a far plane.
pub fn clip_from_world(camera: &Camera, size: UVec2) -> Mat4 {
    let size = size.as_vec2();
    let projection =
        perspective_infinite_reverse(camera.vertical_fov_rad, size.x / size.y, camera.near_m);
    projection * camera.camera_from_world()
}

/// The offset of sample `sample` from the pixel's centre, in pixels. Samples form opposite pairs,
/// whose mean is the centre; the first of each pair is from an evenly spread sequence (Roberts
/// 2018, "The unreasonable effectiveness of quasirandom sequences"). The mean is a box filter of
/// one pixel.
pub fn jitter(sample: u32) -> Vec2 {
    // The powers of 1 / x with x^3 = x + 1, to 32 bits. The start has the best edges of the first
    // 60 starts, in frames of 16, 8, 4, 4, 2, 2 and so on samples.
    const STEP: [u32; 2] = [3_242_174_889, 2_447_445_414];
    const START: u32 = 52;
    let point =
        STEP.map(|step| step.wrapping_mul(START + sample / 2) as i32 as f32 / 2.0_f32.powi(32));
    if sample.is_multiple_of(2) { Vec2::from(point) } else { -Vec2::from(point) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jitter_covers_the_pixel_evenly() {
        let points: Vec<Vec2> = (0..36).map(jitter).collect();
        let mean = points.iter().sum::<Vec2>() / points.len() as f32;
        assert!(mean.abs().max_element() < 0.05, "{mean}");
        assert!(points.iter().all(|p| p.abs().max_element() <= 0.5));
    }
}
