//! The values of settings.

use std::fmt;

use glam::Vec3;

/// One of several named values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The name in lower case.
    pub name: &'static str,
    /// The meaning, in a line without a full stop.
    pub help: &'static str,
}

impl Choice {
    /// Makes a choice.
    pub const fn new(name: &'static str, help: &'static str) -> Self {
        Self { name, help }
    }
}

/// The kind and range of a setting's values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// On or off.
    Switch,
    /// A whole number.
    Whole {
        /// Minimum.
        low: u32,
        /// Maximum.
        high: u32,
        /// The value must be a multiple of this.
        multiple: u32,
    },
    /// A number.
    Number {
        /// Minimum.
        low: f32,
        /// Maximum.
        high: f32,
        /// Words for values without a number, such as `auto`.
        words: &'static [&'static str],
        /// An additional number below `low` that means "off".
        off: Option<f32>,
    },
    /// Three numbers, separated by commas.
    Vector {
        /// Minimum of each number.
        low: f32,
        /// Exclusive upper bound of each number.
        below: f32,
    },
    /// One of several names.
    Choice(&'static [Choice]),
}

/// A value of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// On or off.
    Switch(bool),
    /// A whole number.
    Whole(u32),
    /// A number.
    Number(f32),
    /// A value without a number: automatic, unlimited.
    Word(&'static str),
    /// Three numbers.
    Vector(Vec3),
    /// A name.
    Choice(&'static str),
}

impl Kind {
    /// Numbers in a range.
    pub const fn number(low: f32, high: f32) -> Self {
        Self::Number { low, high, words: &[], off: None }
    }

    /// Whole numbers in a range.
    pub const fn whole(low: u32, high: u32) -> Self {
        Self::Whole { low, high, multiple: 1 }
    }

    /// The words of this kind: names of choices, and words for values without a number.
    pub fn words(self) -> Vec<&'static str> {
        match self {
            Self::Switch => vec!["on", "off"],
            Self::Choice(choices) => choices.iter().map(|choice| choice.name).collect(),
            Self::Number { words, .. } => words.to_vec(),
            Self::Whole { .. } | Self::Vector { .. } => Vec::new(),
        }
    }

    /// Whether the value is of this kind and in its range.
    pub fn allows(self, value: Value) -> bool {
        match (self, value) {
            (Self::Switch, Value::Switch(_)) => true,
            (Self::Whole { low, high, multiple }, Value::Whole(whole)) => {
                (low..=high).contains(&whole) && whole.is_multiple_of(multiple)
            }
            (Self::Number { low, high, off, .. }, Value::Number(number)) => {
                (low..=high).contains(&number) || off == Some(number)
            }
            (Self::Number { words, .. }, Value::Word(given)) => words.contains(&given),
            (Self::Vector { low, below }, Value::Vector(vector)) => {
                vector.to_array().iter().all(|number| (low..below).contains(number))
            }
            (Self::Choice(choices), Value::Choice(name)) => {
                choices.iter().any(|choice| choice.name == name)
            }
            _ => false,
        }
    }

    /// Parses a value; `None` if the text is not a value of this kind. Ranges are not checked.
    ///
    /// In names, `_` and `-` are equivalent. A unit may follow a number, as in `0.5 m`; sizes in
    /// MiB may have other units of memory, as in `2GiB`.
    pub fn parse(self, text: &str, unit: &str) -> Option<Value> {
        let text = text.trim();
        match self {
            Self::Switch => match text {
                "on" | "true" | "yes" | "1" => Some(Value::Switch(true)),
                "off" | "false" | "no" | "0" => Some(Value::Switch(false)),
                _ => None,
            },
            Self::Whole { .. } => number(text, unit).parse().ok().map(Value::Whole),
            Self::Number { words, .. } => {
                if let Some(word) = words.iter().find(|word| is_same(word, text)) {
                    return Some(Value::Word(word));
                }
                let number = if unit == "MiB" {
                    mebibytes(text)?
                } else {
                    number(text, unit).parse().ok()?
                };
                number.is_finite().then_some(Value::Number(number))
            }
            Self::Vector { .. } => {
                let numbers: Option<Vec<f32>> =
                    number(text, unit).split(',').map(|part| part.trim().parse().ok()).collect();
                let [x, y, z] = numbers?.try_into().ok()?;
                Some(Vec3::new(x, y, z)).filter(|v| v.is_finite()).map(Value::Vector)
            }
            Self::Choice(choices) => {
                let named = choices.iter().find(|choice| is_same(choice.name, text));
                named.map(|choice| Value::Choice(choice.name))
            }
        }
    }

    /// Description of the allowed values, as in "a number from 0 to 1".
    pub fn in_words(self) -> String {
        match self {
            Self::Switch => "on or off".to_owned(),
            Self::Whole { low, high, multiple: 1 } => {
                format!("a whole number from {low} to {high}")
            }
            Self::Whole { low, high, multiple } => {
                format!("a multiple of {multiple} from {low} to {high}")
            }
            Self::Number { low, high, words, off } => {
                let off = off.map(|off| format!(", or {off}")).unwrap_or_default();
                let numbers =
                    format!("a number from {} to {}{off}", in_digits(low), in_digits(high));
                words.iter().fold(numbers, |text, word| text + ", or " + word)
            }
            Self::Vector { low, below } => {
                format!("three numbers x,y,z, each from {low} to below {below}")
            }
            Self::Choice(choices) => match choices {
                [] => String::new(),
                [one] => one.name.to_owned(),
                [most @ .., last] => {
                    let most: Vec<&str> = most.iter().map(|choice| choice.name).collect();
                    format!("{} or {}", most.join(", "), last.name)
                }
            },
        }
    }
}

/// A number as text, with an exponent if it is very small or large.
fn in_digits(number: f32) -> String {
    match number.abs() {
        size if size == 0.0 || (1e-4..1e7).contains(&size) => number.to_string(),
        _ => format!("{number:e}"),
    }
}

/// Whether two names are equal, with `_` and `-` treated as the same.
fn is_same(name: &str, text: &str) -> bool {
    name.replace('_', "-") == text.replace('_', "-")
}

/// The text of a number without its unit.
fn number<'a>(text: &'a str, unit: &str) -> &'a str {
    if unit.is_empty() { text } else { text.strip_suffix(unit).unwrap_or(text).trim_end() }
}

/// A size in MiB; a number without a unit is in MiB.
fn mebibytes(text: &str) -> Option<f32> {
    const MIB: f64 = 1_048_576.0;
    let digits = text.trim_end_matches(|letter: char| letter.is_ascii_alphabetic());
    let unit = match text[digits.len()..].to_ascii_lowercase().as_str() {
        "b" => 1.0,
        "kb" => 1e3,
        "mb" => 1e6,
        "gb" => 1e9,
        "tb" => 1e12,
        "kib" => 1024.0,
        "" | "mib" => MIB,
        "gib" => 1024.0 * MIB,
        "tib" => MIB * MIB,
        _ => return None,
    };
    let number: f64 = digits.trim_end().parse().ok()?;
    Some((number * (unit / MIB)) as f32)
}

impl Value {
    /// `true` for a switch that is on; `false` for other kinds.
    pub fn is_on(self) -> bool {
        self == Self::Switch(true)
    }

    /// The whole number; 0 for other kinds.
    pub fn whole(self) -> u32 {
        if let Self::Whole(number) = self { number } else { 0 }
    }

    /// The number; `None` for other kinds, including words.
    pub fn number(self) -> Option<f32> {
        if let Self::Number(number) = self { Some(number) } else { None }
    }

    /// The three numbers; zeros for other kinds.
    pub fn vector(self) -> Vec3 {
        if let Self::Vector(vector) = self { vector } else { Vec3::ZERO }
    }

    /// The name or the word; empty for other kinds.
    pub fn name(self) -> &'static str {
        if let Self::Choice(name) | Self::Word(name) = self { name } else { "" }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Switch(on) => f.write_str(if *on { "on" } else { "off" }),
            Self::Whole(number) => number.fmt(f),
            Self::Number(number) => number.fmt(f),
            Self::Word(name) | Self::Choice(name) => f.write_str(name),
            Self::Vector(v) => write!(f, "{},{},{}", v.x, v.y, v.z),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_may_have_their_unit() {
        let reach = Kind::Number { low: 0.0, high: 9.0, words: &["unlimited"], off: None };
        assert_eq!(reach.parse("2.5 m", "m"), Some(Value::Number(2.5)));
        assert_eq!(reach.parse("2.5", "m"), Some(Value::Number(2.5)));
        assert_eq!(reach.parse("unlimited", "m"), Some(Value::Word("unlimited")));
        assert_eq!(reach.parse("2.5 km", "m"), None);
        assert_eq!(Kind::whole(0, 9).parse("8 frames", "frames"), Some(Value::Whole(8)));
    }

    #[test]
    fn memory_has_several_units() {
        let memory = Kind::number(0.0, 1e6);
        for (text, mib) in
            [("512", 512.0), ("512MiB", 512.0), ("2 GiB", 2048.0), ("1kib", 1.0 / 1024.0)]
        {
            assert_eq!(memory.parse(text, "MiB"), Some(Value::Number(mib)), "{text}");
        }
        for text in ["", "MiB", "2 Gi", "2GiBs", "--1", "nan"] {
            assert_eq!(memory.parse(text, "MiB"), None, "{text}");
        }
    }
}
