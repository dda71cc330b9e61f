//! The class that `js/` calls: the library on the page's device.

use std::collections::BTreeMap;

use glam::{UVec2, Vec3};
use js_sys::{Array, Function};
use lumivox::gpu::{Buffer, Pipelines, Recorder, storage_buffer};
use lumivox::{
    EnvironmentLight, EnvironmentMap, Frame, GBuffer, Geometry, GeometryBatch, Gi, GiView, Indices,
    Light, Lights, Panorama, SurfaceMaterial, SurfaceTexture, TraceSettings, VertexAttributes,
    VertexPositions,
};
use wasm_bindgen::prelude::*;

use crate::error::PageError;
use crate::foreign::{Role, view};
use crate::options::{self, Options};
use crate::probes::Probes;
use crate::{device, input};

/// Runs when the module is loaded: panics, which are defects of this project, then name their
/// place.
#[wasm_bindgen(start)]
pub fn start() {
    console_error_panic_hook::set_once();
}

/// The global illumination of one scene.
#[wasm_bindgen]
#[derive(Debug)]
pub struct SharedGi {
    device: wgpu::Device,
    queue: wgpu::Queue,
    gi: Gi,
    settings: TraceSettings,
    faces_per_frame: Option<u32>,
    meshes: BTreeMap<u32, Mesh>,
    geometry: Geometry,
    lights: Lights,
    sources: Vec<Light>,
    map: Option<EnvironmentMap>,
    view: Option<GiView>,
    probes: Option<Probes>,
}

/// The buffers of a geometry, which JavaScript fills.
#[derive(Debug)]
struct Mesh {
    positions: Buffer,
    attributes: Option<Buffer>,
    indices: Buffer,
    batch: GeometryBatch,
}

#[wasm_bindgen]
impl SharedGi {
    /// Global illumination on a device, for the box between two corners (six numbers, m).
    #[wasm_bindgen(js_name = adopt)]
    pub async fn adopt(
        device: JsValue,
        bounds: Vec<f32>,
        names: Vec<String>,
        values: Vec<String>,
    ) -> Result<SharedGi, JsValue> {
        let [low, high] = corners(&bounds)?;
        let Options { config, settings, faces_per_frame } =
            Options::new([low, high], &names, &values)?;
        let (device, queue) = device::adopt(&device).await?;
        let gi = Gi::with_pipelines(&Pipelines::new(&device), &queue, config)
            .map_err(PageError::from)?;
        let lights = gi.bind_lights(&[], Vec3::ZERO, None);
        Ok(Self {
            device,
            queue,
            gi,
            settings,
            faces_per_frame,
            meshes: BTreeMap::new(),
            geometry: Geometry::default(),
            lights,
            sources: Vec::new(),
            map: None,
            view: None,
            probes: None,
        })
    }

    /// Compiles the remaining pipelines while the page continues; reports the number done and the
    /// total.
    pub async fn compile(&self, on_progress: Option<Function>) -> Result<(), JsValue> {
        let mut report = |done: u32, total: u32| {
            if let Some(call) = &on_progress {
                let _ = call.call2(&JsValue::NULL, &done.into(), &total.into());
            }
        };
        let pipelines = self.gi.pipelines().clone();
        let prepared = self.gi.prepare(&self.geometry, 1, true, &self.settings);
        prepared.map_err(PageError::from)?;
        pipelines.compile(&mut report).await;
        // Kernels for holes and textures are compiled later, in the background.
        wasm_bindgen_futures::spawn_local(async move {
            pipelines.compile_all(&mut |_, _| ()).await;
        });
        Ok(())
    }

    /// Makes the buffers of a geometry. `layout`: bytes, stride and offset of positions; bytes and
    /// stride of other attributes; offsets plus one, or 0, of two sets of texture coordinates and
    /// the colour; bytes of all indices, and of one. Returns three `GPUBuffer`s to be filled, the
    /// second undefined without attributes.
    pub fn mesh(&mut self, id: u32, layout: &[u32]) -> Result<Array, JsValue> {
        let &[
            position_bytes,
            stride,
            offset,
            bytes,
            width,
            first,
            second,
            color,
            index_bytes,
            index,
        ] = layout
        else {
            return Err(PageError::value("a geometry is described by ten numbers").into());
        };
        let buffer = |label, bytes: u32| storage_buffer(&self.device, label, u64::from(bytes));
        let positions = buffer("three.js: positions", position_bytes);
        let indices = buffer("three.js: indices", index_bytes);
        let attributes = (bytes > 0).then(|| buffer("three.js: attributes", bytes));
        let place = VertexPositions { buffer: (*positions).clone(), stride, offset: offset.into() };
        let format = if index == 2 { wgpu::IndexFormat::Uint16 } else { wgpu::IndexFormat::Uint32 };
        let numbers = Indices { buffer: (*indices).clone(), format, offset: 0 };
        let mut batch = GeometryBatch::new(place, numbers, Vec::new());
        batch.attributes = attributes.as_ref().map(|buffer| {
            let mut attributes = VertexAttributes::new((**buffer).clone(), width);
            attributes.texcoords = [first.checked_sub(1), second.checked_sub(1)];
            attributes.color = color.checked_sub(1);
            attributes
        });
        let handle = |buffer: &Buffer| {
            buffer.as_webgpu().map_or(JsValue::UNDEFINED, |buffer| buffer.clone().into())
        };
        let handles = Array::new();
        handles.push(&handle(&positions));
        handles.push(&attributes.as_ref().map_or(JsValue::UNDEFINED, handle));
        handles.push(&handle(&indices));
        self.meshes.insert(id, Mesh { positions, attributes, indices, batch });
        Ok(handles)
    }

    /// Frees the buffers of a geometry that no draw uses.
    #[wasm_bindgen(js_name = removeMesh)]
    pub fn remove_mesh(&mut self, id: u32) {
        self.meshes.remove(&id);
    }

    /// Sets a material; `index` is at most the number of materials. A texture is `null` or a
    /// `GPUTexture`; its twelve `places` are the set of texture coordinates, the wrapping in x and
    /// y (0 clamped, 1 repeated, 2 mirrored), and a 3x3 matrix.
    #[wasm_bindgen(js_name = setMaterial)]
    pub fn set_material(
        &mut self,
        index: usize,
        row: &[f32],
        textures: Vec<JsValue>,
        places: &[f32],
    ) -> Result<(), JsValue> {
        let mut material = input::material(row)?;
        let (places, _) = places.as_chunks::<12>();
        let mut images = [const { None }; 3];
        for (image, (texture, place)) in images.iter_mut().zip(textures.iter().zip(places)) {
            if !texture.is_null() && !texture.is_undefined() {
                *image = Some(self.surface_texture(texture, place)?);
            }
        }
        [material.reflectance_texture, material.emission_texture, material.transmission_texture] =
            images;
        let materials = &mut self.geometry.materials;
        if index >= materials.len() {
            materials.resize(index + 1, SurfaceMaterial::default());
        }
        materials[index] = material;
        Ok(())
    }

    fn surface_texture(
        &self,
        texture: &JsValue,
        place: &[f32; 12],
    ) -> Result<SurfaceTexture, PageError> {
        let wrap = |number: f32| match number as u32 {
            1 => wgpu::AddressMode::Repeat,
            2 => wgpu::AddressMode::MirrorRepeat,
            _ => wgpu::AddressMode::ClampToEdge,
        };
        let sampler = self.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("three.js: image"),
            address_mode_u: wrap(place[1]),
            address_mode_v: wrap(place[2]),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let view = view(&self.device, texture, Role::Image)?;
        let mut surface = SurfaceTexture::new(view, sampler);
        surface.texcoord_set = place[0] as u32;
        surface.transform = input::texture_transform(&place[3..]);
        Ok(surface)
    }

    /// Sets the draws; `input.rs` has the numbers.
    #[wasm_bindgen(js_name = setDraws)]
    pub fn set_draws(&mut self, rows: &[u32], matrices: &[f32]) -> Result<(), JsValue> {
        let draws = input::draws(rows, matrices)?;
        let mut by_mesh: BTreeMap<u32, Vec<lumivox::Draw>> = BTreeMap::new();
        for (mesh, draw) in draws {
            by_mesh.entry(mesh).or_default().push(draw);
        }
        let mut batches = Vec::with_capacity(by_mesh.len());
        for (id, draws) in by_mesh {
            let Some(mesh) = self.meshes.get(&id) else {
                return Err(PageError::value(format!("there is no geometry {id}")).into());
            };
            let mut batch = mesh.batch.clone();
            batch.draws = draws;
            batches.push(batch);
        }
        // Objects that have moved once may have new vertices, too.
        let may_change = batches.iter().flat_map(|batch| &batch.draws).any(|draw| !draw.is_static);
        let known = &self.geometry.batches;
        let is_known = batches.len() == known.len()
            && batches
                .iter()
                .zip(known)
                .all(|(new, old)| new.positions == old.positions && new.draws == old.draws);
        if may_change || !is_known {
            self.geometry.batches = batches;
        }
        Ok(())
    }

    /// Sets the lights; `input.rs` has the numbers.
    #[wasm_bindgen(js_name = setLights)]
    pub fn set_lights(&mut self, rows: &[f32]) -> Result<(), JsValue> {
        self.sources = input::lights(rows)?;
        Ok(())
    }

    /// Sets a picture of the surroundings, three numbers per texel, or none if the width is 0.
    /// Returns its suns: each sun's direction of light, irradiance, and half angle (rad).
    #[wasm_bindgen(js_name = setEnvironment)]
    pub fn set_environment(
        &mut self,
        width: u32,
        height: u32,
        rgb: &[f32],
    ) -> Result<Vec<f32>, JsValue> {
        if width == 0 {
            self.map = None;
            return Ok(Vec::new());
        }
        let (rgb, _) = rgb.as_chunks::<3>();
        let map = EnvironmentMap::new(&self.device, &self.queue, Panorama { width, height, rgb })
            .map_err(PageError::from)?;
        let suns = map.peaks().iter().flat_map(|peak| {
            let [a, b, c] = (-peak.direction).to_array();
            let [red, green, blue] = peak.irradiance.to_array();
            [a, b, c, red, green, blue, peak.angular_radius_rad]
        });
        let suns = suns.collect();
        self.map = Some(map);
        Ok(suns)
    }

    /// Sets the G-buffer of a picture of this size: depth, normals, specular reflectance, motion
    /// (`gbuffer.wgsl`). Returns two `GPUTexture`s: irradiance (alpha: open share of the
    /// hemisphere), and reflected radiance.
    #[wasm_bindgen(js_name = setScreen)]
    pub fn set_screen(
        &mut self,
        width: u32,
        height: u32,
        textures: Vec<JsValue>,
    ) -> Result<Array, JsValue> {
        let [depth, others @ ..] = textures.as_slice() else {
            return Err(PageError::value("the G-buffer has four textures").into());
        };
        let mut resources = vec![view(&self.device, depth, Role::Depth)?.into()];
        for texture in others {
            resources.push(view(&self.device, texture, Role::GBuffer)?.into());
        }
        let size = UVec2::new(width, height);
        let view = self.gi.view(GBuffer::Own(&resources), size, &self.settings);
        let handles = Array::new();
        for output in [view.irradiance(), view.specular()] {
            let texture = output.texture();
            handles.push(
                &texture.as_webgpu().map_or(JsValue::UNDEFINED, |texture| texture.clone().into()),
            );
        }
        self.view = Some(view);
        Ok(handles)
    }

    /// Makes the probes at their first call. Returns their `GPUTexture` and seven numbers
    /// (`Probes::place`).
    pub fn probes(&mut self) -> Result<Array, JsValue> {
        if self.probes.is_none() {
            self.probes = Some(Probes::new(&self.gi).map_err(PageError::from)?);
        }
        let result = Array::new();
        if let Some(probes) = &self.probes {
            let texture = probes.texture().as_webgpu();
            result.push(&texture.map_or(JsValue::UNDEFINED, |texture| texture.clone().into()));
            for number in probes.place() {
                result.push(&number.into());
            }
        }
        Ok(result)
    }

    /// Changes one of the cones' settings.
    #[wasm_bindgen(js_name = setOption)]
    pub fn set_option(&mut self, name: &str, value: &str) -> Result<(), JsValue> {
        let mut settings = self.settings;
        options::set(&mut settings, name, value)?;
        let has_other_targets = settings.temporal != self.settings.temporal
            || settings.resolution != self.settings.resolution;
        if has_other_targets {
            return Err(
                PageError::value(format!("{name} cannot be changed; make another one")).into()
            );
        }
        self.settings = settings;
        if let Some(view) = &mut self.view {
            view.settings = settings;
        }
        Ok(())
    }

    /// Records and submits a frame: voxels, one bounce of their light, cones. `sky` is the radiance
    /// of the surroundings or the factor of their picture, and their rotation (rad). With
    /// `has_probes` also a turn of the probes. Returns three numbers: 1 if voxels are late and the
    /// frame should be repeated; voxels; faces.
    pub fn render(
        &mut self,
        camera: &[f32],
        sky: &[f32],
        has_probes: bool,
    ) -> Result<Vec<u32>, JsValue> {
        let camera = input::camera(camera)?;
        let &[red, green, blue, rotation_rad] = sky else {
            return Err(PageError::value("the sky is four numbers").into());
        };
        let radiance = Vec3::new(red, green, blue);
        let environment = EnvironmentLight { radiance, map: self.map.as_ref(), rotation_rad };
        self.lights.update(&self.queue, &self.sources, environment, None);
        let Some(view) = &mut self.view else {
            return Err(PageError::value("there is no G-buffer yet").into());
        };
        view.set_camera(&self.queue, camera);
        let mut encoder =
            self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut recorder = Recorder::on(&self.device, &self.queue, &mut encoder);
        let (settings, lights) = (&self.settings, &self.lights);
        let faces_per_frame = self.faces_per_frame;
        let frame = Frame { faces_per_frame, ..Frame::new(&self.geometry, lights, settings) };
        let status = self.gi.frame(&mut recorder, frame);
        let traced = self.gi.trace(&mut recorder, view, lights);
        let gathered = match &mut self.probes {
            Some(probes) if has_probes => {
                probes.record((&self.gi, lights), settings, &mut recorder)
            }
            _ => Ok(()),
        };
        drop(recorder);
        self.queue.submit([encoder.finish()]);
        let status = traced.and(gathered).and(status).map_err(PageError::from)?;
        Ok(vec![u32::from(status.is_late), status.voxels, status.faces])
    }

    /// Records and submits a turn of the probes, and a bounce of the voxels' light, without a
    /// picture. Returns `true` once all probes have gathered.
    #[wasm_bindgen(js_name = lightProbes)]
    pub fn light_probes(&mut self) -> Result<bool, JsValue> {
        let Some(probes) = &mut self.probes else { return Ok(true) };
        let mut encoder =
            self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut recorder = Recorder::on(&self.device, &self.queue, &mut encoder);
        let (settings, lights) = (&self.settings, &self.lights);
        let faces_per_frame = self.faces_per_frame;
        let frame = Frame { faces_per_frame, ..Frame::new(&self.geometry, lights, settings) };
        let status = self.gi.frame(&mut recorder, frame);
        let gathered = probes.record((&self.gi, lights), settings, &mut recorder);
        drop(recorder);
        self.queue.submit([encoder.finish()]);
        gathered.and(status).map_err(PageError::from)?;
        Ok(probes.are_lit())
    }

    /// Forgets the light of earlier frames: for a cut.
    pub fn cut(&mut self) {
        if let Some(view) = &mut self.view {
            view.forget();
        }
    }

    /// Bytes on the GPU.
    pub fn memory(&self) -> f64 {
        let gi: u64 = self.gi.memory().iter().map(|(_, bytes)| bytes).sum();
        let view = self.view.as_ref().map_or(0, GiView::memory);
        let map = self.map.as_ref().map_or(0, EnvironmentMap::memory);
        let meshes: u64 = self.meshes.values().map(Mesh::bytes).sum();
        let probes = self.probes.as_ref().map_or(0, Probes::bytes);
        (gi + view + map + meshes + probes) as f64
    }
}

impl Mesh {
    fn bytes(&self) -> u64 {
        let attributes = self.attributes.as_ref().map_or(0, |buffer| buffer.size());
        self.positions.size() + attributes + self.indices.size()
    }
}

fn corners(bounds: &[f32]) -> Result<[Vec3; 2], PageError> {
    match bounds {
        [a, b, c, d, e, f] => Ok([Vec3::new(*a, *b, *c), Vec3::new(*d, *e, *f)]),
        _ => Err(PageError::value("bounds are six numbers")),
    }
}
