//! Kernels in two variants.

use super::{Kernel, Pipelines, ShaderError, ShaderLibrary};

/// A kernel in two variants: one with all code, and a smaller one without what most scenes do not
/// need. On GPUs the smaller one has more waves; software drivers would run that code in vain.
///
/// Neither is created before [`Self::expect`] or its first use.
#[derive(Clone, Debug)]
pub struct KernelVariants {
    without: Kernel,
    with: Kernel,
}

impl KernelVariants {
    /// As [`Kernel::new`]; the constant `feature` of `package::constants` is 1 or 0.
    ///
    /// # Errors
    /// As [`Kernel::new`].
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        feature: &'static str,
        module: &str,
        entry: &str,
        layouts: &[&wgpu::BindGroupLayout],
    ) -> Result<Self, ShaderError> {
        let variant = |has_feature: bool| {
            let mut shaders = shaders.clone();
            shaders.constant_u32(feature, has_feature.into());
            Kernel::deferred(device, &shaders, module, entry, layouts)
        };
        Ok(Self { without: variant(false)?, with: variant(true)? })
    }

    /// The variant with or without the feature.
    pub fn variant(&self, has_feature: bool) -> &Kernel {
        if has_feature { &self.with } else { &self.without }
    }

    /// Queues a variant for [`Pipelines::compile`].
    pub fn expect(&self, device: &Pipelines, has_feature: bool) {
        self.variant(has_feature).expect(device);
    }
}
