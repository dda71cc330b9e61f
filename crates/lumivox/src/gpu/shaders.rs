//! Shader modules, linked at run time.
//!
//! Shaders are WGSL with WESL's `import` statements, so that stages share code without copies. A
//! library of modules maps paths (`package::cones::cone`) to sources; linking a module adds its
//! imports and yields plain WGSL. Constants that Rust and WGSL share are defined once in Rust and
//! injected as the module `package::constants`. The module `package::volume` is the interface of
//! the volumes (dense, octree): a library is made for one of them.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::{Debug, Write as _};
use std::sync::Arc;

use bytemuck::Pod;

use crate::gpu::LINEAR_WORKGROUP_SIZE;

/// A shader that does not link, parse or validate.
#[derive(Debug, thiserror::Error)]
#[error("shader {module}: {message}")]
pub struct ShaderError {
    /// The path of the module that was linked.
    pub module: String,
    /// The message of the linker or of naga, with the place.
    pub message: String,
}

/// The memory layout of a WGSL struct, as naga reflects it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StructLayout {
    /// Bytes from one element of an array to the next.
    pub size: u32,
    /// Name and byte offset of each member.
    pub members: Vec<(String, u32)>,
}

/// The modules that shaders are linked from. Clones are cheap: they share unchanged parts.
#[derive(Clone, Debug, Default)]
pub struct ShaderLibrary {
    content: Arc<Content>,
}

/// Everything that the linked shaders depend on.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Content {
    modules: BTreeMap<String, Cow<'static, str>>,
    constants: BTreeMap<&'static str, String>,
}

impl ShaderLibrary {
    /// An empty library with the constants that all stages share.
    pub(crate) fn new(modules: &[(&str, &'static str)]) -> Self {
        let mut library = Self::default();
        library.constant_u32("LINEAR_WORKGROUP_SIZE", LINEAR_WORKGROUP_SIZE);
        for (path, source) in modules {
            library.add(path, *source);
        }
        library
    }

    /// Adds the module `path` (without the leading `package::`), or replaces it.
    pub fn add(&mut self, path: &str, source: impl Into<Cow<'static, str>>) -> &mut Self {
        self.content_mut().modules.insert(format!("package::{path}"), source.into());
        self
    }

    /// Defines a `u32` constant of the module `package::constants`.
    pub fn constant_u32(&mut self, name: &'static str, value: u32) -> &mut Self {
        let declaration = format!("const {name}: u32 = {value}u;");
        self.content_mut().constants.insert(name, declaration);
        self
    }

    /// Defines an `f32` constant of the module `package::constants`.
    pub fn constant_f32(&mut self, name: &'static str, value: f32) -> &mut Self {
        let declaration = format!("const {name}: f32 = {value:?}f;");
        self.content_mut().constants.insert(name, declaration);
        self
    }

    fn content_mut(&mut self) -> &mut Content {
        Arc::make_mut(&mut self.content)
    }

    pub(crate) fn content(&self) -> &Arc<Content> {
        &self.content
    }

    /// The paths of all modules, without the leading `package::`.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.content.modules.keys().map(|path| path.trim_start_matches("package::"))
    }

    /// The source of the module `path`, as it was added.
    pub fn source(&self, path: &str) -> Option<&str> {
        self.content.modules.get(&format!("package::{path}")).map(AsRef::as_ref)
    }

    /// Plain WGSL of the module `path` with everything that it imports; unused declarations are dropped.
    ///
    /// # Errors
    /// When a module is missing or does not parse.
    pub fn link(&self, path: &str) -> Result<String, ShaderError> {
        self.compile(path, true)
    }

    /// As [`Self::link`], but keeps every declaration of the module, for reflection.
    ///
    /// # Errors
    /// When a module is missing or does not parse.
    pub fn link_whole(&self, path: &str) -> Result<String, ShaderError> {
        self.compile(path, false)
    }

    fn compile(&self, path: &str, strip: bool) -> Result<String, ShaderError> {
        let fail = |message: String| ShaderError { module: path.to_owned(), message };
        let mut resolver = wesl::VirtualResolver::new();
        for (path, source) in &self.content.modules {
            let parsed = path.parse().map_err(|e| fail(format!("{path}: {e}")))?;
            resolver.add_module(parsed, Cow::Borrowed(source));
        }
        let mut constants = String::new();
        for declaration in self.content.constants.values() {
            let _ = writeln!(constants, "{declaration}");
        }
        let constants_path = "package::constants".parse().map_err(|e| fail(format!("{e}")))?;
        resolver.add_module(constants_path, Cow::Owned(constants));

        let mut compiler = wesl::Wesl::new("").set_custom_resolver(resolver);
        compiler.use_stripping(strip);
        let root = format!("package::{path}").parse().map_err(|e| fail(format!("{e}")))?;
        let compiled = compiler.compile(&root).map_err(|e| fail(e.to_string()))?;
        Ok(compiled.to_string())
    }

    /// Links `path`, validates it with naga and returns the reflected module and its WGSL.
    ///
    /// # Errors
    /// When it does not link, parse or validate.
    pub fn reflect(&self, path: &str) -> Result<(naga::Module, String), ShaderError> {
        let source = self.link(path)?;
        let fail = |message: String| ShaderError { module: path.to_owned(), message };
        let module = naga::front::wgsl::parse_str(&source)
            .map_err(|e| fail(e.emit_to_string_with_path(&source, path)))?;
        naga::valid::Validator::new(
            naga::valid::ValidationFlags::all(),
            // Every WebGPU device packs half floats.
            naga::valid::Capabilities::default()
                | naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32,
        )
        .validate(&module)
        .map_err(|e| fail(e.emit_to_string_with_path(&source, path)))?;
        Ok((module, source))
    }

    /// The layout of the struct `name` of the module `path`, which the Rust struct has to match.
    ///
    /// # Errors
    /// When the module does not link or parse, or has no such struct.
    pub fn struct_layout(&self, path: &str, name: &str) -> Result<StructLayout, ShaderError> {
        let source = self.link_whole(path)?;
        let fail = |message: String| ShaderError { module: path.to_owned(), message };
        let module = naga::front::wgsl::parse_str(&source)
            .map_err(|e| fail(e.emit_to_string_with_path(&source, path)))?;
        let (_, ty) = module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some(name))
            .ok_or_else(|| fail(format!("there is no struct `{name}`")))?;
        let naga::TypeInner::Struct { members, span } = &ty.inner else {
            return Err(fail(format!("`{name}` is not a struct")));
        };
        let members = members
            .iter()
            .map(|member| (member.name.clone().unwrap_or_default(), member.offset))
            .collect();
        Ok(StructLayout { size: *span, members })
    }

    /// Compares the struct `name` of the module `path` with its Rust struct: the names and offsets
    /// of its members, and its size. Members whose names begin with `padding` are ignored.
    ///
    /// # Errors
    /// As [`Self::struct_layout`], and when the two differ.
    pub fn check_struct<T: Pod + Debug>(&self, path: &str, name: &str) -> Result<(), ShaderError> {
        let StructLayout { size, members } = self.struct_layout(path, name)?;
        let counts = |(name, _): &(String, u32)| !name.starts_with("padding");
        let wgsl: Vec<_> = members.into_iter().filter(counts).collect();
        let rust: Vec<_> = members_of::<T>().into_iter().filter(counts).collect();
        if (&rust, size_of::<T>() as u32) == (&wgsl, size) {
            return Ok(());
        }
        let message = format!(
            "`{name}` has {size} bytes and {wgsl:?}, {} has {} bytes and {rust:?}",
            std::any::type_name::<T>(),
            size_of::<T>()
        );
        Err(ShaderError { module: path.to_owned(), message })
    }
}

/// The members of a struct of 32-bit numbers with their byte offsets, from its debug output: plain
/// old data has no gaps.
fn members_of<T: Pod + Debug>() -> Vec<(String, u32)> {
    let text = format!("{:?}", T::zeroed());
    let mut members: Vec<(String, u32)> = Vec::new();
    let (mut depth, mut bytes, mut word) = (0, 0, String::new());
    for letter in text.chars().chain([' ']) {
        if letter.is_ascii_alphanumeric() || "_.-".contains(letter) {
            word.push(letter);
            continue;
        }
        if word.starts_with(|c: char| c.is_ascii_digit() || c == '-') {
            bytes += 4;
        } else if depth == 1 && letter == ':' {
            members.push((word.clone(), bytes));
        }
        word.clear();
        match letter {
            '{' | '(' | '[' => depth += 1,
            '}' | ')' | ']' => depth -= 1,
            _ => {}
        }
    }
    members
}
