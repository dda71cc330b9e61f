//! Shadow maps: the scene's depth seen from each light, in the layers of one depth array.
//!
//! `shadow_layers.rs` assigns the layers; pixels also use maps around the camera
//! ([`NearShadows`](super::near_shadows::NearShadows)). Both sides of every triangle cast shadows;
//! instead of culling one, the receiver is offset from its surface (`light/shadow_map.wgsl`). A
//! surface that transmits a share of the light leaves that share of the texels free, in a pattern
//! that the filter evens out.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec4};
use lumivox::gpu::pipelines::{DrawPipeline, Shader};
use lumivox::gpu::{
    BindGroupBuilder, LayoutBuilder, Pipelines, Recorder, ShaderError, ShaderLibrary, Texture,
    TextureView,
};
use lumivox::{Grid, Light, ShadowLayer, ShadowMaps};
use lumivox_scene::Bounds;

use crate::Gpu;
use crate::passes::raster::{self, RasterPipeline};
use crate::passes::shadow_layers;
use crate::scene::{Attributes, GpuScene, Presence, SceneDraw};
/// `ShadowView` of `shadow_maps.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ShadowView {
    pub(crate) clip_from_world: Mat4,
}

/// Renders shadow maps.
#[derive(Debug)]
pub struct ShadowMapPass {
    shader: Shader,
    layout: wgpu::BindGroupLayout,
    /// The pipelines that the scene needs.
    pipelines: BTreeMap<Variant, DrawPipeline>,
}

/// A kind of pipeline; draws are sorted in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Variant {
    /// Only positions are needed.
    Solid,
    /// The alpha is compared with its cutoff.
    Masked(Attributes),
    /// The surface covers a share of each pixel.
    Partial(Attributes),
}

impl Variant {
    fn of(scene: &GpuScene, draw: &SceneDraw) -> Self {
        let attributes = scene.batches[draw.batch].kind;
        match scene.materials[draw.material].presence {
            Presence::Masked => Self::Masked(attributes),
            Presence::Partial => Self::Partial(attributes),
            Presence::Whole | Presence::Absent => Self::Solid,
        }
    }

    fn create(
        self,
        pipelines: &Pipelines,
        shader: &Shader,
        layout: &wgpu::BindGroupLayout,
        material_layout: &wgpu::BindGroupLayout,
    ) -> Result<DrawPipeline, ShaderError> {
        let groups = [layout, material_layout];
        let (fragment, attributes, groups) = match self {
            Self::Solid => (None, None, &groups[..1]),
            Self::Masked(attributes) => (Some("masked_fragment"), Some(attributes), &groups[..]),
            Self::Partial(attributes) => (Some("partial_fragment"), Some(attributes), &groups[..]),
        };
        let streams = raster::streams(attributes.unwrap_or_default());
        let vertex = match attributes {
            None => "solid_vertex",
            Some(Attributes::Texcoords) => "plain_vertex",
            Some(Attributes::All) => "colored_vertex",
        };
        RasterPipeline {
            shader,
            vertex,
            fragment,
            targets: &[],
            // Normals are not needed here.
            vertex_buffers: &streams[..if attributes.is_some() { 2 } else { 1 }],
            groups,
            cull_mode: None,
            depth: raster::Depth::Hides,
        }
        .create(pipelines)
    }
}

impl ShadowMapPass {
    /// Creates the pipelines for a scene.
    ///
    /// # Errors
    /// When the shader does not link.
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        scene: &GpuScene,
    ) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::new(wgpu::ShaderStages::VERTEX)
            .uniform()
            .storage()
            .build(device, "shadow view");
        let shader = device.shader(shaders, "render::passes::shadow_maps")?;
        let mut pass = Self { shader, layout, pipelines: BTreeMap::new() };
        pass.set_scene(device, scene)?;
        Ok(pass)
    }

    /// Updates to another pose of the same scene: a hidden object may be visible now.
    ///
    /// # Errors
    /// When the shader lacks something that a material needs.
    pub(crate) fn set_scene(
        &mut self,
        pipelines: &Pipelines,
        scene: &GpuScene,
    ) -> Result<(), ShaderError> {
        for draw in &scene.draws {
            if let Entry::Vacant(slot) = self.pipelines.entry(Variant::of(scene, draw)) {
                let (shader, layouts) = (&self.shader, (&self.layout, &scene.material_layout));
                let pipeline = slot.key().create(pipelines, shader, layouts.0, layouts.1)?;
                slot.insert(pipeline);
            }
        }
        Ok(())
    }

    /// Renders the shadow maps of `lights` and sets the layers of each light. Lights that do not
    /// fit use shadows by cones, with a warning. `None` if no light has a map.
    pub fn record(
        &self,
        gpu: &Gpu,
        recorder: &mut Recorder,
        scene: &GpuScene,
        lights: &mut [Light],
        (grid, resolution): (&Grid, u32),
    ) -> Option<ShadowMaps> {
        let (layers, resolution) = shadow_layers::assign(lights, scene.bounds, grid, resolution);
        if layers.is_empty() {
            return None;
        }
        let texture = depth_array(&gpu.device, "shadow maps", resolution, layers.len() as u32);
        for (index, layer) in layers.iter().enumerate() {
            self.record_layer(gpu, recorder, scene, &texture, (index as u32, layer));
        }
        Some(ShadowMaps { depth: view_of_all(&texture), layers })
    }

    /// Draws one layer of a depth array.
    pub(super) fn record_layer(
        &self,
        gpu: &Gpu,
        recorder: &mut Recorder,
        scene: &GpuScene,
        texture: &Texture,
        (index, layer): (u32, &ShadowLayer),
    ) {
        let view = ShadowView { clip_from_world: layer.clip_from_world };
        let view = lumivox::gpu::uniform_buffer(&gpu.device, "shadow view", &view);
        let group = BindGroupBuilder::new(&self.layout)
            .buffer(&view)
            .buffer(&scene.draw_records)
            .build(&gpu.device, "shadow view");
        let target = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2),
            base_array_layer: index,
            array_layer_count: Some(1),
            ..Default::default()
        });
        let seen = runs_in_sight(scene, layer.clip_from_world);
        let depth = raster::depth_attachment(&target);
        recorder.render("shadow_maps", &[], Some(depth), |pass| {
            pass.bind(0, &group);
            for (variant, pipeline) in &self.pipelines {
                pass.set_pipeline(pipeline);
                for records in &seen {
                    let draw = scene.draw_of(records.start);
                    if Variant::of(scene, draw) != *variant {
                        continue;
                    }
                    let batch = &scene.batches[draw.batch];
                    pass.set_vertex_buffer(0, batch.positions.slice(..));
                    if *variant != Variant::Solid {
                        pass.bind(1, &scene.materials[draw.material].group);
                        pass.set_vertex_buffer(1, batch.attributes.slice(..));
                    }
                    raster::draw(pass, batch, draw, records.clone());
                }
            }
        });
    }
}

/// Square depth maps of one size.
pub(super) fn depth_array(
    device: &wgpu::Device,
    label: &'static str,
    resolution: u32,
    layers: u32,
) -> Texture {
    let edge = resolution;
    let descriptor = wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: edge, height: edge, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: raster::DEPTH_FORMAT,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
        view_formats: &[],
    };
    Texture::new(device, &descriptor)
}

/// A view of all layers of a depth array.
pub(super) fn view_of_all(texture: &Texture) -> TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    })
}

/// The ranges of records in each run of draws that may be visible in a projection.
fn runs_in_sight(scene: &GpuScene, clip_from_world: Mat4) -> Vec<Range<u32>> {
    let sides = sides(clip_from_world);
    let mut seen: Vec<Range<u32>> = Vec::new();
    for run in &scene.runs {
        for record in run.clone() {
            if !may_be_seen(&sides, scene.draw_of(record).bounds) {
                continue;
            }
            match seen.last_mut().filter(|last| last.end == record) {
                // Do not extend a range of the previous run, which has other triangles.
                Some(last) if last.start >= run.start => last.end += 1,
                _ => seen.push(record..record + 1),
            }
        }
    }
    seen
}

/// The sides of a projection, as planes whose distance is negative outside: left, right, bottom,
/// top, near (there is no far plane).
fn sides(clip_from_world: Mat4) -> [Vec4; 5] {
    let [x, y, z, w] = [0, 1, 2, 3].map(|row| clip_from_world.row(row));
    [w - x, w + x, w - y, w + y, w - z]
}

/// Whether any part of a box may be inside the planes: no plane has all of it outside. Rounding
/// errors count as inside.
fn may_be_seen(sides: &[Vec4; 5], bounds: Bounds) -> bool {
    let (center, half) = (bounds.center(), 0.5 * bounds.size());
    sides.iter().all(|side| {
        let normal = side.truncate();
        let reach = normal.abs().dot(half);
        let size = normal.abs().dot(center.abs()) + side.w.abs() + reach;
        let most = normal.dot(center) + side.w + reach;
        // A box whose size overflows may be anywhere.
        most.is_nan() || most >= -1e-5 * size
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::passes::shadow_layers::perspective_layer;
    use glam::Vec3;

    #[test]
    fn boxes_outside_the_frustum_are_culled() {
        let layer = perspective_layer(Vec3::ZERO, Vec3::NEG_Z, 0.7, 0.01, 256);
        let at = |center: Vec3| Bounds { min: center - 0.5, max: center + 0.5 };
        let sides = sides(layer.clip_from_world);
        assert!(may_be_seen(&sides, at(Vec3::new(0.0, 0.0, -5.0))));
        assert!(may_be_seen(&sides, at(Vec3::ZERO)));
        assert!(!may_be_seen(&sides, at(Vec3::new(0.0, 0.0, 5.0))));
        assert!(!may_be_seen(&sides, at(Vec3::new(20.0, 0.0, -5.0))));
    }
}
