//! The directional albedo of sheen: the share of uniform white light that it reflects in one
//! direction.
//!
//! The distribution is "Charlie" (Estevez and Kulla 2017, "Production friendly microfacet sheen
//! BRDF", section 3), the shadowing their fit, as `KHR_materials_sheen` specifies. Renderers add
//! the colour times this albedo to the surface and dim the layers below by its largest component.

use std::f32::consts::{FRAC_PI_2, PI};

use rayon::prelude::*;

/// Edge of the table of cosines by roughnesses; few entries are enough, as the function is smooth.
pub(crate) const EDGE: u32 = 32;

/// The table as bytes, 255 for one: cosines along rows, roughness from row to row, both at the
/// centres of `EDGE` equal steps from 0 to 1.
pub(crate) fn table() -> Vec<u8> {
    let center = |i: u32| (i as f32 + 0.5) / EDGE as f32;
    (0..EDGE * EDGE)
        .into_par_iter()
        .map(|i| directional_albedo(center(i % EDGE), center(i / EDGE)))
        .map(|albedo| (albedo * 255.0).round().clamp(0.0, 255.0) as u8)
        .collect()
}

/// The integral of the BRDF times the cosine over all directions of light.
fn directional_albedo(cos_view: f32, roughness: f32) -> f32 {
    // Midpoints: the integrand is smooth except at the horizon, where the cosine makes it zero.
    let (polar_steps, azimuth_steps) = (64, 48);
    let view = [(1.0 - cos_view * cos_view).sqrt(), 0.0, cos_view];
    let mut sum = 0.0;
    for i in 0..polar_steps {
        let (sin, cos) = ((i as f32 + 0.5) / polar_steps as f32 * FRAC_PI_2).sin_cos();
        for j in 0..azimuth_steps {
            // Half a turn; the other half is symmetric.
            let azimuth = (j as f32 + 0.5) / azimuth_steps as f32 * PI;
            let light = [sin * azimuth.cos(), sin * azimuth.sin(), cos];
            let half = std::array::from_fn::<f32, 3, _>(|k| view[k] + light[k]);
            let length = half.iter().map(|x| x * x).sum::<f32>().sqrt();
            sum += brdf(cos_view, cos, half[2] / length, roughness) * cos * sin;
        }
    }
    sum * 2.0 * (FRAC_PI_2 / polar_steps as f32) * (PI / azimuth_steps as f32)
}

fn brdf(n_dot_v: f32, n_dot_l: f32, n_dot_h: f32, roughness: f32) -> f32 {
    // Below this, the distribution is a spike at the horizon that no table can resolve.
    let alpha = (roughness * roughness).max(1e-3);
    let sine = (1.0 - n_dot_h * n_dot_h).max(0.0).sqrt();
    let distribution = (2.0 + 1.0 / alpha) * sine.powf(1.0 / alpha) / (2.0 * PI);
    let visibility =
        1.0 / ((1.0 + lambda(n_dot_v, alpha) + lambda(n_dot_l, alpha)) * 4.0 * n_dot_v * n_dot_l);
    // KHR_materials_sheen specifies these bounds.
    distribution * visibility.clamp(0.0, 1.0)
}

/// Estevez and Kulla's fit of the masking.
fn lambda(cosine: f32, alpha: f32) -> f32 {
    if cosine < 0.5 {
        fit(cosine, alpha).exp()
    } else {
        (2.0 * fit(0.5, alpha) - fit(1.0 - cosine, alpha)).exp()
    }
}

/// Table 1 of the same paper, interpolated between a smooth and a rough surface.
fn fit(x: f32, alpha: f32) -> f32 {
    let smooth = (1.0 - alpha) * (1.0 - alpha);
    let mix = |rough: f32, smoothest: f32| rough + (smoothest - rough) * smooth;
    let (a, b) = (mix(21.5473, 25.3245), mix(3.829_87, 3.324_35));
    let (c, d, e) = (mix(0.198_23, 0.168_01), mix(-1.977_6, -1.273_93), mix(-4.320_54, -4.859_67));
    a / (1.0 + b * x.powf(c)) + d * x + e
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_distribution_is_normalized() {
        // Projected microfacets cover their surface once: the integral of D n.h over the hemisphere
        // is 1.
        for roughness in [0.2_f32, 0.5, 1.0] {
            let alpha = roughness * roughness;
            let steps = 20_000;
            let integral: f32 = (0..steps)
                .map(|i| {
                    let (sin, cos) = ((i as f32 + 0.5) / steps as f32 * FRAC_PI_2).sin_cos();
                    (2.0 + 1.0 / alpha) * sin.powf(1.0 / alpha) / (2.0 * PI) * cos * sin
                })
                .sum();
            let integral = integral * 2.0 * PI * FRAC_PI_2 / steps as f32;
            assert!((integral - 1.0).abs() < 1e-3, "{roughness}: {integral}");
        }
    }

    #[test]
    fn velvet_shines_at_grazing_angles_and_never_adds_light() {
        for roughness in [0.1, 0.3, 0.6, 1.0] {
            let albedo: Vec<f32> =
                [0.05, 0.3, 0.9].map(|cosine| directional_albedo(cosine, roughness)).to_vec();
            assert!(albedo[0] > 1.5 * albedo[2], "{roughness}: {albedo:?}");
            assert!(albedo.iter().all(|a| (0.0..=1.0).contains(a)), "{roughness}: {albedo:?}");
        }
        // More steps make no difference at 8 bits.
        assert_eq!(table().len(), (EDGE * EDGE) as usize);
    }
}
