//! Kernels that sample emitters.

use crate::gpu::{Kernel, Pipelines, ShaderError, ShaderLibrary};

/// A kernel in two variants: one that samples emitters, and a smaller one for geometry without
/// emitters.
///
/// Neither is created before [`Self::expect`] or its first use.
#[derive(Clone, Debug)]
pub(crate) struct SamplingKernel {
    without: Kernel,
    with: Kernel,
}

impl SamplingKernel {
    /// As [`Kernel::new`].
    ///
    /// # Errors
    /// As [`Kernel::new`].
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        module: &str,
        entry: &str,
        layouts: &[&wgpu::BindGroupLayout],
    ) -> Result<Self, ShaderError> {
        let variant = |samples: bool| {
            let mut shaders = shaders.clone();
            shaders.constant_u32("SAMPLES_EMITTERS", samples.into());
            Kernel::deferred(device, &shaders, module, entry, layouts)
        };
        Ok(Self { without: variant(false)?, with: variant(true)? })
    }

    /// The variant for geometry with or without emitters.
    pub(crate) fn variant(&self, has_emitters: bool) -> &Kernel {
        if has_emitters { &self.with } else { &self.without }
    }

    /// Queues a variant for [`Pipelines::compile`].
    pub(crate) fn expect(&self, device: &Pipelines, has_emitters: bool) {
        self.variant(has_emitters).expect(device);
    }
}
