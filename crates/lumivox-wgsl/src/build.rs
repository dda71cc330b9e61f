//! Parsing a crate's modules in its build script.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs};

use crate::module::{Declaration, Module, Use, parse_with_imports, unique_name};

/// Files that implement one path.
#[derive(Clone, Copy, Debug)]
pub struct Slot {
    /// The path, without the leading `package::`.
    pub path: &'static str,
    /// The paths of the files; [`crate::ShaderLibrary::fill`] takes one of them.
    pub implementations: &'static [&'static str],
}

/// Parses all `*.wgsl` below `src` of the crate that is built, except in folders `tests`, and
/// writes `shaders.rs` to `OUT_DIR` for `include!`: `MODULES`, and `SLOTS` with the names of
/// implementations. The resolved modules lie in `OUT_DIR/wgsl`, for reading.
///
/// `a/b/c.wgsl` is the module `prefix::a::b::c`, and `a/b/b.wgsl` is `prefix::a::b`.
///
/// If a module does not parse, or imports a name that this crate's modules do not declare, the
/// build fails with file and line.
///
/// # Panics
/// When a file cannot be read or written.
pub fn build_modules(prefix: &str, slots: &[Slot]) {
    let root = PathBuf::from(env::var("CARGO_MANIFEST_DIR").expect("Cargo sets it"));
    let out = PathBuf::from(env::var("OUT_DIR").expect("Cargo sets it"));
    let source = root.join("src");
    println!("cargo::rerun-if-changed=src");
    let mut files = Vec::new();
    find_files(&source, &mut files);
    files.sort();
    let (mut modules, mut implementations) = (Vec::new(), Vec::new());
    let mut problems = Vec::new();
    for file in &files {
        let name = path_of(prefix, file.strip_prefix(&source).expect("it is below"));
        let slot = slots.iter().find(|slot| slot.implementations.contains(&name.as_str()));
        let path = slot.map_or(name.as_str(), |slot| slot.path);
        let text =
            fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        match parse_with_imports(path, &text, false) {
            Ok((mut module, imports)) => {
                module.is_built = true;
                let list = if slot.is_some() { &mut implementations } else { &mut modules };
                list.push(Parsed { file, name, module, imports });
            }
            Err(error) => {
                problems.push(format!("{}:{}: {}", file.display(), error.line, error.message));
            }
        }
    }
    // A module that does not parse would cause further errors in its importers.
    if problems.is_empty() {
        problems = unresolved(prefix, &modules, &implementations, slots);
    }
    if !problems.is_empty() {
        for problem in problems {
            println!("cargo::error={problem}");
        }
        std::process::exit(1);
    }

    let mut text = String::from("use std::borrow::Cow::Borrowed;\n");
    let _ = write!(text, "pub(crate) static MODULES: &[lumivox_wgsl::Module] = &[");
    let _ = fs::remove_dir_all(out.join("wgsl"));
    for Parsed { name, module, .. } in &modules {
        write_module(&mut text, module);
        write_readable(&out, name, module);
    }
    text.push_str("];\n");
    if !slots.is_empty() {
        let _ =
            write!(text, "pub(crate) static IMPLEMENTATIONS: &[(&str, lumivox_wgsl::Module)] = &[");
        for Parsed { name, module, .. } in &implementations {
            let _ = write!(text, "({name:?}, ");
            write_module(&mut text, module);
            text.truncate(text.len() - 1);
            text.push_str("),");
            write_readable(&out, name, module);
        }
        text.push_str("];\n");
    }
    fs::write(out.join("shaders.rs"), text).expect("OUT_DIR can be written");
}

fn find_files(folder: &Path, files: &mut Vec<PathBuf>) {
    let entries =
        fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    for entry in entries {
        let path = entry.expect("the folder can be listed").path();
        if path.is_dir() && !path.ends_with("tests") {
            find_files(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "wgsl") {
            files.push(path);
        }
    }
}

/// The path of the module in a file.
fn path_of(prefix: &str, file: &Path) -> String {
    let file = file.with_extension("");
    let mut parts: Vec<_> = file.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    if let [.., folder, name] = parts.as_slice()
        && folder == name
    {
        parts.pop();
    }
    if !prefix.is_empty() {
        parts.insert(0, prefix.to_owned());
    }
    parts.join("::")
}

/// A module with its file.
struct Parsed<'a> {
    file: &'a PathBuf,
    name: String,
    module: Module,
    imports: Vec<(Use, u32)>,
}

/// Errors for imports of names that this crate's modules do not declare, and for duplicates of
/// unique names. Modules of other crates, and constants, are unknown here: linking checks them.
fn unresolved(
    prefix: &str,
    modules: &[Parsed<'_>],
    implementations: &[Parsed<'_>],
    slots: &[Slot],
) -> Vec<String> {
    let mut problems = Vec::new();
    let mut declared: BTreeMap<&str, Vec<&Parsed<'_>>> = BTreeMap::new();
    for parsed in modules.iter().chain(implementations) {
        declared.entry(&parsed.module.path).or_default().push(parsed);
    }
    let is_own = |path: &str| prefix.is_empty() || path.split("::").next() == Some(prefix);
    for Parsed { file, imports, .. } in modules.iter().chain(implementations) {
        for (used, line) in imports.iter().filter(|(used, _)| is_own(&used.module)) {
            if used.module == "constants" {
                continue;
            }
            let place = format!("{}:{line}: ", file.display());
            let Some(found) = declared.get(used.module.as_ref()) else {
                problems.push(format!("{place}there is no module `package::{}`", used.module));
                continue;
            };
            for other in found {
                let declares = |d: &&Declaration| d.name == used.name && d.entry.is_none();
                if !other.module.declarations.iter().any(|d| declares(&d)) {
                    let (name, file) = (&used.name, other.file.display());
                    problems.push(format!("{place}`{name}` is not declared by {file}"));
                }
            }
        }
    }
    let mut unique: HashMap<String, &Path> = HashMap::new();
    for Parsed { file, module, .. } in modules {
        let names = module.declarations.iter().filter(|d| d.entry.is_none() && !d.name.is_empty());
        let names = names.map(|d| unique_name(&module.path, &d.name));
        // A module's path must be unique even if it declares nothing.
        for name in names.chain([module.path.clone().into_owned()]) {
            if let Some(other) = unique.insert(name.clone(), file) {
                let (file, other) = (file.display(), other.display());
                problems.push(format!("{file}: `{name}` is also of {other}; rename one"));
            }
        }
    }
    for slot in slots {
        for path in slot.implementations {
            if !implementations.iter().any(|parsed| parsed.name == *path) {
                let slot = slot.path;
                problems.push(format!("there is no file of `{path}`, which implements `{slot}`"));
            }
        }
    }
    problems
}

/// A module as an expression of Rust, with a comma.
fn write_module(text: &mut String, module: &Module) {
    let _ = writeln!(
        text,
        "lumivox_wgsl::Module {{ path: Borrowed({:?}), directives: Borrowed({:?}), is_built: true, declarations: Borrowed(&[",
        module.path, module.directives
    );
    for declaration in module.declarations.iter() {
        let _ = write!(
            text,
            "lumivox_wgsl::Declaration {{ name: Borrowed({:?}), line: {}, text: Borrowed({:?}), uses: Borrowed(&[",
            declaration.name, declaration.line, declaration.text
        );
        for used in declaration.uses.iter() {
            let _ = write!(
                text,
                "lumivox_wgsl::Use {{ module: Borrowed({:?}), name: Borrowed({:?}) }},",
                used.module, used.name
            );
        }
        text.push_str("]), entry: ");
        match &declaration.entry {
            None => text.push_str("None"),
            Some(entry) => {
                text.push_str("Some(lumivox_wgsl::EntryPoint { workgroup_size: Borrowed(&[");
                for size in entry.workgroup_size.iter() {
                    let _ = write!(text, "Borrowed({size:?}),");
                }
                text.push_str("]) })");
            }
        }
        text.push_str(" },\n");
    }
    text.push_str("]) },");
}

/// A file for reading.
fn write_readable(out: &Path, name: &str, module: &Module) {
    let file = out.join("wgsl").join(name.replace("::", "/")).with_extension("wgsl");
    let folder = file.parent().expect("it is below OUT_DIR");
    fs::create_dir_all(folder).expect("OUT_DIR can be written");
    let text: Vec<_> = module.declarations.iter().map(|d| d.text.as_ref()).collect();
    fs::write(file, text.join("\n\n") + "\n").expect("OUT_DIR can be written");
}
