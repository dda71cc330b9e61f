//! Map coordinates of millions of metres, which 32-bit floats resolve to only half a metre.
//!
//! Readers store what f32 loses of such coordinates ([`Rest`]). Once all positions are known, the
//! scene is moved in f64 by its *origin*, a round number near its middle.

use glam::{DVec3, Vec3};

use super::Notes;

/// The least coordinate that counts as far, in the file's unit: f32 is exact to a quarter of a
/// thousandth up to it.
pub(super) const FAR: f64 = 4096.0;
/// Origins are multiples of this power of two, so that subtracting an origin from an f32 coordinate
/// is exact.
const ROUND: f64 = 1024.0;
/// Scenes at or beyond this coordinate always get an origin: f32 is only exact to a thousandth
/// there, a millimetre if the unit is a metre.
const ALWAYS: f64 = 16384.0;
/// Nearer scenes get an origin if their distance from zero is more than this many times their size.
const TIMES: f64 = 8.0;
/// The most positions that are sampled to find the middle.
const MOST_SAMPLES: usize = 4096;

/// The errors of positions rounded to f32, in their order; empty until a position is far.
#[derive(Debug, Default)]
pub(super) struct Rest {
    count: usize,
    lost: Vec<Vec3>,
}

impl Rest {
    /// Converts the next position to f32.
    pub(super) fn place(&mut self, place: DVec3) -> Vec3 {
        let rounded = place.as_vec3();
        if !self.lost.is_empty() || is_far(place) {
            self.lost.resize(self.count, Vec3::ZERO);
            let lost = (place - rounded.as_dvec3()).as_vec3();
            self.lost.push(if lost.is_finite() { lost } else { Vec3::ZERO });
        }
        self.count += 1;
        rounded
    }

    /// The exact positions relative to the position `first`, by index, so that shapes far from zero
    /// do not lose precision.
    pub(super) fn relative_to<'a>(
        &'a self,
        first: usize,
        places: &'a [Vec3],
    ) -> impl Fn(usize) -> Vec3 + 'a {
        let exact = move |index: usize| {
            let lost = self.lost.get(index).copied().unwrap_or(Vec3::ZERO);
            places[index].as_dvec3() + lost.as_dvec3()
        };
        let middle = if self.lost.is_empty() { DVec3::ZERO } else { exact(first) };
        move |index| (exact(index) - middle).as_vec3()
    }

    /// Subtracts the origin from the positions, in one or more lists, and returns it; zero if they
    /// do not need one.
    pub(super) fn take_origin<'a>(&self, lists: impl IntoIterator<Item = &'a mut [Vec3]>) -> DVec3 {
        let mut lists: Vec<&mut [Vec3]> = lists.into_iter().collect();
        let origin =
            origin_of(|| lists.iter().flat_map(|list| list.iter()).map(|place| place.as_dvec3()));
        if origin != DVec3::ZERO {
            let lost = self.lost.iter().copied().chain(std::iter::repeat(Vec3::ZERO));
            for (place, lost) in lists.iter_mut().flat_map(|list| list.iter_mut()).zip(lost) {
                *place = (place.as_dvec3() + lost.as_dvec3() - origin).as_vec3();
            }
        }
        origin
    }
}

fn is_far(place: DVec3) -> bool {
    place.abs().max_element() >= FAR
}

/// Computes the origin of positions; zero if they do not need one.
pub(super) fn origin_of<I: Iterator<Item = DVec3>>(places: impl Fn() -> I) -> DVec3 {
    let finite = || places().filter(|place| place.as_vec3().is_finite());
    if !finite().any(is_far) {
        return DVec3::ZERO;
    }
    let step = finite().count().div_ceil(MOST_SAMPLES);
    // Stray positions, such as unused vertices at zero, do not move the median.
    let median = |axis: usize| {
        let mut values: Vec<f64> = finite().step_by(step).map(|place| place[axis]).collect();
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let origin = (DVec3::from_array([0, 1, 2].map(median)) / ROUND).round() * ROUND;
    let far = origin.abs().max_element();
    let is_near = |place: &DVec3| (*place - origin).abs().max_element() < 0.25 * far;
    let (mut low, mut high, mut near) = (DVec3::INFINITY, DVec3::NEG_INFINITY, 0);
    for place in finite().filter(is_near) {
        (low, high, near) = (low.min(place), high.max(place), near + 1);
    }
    let helps = far >= ALWAYS || far > TIMES * (high - low).max_element();
    if far > 0.0 && 2 * near > finite().count() && helps { origin } else { DVec3::ZERO }
}

/// Warns that the scene has an origin, in metres with y up.
pub(super) fn tell(warnings: &mut Vec<String>, origin: DVec3) {
    if origin == DVec3::ZERO {
        return;
    }
    let [x, y, z] = origin.to_array();
    warnings.push(format!(
        "its places are far from zero, where 32-bit floats are coarse, so the scene counts from ({x}, {y}, {z}); the command line \
         takes and tells metres from the file's zero, with y up"
    ));
}

/// Warns about lost precision if the file itself stores far positions as f32.
pub(super) fn tell_lost(notes: &mut Notes, origin: DVec3) {
    if origin == DVec3::ZERO {
        return;
    }
    let far = origin.abs().max_element();
    // A position is off by at most half a step.
    let step = f64::from((far as f32).next_up()) - far;
    notes.warn(format!(
        "it stores places as 32-bit floats itself, which are off by up to {} thousandths of its unit there; export it near zero, \
         or as text",
        (500.0 * step).round().max(1.0)
    ));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(places: &[[f64; 3]]) -> (Vec<Vec3>, DVec3) {
        let mut rest = Rest::default();
        let mut all: Vec<Vec3> = places.iter().map(|&place| rest.place(place.into())).collect();
        let origin = rest.take_origin([all.as_mut_slice()]);
        (all, origin)
    }

    #[test]
    fn map_coordinates_keep_millimetre_precision() {
        let on_map = |x: f64, y: f64, z: f64| [500_000.123 + x, 400.0 + y, 4_649_776.456 + z];
        let (places, origin) =
            placed(&[on_map(0.0, 0.0, 0.0), on_map(0.001, 0.0, 0.0), on_map(0.0, 2.5, 8.125)]);
        assert_eq!(origin, DVec3::new(499_712.0, 0.0, 4_649_984.0));
        assert!((places[1].x - places[0].x - 0.001).abs() < 2e-5, "{places:?}");
        assert!((places[2] - places[0] - Vec3::new(0.0, 2.5, 8.125)).length() < 2e-5);
    }

    /// In many files, unused vertices are at zero.
    #[test]
    fn an_unused_vertex_at_zero_does_not_prevent_recentring() {
        let (places, origin) =
            placed(&[[0.0; 3], [5e5, 0.0, 4e6], [5e5, 1.0, 4e6], [5e5, 1.0, 4e6 + 1.0]]);
        assert_eq!(places[0], (-origin).as_vec3());
        assert_eq!(places[3] - places[1], Vec3::new(0.0, 1.0, 1.0));
    }

    #[test]
    fn scenes_near_zero_or_very_large_are_not_recentred() {
        for given in [
            vec![[5000.0, 1.0, 2.0], [-5000.0, 0.0, 1.0], [3.0, 4.0, 5.0]],
            vec![[0.5, 1.0, 2.0], [1.5, 2.0, 4000.0]],
            vec![[4500.0, 1.0, 2.0], [5200.0, 0.0, 1.0], [5100.0, 4.0, 800.0]],
            vec![[f64::INFINITY, 0.0, 0.0], [f64::NAN, 0.0, 1.0], [1e300, 0.0, 0.0]],
            vec![[1e30, 0.0, 0.0], [1.0, 0.0, 1.0], [1.0, 0.5, 0.0]],
        ] {
            let (places, origin) = placed(&given);
            assert_eq!(origin, DVec3::ZERO);
            let bits = |place: Vec3| place.to_array().map(f32::to_bits);
            for (place, given) in places.into_iter().zip(given) {
                assert_eq!(bits(place), bits(DVec3::from(given).as_vec3()));
            }
        }
    }
}
