//! Properties of lights and materials by name: one table each, to read, to write, and to compare.

use super::arguments::in_words;
use super::suggest;
use crate::Failure;

/// A property of a `T`.
pub struct Property<T: 'static> {
    /// Its name.
    pub name: &'static str,
    /// Other names.
    pub aliases: &'static [&'static str],
    /// Maximum count of numbers in its value.
    pub count: usize,
    /// The value's meaning, with unit and range; empty if the error of [`Self::set`] for no words
    /// states it.
    pub is: &'static str,
    /// Its value in words that read back to the same bits; `None` if the thing does not have it.
    pub get: fn(&Self, &T) -> Option<String>,
    /// Sets its value.
    pub set: fn(&Self, &mut T, &[&str]) -> Result<(), Failure>,
}

/// The names of a table.
pub const fn names<T, const COUNT: usize>(table: &[Property<T>]) -> [&'static str; COUNT] {
    let mut names = [""; COUNT];
    let mut index = 0;
    while index < COUNT {
        names[index] = table[index].name;
        index += 1;
    }
    names
}

/// The first word of a value.
pub fn first<'a>(words: &[&'a str]) -> &'a str {
    words.first().copied().unwrap_or_default()
}

/// The properties of a thing, one in a line.
pub fn list<T>(table: &[Property<T>], thing: &T) -> String {
    let lines: Vec<String> = table
        .iter()
        .filter_map(|property| {
            Some(format!("  {} {}", property.name, (property.get)(property, thing)?))
        })
        .collect();
    lines.join("\n")
}

/// Sets properties, all or none. `words` are a name and its value, then the next name.
///
/// # Errors
/// When there is no such property, or a value is wrong.
pub fn set<T: Clone>(
    table: &[Property<T>],
    what: &str,
    thing: &T,
    words: &[&str],
) -> Result<T, Failure> {
    let mut changed = thing.clone();
    let mut words = words;
    while let Some((name, rest)) = words.split_first() {
        let is_it = |p: &&Property<T>| p.name == *name || p.aliases.contains(name);
        let known = || table.iter().filter(|p| (p.get)(p, &changed).is_some()).map(|p| p.name);
        let Some(property) = table.iter().find(is_it) else {
            let like = suggest::like(name, known());
            let remedy = match like {
                Some(like) => format!("did you mean \"{like}\"?"),
                None => format!("it has {}", in_words(&known().collect::<Vec<_>>())),
            };
            return Err(Failure::input(format!("{what} has no property \"{name}\"; {remedy}")));
        };
        if (property.get)(property, &changed).is_none() {
            let known = in_words(&known().collect::<Vec<_>>());
            return Err(Failure::input(format!(
                "{what} has no {name} with its present shading; it has {known}"
            )));
        }
        // The value is up to `count` numbers, or one word that is not a number, such as `none`.
        let is_number =
            |word: &&&str| word.split(',').all(|part| part.trim().parse::<f64>().is_ok());
        let numbers = rest.iter().take(property.count).take_while(is_number).count();
        let has_commas = rest.first().is_some_and(|word| word.contains(','));
        let taken = if has_commas { 1 } else { numbers.max(1).min(rest.len()) };
        let (value, rest) = rest.split_at(taken);
        if value.is_empty() && !property.is.is_empty() {
            let is = property.is;
            return Err(Failure::input(format!("{what}: {name} is {is}; got nothing")));
        }
        (property.set)(property, &mut changed, value)?;
        words = rest;
    }
    Ok(changed)
}

/// The properties that differ between two things, as words that set them.
pub fn difference<T>(table: &[Property<T>], thing: &T, from: &T) -> Vec<String> {
    let differing = table.iter().filter_map(|property| {
        let value = (property.get)(property, thing)?;
        let is_same = (property.get)(property, from).is_some_and(|other| other == value);
        (!is_same).then(|| format!("{} {value}", property.name))
    });
    differing.collect()
}
