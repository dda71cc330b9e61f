//! Drawing finished pictures on the page's canvas.

use glam::{UVec2, Vec2};
use lumivox::gpu::Texture;
use lumivox_render::Gpu;
use web_sys::{HtmlCanvasElement, OffscreenCanvas};
use wgpu::util::DeviceExt as _;

use crate::error::{Code, WebError};

/// The format of the canvas, which every browser supports.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Half the width of the line between two pictures, px.
const HALF_LINE: f32 = 1.0;

/// A canvas of a page, or one that was transferred to a worker.
#[derive(Clone, Debug)]
pub enum Canvas {
    /// An element of the page.
    Element(HtmlCanvasElement),
    /// A canvas without an element.
    Offscreen(OffscreenCanvas),
}

impl Canvas {
    /// Width and height, px.
    pub fn size(&self) -> UVec2 {
        match self {
            Self::Element(canvas) => UVec2::new(canvas.width(), canvas.height()),
            Self::Offscreen(canvas) => UVec2::new(canvas.width(), canvas.height()),
        }
    }

    fn resize(&self, size: UVec2) {
        match self {
            Self::Element(canvas) => {
                canvas.set_width(size.x);
                canvas.set_height(size.y);
            }
            Self::Offscreen(canvas) => {
                canvas.set_width(size.x);
                canvas.set_height(size.y);
            }
        }
    }

    fn target(&self) -> wgpu::SurfaceTarget<'static> {
        match self {
            Self::Element(canvas) => wgpu::SurfaceTarget::Canvas(canvas.clone()),
            Self::Offscreen(canvas) => wgpu::SurfaceTarget::OffscreenCanvas(canvas.clone()),
        }
    }
}

/// Draws pictures onto a canvas.
#[derive(Debug)]
pub struct Presenter {
    canvas: Canvas,
    surface: wgpu::Surface<'static>,
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    split: wgpu::Buffer,
    size: UVec2,
}

impl Presenter {
    /// A presenter for a canvas at its present size.
    ///
    /// # Errors
    /// When something else already draws on the canvas.
    pub fn new(gpu: &Gpu, canvas: Canvas) -> Result<Self, WebError> {
        let surface = gpu.instance.create_surface(canvas.target());
        let surface = surface.map_err(|error| {
            WebError::new(
                Code::Value,
                format!(
                    "the canvas has no WebGPU context: {error}; use one that nothing else draws on"
                ),
            )
        })?;
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::include_wgsl!("present.wgsl"));
        let texture = |binding| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Texture {
                sample_type: wgpu::TextureSampleType::Float { filterable: false },
                view_dimension: wgpu::TextureViewDimension::D2,
                multisampled: false,
            },
            count: None,
        };
        let uniform = wgpu::BindGroupLayoutEntry {
            binding: 2,
            visibility: wgpu::ShaderStages::FRAGMENT,
            ty: wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            },
            count: None,
        };
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("present"),
            entries: &[texture(0), texture(1), uniform],
        });
        let pipeline_layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("present"),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("present"),
            layout: Some(&pipeline_layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &[Some(FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        });
        let split = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("split"),
            contents: &[0; 16],
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        });
        let size = canvas.size().max(UVec2::ONE);
        let mut presenter = Self { canvas, surface, pipeline, layout, split, size };
        presenter.configure(gpu);
        Ok(presenter)
    }

    /// The canvas.
    pub fn canvas(&self) -> &Canvas {
        &self.canvas
    }

    /// Width and height of the canvas, px.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Gives the canvas another size, px.
    pub fn resize(&mut self, gpu: &Gpu, size: UVec2) {
        self.canvas.resize(size);
        self.size = size;
        self.configure(gpu);
    }

    fn configure(&mut self, gpu: &Gpu) {
        let configuration = wgpu::SurfaceConfiguration {
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
            format: FORMAT,
            color_space: wgpu::SurfaceColorSpace::default(),
            width: self.size.x,
            height: self.size.y,
            present_mode: wgpu::PresentMode::AutoVsync,
            desired_maximum_frame_latency: 2,
            alpha_mode: wgpu::CompositeAlphaMode::Opaque,
            view_formats: Vec::new(),
        };
        self.surface.configure(&gpu.device, &configuration);
    }

    /// Shows a picture of the canvas's size, and optionally a second picture to the right of a
    /// share of the width.
    ///
    /// # Errors
    /// When the canvas is lost.
    pub fn show(
        &self,
        gpu: &Gpu,
        left: &Texture,
        right: Option<(&Texture, f32)>,
    ) -> Result<(), WebError> {
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame)
            | wgpu::CurrentSurfaceTexture::Suboptimal(frame) => frame,
            other => {
                return Err(WebError::new(
                    Code::Device,
                    format!("the canvas has no texture to draw on: {other:?}"),
                ));
            }
        };
        let at = right.map_or(f32::MAX, |(_, share)| share * self.size.x as f32);
        let Vec2 { x, y } = self.size.as_vec2();
        let split: Vec<u8> =
            [at, HALF_LINE, x, y].iter().flat_map(|number| number.to_le_bytes()).collect();
        gpu.queue.write_buffer(&self.split, 0, &split);
        let view =
            |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let (left_view, right_view) =
            (view(left), view(right.map_or(left, |(texture, _)| texture)));
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("present"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&left_view),
                },
                wgpu::BindGroupEntry {
                    binding: 1,
                    resource: wgpu::BindingResource::TextureView(&right_view),
                },
                wgpu::BindGroupEntry { binding: 2, resource: self.split.as_entire_binding() },
            ],
        });
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let target = view(&frame.texture);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("present"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &target,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..Default::default()
            });
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
        }
        gpu.queue.submit([encoder.finish()]);
        gpu.queue.present(frame);
        Ok(())
    }
}
