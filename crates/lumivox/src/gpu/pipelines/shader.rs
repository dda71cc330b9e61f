//! A linked shader, and its entry points.

use std::hash::{Hash, Hasher};
use std::sync::{Arc, OnceLock};

use lumivox_wgsl::LinkedShader;

use crate::gpu::ShaderError;

/// A linked shader; its module on the device is created with its first pipeline. Clones share it.
#[derive(Clone, Debug)]
pub struct Shader(Arc<Content>);

#[derive(Debug)]
struct Content {
    device: wgpu::Device,
    path: String,
    linked: LinkedShader,
    module: OnceLock<wgpu::ShaderModule>,
}

impl Shader {
    /// Creates and validates the shader on the device now if it has a module added at run time.
    ///
    /// # Errors
    /// If the device rejects the shader. Browsers report that only later, in the log.
    pub(super) fn new(
        device: &wgpu::Device,
        path: &str,
        linked: LinkedShader,
    ) -> Result<Self, ShaderError> {
        let is_built = linked.added.is_empty();
        let (device, path) = (device.clone(), path.to_owned());
        let shader = Self(Arc::new(Content { device, path, linked, module: OnceLock::new() }));
        if !is_built {
            shader.check()?;
        }
        Ok(shader)
    }

    /// The entry point with that name.
    ///
    /// # Errors
    /// If the shader has no such entry point.
    pub fn entry(&self, name: &str) -> Result<ShaderEntry, ShaderError> {
        let found = self.0.linked.entries.iter().position(|(entry, _)| entry == name);
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
                source: wgpu::ShaderSource::Wgsl(self.0.linked.source.as_str().into()),
            })
        })
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn check(&self) -> Result<(), ShaderError> {
        let scope = self.0.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let info = ready(self.module().get_compilation_info());
        let error = ready(scope.pop()).flatten();
        match info.and_then(|info| self.error_in(&info)) {
            Some(error) => Err(error),
            None => error.map_or(Ok(()), |error| {
                Err(ShaderError { module: self.0.path.clone(), message: error.to_string() })
            }),
        }
    }

    #[cfg(target_arch = "wasm32")]
    fn check(&self) -> Result<(), ShaderError> {
        let shader = self.clone();
        let info = self.module().get_compilation_info();
        wasm_bindgen_futures::spawn_local(async move {
            if let Some(error) = shader.error_in(&info.await) {
                tracing::error!("{error}");
            }
        });
        Ok(())
    }

    /// The first error in the compiler's messages, with its module.
    fn error_in(&self, info: &wgpu::CompilationInfo) -> Option<ShaderError> {
        let is_error = |message: &&wgpu::CompilationMessage| {
            message.message_type == wgpu::CompilationMessageType::Error
        };
        let message = info.messages.iter().find(is_error)?;
        let linked = &self.0.linked;
        let place = message.location.and_then(|location| linked.place_of(location.line_number));
        let (module, line) = place.unwrap_or((&self.0.path, None));
        let message = match line {
            Some(line) => format!("line {line}: {}", message.message),
            None => format!("with {}: {}", linked.added.join(", "), message.message),
        };
        Some(ShaderError { module: module.to_owned(), message })
    }
}

/// The result of a future that is ready at once outside of browsers.
#[cfg(not(target_arch = "wasm32"))]
fn ready<T>(future: impl Future<Output = T>) -> Option<T> {
    let mut context = std::task::Context::from_waker(std::task::Waker::noop());
    match std::pin::pin!(future).poll(&mut context) {
        std::task::Poll::Ready(value) => Some(value),
        std::task::Poll::Pending => None,
    }
}

/// A cache contains each shader only once, so identity is equality.
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
    /// The entry point's name.
    pub fn name(&self) -> &str {
        &self.shader.0.linked.entries[self.number].0
    }

    /// The path of the module, and the name of the entry point.
    pub fn label(&self) -> String {
        format!("{}::{}", self.shader.0.path, self.name())
    }

    /// Invocations along x, y and z of one workgroup; zeros for stages other than compute.
    pub fn workgroup_size(&self) -> [u32; 3] {
        self.shader.0.linked.entries[self.number].1
    }

    pub(super) fn module(&self) -> &wgpu::ShaderModule {
        self.shader.module()
    }

    /// The linked WGSL.
    pub(super) fn source(&self) -> &str {
        &self.shader.0.linked.source
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn source_bytes(&self) -> usize {
        self.source().len()
    }
}
