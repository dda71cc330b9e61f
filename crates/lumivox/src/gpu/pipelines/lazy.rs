//! Pipelines that are created on demand.

use std::sync::{Arc, OnceLock};

use super::{ComputePlan, DrawPlan, Pipelines};

/// The description of a pipeline.
pub(crate) trait Plan {
    type Pipeline: std::fmt::Debug;

    fn create(&self, device: &wgpu::Device, cache: Option<&wgpu::PipelineCache>) -> Self::Pipeline;
}

/// A pipeline that is created once, at its first use or earlier. Clones share it.
#[derive(Debug)]
pub(crate) struct Lazy<P: Plan>(Arc<Slot<P>>);

#[derive(Debug)]
struct Slot<P: Plan> {
    device: wgpu::Device,
    driver_cache: Option<wgpu::PipelineCache>,
    plan: P,
    pipeline: OnceLock<P::Pipeline>,
}

pub(crate) type LazyCompute = Lazy<ComputePlan>;

impl<P: Plan> Lazy<P> {
    pub(super) fn new(pipelines: &Pipelines, plan: P) -> Self {
        let Pipelines { device, driver_cache, .. } = pipelines.clone();
        Self(Arc::new(Slot { device, driver_cache, plan, pipeline: OnceLock::new() }))
    }

    pub(crate) fn get(&self) -> &P::Pipeline {
        self.0.pipeline.get_or_init(|| self.0.create())
    }

    pub(super) fn is_made(&self) -> bool {
        self.0.pipeline.get().is_some()
    }

    pub(super) fn device(&self) -> &wgpu::Device {
        &self.0.device
    }
}

impl<P: Plan> Slot<P> {
    fn create(&self) -> P::Pipeline {
        self.plan.create(&self.device, self.driver_cache.as_ref())
    }
}

impl<P: Plan> Clone for Lazy<P> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

/// A compute or render pipeline that may not be created yet.
#[derive(Clone, Debug)]
pub(super) enum Pending {
    Compute(LazyCompute),
    Draw(Lazy<DrawPlan>),
}

impl Pending {
    pub(super) fn is_made(&self) -> bool {
        match self {
            Self::Compute(pipeline) => pipeline.is_made(),
            Self::Draw(pipeline) => pipeline.is_made(),
        }
    }

    /// An address that identifies the pipeline: all clones have the same.
    pub(super) fn address(&self) -> *const () {
        match self {
            Self::Compute(pipeline) => Arc::as_ptr(&pipeline.0).cast(),
            Self::Draw(pipeline) => Arc::as_ptr(&pipeline.0).cast(),
        }
    }

    /// Size of its shader in bytes, an estimate of the compile time.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn source_bytes(&self) -> usize {
        match self {
            Self::Compute(pipeline) => pipeline.0.plan.entry.source_bytes(),
            Self::Draw(pipeline) => pipeline.0.plan.vertex.source_bytes(),
        }
    }

    /// Creates the pipeline if it does not exist.
    pub(super) fn make(&self) {
        match self {
            Self::Compute(pipeline) => {
                pipeline.get();
            }
            Self::Draw(pipeline) => {
                pipeline.get();
            }
        }
    }

    /// Creates a pipeline and discards it, to observe the calls that wgpu makes.
    #[cfg(target_arch = "wasm32")]
    pub(super) fn rehearse(&self) {
        match self {
            Self::Compute(pipeline) => drop(pipeline.0.create()),
            Self::Draw(pipeline) => drop(pipeline.0.create()),
        }
    }
}

impl Plan for ComputePlan {
    type Pipeline = wgpu::ComputePipeline;

    fn create(
        &self,
        device: &wgpu::Device,
        cache: Option<&wgpu::PipelineCache>,
    ) -> wgpu::ComputePipeline {
        let label = self.entry.label();
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&label),
            layout: Some(&pipeline_layout(device, &label, &self.groups)),
            module: self.entry.module(),
            entry_point: Some(self.entry.name()),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache,
        })
    }
}

pub(super) fn pipeline_layout(
    device: &wgpu::Device,
    label: &str,
    groups: &[wgpu::BindGroupLayout],
) -> wgpu::PipelineLayout {
    let groups: Vec<_> = groups.iter().map(Some).collect();
    device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &groups,
        immediate_size: 0,
    })
}
