//! The distinct corners of a file's polygons: position, texture coordinates, normal.
//!
//! Chains from each position to its corners need less memory than a hash map, and keep the file's
//! order in memory: five million corners take a second, and 16 bytes each.

/// A corner of polygons, as indices into the file's vectors.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Corner {
    pub(super) position: u32,
    /// [`Corner::NONE`] without texture coordinates.
    pub(super) uv: u32,
    pub(super) normal: Normal,
}

impl Corner {
    pub(super) const NONE: u32 = u32::MAX;
}

/// The source of a corner's normal.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Normal(u32);

impl Normal {
    /// The normal of the face.
    pub(super) const FLAT: Self = Self(u32::MAX);
    const GROUP: u32 = 1 << 31;

    /// A normal of the file, by its index; the normal of the face if the index exceeds 31 bits.
    pub(super) fn given(number: u32) -> Self {
        if number < Self::GROUP { Self(number) } else { Self::FLAT }
    }

    /// The mean over the smoothing group with this number.
    pub(super) fn group(number: u32) -> Self {
        Self(number | Self::GROUP)
    }

    pub(super) fn as_given(self) -> Option<usize> {
        (self.0 < Self::GROUP).then_some(self.0 as usize)
    }

    pub(super) fn is_group(self) -> bool {
        self.0 >= Self::GROUP && self != Self::FLAT
    }
}

/// The distinct corners.
#[derive(Default)]
pub(super) struct Corners {
    list: Vec<Corner>,
    /// The next corner at the same position.
    next: Vec<u32>,
    /// The last corner at each position.
    heads: Vec<u32>,
}

impl Corners {
    /// The most corners at a position that are compared before a new one is added: more than in
    /// real meshes, and a bound on the cost of hostile ones.
    const LONGEST_CHAIN: usize = 32;

    /// Returns the index of a corner, which is added if it is new.
    pub(super) fn number(&mut self, corner: Corner) -> u32 {
        let place = corner.position as usize;
        if self.heads.len() <= place {
            self.heads.resize(place + 1, Corner::NONE);
        }
        if let Some(known) = self.find(corner.position, |other| *other == corner) {
            return known;
        }
        let number = self.list.len() as u32;
        self.list.push(corner);
        self.next.push(self.heads[place]);
        self.heads[place] = number;
        number
    }

    /// The index of the first corner in a position's chain that fits.
    pub(super) fn find(&self, position: u32, fits: impl Fn(&Corner) -> bool) -> Option<u32> {
        let mut number = self.heads[position as usize];
        for _ in 0..Self::LONGEST_CHAIN {
            let corner = self.list.get(number as usize)?;
            if fits(corner) {
                return Some(number);
            }
            number = self.next[number as usize];
        }
        None
    }

    pub(super) fn get(&self, number: u32) -> Corner {
        self.list[number as usize]
    }

    pub(super) fn len(&self) -> usize {
        self.list.len()
    }

    /// Frees the memory that is only needed to add corners.
    pub(super) fn close(&mut self) {
        self.next = Vec::new();
        self.heads = Vec::new();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_obj_corners_share_a_vertex() {
        let mut corners = Corners::default();
        let corner = |position, uv, normal| Corner { position, uv, normal };
        let all = [
            corner(5, 1, Normal::given(2)),
            corner(5, 1, Normal::group(2)),
            corner(5, Corner::NONE, Normal::FLAT),
            corner(0, 1, Normal::given(2)),
        ];
        for _ in 0..2 {
            assert_eq!(all.map(|c| corners.number(c)), [0, 1, 2, 3]);
        }
        assert_eq!(corners.len(), 4);
        assert!(all[1].normal.is_group() && !all[2].normal.is_group());
        assert_eq!(all[0].normal.as_given(), Some(2));
    }

    #[test]
    fn many_corners_at_one_position_stay_fast() {
        let mut corners = Corners::default();
        for uv in 0..100_000 {
            corners.number(Corner { position: 0, uv, normal: Normal::FLAT });
        }
        assert_eq!(corners.len(), 100_000);
    }
}
