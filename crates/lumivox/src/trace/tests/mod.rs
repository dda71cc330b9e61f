//! Traces of a room: several recordings in one submission, and G-buffers of other layouts.

pub(crate) mod room;

use glam::{Mat4, UVec2, Vec2, Vec3};

use super::targets::TraceTargets;
use super::{AS_THE_CAMERA, CameraView, GBuffer, GBufferViews, GiView};
use crate::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Pipelines, Recorder, Timing, storage_buffer,
};
use crate::hooks::Mounted;
use crate::testing::{busy_room, device, read};
use crate::{Gi, GiConfig, Grid, Lights, Preset, TraceResolution, TraceSettings};

const SIZE: UVec2 = UVec2::new(32, 24);

/// A lit room, and its G-buffer.
struct Room {
    device: Pipelines,
    queue: wgpu::Queue,
    gi: Gi,
    lights: Lights,
    /// The textures of its G-buffer: depth, and either all others or a packed one.
    textures: Vec<wgpu::TextureView>,
}

fn lit(config: GiConfig) -> (Pipelines, wgpu::Queue, Gi, Lights) {
    let (device, queue) = device();
    let mut gi = Gi::with_pipelines(&device, &queue, config).expect("a device");
    let geometry = busy_room().build(&device);
    pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
    let lights = gi.bind_lights(&[], Vec3::splat(0.2), None);
    let mut recorder = Recorder::new(&device, &queue);
    gi.light(&mut recorder, &lights, 2, &TraceSettings::default()).expect("valid settings");
    recorder.submit();
    (device, queue, gi, lights)
}

fn grid() -> Grid {
    Grid::fit(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), 24, Vec3::ZERO).expect("it fits")
}

impl Room {
    fn new() -> Self {
        let (device, queue, gi, lights) = lit(GiConfig::new(grid()));
        let (depth, colors) =
            room::draw((&device, &queue), (room::view(SIZE), SIZE), "textures", &room::FORMATS);
        let textures = [vec![depth], colors].concat();
        Self { device, queue, gi, lights, textures }
    }

    /// A room with the same G-buffer in another layout.
    fn packed() -> Self {
        let texture = |sample_type| wgpu::BindingType::Texture {
            sample_type,
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let bindings = [wgpu::TextureSampleType::Uint, wgpu::TextureSampleType::Depth].map(texture);
        let module = Mounted::new(include_str!("packed.wgsl"), bindings);
        let config = GiConfig { gbuffer: Some(module), ..GiConfig::new(grid()) };
        let (device, queue, gi, lights) = lit(config);
        let (depth, colors) =
            room::draw((&device, &queue), (room::view(SIZE), SIZE), "textures", &room::FORMATS);
        let packed = pack(&device, &queue, &colors);
        Self { device, queue, gi, lights, textures: vec![packed, depth] }
    }

    /// A view of the room by [`room::view`].
    fn view(&self, settings: &TraceSettings) -> GiView {
        self.view_with(settings, None)
    }

    fn view_with(&self, settings: &TraceSettings, motion: Option<&wgpu::TextureView>) -> GiView {
        let own: Vec<_> = self.textures.iter().cloned().map(Into::into).collect();
        let gbuffer = match self.textures.as_slice() {
            [depth, normals, diffuse, specular, emission] => {
                GBufferViews { depth, normals, diffuse, specular, emission, motion }.into()
            }
            _ => GBuffer::Own(&own),
        };
        let mut view = self.gi.view(gbuffer, SIZE, settings);
        view.set_camera(&self.queue, room::view(SIZE));
        view
    }

    fn trace(&self, encoder: &mut wgpu::CommandEncoder, view: &mut GiView) {
        let mut recorder = Recorder::on(&self.device, &self.queue, encoder);
        self.gi.trace(&mut recorder, view, &self.lights).expect("valid settings");
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// The result of a trace in a separate submission.
    fn alone(&self, settings: &TraceSettings) -> Vec<u8> {
        let mut view = self.view(settings);
        let mut encoder = self.encoder();
        self.trace(&mut encoder, &mut view);
        let picture = copied(&self.device, &mut encoder, &view);
        self.queue.submit([encoder.finish()]);
        picture.read(&self.device, &self.queue)
    }
}

const PACK_WGSL: &str = "
@group(0) @binding(0) var normals: texture_2d<f32>;
@group(0) @binding(1) var diffuse: texture_2d<f32>;
@group(0) @binding(2) var specular: texture_2d<f32>;
@group(0) @binding(3) var emission: texture_2d<f32>;
@group(0) @binding(4) var packed: texture_storage_2d<rgba32uint, write>;
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let turned = textureLoad(normals, id.xy, 0);
    let coat = vec2f(textureLoad(diffuse, id.xy, 0).a, textureLoad(emission, id.xy, 0).a);
    textureStore(packed, id.xy, vec4u(
        pack2x16float(turned.xy),
        pack2x16float(turned.zw),
        pack2x16float(textureLoad(specular, id.xy, 0).zw),
        pack2x16float(coat),
    ));
}";

/// Packs the textures' half floats into one texture of integers.
fn pack(
    device: &Pipelines,
    queue: &wgpu::Queue,
    colors: &[wgpu::TextureView],
) -> wgpu::TextureView {
    let format = wgpu::TextureFormat::Rgba32Uint;
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("packed"),
        size: wgpu::Extent3d { width: SIZE.x, height: SIZE.y, ..Default::default() },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    let packed = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let layout = (0..4)
        .fold(LayoutBuilder::compute(), |layout, _| layout.texture_2d_unfilterable())
        .storage_texture(wgpu::TextureViewDimension::D2, format)
        .build(device, "pack");
    let mut shaders = crate::shaders::library();
    shaders.add("test::pack", PACK_WGSL);
    let kernel = Kernel::new(device, &shaders, "test::pack", "main", &[&layout]).expect("links");
    let group = colors
        .iter()
        .fold(BindGroupBuilder::new(&layout), BindGroupBuilder::view)
        .view(&packed)
        .build(device, "pack");
    let mut recorder = Recorder::new(device, queue);
    kernel.run(&mut recorder, &[&group], [SIZE.x, SIZE.y, 1]);
    recorder.submit();
    packed
}

/// Both pictures of the targets, in a buffer.
struct Copied(crate::gpu::Buffer);

const PICTURE_BYTES: u64 = 256 * SIZE.y as u64;

fn copied(device: &Pipelines, encoder: &mut wgpu::CommandEncoder, view: &GiView) -> Copied {
    let buffer = storage_buffer(device, "pictures", 2 * PICTURE_BYTES);
    for (number, view) in [view.irradiance(), view.specular()].into_iter().enumerate() {
        encoder.copy_texture_to_buffer(
            view.texture().as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: number as u64 * PICTURE_BYTES,
                    bytes_per_row: Some(256),
                    rows_per_image: None,
                },
            },
            wgpu::Extent3d { width: SIZE.x, height: SIZE.y, depth_or_array_layers: 1 },
        );
    }
    Copied(buffer)
}

impl Copied {
    fn read(&self, device: &Pipelines, queue: &wgpu::Queue) -> Vec<u8> {
        let bytes: Vec<u8> = read(device, queue, &self.0, 2 * PICTURE_BYTES as usize);
        assert!(bytes.iter().any(|byte| *byte != 0), "the picture is black");
        bytes
    }
}

/// Two settings that differ in all inputs of a trace.
fn settings(resolution: TraceResolution) -> [TraceSettings; 2] {
    let first = TraceSettings { resolution, ..TraceSettings::preset(Preset::Balanced) };
    let second = TraceSettings {
        resolution,
        diffuse_cones: 12,
        specular: false,
        occlusion_distance_m: 0.2,
        ..TraceSettings::preset(Preset::High)
    };
    [first, second]
}

#[test]
#[ignore = "slow: over three seconds"]
fn traces_of_one_submission_see_their_own_settings() {
    let room = Room::new();
    for resolution in [TraceResolution::Full, TraceResolution::Half] {
        let [first, second] = settings(resolution);
        let alone = [room.alone(&first), room.alone(&second)];
        assert_ne!(alone[0], alone[1], "the settings change nothing");

        // Into the same targets, one after the other.
        let mut view = room.view(&first);
        let mut encoder = room.encoder();
        let mut pictures = Vec::new();
        for settings in [first, second] {
            view.settings = settings;
            room.trace(&mut encoder, &mut view);
            pictures.push(copied(&room.device, &mut encoder, &view));
        }
        // Then into separate targets, with the copies last.
        let mut own = [room.view(&first), room.view(&second)];
        for view in &mut own {
            room.trace(&mut encoder, view);
        }
        pictures.extend(own.each_ref().map(|own| copied(&room.device, &mut encoder, own)));
        room.queue.submit([encoder.finish()]);
        for (number, picture) in pictures.iter().enumerate() {
            let picture = picture.read(&room.device, &room.queue);
            assert!(picture == alone[number % 2], "trace {number} at {resolution:?}");
        }
    }
}

#[test]
fn steady_frames_make_no_new_slots() {
    let room = Room::new();
    let [settings, _] = settings(TraceResolution::Half);
    let mut view = room.view(&settings);
    for frame in 0..8 {
        let mut encoder = room.encoder();
        room.trace(&mut encoder, &mut view);
        room.queue.submit([encoder.finish()]);
        // The device's callbacks free slots; another test's thread may be about to call them.
        while !view.targets().are_slots_free() {
            room.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device is there");
            std::thread::yield_now();
        }
        assert_eq!(view.targets().slot_count(), 1, "frame {frame}");
    }
    // Two recordings in progress need two slots.
    let (mut first, mut second) = (room.encoder(), room.encoder());
    room.trace(&mut first, &mut view);
    room.trace(&mut second, &mut view);
    assert_eq!(view.targets().slot_count(), 2);
    // A dropped recording frees its slot.
    drop(first);
    room.trace(&mut second, &mut view);
    assert_eq!(view.targets().slot_count(), 2);
}

#[test]
fn predicted_target_bytes_match_allocated_targets() {
    let (device, _) = device();
    for resolution in [TraceResolution::Full, TraceResolution::Half] {
        for preset in [Preset::Balanced, Preset::Realtime] {
            let settings = TraceSettings { resolution, ..TraceSettings::preset(preset) };
            for size in [SIZE, UVec2::new(37, 21)] {
                let targets = TraceTargets::new(&device, size, &settings);
                let known = TraceTargets::bytes(size, &settings);
                assert_eq!(targets.memory(), known, "{size} {settings:?}");
            }
        }
    }
}

/// A frame after a cut equals the first frame of new targets; one without a cut does not.
#[test]
#[ignore = "slow: over three seconds"]
fn forget_discards_all_history() {
    let room = Room::new();
    for resolution in [TraceResolution::Full, TraceResolution::Half] {
        let settings = TraceSettings { resolution, ..TraceSettings::preset(Preset::Realtime) };
        let fresh = room.alone(&settings);
        let mut view = room.view(&settings);
        assert!(view.is_temporal());
        let mut pictures = Vec::new();
        for forgets in [false, false, true] {
            if forgets {
                view.forget();
            }
            let mut encoder = room.encoder();
            room.trace(&mut encoder, &mut view);
            let picture = copied(&room.device, &mut encoder, &view);
            room.queue.submit([encoder.finish()]);
            pictures.push(picture.read(&room.device, &room.queue));
        }
        assert!(pictures[0] == fresh, "the first frame at {resolution:?}");
        assert!(pictures[1] != fresh, "nothing is recalled at {resolution:?}");
        assert!(pictures[2] == fresh, "the frame after a cut at {resolution:?}");
    }
}

/// A frame without cones sets the previous camera; after a cut there is no previous camera.
#[test]
fn a_skipped_frame_keeps_its_camera() {
    let room = Room::new();
    let mut view = room.view(&TraceSettings::preset(Preset::Realtime));
    let first = view.camera().clip_from_world;
    let second = CameraView::new(Mat4::from_scale(Vec3::splat(0.5)) * first, Vec3::ONE);
    view.skip();
    view.set_camera(&room.queue, second);
    assert_eq!(view.previous_clip_from_world(), first);
    view.forget();
    view.set_camera(&room.queue, second);
    assert_eq!(view.previous_clip_from_world(), second.clip_from_world);
}

/// An engine may pass NaN as light for one frame.
#[test]
fn nan_light_does_not_enter_the_history() {
    let room = Room::new();
    for resolution in [TraceResolution::Full, TraceResolution::Half] {
        let settings = TraceSettings { resolution, ..TraceSettings::preset(Preset::Realtime) };
        let mut view = room.view(&settings);
        let broken = room.gi.bind_lights(&[], Vec3::splat(f32::NAN), None);
        let frames = [&room.lights, &broken, &room.lights].map(|lights| {
            let mut encoder = room.encoder();
            let mut recorder = Recorder::on(&room.device, &room.queue, &mut encoder);
            room.gi.trace(&mut recorder, &mut view, lights).expect("valid settings");
            drop(recorder);
            let picture = copied(&room.device, &mut encoder, &view);
            room.queue.submit([encoder.finish()]);
            picture.read(&room.device, &room.queue)
        });
        let is_infinite = |half: &[u8]| u16::from_le_bytes([half[0], half[1]]) & 0x7c00 == 0x7c00;
        let infinite =
            |frame: &[u8]| frame.chunks_exact(2).filter(|half| is_infinite(half)).count();
        assert_eq!(infinite(&frames[2]), 0, "half floats of {}", frames[2].len() / 2);
        let is_dark = |pixel: &[u8]| pixel[..6].iter().all(|byte| *byte == 0);
        let dark = |frame: &[u8]| frame.chunks_exact(8).filter(|pixel| is_dark(pixel)).count();
        assert!(dark(&frames[2]) <= dark(&frames[0]), "{} are dark", dark(&frames[2]));
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_packed_gbuffer_gives_the_bits_of_the_textures() {
    let (textures, packed) = (Room::new(), Room::packed());
    for resolution in [TraceResolution::Full, TraceResolution::Half] {
        for settings in settings(resolution) {
            let (expected, found) = (textures.alone(&settings), packed.alone(&settings));
            let differ = expected.iter().zip(&found).filter(|(a, b)| a != b).count();
            assert_eq!(differ, 0, "bytes of {} differ: {settings:?}", expected.len());
        }
    }
}

const MOTION_WGSL: &str = "
import package::trace::gbuffer::{load_motion, load_surface};
import package::trace::view::view;
@group(1) @binding(0) var<storage, read_write> motion: array<vec2f>;
@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= view.size) { return; }
    motion[id.y * view.size.x + id.x] = load_motion(id.xy, load_surface(id.xy).position_in_world);
}";

/// The result of `load_motion` for each pixel, row by row.
fn motion_of(room: &Room, seen: &GiView) -> Vec<Vec2> {
    let Room { device, queue, gi, .. } = room;
    let mut shaders = gi.shaders().clone();
    shaders.add("test::motion", MOTION_WGSL);
    let layout = LayoutBuilder::compute().storage_mut().build(device, "motion");
    let layouts = [gi.globals_layout(), &layout, gi.lights_layout(), gi.gbuffer_layout()];
    let kernel = Kernel::new(device, &shaders, "test::motion", "main", &layouts).expect("links");
    let pixels = u64::from(SIZE.element_product());
    let output = storage_buffer(device, "motion", 8 * pixels);
    let group = BindGroupBuilder::new(&layout).buffer(&output).build(device, "motion");
    let mut recorder = Recorder::new(device, queue);
    let groups = [gi.globals(), &group, &room.lights.group, seen.group()];
    kernel.run(&mut recorder, &groups, [SIZE.x, SIZE.y, 1]);
    recorder.submit();
    read(device, queue, &output, pixels as usize)
}

/// Compares motion by the camera with the place of the pixel's surface in the previous frame; then
/// tests motion from a texture.
#[test]
fn motion_is_current_minus_previous_surface_position() {
    let room = Room::new();
    let view = room::view(SIZE);
    // The previous camera: its picture was scaled about the middle and moved.
    let moved =
        Mat4::from_translation(Vec3::new(0.2, 0.1, 0.0)) * Mat4::from_scale(Vec3::splat(0.5));
    let previous = moved * view.clip_from_world;
    let settings = TraceSettings::default();
    let mut seen = room.view(&settings);
    // A jitter is not motion.
    let jitter = Vec2::new(0.3, -0.2);
    seen.set_camera(&room.queue, CameraView { clip_from_world: previous, jitter, ..view });
    room.trace(&mut room.encoder(), &mut seen);
    seen.set_camera(&room.queue, view);
    for (index, motion) in motion_of(&room, &seen).into_iter().enumerate() {
        let pixel = UVec2::new(index as u32 % SIZE.x, index as u32 / SIZE.x);
        let uv = (pixel.as_vec2() + 0.5) / SIZE.as_vec2();
        // The point of the room that the pixel shows.
        let ndc = Vec2::new(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
        let far = view.clip_from_world.inverse().project_point3(ndc.extend(1e-4));
        let direction = (far - view.position).normalize();
        let walls = Vec3::select(direction.cmpgt(Vec3::ZERO), Vec3::new(1.0, 0.7, 0.9), Vec3::ZERO);
        let distance = ((walls - view.position) / direction).min_element();
        let was = previous.project_point3(view.position + distance * direction);
        let expected = uv - Vec2::new(0.5 + 0.5 * was.x, 0.5 - 0.5 * was.y);
        if (uv - 0.5).length() > 0.15 {
            assert!((motion - expected).length() < 1e-3, "{pixel}: {motion}, not {expected}");
        }
    }

    // Without movement of the camera the motion is zero.
    seen.forget();
    seen.set_camera(&room.queue, view);
    let still = motion_of(&room, &seen);
    assert!(still.iter().all(|motion| motion.length() < 1e-4));

    let size = wgpu::Extent3d { width: SIZE.x, height: SIZE.y, ..Default::default() };
    let texture = room.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("motion"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rg32Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let motion_at = |i: u32| i as f32 / SIZE.element_product() as f32;
    let mut content: Vec<[f32; 2]> =
        (0..SIZE.element_product()).map(|i| [motion_at(i), -motion_at(i)]).collect();
    // A surface that is static in the world has the camera's motion.
    content[7] = [AS_THE_CAMERA, 0.0];
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(8 * SIZE.x),
        rows_per_image: None,
    };
    let bytes = bytemuck::cast_slice(&content);
    room.queue.write_texture(texture.as_image_copy(), bytes, layout, size);
    let motion = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let read = motion_of(&room, &room.view_with(&settings, Some(&motion)));
    assert!(read[7].length() < 1e-4, "{}", read[7]);
    content[7] = read[7].to_array();
    assert!(read.iter().zip(&content).all(|(read, written)| *read == Vec2::from(*written)));
}
