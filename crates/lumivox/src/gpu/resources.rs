//! Buffers and textures whose memory is given back at once.
//!
//! In browsers dropping a `wgpu::Buffer` frees nothing before the garbage collector comes, and that knows nothing of the
//! GPU's memory: only `destroy` gives it back. So handles of these types are counted, as wgpu does elsewhere, and the
//! last one to go destroys. Bind groups hold handles of what they bind, and a [`Recorder`](crate::gpu::Recorder) of what
//! its passes use and its copies touch, until they are submitted. What else is recorded with a buffer of this library
//! must be submitted before the object that the buffer belongs to goes.

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

/// A view of a texture, with a handle of it unless it is a caller's.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureView {
    view: wgpu::TextureView,
    texture: Option<Texture>,
}

/// A bind group, with handles of what it binds unless that is a caller's.
#[derive(Clone, Debug)]
pub struct BindGroup {
    group: wgpu::BindGroup,
    kept: Arc<[Kept]>,
}

/// A handle that keeps something from being destroyed.
#[derive(Clone, Debug)]
pub enum Kept {
    /// Of a buffer.
    Buffer(Buffer),
    /// Of a texture.
    Texture(Texture),
}

/// What this library and those who use its types hold on all devices.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LiveResources {
    /// Buffers.
    pub buffers: u64,
    /// Textures.
    pub textures: u64,
    /// Bytes of the buffers.
    pub buffer_bytes: u64,
}

static BUFFERS: AtomicU64 = AtomicU64::new(0);
static TEXTURES: AtomicU64 = AtomicU64::new(0);
static BUFFER_BYTES: AtomicU64 = AtomicU64::new(0);

impl LiveResources {
    /// What there is now.
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

    /// Takes a buffer over: other handles of it are of no use once this one and its clones are gone.
    pub fn own(buffer: wgpu::Buffer) -> Self {
        BUFFERS.fetch_add(1, Ordering::Relaxed);
        BUFFER_BYTES.fetch_add(buffer.size(), Ordering::Relaxed);
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

    /// Takes a texture over: other handles of it are of no use once this one and its clones are gone.
    pub fn own(texture: wgpu::Texture) -> Self {
        TEXTURES.fetch_add(1, Ordering::Relaxed);
        Self(Arc::new(OwnTexture(texture)))
    }

    /// A view.
    pub fn create_view(&self, descriptor: &wgpu::TextureViewDescriptor<'_>) -> TextureView {
        TextureView { view: self.0.0.create_view(descriptor), texture: Some(self.clone()) }
    }

    /// A view of all of it.
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

/// A caller's view, whose texture is the caller's to destroy.
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
        Self { group, kept: kept.into() }
    }

    pub(super) fn kept(&self) -> &Arc<[Kept]> {
        &self.kept
    }
}

/// A caller's bind group of the caller's own resources.
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

/// A buffer of this library, or a caller's own.
pub trait BufferHandle {
    /// The buffer.
    fn raw(&self) -> &wgpu::Buffer;
    /// A handle, if it would be destroyed without one.
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

/// A view of a texture of this library, or a caller's own.
pub trait ViewHandle {
    /// The view.
    fn raw(&self) -> &wgpu::TextureView;
    /// A handle, if its texture would be destroyed without one.
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
