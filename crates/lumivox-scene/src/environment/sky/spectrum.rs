//! Light of 16 wavelengths, and its conversion to luminance and colour.
//!
//! The air treats each wavelength differently, by far more than three channels could represent (the
//! Rayleigh scattering of 400 nm is nine times that of 700 nm), so the sky is computed in bands of
//! 20 nm from 390 to 710 nm and only the result is converted to RGB: 683 lm/W times the CIE 1931
//! colour matching functions.

use glam::{DMat3, DVec3};

/// The number of bands.
pub(super) const BANDS: usize = 16;
/// One value per band.
pub(super) type Spectrum = [f64; BANDS];

const FIRST_NM: f64 = 400.0;
const WIDTH_NM: f64 = 20.0;
/// Luminous efficacy of radiation of 540 THz, lm/W: the definition of the candela.
const LUMENS_PER_WATT: f64 = 683.0;

/// Irradiance of the sun outside of the atmosphere, W/(m² nm), from 390 nm in steps of 10: the
/// means of ASTM G173-03, "Standard tables for reference solar spectral irradiances".
const SOLAR: [f64; 2 * BANDS + 1] = [
    1.14716, 1.72765, 1.73054, 1.6887, 1.61253, 1.91198, 2.03474, 2.02042, 2.02212, 1.93377,
    1.95809, 1.91686, 1.8298, 1.8685, 1.8931, 1.85149, 1.8504, 1.8341, 1.8345, 1.8147, 1.78158,
    1.7533, 1.6965, 1.68194, 1.64654, 1.6048, 1.52143, 1.55622, 1.5113, 1.474, 1.4482, 1.41018,
    1.36775,
];

/// Absorption cross-section of ozone at 233 K, 1e-25 m², from 390 nm in steps of 10 (the Chappuis
/// band): Gorshelev et al. 2014, "High spectral resolution ozone absorption cross-sections".
const OZONE: [f64; 2 * BANDS + 1] = [
    0.0066, 0.0153, 0.0276, 0.0552, 0.0845, 0.1582, 0.2316, 0.3669, 0.4924, 0.7752, 0.9016, 1.480,
    1.602, 2.139, 2.755, 3.091, 3.500, 4.266, 4.672, 4.398, 4.701, 5.019, 4.305, 3.740, 3.215,
    2.662, 2.238, 1.852, 1.473, 1.209, 0.942, 0.7455, 0.6566,
];

/// The mean over each band of a table in steps of 10 nm, by the trapezoidal rule.
fn banded(table: &[f64; 2 * BANDS + 1]) -> Spectrum {
    std::array::from_fn(|band| {
        0.25 * table[2 * band] + 0.5 * table[2 * band + 1] + 0.25 * table[2 * band + 2]
    })
}

/// The sun's irradiance outside the atmosphere, W/(m² nm).
pub(super) fn solar() -> Spectrum {
    banded(&SOLAR)
}

/// Absorption cross-section of ozone, m².
pub(super) fn ozone_cross_section() -> Spectrum {
    banded(&OZONE).map(|section| section * 1e-25)
}

/// Evaluates a function of the wavelength in µm at the middle of each band.
pub(super) fn by_wavelength(value: impl Fn(f64) -> f64) -> Spectrum {
    std::array::from_fn(|band| value(1e-3 * (FIRST_NM + WIDTH_NM * band as f64)))
}

/// Converts spectra to linear sRGB.
pub(super) struct Observer {
    /// lm nm/W of X, Y and Z for each band.
    matching: [DVec3; BANDS],
    rgb_from_xyz: DMat3,
}

impl Observer {
    pub(super) fn new() -> Self {
        let matching = std::array::from_fn(|band| {
            let middle = FIRST_NM + WIDTH_NM * band as f64;
            let steps = WIDTH_NM as i32;
            let at = |i: i32| color_matching(middle + f64::from(i) + 0.5 - 0.5 * WIDTH_NM);
            (0..steps).map(at).sum::<DVec3>() * LUMENS_PER_WATT
        });
        // IEC 61966-2-1, section 5.2.
        let rgb_from_xyz = DMat3::from_cols(
            DVec3::new(3.2406, -0.9689, 0.0557),
            DVec3::new(-1.5372, 1.8758, -0.2040),
            DVec3::new(-0.4986, 0.0415, 1.0570),
        );
        Self { matching, rgb_from_xyz }
    }

    /// Linear sRGB of a spectral radiance in W/(m² sr nm), in cd/m²; of an irradiance, in lux.
    /// Colours outside of sRGB become paler until they fit, at the same luminance.
    pub(super) fn rgb(&self, spectrum: &Spectrum) -> DVec3 {
        let xyz: DVec3 = self.matching.iter().zip(spectrum).map(|(m, value)| *m * *value).sum();
        let rgb = self.rgb_from_xyz * xyz;
        let (least, grey) = (rgb.min_element(), xyz.y);
        if least >= 0.0 || grey <= 0.0 {
            return rgb.max(DVec3::ZERO);
        }
        let kept = grey / (grey - least);
        (DVec3::splat(grey) + (rgb - grey) * kept).max(DVec3::ZERO)
    }
}

/// The CIE 1931 colour matching functions: the multi-lobe fit of Wyman, Sloan and Shirley 2013,
/// "Simple analytic approximations to the CIE XYZ color matching functions", section 2.2.
fn color_matching(nm: f64) -> DVec3 {
    let lobe = |mean: f64, below: f64, above: f64| {
        let width = if nm < mean { below } else { above };
        (-0.5 * ((nm - mean) / width).powi(2)).exp()
    };
    DVec3::new(
        1.056 * lobe(599.8, 37.9, 31.0) + 0.362 * lobe(442.0, 16.0, 26.7)
            - 0.065 * lobe(501.1, 20.4, 26.2),
        0.821 * lobe(568.8, 46.9, 40.5) + 0.286 * lobe(530.9, 16.3, 31.1),
        1.217 * lobe(437.0, 11.8, 36.0) + 0.681 * lobe(459.0, 26.0, 13.8),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ASTM G173-03 integrates to 133.1 klx.
    #[test]
    fn the_sun_outside_of_the_air_has_133_klx() {
        let rgb = Observer::new().rgb(&solar());
        let lux = rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722));
        assert!((lux / 133_100.0 - 1.0).abs() < 0.02, "{lux}");
    }

    #[test]
    fn colours_that_do_not_fit_keep_their_luminance() {
        let observer = Observer::new();
        for band in 0..BANDS {
            let spectrum = std::array::from_fn(|i| if i == band { 1.0 } else { 0.0 });
            let rgb = observer.rgb(&spectrum);
            assert!(rgb.min_element() >= 0.0);
            let luminance = rgb.dot(DVec3::new(0.2126, 0.7152, 0.0722));
            let expected = observer.matching[band].y;
            assert!((luminance / expected - 1.0).abs() < 1e-3, "{band}: {luminance} {expected}");
        }
    }
}
