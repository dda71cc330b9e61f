//! Specular reflection of a surface in voxels: the reflected share of the light, without its
//! direction.

use std::f32::consts::TAU;

/// Mean of Schlick's `(1 - cos)^5` (cosine between half vector and light) if light and view are
/// both cosine-distributed over the hemisphere: `∫∫ (1 - h·l)^5 dμ dμ` of normalized
/// cosine-weighted measures.
const ENTERING_FIFTH_POWER: f32 = 0.003_688;

/// Number of samples of the light's cosine, and of each of the two numbers that choose a half
/// vector.
const STEPS: usize = 16;

/// Light that a dielectric surface reflects specularly, for faces of voxels. This light does not
/// enter the surface.
///
/// Faces send the same light in all directions, so they store the reflected share but not its
/// direction. For light that arrives at the cosine c the share is `mean + grazing ((1 - c)^4 -
/// 1/15)`, the least-squares fit of that form over light from all around. Black lacquer of
/// roughness 0.5 reflects 5 % in the mean, and 9 % of a low sun's light at c = 1/3. Without it,
/// dark and strongly coloured rooms lose as much of their bounced light.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gloss {
    /// Reflected share of light from all around, 0 to 1.
    pub mean: f32,
    /// How the share grows towards grazing angles, -1 to 1.
    pub grazing: f32,
    /// Share of light from all around that does not enter the surface, 0 to 1.
    pub kept_out: f32,
}

impl Gloss {
    /// A Lambert surface: reflects nothing specularly.
    pub const NONE: Self = Self { mean: 0.0, grazing: 0.0, kept_out: 0.0 };

    /// Computed from the microfacet BRDF of the cones' pixels (`trace/brdf.wgsl`): GGX,
    /// height-correlated Smith, Schlick, and the light of further microfacets.
    ///
    /// `f0` is the reflectance at normal incidence, `roughness` the perceptual roughness; both are
    /// clamped to 0 to 1.
    pub fn new(f0: f32, roughness: f32) -> Self {
        let f0 = f0.clamp(0.0, 1.0);
        if f0 <= 0.0 {
            return Self::NONE;
        }
        // As in the shader, whose F0 has three channels.
        let f90 = (3.0 * 50.0 * 0.33 * f0).min(1.0);
        let roughness = roughness.clamp(0.0, 1.0);
        let alpha = (roughness * roughness).max(1e-3);
        // Midpoints in the squared cosine are distributed like light from all around.
        let cosines: [f32; STEPS] =
            std::array::from_fn(|i| ((i as f32 + 0.5) / STEPS as f32).sqrt());
        let shares = cosines.map(|cosine| {
            // With the light of further microfacets, as `of_all_microfacets` of the shader.
            let all = mirrored(cosine, alpha, 1.0, 1.0);
            mirrored(cosine, alpha, f0, f90) * (1.0 + f0 * (1.0 / all - 1.0))
        });
        let shapes = cosines.map(|cosine| (1.0 - cosine).powi(4) - 1.0 / 15.0);
        let mean = shares.iter().sum::<f32>() / STEPS as f32;
        let growth = shares.iter().zip(&shapes).map(|(share, shape)| (share - mean) * shape);
        let norm = shapes.iter().map(|shape| shape * shape).sum::<f32>();
        Self {
            mean: mean.clamp(0.0, 1.0),
            grazing: (growth.sum::<f32>() / norm).clamp(-1.0, 1.0),
            kept_out: f0 + (f90 - f0) * ENTERING_FIFTH_POWER,
        }
    }

    /// The gloss of a surface that covers `share` of the area.
    #[must_use]
    pub fn of_share(self, share: f32) -> Self {
        let [mean, grazing, kept_out] = self.to_array().map(|number| number * share);
        Self { mean, grazing, kept_out }
    }

    pub(crate) fn to_array(self) -> [f32; 3] {
        [self.mean, self.grazing, self.kept_out]
    }
}

/// The directional albedo: the share of light from a direction at this cosine that is reflected in
/// any direction. Mean of `F G2 / G1` over the distribution of visible normals (Heitz 2018,
/// equation 19).
fn mirrored(cosine: f32, alpha: f32, f0: f32, f90: f32) -> f32 {
    let light = glam::Vec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
    let stretched = glam::Vec3::new(light.x * alpha, 0.0, light.z).normalize();
    let lambda = |c: f32| 0.5 * ((1.0 + alpha * alpha * (1.0 / (c * c) - 1.0)).sqrt() - 1.0);
    let middle = |i: usize| (i as f32 + 0.5) / STEPS as f32;
    let mut sum = 0.0;
    for i in 0..STEPS {
        let (sin, cos) = (TAU * middle(i)).sin_cos();
        for j in 0..STEPS {
            // Dupuy and Benyoub 2023, listing 3.
            let z = (1.0 - middle(j)) * (1.0 + stretched.z) - stretched.z;
            let sine = (1.0 - z * z).max(0.0).sqrt();
            let cap = glam::Vec3::new(sine * cos, sine * sin, z) + stretched;
            let normal = glam::Vec3::new(cap.x * alpha, cap.y * alpha, cap.z.max(0.0)).normalize();
            let along = light.dot(normal).clamp(0.0, 1.0);
            let out = 2.0 * along * normal.z - cosine;
            if out > 0.0 {
                let fresnel = f0 + (f90 - f0) * (1.0 - along).powi(5);
                sum += fresnel * (1.0 + lambda(cosine)) / (1.0 + lambda(cosine) + lambda(out));
            }
        }
    }
    sum / (STEPS * STEPS) as f32
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// The BRDF of `trace/brdf.wgsl` with its cosine, in f64, for light and view in the frame of
    /// the normal.
    fn brdf_times_cosine(light: glam::DVec3, view: glam::DVec3, alpha: f64, f0: f64) -> f64 {
        let half = (light + view).normalize();
        let a2 = alpha * alpha;
        let d = half.z * half.z * (a2 - 1.0) + 1.0;
        let distribution = a2 / (PI * d * d);
        let smith = |a: f64, b: f64| a * (b * b * (1.0 - a2) + a2).sqrt();
        let visibility = 0.5 / (smith(light.z, view.z) + smith(view.z, light.z));
        let fresnel = f0 + (1.0 - f0) * (1.0 - half.dot(view)).powi(5);
        fresnel * distribution * visibility * view.z
    }

    fn direction(cosine: f64, azimuth: f64) -> glam::DVec3 {
        let sine = (1.0 - cosine * cosine).sqrt();
        glam::DVec3::new(sine * azimuth.cos(), sine * azimuth.sin(), cosine)
    }

    /// The directional albedo at a cosine, by summation over directions.
    fn summed(cosine: f64, roughness: f64, f0: f64) -> f64 {
        const STEPS: u32 = 200;
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
        let light = direction(cosine, 0.0);
        let mut sum = 0.0;
        for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
            let view = direction(middle(i), PI * middle(j));
            sum += brdf_times_cosine(light, view, roughness * roughness, f0);
        }
        sum * 2.0 * PI / f64::from(STEPS * STEPS)
    }

    /// The directional albedo with the light of further microfacets.
    fn all(cosine: f64, roughness: f64, f0: f64) -> f64 {
        let lost = 1.0 - summed(cosine, roughness, 1.0);
        summed(cosine, roughness, f0) * (1.0 + f0 * lost / (1.0 - lost))
    }

    #[test]
    fn mean_gloss_matches_the_brdf() {
        for roughness in [0.4, 0.5, 0.7, 1.0] {
            let gloss = Gloss::new(0.04, roughness as f32);
            let cosines = (0..24).map(|i| ((f64::from(i) + 0.5) / 24.0).sqrt());
            let mean = cosines.map(|c| all(c, roughness, 0.04)).sum::<f64>() / 24.0;
            let error = f64::from(gloss.mean) / mean - 1.0;
            assert!(error.abs() < 0.02, "{roughness}: {gloss:?}, not {mean}");
        }
    }

    /// From rough to smooth, at the angles of light on walls, the fit errs by less than 0.01 of the
    /// light, or by less than a sixth.
    #[test]
    fn grazing_gloss_grows_like_the_brdf() {
        for roughness in [0.35, 0.5, 0.7, 1.0] {
            let gloss = Gloss::new(0.04, roughness as f32);
            for cosine in [0.2, 0.33, 0.5, 0.8, 1.0] {
                let growth = (1.0_f64 - cosine).powi(4) - 1.0 / 15.0;
                let share = f64::from(gloss.mean) + f64::from(gloss.grazing) * growth;
                let exact = all(cosine, roughness, 0.04);
                let allowed = 0.01_f64.max(exact / 6.0);
                assert!(
                    (share - exact).abs() < allowed,
                    "{roughness}, {cosine}: {share}, not {exact}"
                );
            }
        }
    }

    #[test]
    fn the_kept_out_share_is_schlicks_mean() {
        const STEPS: u32 = 40;
        let middle = |i: u32| (f64::from(i) + 0.5) / f64::from(STEPS);
        let mut sum = 0.0;
        for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
            let light = direction(middle(i).sqrt(), 0.0);
            for k in 0..STEPS {
                let view = direction(middle(j).sqrt(), PI * middle(k));
                sum += (1.0 - (light + view).normalize().dot(view)).powi(5);
            }
        }
        let mean = sum / f64::from(STEPS).powi(3);
        assert!((mean / f64::from(ENTERING_FIFTH_POWER) - 1.0).abs() < 0.02, "{mean}");
        let kept_out = Gloss::new(0.04, 0.5).kept_out;
        assert!((kept_out - 0.043_54).abs() < 1e-4, "{kept_out}");
    }

    #[test]
    fn lambert_has_no_gloss_and_a_mirror_full_gloss() {
        assert_eq!(Gloss::new(0.0, 0.5), Gloss::NONE);
        let mirror = Gloss::new(1.0, 0.0);
        assert!(mirror.mean > 0.98 && mirror.kept_out > 0.999, "{mirror:?}");
        assert!(mirror.grazing.abs() < 0.02, "{mirror:?}");
        let lacquer = Gloss::new(0.04, 0.5);
        assert!((lacquer.of_share(0.5).mean * 2.0 - lacquer.mean).abs() < 1e-7);
    }
}
