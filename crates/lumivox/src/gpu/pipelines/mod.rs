//! A cache of shaders, layouts and pipelines, one per device.
//!
//! Objects created with the same [`Pipelines`] share the cache: a second scene, another resolution
//! or a volume that was used before find their pipelines in it. Keys are contents: a shader is
//! identified by its linked WGSL, a bind group layout by its entries, a pipeline by both. So
//! layouts and bind groups of different objects are compatible.
//!
//! Requesting a pipeline links its shader and creates nothing on the device. Only shaders with
//! modules added at run time are created and validated at once, so that errors are reported early.
//! [`Pipelines::compile`] creates the pipelines that most scenes need, in parallel: on all cores,
//! or in the browser without blocking the page. Others are created at their first use.
//!
//! Nothing is released before the last clone is dropped: the number of pipelines grows with the
//! kinds of volumes, materials and views, not with scenes.

#[cfg(target_arch = "wasm32")]
mod browser;
mod draw;
mod lazy;
#[cfg(not(target_arch = "wasm32"))]
mod native;
mod shader;
#[cfg(test)]
mod tests;

use std::collections::{HashMap, HashSet};
use std::ops::Deref;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{ShaderError, ShaderLibrary};
pub use draw::{DrawPipeline, DrawPlan};
pub(crate) use lazy::LazyCompute;
use lazy::{Lazy, Pending};
pub use shader::{Shader, ShaderEntry};

/// The inputs of a [`LazyCompute`].
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ComputePlan {
    pub(crate) entry: ShaderEntry,
    pub(crate) groups: Vec<wgpu::BindGroupLayout>,
}

/// The pipeline cache of one device; derefs to the device. Clones share it.
#[derive(Clone, Debug)]
pub struct Pipelines {
    device: wgpu::Device,
    driver_cache: Option<wgpu::PipelineCache>,
    cache: Arc<Cache>,
}

#[derive(Debug, Default)]
struct Cache {
    linked: Mutex<Linked>,
    layouts: Mutex<HashMap<Vec<wgpu::BindGroupLayoutEntry>, wgpu::BindGroupLayout>>,
    compute: Mutex<HashMap<ComputePlan, LazyCompute>>,
    draw: Mutex<HashMap<DrawPlan, DrawPipeline>>,
    /// Requested pipelines that may not be created yet.
    pending: Mutex<Vec<Pending>>,
}

/// Shaders by origin and by content.
#[derive(Debug, Default)]
struct Linked {
    /// All libraries with different contents.
    libraries: Vec<ShaderLibrary>,
    /// Shaders by the library's index in the list, and the module's path.
    by_path: HashMap<(usize, String), Shader>,
    by_source: HashMap<String, Shader>,
}

/// Numbers of cached objects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PipelineCounts {
    /// Shader modules with different WGSL.
    pub shaders: usize,
    /// Bind group layouts with different entries.
    pub layouts: usize,
    /// Requested pipelines.
    pub pipelines: usize,
    /// Requested pipelines that the device has created.
    pub made: usize,
}

impl Pipelines {
    /// An empty cache for a device.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { device: device.clone(), driver_cache: None, cache: Arc::default() }
    }

    /// [`Self::new`] with a cache of the driver's compilations.
    pub fn with_cache(device: &wgpu::Device, driver_cache: wgpu::PipelineCache) -> Self {
        Self { driver_cache: Some(driver_cache), ..Self::new(device) }
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// The shader module `path` of a library, linked once for the same sources and constants.
    ///
    /// # Errors
    /// If the shader does not link, or contains a module that was added at run time and does not
    /// validate.
    pub fn shader(&self, library: &ShaderLibrary, path: &str) -> Result<Shader, ShaderError> {
        let mut linked = lock(&self.cache.linked);
        let known = linked.libraries.iter().position(|known| known == library);
        let number = known.unwrap_or_else(|| {
            linked.libraries.push(library.clone());
            linked.libraries.len() - 1
        });
        let key = (number, path.to_owned());
        if let Some(shader) = linked.by_path.get(&key) {
            return Ok(shader.clone());
        }
        let joined = library.link(path)?;
        let shader = if let Some(shader) = linked.by_source.get(&joined.source) {
            shader.clone()
        } else {
            let source = joined.source.clone();
            let shader = Shader::new(&self.device, path, joined)?;
            linked.by_source.insert(source, shader.clone());
            shader
        };
        linked.by_path.insert(key, shader.clone());
        Ok(shader)
    }

    /// The layout of bind groups with the given entries; its label is that of the first request.
    pub(crate) fn layout(
        &self,
        entries: Vec<wgpu::BindGroupLayoutEntry>,
        label: &str,
    ) -> wgpu::BindGroupLayout {
        let mut layouts = lock(&self.cache.layouts);
        let create = |entries: &Vec<_>| {
            let label = Some(label);
            self.device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries })
        };
        layouts.entry(entries).or_insert_with_key(create).clone()
    }

    /// A compute pipeline, created by [`Self::compile_all`], by [`Self::compile`] if it is
    /// expected, or at its first use.
    pub(crate) fn compute(&self, plan: ComputePlan) -> LazyCompute {
        let create = |plan: &ComputePlan| Lazy::new(self, plan.clone());
        lock(&self.cache.compute).entry(plan).or_insert_with_key(create).clone()
    }

    /// Makes [`Self::compile`] create a compute pipeline.
    pub(crate) fn expect(&self, pipeline: &LazyCompute) {
        if !pipeline.is_made() {
            lock(&self.cache.pending).push(Pending::Compute(pipeline.clone()));
        }
    }

    /// A render pipeline, created by [`Self::compile`] or at its first use.
    pub fn draw(&self, plan: DrawPlan) -> DrawPipeline {
        let create = |plan: &DrawPlan| {
            let pipeline = Lazy::new(self, plan.clone());
            lock(&self.cache.pending).push(Pending::Draw(pipeline.clone()));
            DrawPipeline(pipeline)
        };
        lock(&self.cache.draw).entry(plan).or_insert_with_key(create).clone()
    }

    /// Creates the requested pipelines that do not exist yet: on all cores, or in browsers without
    /// blocking the page. It skips pipelines that only scenes with motion or holes run;
    /// [`Self::compile_all`] includes them. `progress` is called with the number created and the
    /// total, unless nothing is left to create.
    ///
    /// Errors are reported to the device's error handlers, not here.
    pub async fn compile(&self, progress: &mut dyn FnMut(u32, u32)) {
        let pending = std::mem::take(&mut *lock(&self.cache.pending));
        make(&self.device, pending, progress).await;
    }

    /// [`Self::compile`] for every requested pipeline, so that no frame waits for one.
    pub async fn compile_all(&self, progress: &mut dyn FnMut(u32, u32)) {
        let mut pending = std::mem::take(&mut *lock(&self.cache.pending));
        let is_draw = |pipeline: &Pending| matches!(pipeline, Pending::Draw(_));
        pending.retain(is_draw);
        pending.extend(lock(&self.cache.compute).values().cloned().map(Pending::Compute));
        make(&self.device, pending, progress).await;
    }

    /// Every requested compute pipeline: its label, its entry point, and the linked WGSL. For tools
    /// that compile it elsewhere.
    pub fn kernels(&self) -> Vec<(String, String, String)> {
        let of = |plan: &ComputePlan| {
            let entry = &plan.entry;
            (entry.label(), entry.name().to_owned(), entry.source().to_owned())
        };
        lock(&self.cache.compute).keys().map(of).collect()
    }

    /// Numbers of cached objects.
    pub fn counts(&self) -> PipelineCounts {
        let compute = lock(&self.cache.compute);
        let draw = lock(&self.cache.draw);
        let made = compute.values().filter(|pipeline| pipeline.is_made()).count()
            + draw.values().filter(|pipeline| pipeline.0.is_made()).count();
        PipelineCounts {
            shaders: lock(&self.cache.linked).by_source.len(),
            layouts: lock(&self.cache.layouts).len(),
            pipelines: compute.len() + draw.len(),
            made,
        }
    }
}

impl Deref for Pipelines {
    type Target = wgpu::Device;

    fn deref(&self) -> &wgpu::Device {
        &self.device
    }
}

/// Creates the pipelines that do not exist yet.
async fn make(
    device: &wgpu::Device,
    mut pending: Vec<Pending>,
    progress: &mut dyn FnMut(u32, u32),
) {
    pending.retain(|pipeline| !pipeline.is_made());
    let mut seen = HashSet::new();
    pending.retain(|pipeline| seen.insert(pipeline.address()));
    if pending.is_empty() {
        return;
    }
    progress(0, pending.len() as u32);
    #[cfg(not(target_arch = "wasm32"))]
    native::make(device, &pending, progress).await;
    #[cfg(target_arch = "wasm32")]
    browser::make(device, &pending, progress).await;
}

/// Creates the compute pipelines that do not exist yet, in parallel.
pub(super) async fn make_all(pipelines: &[LazyCompute]) {
    if let Some(first) = pipelines.first() {
        let device = first.device().clone();
        let pending = pipelines.iter().cloned().map(Pending::Compute).collect();
        make(&device, pending, &mut |_, _| {}).await;
    }
}

/// Locks a mutex even after a panic, which cannot leave these maps inconsistent.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
