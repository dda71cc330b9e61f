//! Depth maps for the tests, as a renderer makes them: the triangles of a geometry drawn from a
//! light.

use glam::camera::rh::proj::directx::{orthographic, perspective_infinite_reverse};
use glam::camera::rh::view::look_to_mat4;
use glam::{Mat4, Vec3};

use lumivox::gpu::{BindGroupBuilder, LayoutBuilder, Pipelines, Recorder, uniform_buffer};
use lumivox::{Geometry, LightSource, ShadowLayer, ShadowMaps};

const DEPTH_WGSL: &str = "
@group(0) @binding(0) var<uniform> clip_from_local: mat4x4f;
@group(0) @binding(1) var<storage, read> positions: array<f32>;
@vertex
fn main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
    let position = vec3f(positions[3u * index], positions[3u * index + 1u], positions[3u * index + 2u]);
    return clip_from_local * vec4f(position, 1.0);
}";

/// Texels that layers see more on each side, as in the renderer.
const BORDER: f32 = 4.0;
const NEAR_M: f32 = 1e-3;

/// The layers of a light; parallel light covers a box of the given radius about `middle`.
pub(super) fn layers(
    source: &LightSource,
    middle: Vec3,
    radius: f32,
    size: u32,
) -> Vec<ShadowLayer> {
    let size = size as f32;
    let border = size / (size - 2.0 * BORDER);
    let perspective = |position, axis: Vec3, half_angle: f32| {
        let slope = half_angle.tan() * border;
        let view = look_to_mat4(position, axis, axis.any_orthonormal_vector());
        let projection = perspective_infinite_reverse(2.0 * slope.atan(), 1.0, NEAR_M);
        ShadowLayer {
            clip_from_world: projection * view,
            is_perspective: true,
            texel_size: 2.0 * slope / size,
            has_finer: false,
        }
    };
    match *source {
        LightSource::Directional { direction, .. } | LightSource::Environment { direction, .. } => {
            let view = look_to_mat4(middle, direction, direction.any_orthonormal_vector());
            let half = radius * border;
            // Near and far are swapped: reversed depth.
            let projection = orthographic(-half, half, -half, half, radius, -radius);
            vec![ShadowLayer {
                clip_from_world: projection * view,
                is_perspective: false,
                texel_size: 2.0 * half / size,
                has_finer: false,
            }]
        }
        LightSource::Spot { position, direction, outer_angle_rad, .. } => {
            vec![perspective(position, direction, outer_angle_rad)]
        }
        LightSource::Point { position, .. } => {
            let axes = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z];
            axes.map(|axis| perspective(position, axis, std::f32::consts::FRAC_PI_4)).to_vec()
        }
    }
}

/// Draws a geometry into the layers.
pub(super) fn draw(
    recorder: &mut Recorder,
    geometry: &Geometry,
    layers: Vec<ShadowLayer>,
    size: u32,
) -> ShadowMaps {
    let device = recorder.device().clone();
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test maps"),
        size: wgpu::Extent3d {
            width: size,
            height: size,
            depth_or_array_layers: layers.len() as u32,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Depth32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    });
    let layout = LayoutBuilder::new(wgpu::ShaderStages::VERTEX)
        .uniform()
        .storage()
        .build(&Pipelines::new(&device), "test maps");
    let pipeline = pipeline(&device, &layout);
    for (index, layer) in layers.iter().enumerate() {
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: index as u32,
            array_layer_count: Some(1),
            ..Default::default()
        });
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        recorder.render("test maps", &[], Some(depth), |pass| {
            pass.set_pipeline(&pipeline);
            for batch in &geometry.batches {
                for draw in &batch.draws {
                    let matrix: Mat4 = layer.clip_from_world * draw.world_from_local;
                    let group = BindGroupBuilder::new(&layout)
                        .buffer(&uniform_buffer(&device, "test map", &matrix))
                        .buffer(&batch.positions.buffer)
                        .build(&device, "test maps");
                    pass.bind(0, &group);
                    // The test scenes' indices count up.
                    pass.draw(draw.first_index..draw.first_index + draw.index_count, 0..1);
                }
            }
        });
    }
    let depth = texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    ShadowMaps { depth: depth.into(), layers }
}

fn pipeline(device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("test maps"),
        source: wgpu::ShaderSource::Wgsl(DEPTH_WGSL.into()),
    });
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("test maps"),
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("test maps"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: None,
        multiview_mask: None,
        cache: None,
    })
}
