//! Named values of the library's enums.

use super::{Choice, Value};
use crate::{Directionality, Duplication, Mipmapping, TraceResolution};

/// A type with a few values, each with a name and a line of help.
pub trait Choices: Copy + PartialEq + 'static {
    /// The values.
    const VALUES: &'static [Self];
    /// Their names, in the same order.
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

impl Choices for Directionality {
    const VALUES: &'static [Self] = &[Self::SixLobes, Self::Isotropic];
    const CHOICES: &'static [Choice] = &[
        Choice::new("six_lobes", "a radiance for each of six directions"),
        Choice::new("isotropic", "one radiance a voxel"),
    ];
}

impl Choices for TraceResolution {
    const VALUES: &'static [Self] = &[Self::Full, Self::Half];
    const CHOICES: &'static [Choice] = &[
        Choice::new("full", "cones from every pixel"),
        Choice::new("half", "cones from one pixel of each 2x2 block"),
    ];
}

impl Choices for Duplication {
    const VALUES: &'static [Self] = &[Self::Table, Self::Pointers, Self::Search];
    const CHOICES: &'static [Choice] = &[
        Choice::new("table", "by a search from the table of nodes on"),
        Choice::new("pointers", "by pointers from node to node, 12 bytes a node"),
        Choice::new("search", "by a search from the root for each"),
    ];
}

impl Choices for Mipmapping {
    const VALUES: &'static [Self] = &[Self::Occupied, Self::Every];
    const CHOICES: &'static [Choice] = &[
        Choice::new("occupied", "only occupied cells"),
        Choice::new("every", "all possible cells, most of them empty"),
    ];
}
