//! One module: its declarations, under names that are unique in every program.

use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

use crate::tokens::{Kind, Token, tokens};

/// A module whose imports are resolved.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Module {
    /// Its path without the leading `package::`; for a slot's implementation, the slot's path.
    pub path: Cow<'static, str>,
    /// The directives `enable`, `requires` and `diagnostic`.
    pub directives: Cow<'static, str>,
    /// The declarations, in the order of the source.
    pub declarations: Cow<'static, [Declaration]>,
    /// Whether a build script has parsed it.
    pub is_built: bool,
}

/// A function, structure, variable, constant or alias of a module.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Declaration {
    /// Its name in the module; empty for a `const_assert`.
    pub name: Cow<'static, str>,
    /// The line of the source at which [`Self::text`] starts, from 1.
    pub line: u32,
    /// WGSL in which all names of modules are unique.
    pub text: Cow<'static, str>,
    /// The declarations that the text names.
    pub uses: Cow<'static, [Use]>,
    /// For functions that are entry points.
    pub entry: Option<EntryPoint>,
}

/// A declaration by its module and name.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Use {
    /// The path of the module without the leading `package::`.
    pub module: Cow<'static, str>,
    /// The name in that module.
    pub name: Cow<'static, str>,
}

/// The properties of an entry point.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EntryPoint {
    /// The workgroup's size along x, y and z: numbers or unique names of constants; missing ones
    /// are 1. Empty for vertex and fragment shaders.
    pub workgroup_size: Cow<'static, [Cow<'static, str>]>,
}

/// A module that cannot be split into declarations.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {message}")]
pub struct ParseError {
    /// The line of the source, from 1.
    pub line: u32,
    /// The description of the error.
    pub message: String,
}

impl ParseError {
    fn new(token: Option<&Token<'_>>, message: impl Into<String>) -> Self {
        Self { line: token.map_or(1, |token| token.line), message: message.into() }
    }
}

/// The unique name of a declaration. Constants from Rust keep their names, which are unique.
pub(crate) fn unique_name(module: &str, name: &str) -> String {
    if module == "constants" {
        return name.to_owned();
    }
    format!("{}_{name}", module.replace("::", "_"))
}

/// Words with a meaning only in WGSL's templates, where they would be mistaken for a declaration of
/// that name.
const ENUMERANTS: &[&str] =
    &["function", "private", "read", "read_write", "storage", "uniform", "workgroup", "write"];

/// Attributes whose arguments are words of WGSL.
const ATTRIBUTES_OF_WORDS: &[&str] = &["builtin", "interpolate", "diagnostic"];

/// Splits the module `path` (without `package::`) into declarations with unique names. With
/// `keeps_lines` each declaration's text has the lines of the source; otherwise comments and empty
/// lines are left out.
///
/// # Errors
/// If brackets are unbalanced, an import is not a path below `package::`, or a declaration has no
/// name or a name that is already used.
pub fn parse(path: &str, source: &str, keeps_lines: bool) -> Result<Module, ParseError> {
    parse_with_imports(path, source, keeps_lines).map(|(module, _)| module)
}

/// As [`parse`], with the module's imports and their lines.
pub(crate) fn parse_with_imports(
    path: &str,
    source: &str,
    keeps_lines: bool,
) -> Result<(Module, Vec<(Use, u32)>), ParseError> {
    let is_name = |part: &str| {
        part.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && part.chars().all(|c| c.is_alphanumeric() || c == '_')
    };
    if path == "constants" || !path.split("::").all(is_name) {
        let message = format!("`{path}` cannot be a module's path: it is `constants`, or no names");
        return Err(ParseError::new(None, message));
    }
    let all = tokens(source.trim_start_matches('\u{feff}'));
    if let Some(comment) = all.iter().find(|token| token.kind == Kind::Unclosed) {
        return Err(ParseError::new(Some(comment), "`/*` is not closed"));
    }
    let (mut names, mut imports) = (HashMap::new(), Vec::new());
    let mut directives = String::new();
    let mut pieces = Vec::new();
    for piece in split(&all)? {
        let first = piece.iter().find(|token| token.is_code());
        match first.map_or("", |token| token.text) {
            "" | ";" => {}
            "import" => import(piece, &mut names, &mut imports)?,
            "enable" | "requires" | "diagnostic" => {
                directives.extend(piece.iter().filter(|token| token.is_code()).flat_map(spaced));
                directives.push('\n');
            }
            _ => pieces.push((Head::of(piece)?, piece)),
        }
    }
    for (head, piece) in &pieces {
        let own = Use { module: path.to_owned().into(), name: head.name.to_owned().into() };
        if ENUMERANTS.contains(&head.name) {
            let message = format!("`{}` is a word of WGSL; choose another name", head.name);
            return Err(ParseError::new(piece.iter().find(|t| t.is_code()), message));
        }
        if !head.name.is_empty() && names.insert(head.name.to_owned(), own).is_some() {
            let message = format!("`{}` is declared or imported twice", head.name);
            return Err(ParseError::new(piece.iter().find(|t| t.is_code()), message));
        }
    }
    // Entry points keep their names, which no declaration uses.
    for (head, _) in &pieces {
        if head.is_entry {
            names.remove(head.name);
        }
    }
    // A local variable with a unique name would be mistaken for the declaration.
    let unique = names.values().map(|used| unique_name(&used.module, &used.name)).collect();
    let declarations =
        pieces.iter().map(|(head, piece)| declare(head, piece, (&names, &unique), keeps_lines));
    let module = Module {
        path: path.to_owned().into(),
        directives: directives.into(),
        declarations: declarations.collect::<Result<Vec<_>, _>>()?.into(),
        is_built: false,
    };
    Ok((module, imports))
}

/// A token of a directive, and its separator from the next one.
fn spaced<'a>(token: &Token<'a>) -> [&'a str; 2] {
    [token.text, if token.kind == Kind::Word { " " } else { "" }]
}

/// The source, cut after each `;` and each block at the outermost level.
fn split<'t, 's>(all: &'t [Token<'s>]) -> Result<Vec<&'t [Token<'s>]>, ParseError> {
    let mut pieces = Vec::new();
    let mut open: Vec<&Token<'_>> = Vec::new();
    let (mut start, mut is_import) = (0, false);
    for (at, token) in all.iter().enumerate() {
        if token.kind == Kind::Word && open.is_empty() {
            is_import |= token.is("import") && all[start..at].iter().all(|t| !t.is_code());
        }
        if token.kind != Kind::Symbol {
            continue;
        }
        match token.text {
            "(" | "[" | "{" => open.push(token),
            ")" | "]" | "}" => {
                let expected = match open.pop().map_or("", |token| token.text) {
                    "(" => ")",
                    "[" => "]",
                    "{" => "}",
                    _ => "",
                };
                if !token.is(expected) {
                    return Err(ParseError::new(
                        Some(token),
                        format!("unexpected `{}`", token.text),
                    ));
                }
            }
            _ => {}
        }
        // The names of an import are in braces, and its end is the semicolon.
        let is_end = token.is(";") || (token.is("}") && !is_import);
        if is_end && open.is_empty() {
            pieces.push(&all[start..=at]);
            (start, is_import) = (at + 1, false);
        }
    }
    if let Some(bracket) = open.last() {
        return Err(ParseError::new(Some(bracket), format!("`{}` is not closed", bracket.text)));
    }
    if let Some(token) = all[start..].iter().find(|token| token.is_code()) {
        return Err(ParseError::new(Some(token), "this declaration has no end: `;` is missing"));
    }
    Ok(pieces)
}

/// Adds the names of `import package::a::{b, c::d};`.
fn import(
    piece: &[Token<'_>],
    names: &mut HashMap<String, Use>,
    imports: &mut Vec<(Use, u32)>,
) -> Result<(), ParseError> {
    let code: Vec<_> = piece.iter().filter(|token| token.is_code()).collect();
    if code.get(1).is_none_or(|token| !token.is("package")) {
        return Err(ParseError::new(
            code.get(1).copied(),
            "an import starts with `package::`, as in `import package::grid::grid;`",
        ));
    }
    // The path so far, and its length outside each open brace.
    let (mut path, mut outer): (Vec<&str>, Vec<usize>) = (Vec::new(), Vec::new());
    // Colons since the last word, brace or comma; `package` is before the first.
    let mut colons = 0;
    for &token in &code[2..] {
        let is_first = path.len() == outer.last().copied().unwrap_or(0) && !outer.is_empty();
        let expected = if is_first { 0 } else { 2 };
        match (token.kind, token.text) {
            (_, ":") => colons += 1,
            (Kind::Word, _) | (_, "{") if colons != expected => {
                let message = format!(
                    "`::`, `,` or `;` is missing before `{}`; an import cannot be renamed",
                    token.text
                );
                return Err(ParseError::new(Some(token), message));
            }
            (Kind::Word, word) => (path, colons) = ([path, vec![word]].concat(), 0),
            (_, "{") => {
                outer.push(path.len());
                colons = 0;
            }
            (_, "," | "}" | ";") => {
                let inside = outer.last().copied().unwrap_or(0);
                if let Some((name, module)) = path.split_last().filter(|_| path.len() > inside) {
                    if module.is_empty() {
                        let message = format!("`{name}` is a module; import names of it");
                        return Err(ParseError::new(Some(token), message));
                    }
                    let used =
                        Use { module: module.join("::").into(), name: (*name).to_owned().into() };
                    imports.push((used.clone(), token.line));
                    if names.insert((*name).to_owned(), used).is_some() {
                        let message = format!("`{name}` is imported twice");
                        return Err(ParseError::new(Some(token), message));
                    }
                }
                path.truncate(inside);
                if token.is("}") {
                    outer.pop();
                    path.truncate(outer.last().copied().unwrap_or(0));
                }
            }
            _ => {
                let message = format!("unexpected `{}` in an import", token.text);
                return Err(ParseError::new(Some(token), message));
            }
        }
    }
    Ok(())
}

/// The start of a declaration.
struct Head<'a> {
    name: &'a str,
    is_struct: bool,
    is_entry: bool,
}

impl<'a> Head<'a> {
    fn of(piece: &[Token<'a>]) -> Result<Self, ParseError> {
        let mut code = piece.iter().filter(|token| token.is_code()).peekable();
        let mut is_entry = false;
        while code.next_if(|token| token.is("@")).is_some() {
            let attribute = code.next().map_or("", |token| token.text);
            is_entry |= matches!(attribute, "compute" | "vertex" | "fragment");
            if code.peek().is_some_and(|token| token.is("(")) {
                skip_brackets(&mut code, "(", ")");
            }
        }
        let keyword = code.next();
        let word = keyword.map_or("", |token| token.text);
        let has_name = match word {
            "fn" | "struct" | "alias" | "const" | "override" | "var" => true,
            "const_assert" => false,
            _ => {
                let message = format!("`{word}` starts no declaration of WGSL");
                return Err(ParseError::new(keyword, message));
            }
        };
        if word == "var" && code.peek().is_some_and(|token| token.is("<")) {
            skip_brackets(&mut code, "<", ">");
        }
        let mut name = "";
        if has_name {
            match code.next().filter(|token| token.kind == Kind::Word) {
                Some(token) => name = token.text,
                None => {
                    return Err(ParseError::new(
                        keyword,
                        format!("a name is missing after `{word}`"),
                    ));
                }
            }
        }
        Ok(Self { name, is_struct: word == "struct", is_entry })
    }
}

fn skip_brackets<'t, 's: 't>(
    code: &mut impl Iterator<Item = &'t Token<'s>>,
    open: &str,
    close: &str,
) {
    let mut depth = 0;
    for token in code {
        depth += i32::from(token.is(open)) - i32::from(token.is(close));
        if depth == 0 {
            return;
        }
    }
}

/// Replaces names by unique ones.
fn declare(
    head: &Head<'_>,
    piece: &[Token<'_>],
    (names, unique): (&HashMap<String, Use>, &HashSet<String>),
    keeps_lines: bool,
) -> Result<Declaration, ParseError> {
    let start = piece.iter().position(Token::is_code).unwrap_or(0);
    let piece = &piece[start..];
    let mut text = String::new();
    let mut uses = HashSet::new();
    let (mut braces, mut before) = (0, "");
    // Depth of parentheses in the arguments of an attribute whose arguments are words.
    let mut words_of_attribute = None::<i32>;
    for (at, token) in piece.iter().enumerate() {
        if !token.is_code() {
            // A comment separates words, as white space does.
            text.push_str(if keeps_lines || token.kind == Kind::Space { token.text } else { " " });
            continue;
        }
        let after = piece[at + 1..].iter().find(|token| token.is_code());
        let next = after.map_or("", |token| token.text);
        if let Some(depth) = &mut words_of_attribute {
            *depth += i32::from(token.is("(")) - i32::from(token.is(")"));
            if *depth == 0 {
                words_of_attribute = None;
            }
            text.push_str(token.text);
        } else if token.kind == Kind::Word {
            let is_attribute = before == "@";
            if is_attribute && next == "(" && ATTRIBUTES_OF_WORDS.contains(&token.text) {
                words_of_attribute = Some(0);
            }
            let is_member = before == "." || (head.is_struct && braces == 1 && next == ":");
            let used = names.get(token.text).filter(|_| !is_attribute && !is_member);
            match used {
                Some(used) => {
                    text.push_str(&unique_name(&used.module, &used.name));
                    uses.insert(used.clone());
                }
                None if token.is("package") && next == ":" => {
                    let message = "a path in code; name it in an `import` at the top of the module";
                    return Err(ParseError::new(Some(token), message));
                }
                None if !is_attribute && !is_member && unique.contains(token.text) => {
                    let message = format!(
                        "`{}` is what another declaration is called in shaders; choose another name",
                        token.text
                    );
                    return Err(ParseError::new(Some(token), message));
                }
                None => text.push_str(token.text),
            }
        } else {
            braces += i32::from(token.is("{")) - i32::from(token.is("}"));
            text.push_str(token.text);
        }
        before = token.text;
    }
    if !keeps_lines {
        let lines = text.lines().map(str::trim_end).filter(|line| !line.is_empty());
        text = lines.collect::<Vec<_>>().join("\n");
    }
    // The declaration's text contains its own name.
    if let Some(own) = names.get(head.name) {
        uses.remove(own);
    }
    let mut uses: Vec<_> = uses.into_iter().collect();
    uses.sort_unstable();
    let entry = head.is_entry.then(|| EntryPoint { workgroup_size: workgroup_size(&text) });
    Ok(Declaration {
        name: head.name.to_owned().into(),
        line: piece.first().map_or(1, |token| token.line),
        text: text.into(),
        uses: uses.into(),
        entry,
    })
}

/// The arguments of `@workgroup_size`, as written.
fn workgroup_size(text: &str) -> Cow<'static, [Cow<'static, str>]> {
    let all = tokens(text);
    let attributes = all.iter().filter(|token| token.is_code());
    let mut code = attributes.take_while(|token| !token.is("fn"));
    if !code.any(|token| token.is("workgroup_size")) {
        return Cow::Borrowed(&[]);
    }
    let (mut sizes, mut depth) = (vec![String::new()], 1);
    for token in code.skip(1) {
        depth += i32::from(token.is("(")) - i32::from(token.is(")"));
        match token.text {
            _ if depth == 0 => break,
            "," if depth == 1 => sizes.push(String::new()),
            word => sizes.last_mut().expect("it has one").push_str(word),
        }
    }
    sizes.retain(|size| !size.is_empty());
    sizes.into_iter().map(Cow::Owned).collect::<Vec<_>>().into()
}

/// Parses a number; `Err` with the text if it is not one but the name of a constant.
pub(crate) fn number(text: &str) -> Result<u32, &str> {
    let value = text.trim_end_matches(['u', 'i']);
    let parsed = match value.strip_prefix("0x") {
        Some(hexadecimal) => u32::from_str_radix(hexadecimal, 16),
        None => value.parse(),
    };
    parsed.map_err(|_| text)
}

/// The value of a declaration `const name: type = value;`.
pub(crate) fn value_of_const(declaration: &str) -> Option<String> {
    let all = tokens(declaration);
    let mut code = all.iter().filter(|token| token.is_code());
    if !code.next()?.is("const") || !code.any(|token| token.is("=")) {
        return None;
    }
    Some(code.take_while(|token| !token.is(";")).map(|token| token.text).collect())
}
