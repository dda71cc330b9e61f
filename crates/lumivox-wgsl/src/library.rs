//! Modules, and shaders joined from them.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;

use crate::module::{Declaration, Module, ParseError, Use, number, parse, value_of_const};

/// A shader that does not parse, link or validate.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("shader {module}: {message}")]
pub struct ShaderError {
    /// The path of the faulty module.
    pub module: String,
    /// The mistake, with its line in the module's source if it is known.
    pub message: String,
}

/// The modules that shaders are joined from. Clones are cheap: they share unchanged parts.
#[derive(Clone, Debug, Default)]
pub struct ShaderLibrary {
    content: Arc<Content>,
}

#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Content {
    modules: BTreeMap<Cow<'static, str>, Found>,
    constants: BTreeMap<Cow<'static, str>, String>,
}

/// The content of a path.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Found {
    Built(&'static Module),
    Added(Arc<Module>),
    Unparsed(ParseError),
}

/// Equal libraries link equal shaders.
impl PartialEq for ShaderLibrary {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.content, &other.content) || self.content == other.content
    }
}

/// A shader as plain WGSL.
#[derive(Clone, Debug)]
pub struct LinkedShader {
    /// The text of all declarations that the entry points reach.
    pub source: String,
    /// Names and workgroup sizes of the entry points; zeros for vertex and fragment shaders.
    pub entries: Vec<(String, [u32; 3])>,
    /// The paths of linked modules that were added at run time.
    pub added: Vec<String>,
    places: Vec<Place>,
    lines: u32,
}

/// The origin of a declaration.
#[derive(Clone, Debug)]
struct Place {
    /// Its first line in the linked source, from 1.
    line: u32,
    module: String,
    /// The line in the module's source; `None` in modules of a build script, which drops lines.
    line_of_module: Option<u32>,
}

impl ShaderLibrary {
    /// Adds modules that a build script has parsed.
    pub fn add_built(&mut self, modules: &'static [Module]) -> &mut Self {
        for module in modules {
            self.content_mut().modules.insert(module.path.clone(), Found::Built(module));
        }
        self
    }

    /// Fills a slot with an implementation that a build script has parsed.
    pub fn fill(&mut self, implementation: &'static Module) -> &mut Self {
        self.add_built(std::slice::from_ref(implementation))
    }

    /// Adds the module `path` (without the leading `package::`), or replaces it. If the source does
    /// not parse, [`Self::link`] fails.
    pub fn add(&mut self, path: &str, source: impl AsRef<str>) -> &mut Self {
        let found = match parse(path, source.as_ref(), true) {
            Ok(module) => Found::Added(Arc::new(module)),
            Err(error) => Found::Unparsed(error),
        };
        self.content_mut().modules.insert(path.to_owned().into(), found);
        self
    }

    /// Defines a `u32` constant of the module `package::constants`.
    pub fn constant_u32(&mut self, name: &'static str, value: u32) -> &mut Self {
        self.constant(name, format!("const {name}: u32 = {value}u;"))
    }

    /// Defines an `f32` constant of the module `package::constants`; the value must be finite.
    pub fn constant_f32(&mut self, name: &'static str, value: f32) -> &mut Self {
        // `Debug` writes enough digits to read the same value.
        self.constant(name, format!("const {name}: f32 = {value:?}f;"))
    }

    fn constant(&mut self, name: &'static str, declaration: String) -> &mut Self {
        self.content_mut().constants.insert(name.into(), declaration);
        self
    }

    fn content_mut(&mut self) -> &mut Content {
        Arc::make_mut(&mut self.content)
    }

    /// The paths of all modules, without the leading `package::`.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.content.modules.keys().map(AsRef::as_ref)
    }

    /// Plain WGSL of the entry points of the module `path` and all that they reach.
    ///
    /// # Errors
    /// When the module or one that it imports from is missing or does not parse, or has no
    /// declaration of an imported name.
    pub fn link(&self, path: &str) -> Result<LinkedShader, ShaderError> {
        self.join(path, |declaration| declaration.entry.is_some() || declaration.name.is_empty())
    }

    /// As [`Self::link`], with all declarations of the module and what they reach, for reflection.
    ///
    /// # Errors
    /// As [`Self::link`].
    pub fn link_whole(&self, path: &str) -> Result<LinkedShader, ShaderError> {
        self.join(path, |_| true)
    }

    fn module(&self, path: &str, importer: &str) -> Result<&Module, ShaderError> {
        match self.content.modules.get(path) {
            Some(Found::Built(module)) => Ok(module),
            Some(Found::Added(module)) => Ok(module),
            Some(Found::Unparsed(error)) => {
                Err(ShaderError { module: path.to_owned(), message: error.to_string() })
            }
            None if path == importer => Err(ShaderError {
                module: path.to_owned(),
                message: "there is no such module".to_owned(),
            }),
            None => Err(ShaderError {
                module: importer.to_owned(),
                message: format!("it imports from `package::{path}`, and there is no such module"),
            }),
        }
    }

    fn join(
        &self,
        root: &str,
        is_root: impl Fn(&Declaration) -> bool,
    ) -> Result<LinkedShader, ShaderError> {
        let mut join = Join {
            library: self,
            seen: HashSet::new(),
            constants: HashSet::new(),
            linked: LinkedShader::EMPTY,
        };
        let module = self.module(root, root)?;
        let mut directives = String::new();
        let roots: Vec<_> = module.declarations.iter().filter(|d| is_root(d)).collect();
        for declaration in &roots {
            join.add(module, declaration, &mut directives)?;
        }
        let mut linked = join.linked;
        if !directives.is_empty() {
            let lines = directives.matches('\n').count() as u32;
            linked.source.insert_str(0, &directives);
            for place in &mut linked.places {
                place.line += lines;
            }
        }
        for declaration in roots {
            let Some(entry) = &declaration.entry else { continue };
            let mut size = [u32::from(!entry.workgroup_size.is_empty()); 3];
            for (along, text) in size.iter_mut().zip(entry.workgroup_size.iter()) {
                *along = linked.number(text).ok_or_else(|| ShaderError {
                    module: root.to_owned(),
                    message: format!(
                        "line {}: the workgroup size `{text}` is neither a number nor a `const` that is one",
                        declaration.line
                    ),
                })?;
            }
            linked.entries.push((declaration.name.clone().into_owned(), size));
        }
        Ok(linked)
    }
}

/// A shader to which reached declarations are added.
struct Join<'a> {
    library: &'a ShaderLibrary,
    /// Declarations, by their addresses.
    seen: HashSet<*const Declaration>,
    constants: HashSet<&'a str>,
    linked: LinkedShader,
}

impl<'a> Join<'a> {
    /// Adds a declaration after those that it uses.
    fn add(
        &mut self,
        module: &'a Module,
        declaration: &'a Declaration,
        directives: &mut String,
    ) -> Result<(), ShaderError> {
        if !self.seen.insert(std::ptr::from_ref(declaration)) {
            return Ok(());
        }
        if !directives.contains(module.directives.as_ref()) {
            directives.push_str(&module.directives);
        }
        for used in declaration.uses.iter() {
            self.add_used(module, used, directives)?;
        }
        let linked = &mut self.linked;
        if !module.is_built && !linked.added.iter().any(|path| *path == module.path) {
            linked.added.push(module.path.clone().into_owned());
        }
        let line = (!module.is_built).then_some(declaration.line);
        linked.push(&module.path, line, &declaration.text);
        Ok(())
    }

    fn add_used(
        &mut self,
        importer: &'a Module,
        used: &'a Use,
        directives: &mut String,
    ) -> Result<(), ShaderError> {
        let fail = |message| ShaderError { module: importer.path.clone().into_owned(), message };
        if used.module == "constants" {
            let declaration = self
                .library
                .content
                .constants
                .get(&used.name)
                .ok_or_else(|| fail(format!("Rust defines no constant `{}`", used.name)))?;
            if self.constants.insert(&used.name) {
                self.linked.push("constants", None, declaration);
            }
            return Ok(());
        }
        let module = self.library.module(&used.module, &importer.path)?;
        let found = module.declarations.iter().find(|d| d.name == used.name && d.entry.is_none());
        let declaration = found.ok_or_else(|| {
            // A caller's module fills a slot of built modules without its whole interface.
            if importer.is_built && !module.is_built {
                return ShaderError {
                    module: used.module.clone().into_owned(),
                    message: format!(
                        "it does not declare `{}`, which `package::{}` imports from it",
                        used.name, importer.path
                    ),
                };
            }
            fail(format!(
                "it imports `{}` from `package::{}`, which does not declare it",
                used.name, used.module
            ))
        })?;
        self.add(module, declaration, directives)
    }
}

impl LinkedShader {
    const EMPTY: Self = Self {
        source: String::new(),
        entries: Vec::new(),
        added: Vec::new(),
        places: Vec::new(),
        lines: 0,
    };

    fn push(&mut self, module: &str, line_of_module: Option<u32>, text: &str) {
        let line = self.lines + 1;
        self.places.push(Place { line, module: module.to_owned(), line_of_module });
        self.source.push_str(text);
        self.source.push('\n');
        self.lines += text.matches('\n').count() as u32 + 1;
    }

    /// The module that a line of [`Self::source`] is from, and the line in the module's source,
    /// from 1, if the module was added at run time.
    pub fn place_of(&self, line: u32) -> Option<(&str, Option<u32>)> {
        let after = self.places.partition_point(|place| place.line <= line);
        let place = self.places.get(after.checked_sub(1)?)?;
        Some((&place.module, place.line_of_module.map(|first| first + line - place.line)))
    }

    /// The value of a number, or of the constant of that unique name.
    fn number(&self, text: &str) -> Option<u32> {
        let mut text = text.to_owned();
        // A chain of constants ends at a number.
        for _ in 0..8 {
            let Err(name) = number(&text) else { return number(&text).ok() };
            let declared = self.source.lines().find(|line| {
                let rest = line.strip_prefix("const ").and_then(|rest| rest.strip_prefix(name));
                rest.is_some_and(|rest| rest.starts_with([' ', ':', '=']))
            });
            text = value_of_const(declared?)?;
        }
        None
    }
}
