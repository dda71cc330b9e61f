//! The layers of a reference: radiance, its shares, and geometry.

use std::f64::consts::PI;

use glam::UVec2;

use super::film::{Film, Sums};

/// The layers of a path-traced picture, each row by row from the top; zero in pixels without a
/// surface.
///
/// Variances are of the mean over samples, averaged over the channels: the square of the pixel's
/// standard error. They are infinite with fewer than 17 samples, that is, fewer than two batches.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceLayers {
    /// Width and height in pixels.
    pub size: UVec2,
    /// Samples of each pixel.
    pub samples: u32,
    /// The fingerprint of the traced scene ([`super::PathTracer::fingerprint`]).
    pub fingerprint: u64,
    /// The picture: radiance in cd/m².
    pub radiance: Vec<[f32; 3]>,
    /// The share of `radiance` that is emitted, comes directly from lamps, or is the background.
    pub direct: Vec<[f32; 3]>,
    /// Irradiance in lux on the visible surface, from emissive surfaces and from surfaces that
    /// lamps light directly.
    pub one_bounce: Vec<[f32; 3]>,
    /// Irradiance in lux on the visible surface from all light except direct light from lamps.
    pub full: Vec<[f32; 3]>,
    /// The cosine-weighted share of the hemisphere that is open within the reach of occlusion.
    pub occlusion: Vec<f32>,
    /// Diffuse albedo.
    pub albedo: Vec<[f32; 3]>,
    /// Shading normal; its length is the pixel's coverage if all samples agree.
    pub normal: Vec<[f32; 3]>,
    /// Distance from the camera, m.
    pub depth_m: Vec<f32>,
    /// The share of the pixel that shows a surface.
    pub coverage: Vec<f32>,
    /// Variance of `radiance`.
    pub radiance_variance: Vec<f32>,
    /// Variance of `direct`.
    pub direct_variance: Vec<f32>,
    /// Variance of `one_bounce`.
    pub one_bounce_variance: Vec<f32>,
    /// Variance of `full`.
    pub full_variance: Vec<f32>,
    /// Variance of `occlusion`.
    pub occlusion_variance: Vec<f32>,
}

impl ReferenceLayers {
    pub(super) fn new(film: &Film, radiance_unit: f32, fingerprint: u64) -> Self {
        let unit = f64::from(radiance_unit);
        let first = |colors: Vec<[f32; 3]>| colors.into_iter().map(|[x, _, _]| x).collect();
        let scalar = |of: fn(&Sums) -> i128| first(film.mean(1.0, |s| [of(s); 3]));
        Self {
            size: film.size,
            samples: film.samples,
            fingerprint,
            radiance: film.mean(unit, |sums| sums.picture),
            direct: film.mean(unit, |sums| sums.direct),
            one_bounce: film.mean(PI * unit, |sums| sums.one_bounce),
            full: film.mean(PI * unit, |sums| sums.full),
            occlusion: scalar(|sums| sums.openness),
            albedo: film.mean(1.0, |sums| sums.albedo),
            normal: film.mean(1.0, |sums| sums.normal),
            depth_m: scalar(|sums| sums.depth_m),
            coverage: scalar(|sums| sums.coverage),
            radiance_variance: film.variance(unit, |sums| (sums.picture, sums.picture_square)),
            direct_variance: film.variance(unit, |sums| (sums.direct, sums.direct_square)),
            one_bounce_variance: film
                .variance(PI * unit, |sums| (sums.one_bounce, sums.one_bounce_square)),
            full_variance: film.variance(PI * unit, |sums| (sums.full, sums.full_square)),
            occlusion_variance: film
                .variance(1.0, |sums| ([sums.openness; 3], sums.openness_square)),
        }
    }

    /// The radiance with the coverage in a, as in [`crate::Picture`].
    pub fn picture(&self) -> Vec<[f32; 4]> {
        let pixels = self.radiance.iter().zip(&self.coverage);
        pixels.map(|([r, g, b], coverage)| [*r, *g, *b, *coverage]).collect()
    }
}
