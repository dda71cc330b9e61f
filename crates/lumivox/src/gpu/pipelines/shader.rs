//! A linked shader, and an entry point of one.

use std::hash::{Hash, Hasher};
use std::sync::{Arc, OnceLock};

use crate::gpu::ShaderError;

/// A shader that was linked and validated; its module on the device is made with the first pipeline. Clones share it.
#[derive(Clone, Debug)]
pub struct Shader(Arc<Linked>);

#[derive(Debug)]
struct Linked {
    device: wgpu::Device,
    path: String,
    source: String,
    /// Names and workgroup sizes (zeros for entry points of other stages than compute).
    entries: Vec<(String, [u32; 3])>,
    module: OnceLock<wgpu::ShaderModule>,
}

impl Shader {
    pub(super) fn new(
        device: &wgpu::Device,
        path: &str,
        source: &str,
        reflected: &naga::Module,
    ) -> Self {
        let entries = reflected.entry_points.iter();
        Self(Arc::new(Linked {
            device: device.clone(),
            path: path.to_owned(),
            source: source.to_owned(),
            entries: entries.map(|point| (point.name.clone(), point.workgroup_size)).collect(),
            module: OnceLock::new(),
        }))
    }

    /// The entry point of that name.
    ///
    /// # Errors
    /// When there is none.
    pub fn entry(&self, name: &str) -> Result<ShaderEntry, ShaderError> {
        let found = self.0.entries.iter().position(|(entry, _)| entry == name);
        let number = found.ok_or_else(|| ShaderError {
            module: self.0.path.clone(),
            message: format!("there is no entry point `{name}`"),
        })?;
        Ok(ShaderEntry { shader: self.clone(), number })
    }

    /// The module on the device.
    fn module(&self) -> &wgpu::ShaderModule {
        self.0.module.get_or_init(|| {
            self.0.device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(&self.0.path),
                source: wgpu::ShaderSource::Wgsl(self.0.source.as_str().into()),
            })
        })
    }
}

/// Within a cache each content exists once, so identity is equality.
impl PartialEq for Shader {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for Shader {}

impl Hash for Shader {
    fn hash<H: Hasher>(&self, state: &mut H) {
        Arc::as_ptr(&self.0).hash(state);
    }
}

/// An entry point of a shader.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ShaderEntry {
    shader: Shader,
    number: usize,
}

impl ShaderEntry {
    /// Its name.
    pub fn name(&self) -> &str {
        &self.shader.0.entries[self.number].0
    }

    /// The path of the module, and the name.
    pub fn label(&self) -> String {
        format!("{}::{}", self.shader.0.path, self.name())
    }

    /// Invocations along x, y and z of one workgroup; zeros for other stages than compute.
    pub fn workgroup_size(&self) -> [u32; 3] {
        self.shader.0.entries[self.number].1
    }

    pub(super) fn module(&self) -> &wgpu::ShaderModule {
        self.shader.module()
    }
}
