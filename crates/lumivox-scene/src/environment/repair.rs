//! Replaces texels that cannot be a radiance. Panoramas often hold a few negative or infinite
//! texels, left by sharpening filters and by conversions to half floats.

use crate::EnvironmentMap;

impl EnvironmentMap {
    /// Sets negative and NaN channels to 0 and infinite ones to the largest finite value of the
    /// picture, with a warning for each kind.
    pub(super) fn repair(&mut self) {
        let channels = || self.rgb.iter().flatten().copied();
        let most = channels().filter(|c| c.is_finite()).fold(0.0, f32::max);
        let (mut negative, mut unknown, mut infinite) = (0_usize, 0_usize, 0_usize);
        for channel in self.rgb.iter_mut().flatten() {
            if channel.is_nan() {
                unknown += 1;
                *channel = 0.0;
            } else if *channel == f32::INFINITY {
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
        tell(infinite, "infinite", &format!("{most}, the largest finite one"));
    }
}
