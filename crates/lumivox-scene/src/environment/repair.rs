//! Replaces texels that cannot be a radiance. Panoramas often hold a few negative or infinite
//! texels, left by sharpening filters and by conversions to half floats.

use crate::EnvironmentMap;

/// The largest possible radiance: 600 000 times that of the sun in cd/m². Larger values are
/// overflows, and would outshine everything.
const MOST: f32 = 1e15;

impl EnvironmentMap {
    /// Sets negative and NaN channels to 0 and infinite ones to the largest possible value of the
    /// picture, with a warning for each kind.
    pub(super) fn repair(&mut self) {
        let channels = || self.rgb.iter().flatten().copied();
        let most = channels().filter(|c| *c <= MOST).fold(0.0, f32::max);
        let (mut negative, mut unknown, mut infinite) = (0_usize, 0_usize, 0_usize);
        for channel in self.rgb.iter_mut().flatten() {
            if channel.is_nan() {
                unknown += 1;
                *channel = 0.0;
            } else if *channel > MOST {
                infinite += 1;
                *channel = most;
            } else if *channel < 0.0 {
                negative += 1;
                *channel = 0.0;
            }
        }
        let mut tell = |count: usize, what: &str, instead: &str| {
            if count > 0 {
                self.warnings.push(format!(
                    "the environment map has {count} {what} values, which count as {instead}"
                ));
            }
        };
        tell(negative, "negative", "0");
        tell(unknown, "undefined (NaN)", "0");
        tell(infinite, "infinite or far too large", &format!("{most}, the largest other one"));
    }
}
