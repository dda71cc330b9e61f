//! Completion of the word at the cursor.
//!
//! It needs only [`Names`], so that a window can complete while its console is busy in another
//! thread. The caller lists files.

use std::path::Path;

use lumivox_explorer::parameters::{PARAMETERS, Parameter, find_parameter};

use super::line::{self, Word};
use super::names::is_scene;
use super::{COMMANDS, Command, Names, Takes};

/// The possible completions of a word.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Completion {
    /// Start of the replaced word, as a byte offset in the line; the word ends at the cursor.
    pub start: usize,
    /// The possible words, quoted where necessary.
    pub candidates: Vec<String>,
}

/// Completes the word that ends at the cursor, a byte offset in the line. `files` lists the files
/// whose paths begin with its argument.
pub fn complete(
    names: &Names,
    files: &dyn Fn(&str) -> Vec<String>,
    text: &str,
    cursor: usize,
) -> Completion {
    let Some(before) = text.get(..cursor) else { return Completion::default() };
    let is_new = before.chars().next_back().is_none_or(|c| c.is_whitespace() || c == ';');
    let mut commands = line::commands(before);
    let mut words = commands.pop().unwrap_or_default();
    let is_open = words.last().is_some_and(|word| word.open.is_some());
    if before.trim_end().ends_with(';') && !is_open {
        words.clear();
    }
    let current = if is_new && !is_open { None } else { words.pop() };
    // The cursor is in a comment.
    if let Some(word) = &current
        && word.range.end != before.len()
    {
        return Completion { start: cursor, candidates: Vec::new() };
    }
    let start = current.as_ref().map_or(cursor, |word| word.range.start);
    let begun = current.map(|word| word.text).unwrap_or_default();
    let candidates = possible(names, files, &words, &begun);
    let candidates = candidates.into_iter().filter(|name| name.starts_with(&begun));
    let mut candidates: Vec<String> = candidates.map(|name| line::quote(&name)).collect();
    candidates.dedup();
    Completion { start, candidates }
}

/// The possible words after the given ones.
fn possible(
    names: &Names,
    files: &dyn Fn(&str) -> Vec<String>,
    before: &[Word],
    begun: &str,
) -> Vec<String> {
    let Some((name, arguments)) = before.split_first() else { return commands_and_parameters() };
    let parameter = find_parameter(&name.text);
    let Some(command) = Command::find(&name.text) else {
        return parameter.filter(|_| arguments.is_empty()).map(values).unwrap_or_default();
    };
    if arguments.len() >= command.count.1 {
        return Vec::new();
    }
    let takes = command.takes.get(arguments.len()).or(command.takes.last());
    match takes.copied().unwrap_or(Takes::Anything) {
        Takes::Anything => {
            parameter.filter(|_| arguments.is_empty()).map(values).unwrap_or_default()
        }
        Takes::Object => names.objects.clone(),
        Takes::Material => names.materials.clone(),
        Takes::Light => names.lights.clone(),
        Takes::Camera => names.cameras.iter().chain(&names.stored).cloned().collect(),
        Takes::Stored => {
            ["1", "2"].map(str::to_owned).into_iter().chain(names.stored.iter().cloned()).collect()
        }
        Takes::Animation => names.animations.clone(),
        Takes::Scene => {
            let is_one = |path: &String| path.ends_with('/') || is_scene(Path::new(path));
            names.scenes.iter().cloned().chain(files(begun).into_iter().filter(is_one)).collect()
        }
        Takes::File => files(begun),
        Takes::Command => commands_and_parameters(),
        Takes::Parameter => PARAMETERS.iter().map(|p| p.name.to_owned()).collect(),
        Takes::Switch => vec!["on".to_owned(), "off".to_owned()],
        Takes::Word(words) => words.iter().map(|word| (*word).to_owned()).collect(),
    }
}

/// All words that a line can begin with, in order.
fn commands_and_parameters() -> Vec<String> {
    let commands = COMMANDS.iter().flat_map(Command::names);
    let mut all: Vec<String> =
        commands.chain(PARAMETERS.iter().flat_map(Parameter::names)).map(str::to_owned).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// The values of a setting whose values are words.
fn values(parameter: &Parameter) -> Vec<String> {
    parameter.kind.words().into_iter().map(str::to_owned).collect()
}
