//! Buffers and textures whose memory is freed when the last handle is dropped.
//!
//! In browsers, dropping a `wgpu::Buffer` frees nothing until the garbage collector runs, and the
//! collector does not know about GPU memory: only `destroy` frees it. So handles of these types are
//! reference-counted, like wgpu's own elsewhere, and the last handle destroys the resource. Bind
//! groups keep handles of their resources. A [`Recorder`](crate::gpu::Recorder) keeps handles of
//! the resources that its passes and copies use, until submission. Other commands that use a buffer
//! of this library must be submitted before the buffer's owner is dropped.

use std::ops::Deref;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A buffer that is destroyed with its last handle.
#[derive(Clone, Debug, PartialEq)]
pub struct Buffer(Arc<OwnBuffer>);

#[derive(Debug, PartialEq)]
struct OwnBuffer(wgpu::Buffer);

/// A texture that is destroyed with its last handle.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture(Arc<OwnTexture>);

#[derive(Debug, PartialEq)]
struct OwnTexture(wgpu::Texture);

/// A view of a texture, with a handle of the texture unless the caller owns it.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureView {
    view: wgpu::TextureView,
    texture: Option<Texture>,
}

/// A bind group, with handles of its resources unless the caller owns them.
#[derive(Clone, Debug)]
pub struct BindGroup {
    group: wgpu::BindGroup,
    kept: Arc<[Kept]>,
}

/// A handle that keeps a resource from being destroyed.
#[derive(Clone, Debug)]
pub enum Kept {
    /// A handle of a buffer.
    Buffer(Buffer),
    /// A handle of a texture.
    Texture(Texture),
}

/// Existing resources on all devices, of this library and of users of its types.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LiveResources {
    /// Buffers.
    pub buffers: u64,
    /// Textures.
    pub textures: u64,
    /// Bytes of the buffers.
    pub buffer_bytes: u64,
}

/// Resources created so far on all devices, by this library and through its types. The numbers only
/// grow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct MadeResources {
    /// Buffers.
    pub buffers: u64,
    /// Textures.
    pub textures: u64,
    /// Bind groups.
    pub bind_groups: u64,
    /// Bytes of the buffers and of the textures' texels.
    pub bytes: u64,
}

static BUFFERS_MADE: AtomicU64 = AtomicU64::new(0);
static TEXTURES_MADE: AtomicU64 = AtomicU64::new(0);
static BIND_GROUPS_MADE: AtomicU64 = AtomicU64::new(0);
static BYTES_MADE: AtomicU64 = AtomicU64::new(0);

impl MadeResources {
    /// The current numbers.
    pub fn now() -> Self {
        Self {
            buffers: BUFFERS_MADE.load(Ordering::Relaxed),
            textures: TEXTURES_MADE.load(Ordering::Relaxed),
            bind_groups: BIND_GROUPS_MADE.load(Ordering::Relaxed),
            bytes: BYTES_MADE.load(Ordering::Relaxed),
        }
    }
}

/// Number of times that this process has blocked until a device had finished all its work: in this
/// library, or counted with [`note_wait`]. It only grows.
pub fn waits() -> u64 {
    WAITS.load(Ordering::Relaxed)
}

/// Counts one blocking wait for a device in [`waits`].
pub fn note_wait() {
    WAITS.fetch_add(1, Ordering::Relaxed);
}

static WAITS: AtomicU64 = AtomicU64::new(0);

/// The bytes of a texture's texels in all levels, without the driver's padding.
fn texel_bytes(texture: &wgpu::Texture) -> u64 {
    let format = texture.format();
    let (block_width, block_height) = format.block_dimensions();
    let block_bytes = format.block_copy_size(None).unwrap_or(4);
    let level_bytes = |level: u32| {
        let edge = |texels: u32| u64::from((texels >> level).max(1));
        let layers = match texture.dimension() {
            wgpu::TextureDimension::D3 => edge(texture.depth_or_array_layers()),
            _ => u64::from(texture.depth_or_array_layers()),
        };
        let columns = edge(texture.width()).div_ceil(block_width.into());
        let rows = edge(texture.height()).div_ceil(block_height.into());
        columns * rows * layers * u64::from(block_bytes) * u64::from(texture.sample_count())
    };
    (0..texture.mip_level_count()).map(level_bytes).sum()
}

static BUFFERS: AtomicU64 = AtomicU64::new(0);
static TEXTURES: AtomicU64 = AtomicU64::new(0);
static BUFFER_BYTES: AtomicU64 = AtomicU64::new(0);

impl LiveResources {
    /// The current numbers.
    pub fn now() -> Self {
        Self {
            buffers: BUFFERS.load(Ordering::Relaxed),
            textures: TEXTURES.load(Ordering::Relaxed),
            buffer_bytes: BUFFER_BYTES.load(Ordering::Relaxed),
        }
    }
}

impl Buffer {
    /// A new buffer.
    pub fn new(device: &wgpu::Device, descriptor: &wgpu::BufferDescriptor<'_>) -> Self {
        Self::own(device.create_buffer(descriptor))
    }

    /// Takes ownership of a buffer: it is destroyed with this handle and its clones, and other
    /// handles become invalid.
    pub fn own(buffer: wgpu::Buffer) -> Self {
        BUFFERS.fetch_add(1, Ordering::Relaxed);
        BUFFERS_MADE.fetch_add(1, Ordering::Relaxed);
        BUFFER_BYTES.fetch_add(buffer.size(), Ordering::Relaxed);
        BYTES_MADE.fetch_add(buffer.size(), Ordering::Relaxed);
        Self(Arc::new(OwnBuffer(buffer)))
    }
}

impl Drop for OwnBuffer {
    fn drop(&mut self) {
        BUFFERS.fetch_sub(1, Ordering::Relaxed);
        BUFFER_BYTES.fetch_sub(self.0.size(), Ordering::Relaxed);
        self.0.destroy();
    }
}

impl Deref for Buffer {
    type Target = wgpu::Buffer;

    fn deref(&self) -> &wgpu::Buffer {
        &self.0.0
    }
}

impl Texture {
    /// A new texture.
    pub fn new(device: &wgpu::Device, descriptor: &wgpu::TextureDescriptor<'_>) -> Self {
        Self::own(device.create_texture(descriptor))
    }

    /// Takes ownership of a texture: it is destroyed with this handle and its clones, and other
    /// handles become invalid.
    pub fn own(texture: wgpu::Texture) -> Self {
        TEXTURES.fetch_add(1, Ordering::Relaxed);
        TEXTURES_MADE.fetch_add(1, Ordering::Relaxed);
        BYTES_MADE.fetch_add(texel_bytes(&texture), Ordering::Relaxed);
        Self(Arc::new(OwnTexture(texture)))
    }

    /// A view.
    pub fn create_view(&self, descriptor: &wgpu::TextureViewDescriptor<'_>) -> TextureView {
        TextureView { view: self.0.0.create_view(descriptor), texture: Some(self.clone()) }
    }

    /// A view of the whole texture.
    pub fn view(&self) -> TextureView {
        self.create_view(&wgpu::TextureViewDescriptor::default())
    }
}

impl Drop for OwnTexture {
    fn drop(&mut self) {
        TEXTURES.fetch_sub(1, Ordering::Relaxed);
        self.0.destroy();
    }
}

impl Deref for Texture {
    type Target = wgpu::Texture;

    fn deref(&self) -> &wgpu::Texture {
        &self.0.0
    }
}

/// A view of a texture that the caller destroys.
impl From<wgpu::TextureView> for TextureView {
    fn from(view: wgpu::TextureView) -> Self {
        Self { view, texture: None }
    }
}

impl Deref for TextureView {
    type Target = wgpu::TextureView;

    fn deref(&self) -> &wgpu::TextureView {
        &self.view
    }
}

impl BindGroup {
    pub(super) fn new(group: wgpu::BindGroup, kept: Vec<Kept>) -> Self {
        BIND_GROUPS_MADE.fetch_add(1, Ordering::Relaxed);
        Self { group, kept: kept.into() }
    }

    pub(super) fn kept(&self) -> &Arc<[Kept]> {
        &self.kept
    }

    /// `true` if a recording or another handle holds the bind group.
    pub(crate) fn is_held(&self) -> bool {
        Arc::strong_count(&self.kept) > 1
    }
}

/// A bind group of resources that the caller owns.
impl From<wgpu::BindGroup> for BindGroup {
    fn from(group: wgpu::BindGroup) -> Self {
        Self::new(group, Vec::new())
    }
}

impl Deref for BindGroup {
    type Target = wgpu::BindGroup;

    fn deref(&self) -> &wgpu::BindGroup {
        &self.group
    }
}

/// A buffer of this library or of the caller.
pub trait BufferHandle {
    /// The buffer.
    fn raw(&self) -> &wgpu::Buffer;
    /// A handle that keeps the buffer from being destroyed; `None` for the caller's own.
    fn kept(&self) -> Option<Kept>;
}

impl BufferHandle for Buffer {
    fn raw(&self) -> &wgpu::Buffer {
        self
    }

    fn kept(&self) -> Option<Kept> {
        Some(Kept::Buffer(self.clone()))
    }
}

impl BufferHandle for wgpu::Buffer {
    fn raw(&self) -> &wgpu::Buffer {
        self
    }

    fn kept(&self) -> Option<Kept> {
        None
    }
}

/// A texture view of this library or of the caller.
pub trait ViewHandle {
    /// The view.
    fn raw(&self) -> &wgpu::TextureView;
    /// A handle that keeps the view's texture from being destroyed; `None` for the caller's own.
    fn kept(&self) -> Option<Kept>;
}

impl ViewHandle for TextureView {
    fn raw(&self) -> &wgpu::TextureView {
        self
    }

    fn kept(&self) -> Option<Kept> {
        self.texture.clone().map(Kept::Texture)
    }
}

impl ViewHandle for wgpu::TextureView {
    fn raw(&self) -> &wgpu::TextureView {
        self
    }

    fn kept(&self) -> Option<Kept> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::{BindGroupBuilder, LayoutBuilder, Pipelines, Recorder, storage_buffer};
    use crate::testing::{device, read};

    /// In each case another object holds the last handle. If a resource is destroyed too early, the
    /// copy is wrong or wgpu reports an error.
    #[test]
    fn recorded_resources_live_until_submission() {
        let (device, queue) = device();
        let pipelines = Pipelines::new(&device);
        let mut shaders = crate::shaders::library();
        shaders.add(
            "test::add",
            "@group(0) @binding(0) var<storage, read> term: array<u32>;
             @group(0) @binding(1) var<storage, read_write> sum: array<u32>;
             @compute @workgroup_size(64)
             fn main(@builtin(global_invocation_id) id: vec3u) {
                 if id.x < 4u { sum[id.x] += term[id.x]; }
             }",
        );
        let layout = LayoutBuilder::compute().storage().storage_mut().build(&pipelines, "add");
        let kernel = crate::gpu::Kernel::new(&pipelines, &shaders, "test::add", "main", &[&layout])
            .expect("it links");
        let sum = storage_buffer(&device, "sum", 16);
        let mut recorder = Recorder::new(&device, &queue);
        for term in 1..4_u32 {
            let source = crate::gpu::upload(&device, "source", &[term; 4]);
            let term = storage_buffer(&device, "term", 16);
            recorder.copy((&source, 0), (&term, 0), 16);
            let group = BindGroupBuilder::new(&layout).buffer(&term).buffer(&sum);
            kernel.run_linear(&mut recorder, &[&group.build(&device, "add")], 4);
        }
        recorder.submit();
        assert_eq!(read::<u32>(&device, &queue, &sum, 4), [6; 4]);
    }

    #[test]
    fn texture_bytes_include_all_mip_levels() {
        let (device, _) = device();
        let made = |size, mip_level_count, dimension| {
            texel_bytes(&device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size,
                mip_level_count,
                sample_count: 1,
                dimension,
                format: wgpu::TextureFormat::Rgba16Float,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            }))
        };
        let size = |width, height, depth_or_array_layers| wgpu::Extent3d {
            width,
            height,
            depth_or_array_layers,
        };
        let (d2, d3) = (wgpu::TextureDimension::D2, wgpu::TextureDimension::D3);
        assert_eq!(made(size(8, 4, 1), 1, d2), 8 * 32);
        assert_eq!(made(size(8, 4, 3), 3, d2), 8 * 3 * (32 + 8 + 2));
        assert_eq!(made(size(8, 4, 4), 3, d3), 8 * (128 + 16 + 2));
    }

    #[test]
    fn dropping_the_last_handle_destroys_the_buffer() {
        let (device, queue) = device();
        let buffer = storage_buffer(&device, "buffer", 16);
        let plain = wgpu::Buffer::clone(&buffer);
        let layout =
            LayoutBuilder::compute().storage_mut().build(&Pipelines::new(&device), "a buffer");
        let group = BindGroupBuilder::new(&layout).buffer(&buffer).build(&device, "a buffer");
        let is_alive = || {
            let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
            let mut recorder = Recorder::new(&device, &queue);
            recorder.clear(&plain);
            recorder.submit();
            pollster::block_on(scope.pop()).is_none()
        };
        let clone = buffer.clone();
        drop(buffer);
        assert!(is_alive(), "a clone is left");
        drop(clone);
        assert!(is_alive(), "a bind group is left");
        drop(group);
        assert!(!is_alive(), "nothing is left but a plain handle");
    }

    #[test]
    fn a_view_keeps_its_texture_alive() {
        let (device, _) = device();
        let descriptor = wgpu::TextureDescriptor {
            label: Some("texture"),
            size: wgpu::Extent3d::default(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        };
        let texture = Texture::new(&device, &descriptor);
        let plain = wgpu::Texture::clone(&texture);
        let can_be_seen = || {
            let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
            let _ = plain.create_view(&wgpu::TextureViewDescriptor::default());
            pollster::block_on(scope.pop()).is_none()
        };
        let view = texture.view();
        drop(texture);
        assert!(can_be_seen(), "a view is left");
        let layout = LayoutBuilder::compute()
            .texture_2d_unfilterable()
            .build(&Pipelines::new(&device), "a view");
        let group = BindGroupBuilder::new(&layout).view(&view).build(&device, "a view");
        drop(view);
        assert!(can_be_seen(), "a bind group is left");
        drop(group);
        assert!(!can_be_seen(), "nothing is left but a plain handle");
    }
}
