//! Checks of WGSL for tests, without a GPU: that shaders are valid, and that structures of Rust and
//! WGSL have one layout. All functions panic with the reason.

use std::fmt::Debug;

use bytemuck::Pod;
use lumivox_wgsl::ShaderLibrary;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Validates all modules whose path starts with `prefix`, each with all that it declares; returns
/// the number of entry points.
///
/// # Panics
/// When a module does not link or is not valid.
pub fn check_modules(library: &ShaderLibrary, prefix: &str) -> usize {
    let modules = library.paths().filter(|path| path.starts_with(prefix));
    modules.map(|path| validated(library, path).entry_points.len()).sum()
}

/// The validated module with all of its declarations.
fn validated(library: &ShaderLibrary, path: &str) -> naga::Module {
    let linked = library.link_whole(path).unwrap_or_else(|error| panic!("{error}"));
    let source = &linked.source;
    let module = naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string_with_path(source, path)));
    // Every WebGPU device packs half floats.
    let capabilities = Capabilities::default() | Capabilities::SHADER_FLOAT16_IN_FLOAT32;
    Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string_with_path(source, path)));
    let sizes = module.entry_points.iter().map(|point| (point.name.clone(), point.workgroup_size));
    assert_eq!(sizes.collect::<Vec<_>>(), linked.entries, "workgroup sizes of {path}");
    module
}

/// Compares the structure `name` of the module `path` with its Rust structure, which consists of
/// 32-bit numbers: the names and offsets of its members, and its size. Members whose names begin
/// with `padding` are ignored.
///
/// # Panics
/// When the two differ, or there is no such structure.
pub fn check_struct<T: Pod + Debug>(library: &ShaderLibrary, path: &str, name: &str) {
    let (members, size) = layout(library, path, name);
    let counts = |(name, _): &(String, u32)| !name.starts_with("padding");
    let wgsl: Vec<_> = members.into_iter().filter(counts).collect();
    let rust: Vec<_> = members_of::<T>().into_iter().filter(counts).collect();
    let of_rust = std::any::type_name::<T>();
    assert_eq!(wgsl, rust, "members of `{name}` in {path} and {of_rust}");
    assert_eq!(size, size_of::<T>() as u32, "bytes of `{name}` in {path} and {of_rust}");
}

/// Names and byte offsets of a structure's members, and the bytes from one element of an array to
/// the next.
///
/// # Panics
/// When there is no such structure.
pub fn layout(library: &ShaderLibrary, path: &str, name: &str) -> (Vec<(String, u32)>, u32) {
    let module = validated(library, path);
    let unique = format!("{}_{name}", path.replace("::", "_"));
    let found = module.types.iter().find(|(_, ty)| ty.name.as_ref() == Some(&unique));
    let Some(naga::TypeInner::Struct { members, span }) = found.map(|(_, ty)| &ty.inner) else {
        panic!("there is no structure `{name}` in {path}");
    };
    let named =
        |member: &naga::StructMember| (member.name.clone().unwrap_or_default(), member.offset);
    (members.iter().map(named).collect(), *span)
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
