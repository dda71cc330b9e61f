//! Bevy without a window: frames on demand, and pictures of what cameras see.

use std::path::Path;

use bevy::app::PluginsState;
use bevy::asset::RenderAssetUsages;
use bevy::camera::RenderTarget;
use bevy::log::LogPlugin;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::RenderPlugin;
use bevy::render::error_handler::RenderErrorHandler;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{TextureFormat, TextureUsages};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use bevy::render::settings::{WgpuLimits, WgpuSettings};
use bevy::render::texture::GpuImage;
use bevy::window::ExitCondition;
use bevy_lumivox::LumivoxEvent;
use bevy_lumivox::lumivox::wgpu;

/// A picture, in linear values of the camera's exposure.
pub struct Shot {
    pub size: UVec2,
    pub rgb: Vec<Vec3>,
}

/// The plugins of an app without a window and a log, on a device with at most these limits.
pub fn plugins(constrained_limits: Option<WgpuLimits>) -> impl PluginGroup {
    DefaultPlugins
        .set(WindowPlugin {
            primary_window: None,
            exit_condition: ExitCondition::DontExit,
            ..WindowPlugin::default()
        })
        .build()
        .disable::<LogPlugin>()
        .set(RenderPlugin {
            synchronous_pipeline_compilation: true,
            render_creation: WgpuSettings { constrained_limits, ..WgpuSettings::default() }.into(),
            ..RenderPlugin::default()
        })
}

/// Finishes building an app; [`App::update`] then renders a frame.
pub fn start(app: &mut App) {
    while app.plugins_state() == PluginsState::Adding {
        bevy::tasks::tick_global_task_pools_on_main_thread();
    }
    // By default Bevy stops drawing and only logs the error.
    app.insert_resource(RenderErrorHandler(|error, _, _| {
        panic!("{:?}: {}", error.ty, error.description)
    }));
    app.finish();
    app.cleanup();
}

/// An image that a camera renders into.
pub fn target(app: &mut App, size: UVec2) -> (Handle<Image>, RenderTarget) {
    let mut image = Image::new_target_texture(size.x, size.y, TextureFormat::Rgba16Float, None);
    image.asset_usage = RenderAssetUsages::all();
    image.texture_descriptor.usage |= TextureUsages::COPY_SRC;
    let handle = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    (handle.clone(), RenderTarget::Image(handle.into()))
}

/// Runs frames until global illumination is ready.
///
/// # Panics
/// If it fails or takes too many frames.
pub fn wait_until_ready(app: &mut App) {
    let mut cursor = app.world().resource::<Messages<LumivoxEvent>>().get_cursor();
    for _ in 0..400 {
        app.update();
        for event in cursor.read(app.world().resource::<Messages<LumivoxEvent>>()) {
            match event {
                LumivoxEvent::Ready => return,
                LumivoxEvent::Failed { error } => panic!("{error}"),
                other => println!("{other:?}"),
            }
        }
        // Without a window nothing limits the frame rate: a slow GPU would fall behind.
        wait_for_gpu(app);
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    panic!("no global illumination after 400 frames");
}

/// Reads an image back from the GPU after the last frame.
///
/// # Panics
/// If it is not on the GPU or the read-back fails.
pub fn shot(app: &App, image: &Handle<Image>) -> Shot {
    let world = app.sub_app(RenderApp).world();
    let images = world.resource::<RenderAssets<GpuImage>>();
    let texture = &images.get(image).expect("an image on the GPU").texture;
    let (device, queue) = (world.resource::<RenderDevice>(), world.resource::<RenderQueue>());
    let device = device.wgpu_device();
    let size = UVec2::new(texture.width(), texture.height());
    let row = (8 * size.x).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("shot"),
        size: u64::from(row * size.y),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row),
                rows_per_image: None,
            },
        },
        texture.size(),
    );
    queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |result| result.expect("mapped"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
    let bytes = buffer.slice(..).get_mapped_range().expect("mapped");
    let half = |bytes: &[u8]| half::f16::from_le_bytes([bytes[0], bytes[1]]).to_f32();
    let pixel = |pixel: &[u8]| Vec3::new(half(&pixel[0..]), half(&pixel[2..]), half(&pixel[4..]));
    let rows = bytes.chunks(row as usize);
    let rgb = rows.flat_map(|row| row[..8 * size.x as usize].chunks(8).map(pixel)).collect();
    Shot { size, rgb }
}

/// The mean of the pictures of some frames.
pub fn mean_shot(app: &mut App, image: &Handle<Image>, frames: u32) -> Shot {
    mean_of(app, image, frames, |_| ())
}

/// The mean picture of some frames, with a change before each.
pub fn mean_of(
    app: &mut App,
    image: &Handle<Image>,
    frames: u32,
    mut change: impl FnMut(&mut App),
) -> Shot {
    let mut sum: Option<Shot> = None;
    for _ in 0..frames {
        change(app);
        app.update();
        let next = shot(app, image);
        match &mut sum {
            None => sum = Some(next),
            Some(sum) => sum.rgb.iter_mut().zip(next.rgb).for_each(|(sum, next)| *sum += next),
        }
    }
    let mut mean = sum.expect("some frames");
    mean.rgb.iter_mut().for_each(|pixel| *pixel /= frames as f32);
    mean
}

/// Waits until the GPU has finished all frames.
pub fn wait_for_gpu(app: &App) {
    let world = app.sub_app(RenderApp).world();
    let device = world.resource::<RenderDevice>().wgpu_device();
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the device answers");
}

impl Shot {
    /// Mean luminance (Rec. 709).
    pub fn mean_luminance(&self) -> f32 {
        self.rgb.iter().map(|rgb| luminance(*rgb)).sum::<f32>() / self.rgb.len() as f32
    }

    /// Saves the picture as a PNG, multiplied by `factor`.
    ///
    /// # Panics
    /// When the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>, factor: f32) {
        let bytes: Vec<u8> =
            self.rgb.iter().flat_map(|rgb| (*rgb * factor).to_array().map(srgb)).collect();
        if let Some(folder) = path.as_ref().parent() {
            std::fs::create_dir_all(folder).expect("a folder for the picture");
        }
        let (width, height) = (self.size.x, self.size.y);
        image::save_buffer(path, &bytes, width, height, image::ColorType::Rgb8).expect("saved");
    }
}

/// Luminance of a linear colour (Rec. 709).
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// The sRGB encoding of a linear value: IEC 61966-2-1.
fn srgb(linear: f32) -> u8 {
    let encoded =
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (encoded.clamp(0.0, 1.0) * 255.0).round() as u8
}
