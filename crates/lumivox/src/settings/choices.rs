//! Named values of the library's enums.

use super::{Choice, Value};

/// A type with a few values, each with a name and a line of help.
pub trait Choices: Copy + PartialEq + 'static {
    /// The values.
    const VALUES: &'static [Self];
    /// The values' names, in the same order.
    const CHOICES: &'static [Choice];

    /// The name of a value.
    fn choice(self) -> &'static str {
        let mut named = Self::VALUES.iter().zip(Self::CHOICES);
        named.find(|(value, _)| **value == self).map_or("", |(_, choice)| choice.name)
    }

    /// The value with this name; `None` if no value has it.
    fn chosen(value: Value) -> Option<Self> {
        let mut named = Self::VALUES.iter().zip(Self::CHOICES);
        named.find(|(_, choice)| choice.name == value.name()).map(|(value, _)| *value)
    }

    /// Sets the value with this name; does nothing if no value has it.
    fn choose(&mut self, value: Value) {
        *self = Self::chosen(value).unwrap_or(*self);
    }
}
