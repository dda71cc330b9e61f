//! The CPU version of `scatter.wgsl`, in f64 and with other forms of the formulas: slopes and
//! Smith's Lambda.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

/// A grey surface whose normal is +z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lobes {
    pub(super) diffuse: f64,
    pub(super) f0: f64,
    pub(super) alpha: f64,
    /// Exponent of a Phong lobe; 0: microfacets.
    pub(super) phong_exponent: f64,
    pub(super) coat_strength: f64,
    pub(super) coat_alpha: f64,
}

impl Default for Lobes {
    fn default() -> Self {
        Self {
            diffuse: 0.0,
            f0: 0.0,
            alpha: 1.0,
            phong_exponent: 0.0,
            coat_strength: 0.0,
            coat_alpha: 1.0,
        }
    }
}

/// A direction with the given cosine to the normal.
pub(super) fn at_cosine(cosine: f64) -> DVec3 {
    DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine)
}

/// Lagarde and de Rousiers 2014, section 3.1.3.
fn schlick(f0: f64, cosine: f64) -> f64 {
    let f90 = (f0 * 49.5).min(1.0);
    f0 + (f90 - f0) * (1.0 - cosine).powi(5)
}

/// Walter et al. 2007, equation 33, in terms of the tangent.
fn distribution(normal: DVec3, alpha: f64) -> f64 {
    let cos_2 = normal.z * normal.z;
    let tan_2 = (1.0 - cos_2).max(0.0) / cos_2;
    alpha.powi(2) / (PI * cos_2.powi(2) * (alpha.powi(2) + tan_2).powi(2))
}

/// Heitz 2014, equation 72.
fn lambda(direction: DVec3, alpha: f64) -> f64 {
    let cos_2 = direction.z * direction.z;
    let tan_2 = (1.0 - cos_2).max(0.0) / cos_2;
    0.5 * ((1.0 + alpha * alpha * tan_2).sqrt() - 1.0)
}

/// Heitz 2014, equation 99.
fn both_seen(view: DVec3, light: DVec3, alpha: f64) -> f64 {
    1.0 / (1.0 + lambda(view, alpha) + lambda(light, alpha))
}

fn mirror(view: DVec3, normal: DVec3) -> DVec3 {
    2.0 * view.dot(normal) * normal - view
}

/// Points in the middle of cells of equal area of the unit square.
fn cells(edge: u32) -> impl Iterator<Item = (f64, f64)> {
    let middle = move |index: u32| (f64::from(index) + 0.5) / f64::from(edge);
    (0..edge).flat_map(move |x| (0..edge).map(move |y| (middle(x), middle(y))))
}

impl Lobes {
    fn gloss_fresnel(&self, cosine: f64) -> f64 {
        if self.phong_exponent > 0.0 { self.f0 } else { schlick(self.f0, cosine) }
    }

    fn coat_fresnel(&self, cosine: f64) -> f64 {
        self.coat_strength * schlick(0.04, cosine)
    }

    /// The BRDF times the cosine, for light from above.
    pub(super) fn value(&self, view: DVec3, light: DVec3) -> f64 {
        let half = (view + light).normalize();
        let cosine = half.dot(view);
        let facets = |alpha| {
            distribution(half, alpha) * both_seen(view, light, alpha) / (4.0 * view.z * light.z)
        };
        let fresnel = self.gloss_fresnel(cosine);
        let gloss = if self.phong_exponent > 0.0 {
            let along = mirror(view, DVec3::Z).dot(light).max(0.0);
            (self.phong_exponent + 2.0) / TAU * along.powf(self.phong_exponent)
        } else {
            facets(self.alpha)
        };
        let below = 1.0 - self.coat_fresnel(view.z);
        let diffuse = (1.0 - fresnel) * self.diffuse / PI;
        let coat = self.coat_fresnel(cosine) * facets(self.coat_alpha);
        let all = self.of_all_microfacets(view.z);
        (below * (diffuse + all * fresnel * gloss) + coat) * light.z
    }

    /// The factor of the gloss that adds the light of further microfacets: Turquin 2019, equation
    /// 15, with the polynomial of `trace/brdf.wgsl`.
    fn of_all_microfacets(&self, cosine: f64) -> f64 {
        if self.phong_exponent > 0.0 {
            return 1.0;
        }
        let (r, s) = (self.alpha.sqrt(), cosine.sqrt());
        let rows = [
            [0.0527, -0.239, -1.255, 1.4782],
            [-2.0794, 17.0211, -21.7604, 5.5204],
            [3.7227, -32.5647, 52.1889, -19.0986],
            [-1.8146, 17.1002, -29.7901, 12.2108],
        ];
        let row = |[a, b, c, d]: [f64; 4]| a + s * (b + s * (c + s * d));
        let lost = rows.iter().rev().fold(0.0, |sum, &of| r * (row(of) + sum)).clamp(0.0, 1.0);
        1.0 + self.f0 * lost / (1.0 - lost)
    }

    /// The density of sampled directions, per steradian.
    pub(super) fn density(&self, view: DVec3, light: DVec3) -> f64 {
        let half = (view + light).normalize();
        // The density of visible normals, mirrored: Heitz 2014, equations 43 and 2.
        let facets =
            |alpha| distribution(half, alpha) / ((1.0 + lambda(view, alpha)) * 4.0 * view.z);
        let gloss = if self.phong_exponent > 0.0 {
            let along = mirror(view, DVec3::Z).dot(light).max(0.0);
            (self.phong_exponent + 1.0) / TAU * along.powf(self.phong_exponent)
        } else {
            facets(self.alpha)
        };
        let coat = self.coat_fresnel(view.z);
        let fresnel = self.gloss_fresnel(view.z);
        let shares =
            [(1.0 - coat) * self.diffuse * (1.0 - fresnel).max(0.1), (1.0 - coat) * fresnel, coat];
        let sum: f64 = shares.iter().sum();
        let densities = [light.z.max(0.0) / PI, gloss, facets(self.coat_alpha)];
        shares.iter().zip(densities).map(|(share, density)| share * density).sum::<f64>() / sum
    }

    /// The share of uniform light that is reflected in a direction with the given cosine. Each lobe
    /// is integrated in coordinates in which it is smooth.
    pub(super) fn albedo(&self, cosine: f64) -> f64 {
        let view = at_cosine(cosine);
        // D cos(h) dh is du dphi / 2 pi, where tan^2(h) = alpha^2 u / (1 - u).
        let facets = |alpha: f64, fresnel: &dyn Fn(f64) -> f64| {
            let each = |(u, turn): (f64, f64)| {
                let tan = alpha * (u / (1.0 - u)).sqrt();
                let cos = 1.0 / tan.hypot(1.0);
                let (sine, cosine) = (TAU * turn).sin_cos();
                let half = DVec3::new(tan * cos * cosine, tan * cos * sine, cos);
                let light = mirror(view, half);
                if light.z <= 0.0 || view.dot(half) <= 0.0 {
                    return 0.0;
                }
                let h_dot_v = view.dot(half);
                fresnel(h_dot_v) * both_seen(view, light, alpha) * h_dot_v / (view.z * cos)
            };
            mean(cells(400).map(each))
        };
        let around = |axis: DVec3, cosine: f64, turn: f64| {
            let (x, y) = axis.any_orthonormal_pair();
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            let turned = (TAU * turn).cos() * x + (TAU * turn).sin() * y;
            sine * turned + cosine * axis
        };
        let gloss = if self.phong_exponent > 0.0 {
            let exponent = self.phong_exponent;
            let axis = mirror(view, DVec3::Z);
            let each = |(u, turn): (f64, f64)| {
                let light = around(axis, f64::powf(u, 1.0 / (exponent + 1.0)), turn);
                self.f0 * light.z.max(0.0) * (exponent + 2.0) / (exponent + 1.0)
            };
            mean(cells(400).map(each))
        } else {
            self.of_all_microfacets(cosine) * facets(self.alpha, &|cosine| schlick(self.f0, cosine))
        };
        let diffuse = mean(cells(400).map(|(u, turn)| {
            let light = around(DVec3::Z, f64::sqrt(u), turn);
            let half = (view + light).normalize();
            self.diffuse * (1.0 - self.gloss_fresnel(half.dot(view)))
        }));
        let below = 1.0 - self.coat_fresnel(cosine);
        below * (diffuse + gloss) + facets(self.coat_alpha, &|cosine| self.coat_fresnel(cosine))
    }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}
