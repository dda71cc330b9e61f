//! Axis-aligned boxes.

use glam::Vec3;

/// An axis-aligned box in world space, in metres. Default: [`Bounds::EMPTY`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The corner with the smallest coordinates.
    pub min: Vec3,
    /// The corner with the largest coordinates.
    pub max: Vec3,
}

impl Default for Bounds {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Bounds {
    /// The box of no points: `min` is plus infinity, `max` minus infinity, so that
    /// [`Bounds::include`] needs no special case.
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The smallest box around `points`.
    pub fn from_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        let mut bounds = Self::EMPTY;
        for point in points {
            bounds.include(point);
        }
        bounds
    }

    /// Grows the box to hold `point`.
    pub fn include(&mut self, point: Vec3) {
        self.min = self.min.min(point);
        self.max = self.max.max(point);
    }

    /// The smallest box around both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Whether the box holds no point at all.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The middle of the box; the origin for an empty one.
    pub fn center(&self) -> Vec3 {
        // Halved before the sum, so that corners near the largest float do not overflow.
        if self.is_empty() { Vec3::ZERO } else { self.min * 0.5 + self.max * 0.5 }
    }

    /// The lengths of the edges in metres; zero for an empty box.
    pub fn size(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }

    /// The eight corners; without meaning for an empty box.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|corner| {
            let pick = |bit: usize, low: f32, high: f32| if corner & bit == 0 { low } else { high };
            Vec3::new(
                pick(1, self.min.x, self.max.x),
                pick(2, self.min.y, self.max.y),
                pick(4, self.min.z, self.max.z),
            )
        })
    }

    /// Half the diagonal in metres: the radius of the sphere around the box.
    pub fn radius_m(&self) -> f32 {
        (self.size() * 0.5).length()
    }

    /// Whether `point` lies inside or on the box.
    pub fn contains(&self, point: Vec3) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_enclose_their_points() {
        let bounds = Bounds::from_points([Vec3::new(1.0, -2.0, 3.0), Vec3::new(-1.0, 4.0, 3.0)]);
        assert_eq!(bounds.min, Vec3::new(-1.0, -2.0, 3.0));
        assert_eq!(bounds.size(), Vec3::new(2.0, 6.0, 0.0));
        assert_eq!(bounds.center(), Vec3::new(0.0, 1.0, 3.0));
        assert!(bounds.contains(bounds.center()));
        assert!(!bounds.is_empty());
    }

    #[test]
    fn the_empty_box_has_no_size() {
        assert!(Bounds::EMPTY.is_empty());
        assert_eq!(Bounds::EMPTY.size(), Vec3::ZERO);
        assert!(!Bounds::EMPTY.contains(Vec3::ZERO));
    }
}
