//! A cache of shaders, layouts and pipelines, one a device.
//!
//! All that is made on a device with one [`Pipelines`] shares what is in it: a second scene,
//! another resolution or a volume that was there before find their pipelines made. What counts is
//! content. A shader is known by its linked WGSL, a bind group layout by its entries, a pipeline by
//! both. So a layout of an older object fits a bind group of a newer one.
//!
//! Asking for a pipeline links its shader and makes nothing on the device, unless the shader
//! contains a module that was added at run time: then the device checks it, so that errors come
//! early. [`Pipelines::compile`] makes the pipelines that most scenes need, at once: on all cores, or
//! by the browser beside the page. The first use makes all others.
//!
//! Nothing is given up before the last clone goes: pipelines number with the kinds of volumes,
//! materials and views that were in use, not with scenes.

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

/// The cache of one device, which it stands for as well (by `Deref`). Clones share it.
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
    /// Asked for, and not known to be made.
    pending: Mutex<Vec<Pending>>,
}

/// Shaders by where they come from and by what they are.
#[derive(Debug, Default)]
struct Linked {
    /// Every library so far that differs from the others.
    libraries: Vec<ShaderLibrary>,
    /// By the library's place in the list, and the module's path.
    by_path: HashMap<(usize, String), Shader>,
    by_source: HashMap<String, Shader>,
}

/// How many there are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PipelineCounts {
    /// Shader modules whose WGSL differs.
    pub shaders: usize,
    /// Bind group layouts whose entries differ.
    pub layouts: usize,
    /// Pipelines that were asked for.
    pub pipelines: usize,
    /// Of those, the ones that the device has made.
    pub made: usize,
}

impl Pipelines {
    /// An empty cache for a device.
    pub fn new(device: &wgpu::Device) -> Self {
        Self { device: device.clone(), driver_cache: None, cache: Arc::default() }
    }

    /// As [`Self::new`], with what the driver has compiled before.
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
    /// When it does not link, or contains a module that was added at run time and does not
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

    /// The layout of bind groups with the given entries; the first label that it was asked for with
    /// stays.
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

    /// A compute pipeline, which is made by [`Self::compile_all`], by [`Self::compile`] if it is
    /// expected, or at its first use.
    pub(crate) fn compute(&self, plan: ComputePlan) -> LazyCompute {
        let create = |plan: &ComputePlan| Lazy::new(self, plan.clone());
        lock(&self.cache.compute).entry(plan).or_insert_with_key(create).clone()
    }

    /// Lets [`Self::compile`] make a compute pipeline.
    pub(crate) fn expect(&self, pipeline: &LazyCompute) {
        if !pipeline.is_made() {
            lock(&self.cache.pending).push(Pending::Compute(pipeline.clone()));
        }
    }

    /// A pipeline that draws, which is made by [`Self::compile`] or at its first use.
    pub fn draw(&self, plan: DrawPlan) -> DrawPipeline {
        let create = |plan: &DrawPlan| {
            let pipeline = Lazy::new(self, plan.clone());
            lock(&self.cache.pending).push(Pending::Draw(pipeline.clone()));
            DrawPipeline(pipeline)
        };
        lock(&self.cache.draw).entry(plan).or_insert_with_key(create).clone()
    }

    /// Makes the pipelines that were asked for and are not there: on all cores, or in browsers
    /// without holding the page up. It leaves out what only scenes that move or have holes run:
    /// [`Self::compile_all`] makes that, too. `progress` gets the number made and the total, if any
    /// are left to make.
    ///
    /// An error of the device is reported like that of any failed call, not here.
    pub async fn compile(&self, progress: &mut dyn FnMut(u32, u32)) {
        let pending = std::mem::take(&mut *lock(&self.cache.pending));
        make(&self.device, pending, progress).await;
    }

    /// As [`Self::compile`], for every pipeline that was asked for: a frame then never waits for
    /// one.
    pub async fn compile_all(&self, progress: &mut dyn FnMut(u32, u32)) {
        let mut pending = std::mem::take(&mut *lock(&self.cache.pending));
        let is_draw = |pipeline: &Pending| matches!(pipeline, Pending::Draw(_));
        pending.retain(is_draw);
        pending.extend(lock(&self.cache.compute).values().cloned().map(Pending::Compute));
        make(&self.device, pending, progress).await;
    }

    /// How many there are of each.
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

/// Makes those of some pipelines that are not there.
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

/// Makes those of some compute pipelines that are not there, all at once.
pub(super) async fn make_all(pipelines: &[LazyCompute]) {
    if let Some(first) = pipelines.first() {
        let device = first.device().clone();
        let pending = pipelines.iter().cloned().map(Pending::Compute).collect();
        make(&device, pending, &mut |_, _| {}).await;
    }
}

/// A panic elsewhere leaves nothing half done in these maps.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
