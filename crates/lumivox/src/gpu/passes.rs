//! Passes that keep the resources of their bind groups until submission.

use std::ops::{Deref, DerefMut};

use crate::gpu::held::Held;
use crate::gpu::resources::{BindGroup, Kept};

/// A compute pass (by `Deref`).
#[derive(Debug)]
pub struct ComputePass<'a> {
    pub(super) pass: wgpu::ComputePass<'a>,
    pub(super) held: &'a mut Held,
}

/// A render pass (by `Deref`).
#[derive(Debug)]
pub struct RenderPass<'a> {
    pub(super) pass: wgpu::RenderPass<'a>,
    pub(super) held: &'a mut Held,
}

impl ComputePass<'_> {
    /// Sets a bind group, whose resources are kept until the pass is submitted.
    pub fn bind(&mut self, index: u32, group: &BindGroup) {
        self.held.group(group);
        self.pass.set_bind_group(index, &**group, &[]);
    }

    /// Keeps another resource that the pass uses.
    pub(crate) fn keep(&mut self, kept: Option<Kept>) {
        self.held.keep(kept);
    }
}

impl RenderPass<'_> {
    /// Sets a bind group, whose resources are kept until the pass is submitted.
    pub fn bind(&mut self, index: u32, group: &BindGroup) {
        self.held.group(group);
        self.pass.set_bind_group(index, &**group, &[]);
    }
}

impl<'a> Deref for ComputePass<'a> {
    type Target = wgpu::ComputePass<'a>;

    fn deref(&self) -> &Self::Target {
        &self.pass
    }
}

impl DerefMut for ComputePass<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.pass
    }
}

impl<'a> Deref for RenderPass<'a> {
    type Target = wgpu::RenderPass<'a>;

    fn deref(&self) -> &Self::Target {
        &self.pass
    }
}

impl DerefMut for RenderPass<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.pass
    }
}
