//! Traces of a room: what one recording sees of another, and G-buffers of other layouts.

mod room;

use glam::{UVec2, Vec3};

use super::{GBuffer, GBufferViews, TraceTargets, View};
use crate::gpu::{Pipelines, Recorder, Timing, storage_buffer};
use crate::testing::{busy_room, device, read};
use crate::{Gi, GiConfig, Grid, Lights, Preset, TraceResolution, TraceSettings};

const SIZE: UVec2 = UVec2::new(32, 24);

/// A lit room, and its G-buffer.
struct Room {
    device: Pipelines,
    queue: wgpu::Queue,
    gi: Gi,
    lights: Lights,
    gbuffer: GBuffer,
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
        let view = room::view(SIZE);
        let gbuffer = own_gbuffer(&device, &queue, &gi, view);
        Self { device, queue, gi, lights, gbuffer }
    }

    fn targets(&self, settings: &TraceSettings) -> TraceTargets {
        self.gi.targets(SIZE, settings.resolution)
    }

    fn trace(&self, encoder: &mut wgpu::CommandEncoder, to: &TraceTargets, with: &TraceSettings) {
        let mut recorder = Recorder::on(&self.device, &self.queue, encoder);
        self.gi
            .trace(&mut recorder, &self.gbuffer, &self.lights, with, to)
            .expect("valid settings");
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// A trace in a submission of its own.
    fn alone(&self, settings: &TraceSettings) -> Vec<u8> {
        let targets = self.targets(settings);
        let mut encoder = self.encoder();
        self.trace(&mut encoder, &targets, settings);
        let picture = copied(&self.device, &mut encoder, &targets);
        self.queue.submit([encoder.finish()]);
        picture.read(&self.device, &self.queue)
    }
}

/// Binds textures as Lumivox's own G-buffer module has them.
fn own_gbuffer(device: &Pipelines, queue: &wgpu::Queue, gi: &Gi, view: View) -> GBuffer {
    let (depth, colors) = room::draw((device, queue), view, "textures", &room::FORMATS);
    let [normals, diffuse, specular, emission] = colors.as_slice() else {
        unreachable!("there are four formats");
    };
    let views = GBufferViews { depth: &depth, normals, diffuse, specular, emission };
    gi.bind_gbuffer(views, view)
}

/// Both pictures of the targets, in a buffer.
struct Copied(crate::gpu::Buffer);

const PICTURE_BYTES: u64 = 256 * SIZE.y as u64;

fn copied(
    device: &Pipelines,
    encoder: &mut wgpu::CommandEncoder,
    targets: &TraceTargets,
) -> Copied {
    let buffer = storage_buffer(device, "pictures", 2 * PICTURE_BYTES);
    for (number, view) in [&targets.irradiance, &targets.specular].into_iter().enumerate() {
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

/// Settings that differ in everything that a trace reads.
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
fn traces_of_one_submission_see_their_own_settings() {
    let room = Room::new();
    for resolution in [TraceResolution::Full, TraceResolution::Half] {
        let [first, second] = settings(resolution);
        let alone = [room.alone(&first), room.alone(&second)];
        assert_ne!(alone[0], alone[1], "the settings change nothing");

        // Into the same targets, one after the other.
        let targets = room.targets(&first);
        let mut encoder = room.encoder();
        let mut pictures = Vec::new();
        for settings in [&first, &second] {
            room.trace(&mut encoder, &targets, settings);
            pictures.push(copied(&room.device, &mut encoder, &targets));
        }
        // And into targets of their own, the copies last.
        let own = [room.targets(&first), room.targets(&second)];
        room.trace(&mut encoder, &own[0], &first);
        room.trace(&mut encoder, &own[1], &second);
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
    let targets = room.targets(&settings);
    for frame in 0..8 {
        let mut encoder = room.encoder();
        room.trace(&mut encoder, &targets, &settings);
        room.queue.submit([encoder.finish()]);
        room.device.poll(wgpu::PollType::wait_indefinitely()).expect("the device is there");
        assert_eq!(targets.slot_count(), 1, "frame {frame}");
    }
    // With two under way there are two.
    let (mut first, mut second) = (room.encoder(), room.encoder());
    room.trace(&mut first, &targets, &settings);
    room.trace(&mut second, &targets, &settings);
    assert_eq!(targets.slot_count(), 2);
    // One that is given up frees its slot.
    drop(first);
    room.trace(&mut second, &targets, &settings);
    assert_eq!(targets.slot_count(), 2);
}
