//! The values that settings have.

use std::fmt;

use glam::Vec3;

/// Which values a parameter has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// On or off.
    Switch,
    /// A whole number.
    Whole {
        /// The least.
        low: u32,
        /// The most.
        high: u32,
        /// It must be a multiple of this.
        multiple: u32,
    },
    /// A number.
    Number {
        /// The least.
        low: f32,
        /// The most.
        high: f32,
        /// The word for [`Value::Word`], where there is something besides numbers.
        word: Option<&'static str>,
        /// A number below `low` that is allowed as well, since it stands for "off".
        off: Option<f32>,
    },
    /// Three numbers, separated by commas.
    Vector {
        /// The least of each.
        low: f32,
        /// Each is below this.
        below: f32,
    },
    /// One of several names.
    Choice(&'static [&'static str]),
}

/// A value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// On or off.
    Switch(bool),
    /// A whole number.
    Whole(u32),
    /// A number.
    Number(f32),
    /// What has no number: automatic, unlimited.
    Word(&'static str),
    /// Three numbers.
    Vector(Vec3),
    /// A name.
    Choice(&'static str),
}

impl Kind {
    /// Numbers in a range.
    pub(super) const fn number(low: f32, high: f32) -> Self {
        Self::Number { low, high, word: None, off: None }
    }

    /// Whole numbers in a range.
    pub(super) const fn whole(low: u32, high: u32) -> Self {
        Self::Whole { low, high, multiple: 1 }
    }

    /// Whether a value is one of these.
    pub fn allows(self, value: Value) -> bool {
        match (self, value) {
            (Self::Switch, Value::Switch(_)) => true,
            (Self::Whole { low, high, multiple }, Value::Whole(whole)) => {
                (low..=high).contains(&whole) && whole.is_multiple_of(multiple)
            }
            (Self::Number { low, high, off, .. }, Value::Number(number)) => {
                (low..=high).contains(&number) || off == Some(number)
            }
            (Self::Number { word, .. }, Value::Word(given)) => word == Some(given),
            (Self::Vector { low, below }, Value::Vector(vector)) => {
                vector.to_array().iter().all(|number| (low..below).contains(number))
            }
            (Self::Choice(names), Value::Choice(name)) => names.contains(&name),
            _ => false,
        }
    }

    /// Reads a value; `None` where the text is none. Ranges are not checked.
    pub(super) fn parse(self, text: &str) -> Option<Value> {
        match self {
            Self::Switch => match text {
                "on" | "true" | "yes" | "1" => Some(Value::Switch(true)),
                "off" | "false" | "no" | "0" => Some(Value::Switch(false)),
                _ => None,
            },
            Self::Whole { .. } => text.parse().ok().map(Value::Whole),
            Self::Number { word, .. } => match word {
                Some(word) if word == text => Some(Value::Word(word)),
                _ => text.parse().ok().filter(|n: &f32| n.is_finite()).map(Value::Number),
            },
            Self::Vector { .. } => {
                let numbers: Option<Vec<f32>> =
                    text.split(',').map(|number| number.trim().parse().ok()).collect();
                let [x, y, z] = numbers?.try_into().ok()?;
                Some(Vec3::new(x, y, z)).filter(|v| v.is_finite()).map(Value::Vector)
            }
            Self::Choice(names) => {
                let plain = |name: &str| name.replace('_', "-");
                let named = names.iter().find(|name| plain(name) == plain(text));
                named.map(|name| Value::Choice(name))
            }
        }
    }

    /// The values in words, as in "a number from 0 to 1".
    pub fn in_words(self) -> String {
        match self {
            Self::Switch => "on or off".to_owned(),
            Self::Whole { low, high, multiple: 1 } => {
                format!("a whole number from {low} to {high}")
            }
            Self::Whole { low, high, multiple } => {
                format!("a multiple of {multiple} from {low} to {high}")
            }
            Self::Number { low, high, word, off } => {
                let off = off.map(|off| format!(", or {off}")).unwrap_or_default();
                let word = word.map(|word| format!(", or {word}")).unwrap_or_default();
                format!("a number from {low} to {high}{off}{word}")
            }
            Self::Vector { low, below } => {
                format!("three numbers x,y,z, each from {low} to below {below}")
            }
            Self::Choice(names) => match names {
                [] => String::new(),
                [one] => (*one).to_owned(),
                [most @ .., last] => format!("{} or {last}", most.join(", ")),
            },
        }
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
