//! Vectors of length one.

use glam::{DVec3, Vec3};

/// The vector at unit length; `None` if it has no direction.
///
/// A vector that has unit length up to rounding is unchanged, to the bit: normalising again would
/// change its last digits each time that a scene is saved and loaded. 1e-5 is about 80 units in the
/// last place, more than the rounding error of normalising.
pub(crate) fn to_unit(v: Vec3) -> Option<Vec3> {
    // In f64, where the length of a finite f32 vector cannot overflow or underflow.
    let wide = v.as_dvec3();
    if (wide.length() - 1.0).abs() <= 1e-5 {
        return Some(v);
    }
    wide.try_normalize().map(DVec3::as_vec3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn to_unit_normalizes_all_but_unit_vectors() {
        let unit = Vec3::new(0.3, -0.5, 0.7).normalize();
        assert_eq!(to_unit(unit), Some(unit));
        assert_eq!(to_unit(Vec3::X * 1e-30), Some(Vec3::X));
        assert_eq!(to_unit(Vec3::new(0.0, 3e38, 0.0)), Some(Vec3::Y));
        assert_eq!(to_unit(Vec3::ZERO), None);
        assert_eq!(to_unit(Vec3::NAN), None);
    }
}
