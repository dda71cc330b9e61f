//! The atmosphere: its transmittance, and the light that it scatters once and many times.
//!
//! A sphere with a radius of 6360 km is surrounded by 100 km of air with three constituents:
//! molecules (Rayleigh scattering), aerosol (Mie scattering and absorption), and ozone
//! (absorption). Single scattering is integrated along each ray; all higher orders come from a
//! table, and are assumed to be the same in every direction: Hillaire 2020, "A scalable and
//! production ready sky and atmosphere rendering technique", section 5.5. Lengths are in km.

use std::f64::consts::PI;

use super::spectrum::{BANDS, Spectrum, by_wavelength, ozone_cross_section};

const GROUND_KM: f64 = 6360.0;
const TOP_KM: f64 = 6460.0;
/// Scale height of air at 288 K: R T / (M g).
const MOLECULES_KM: f64 = 8.4;
/// Scale height of aerosol: Hillaire 2020, section 4, table 1.
const AEROSOL_KM: f64 = 1.2;
/// Single-scattering albedo of aerosol: Hillaire 2020, table 1.
const AEROSOL_ALBEDO: f64 = 0.9;
/// Mean cosine of the scattering angle of aerosol: the same table.
const AEROSOL_ASYMMETRY: f64 = 0.8;
/// The density of ozone falls linearly on both sides of 25 km (the same table); its column is 300
/// Dobson units, 2.687e20 molecules per m² each.
const OZONE_MIDDLE_KM: f64 = 25.0;
const OZONE_HALF_KM: f64 = 15.0;
const OZONE_COLUMN: f64 = 300.0 * 2.687e20;

/// Angular radius of the sun, rad.
pub(super) const SUN_RADIUS_RAD: f64 = 0.004_65;

/// Densities at a point, or their integrals along a path in km: molecules, aerosol, ozone, each
/// relative to its maximum.
type Amounts = [f64; 3];

/// The atmosphere of one day.
pub(super) struct Atmosphere {
    /// Scattering by molecules at their maximum density, 1/km.
    molecules: Spectrum,
    /// Extinction by aerosol at its maximum density, 1/km.
    aerosol: Spectrum,
    /// Absorption by ozone at its maximum density, 1/km.
    ozone: Spectrum,
    ground_albedo: f64,
    columns: Vec<Amounts>,
    /// Multiply scattered light (second order and above), in any direction, for a sun of irradiance
    /// 1.
    many: Vec<Spectrum>,
}

/// Sizes of the tables.
const COLUMN_HEIGHTS: usize = 48;
const COLUMN_COSINES: usize = 128;
const MANY_HEIGHTS: usize = 24;
const MANY_COSINES: usize = 48;
/// The least cosine of the sun's zenith angle in the table: 35 degrees below the horizon, even the
/// highest air is in the earth's shadow.
const LEAST_COSINE: f64 = -0.574;

const COLUMN_STEPS: usize = 64;
const MANY_STEPS: usize = 16;
const VIEW_STEPS: usize = 32;

/// A point above the ground and a direction.
#[derive(Clone, Copy)]
struct Ray {
    /// Distance from the earth's centre.
    r: f64,
    /// Cosine of the direction against the zenith.
    mu: f64,
}

impl Ray {
    fn distance_to(self, radius: f64, far: bool) -> f64 {
        let root = (radius * radius - self.r * self.r * (1.0 - self.mu * self.mu)).max(0.0).sqrt();
        (-self.r * self.mu + if far { root } else { -root }).max(0.0)
    }

    fn meets_ground(self) -> bool {
        self.mu < 0.0 && self.r * self.r * (1.0 - self.mu * self.mu) <= GROUND_KM * GROUND_KM
    }

    /// The distance at which the ray leaves the air or meets the ground.
    fn length(self) -> f64 {
        if self.meets_ground() {
            self.distance_to(GROUND_KM, false)
        } else {
            self.distance_to(TOP_KM, true)
        }
    }

    /// The distance from the earth's centre after following the ray for a length.
    fn radius_after(self, t: f64) -> f64 {
        (t * t + 2.0 * self.r * self.mu * t + self.r * self.r).sqrt()
    }
}

fn densities(r: f64) -> Amounts {
    let height = (r - GROUND_KM).max(0.0);
    [
        (-height / MOLECULES_KM).exp(),
        (-height / AEROSOL_KM).exp(),
        (1.0 - (height - OZONE_MIDDLE_KM).abs() / OZONE_HALF_KM).max(0.0),
    ]
}

/// Divides a path into steps, shorter at its beginning, where the air is densest and detail is
/// nearest. Returns their middles and lengths.
fn steps(length: f64, count: usize) -> impl Iterator<Item = (f64, f64)> {
    let edge = move |i: usize| length * (i as f64 / count as f64).powi(2);
    (0..count).map(move |i| (0.5 * (edge(i) + edge(i + 1)), edge(i + 1) - edge(i)))
}

impl Atmosphere {
    pub(super) fn new(turbidity: f64, ground_albedo: f64) -> Self {
        // Optical depth of the molecules: Bodhaine et al. 1999, "On Rayleigh optical depth
        // calculations", equation 30.
        let molecules = by_wavelength(|um| {
            let squared = um * um;
            let depth = 0.002_152 * (1.045_599_6 - 341.290_61 / squared - 0.902_308_5 * squared)
                / (1.0 + 0.002_705_988_9 / squared - 85.968_563 * squared);
            depth / MOLECULES_KM
        });
        // Angström's formula for aerosol, and its link to turbidity: Preetham, Shirley and Smits
        // 1999, "A practical analytic model for daylight", appendix A.1.
        let beta = (0.046_08 * turbidity - 0.045_86).max(0.0);
        let aerosol = by_wavelength(|um| beta * um.powf(-1.3) / AEROSOL_KM);
        let ozone = ozone_cross_section().map(|section| section * OZONE_COLUMN / OZONE_HALF_KM);
        let mut air = Self {
            molecules,
            aerosol,
            ozone,
            ground_albedo,
            columns: Vec::new(),
            many: Vec::new(),
        };
        air.fill_columns();
        air.fill_many();
        air
    }

    /// The share of light that a column transmits.
    fn transmitted(&self, column: &Amounts) -> Spectrum {
        std::array::from_fn(|band| (-self.optical_depth(band, column)).exp())
    }

    fn optical_depth(&self, band: usize, column: &Amounts) -> f64 {
        self.molecules[band] * column[0]
            + self.aerosol[band] * column[1]
            + self.ozone[band] * column[2]
    }

    // The table of columns is parametrized by the distances to the horizon and to the end of the
    // air: Bruneton and Neyret 2008, "Precomputed atmospheric scattering", section 4.
    fn fill_columns(&mut self) {
        let horizon = (TOP_KM * TOP_KM - GROUND_KM * GROUND_KM).sqrt();
        for i in 0..COLUMN_HEIGHTS {
            let rho = horizon * i as f64 / (COLUMN_HEIGHTS - 1) as f64;
            let r = (rho * rho + GROUND_KM * GROUND_KM).sqrt();
            for j in 0..COLUMN_COSINES {
                let (nearest, farthest) = (TOP_KM - r, rho + horizon);
                let share = j as f64 / (COLUMN_COSINES - 1) as f64;
                let d = nearest + share * (farthest - nearest);
                let mu = if d > 0.0 {
                    ((horizon * horizon - rho * rho - d * d) / (2.0 * r * d)).clamp(-1.0, 1.0)
                } else {
                    1.0
                };
                let ray = Ray { r, mu };
                let mut column = [0.0; 3];
                // Each step is sampled at its middle; the path ends at the top of the atmosphere,
                // never below.
                for (middle, length) in steps(d, COLUMN_STEPS) {
                    let here = densities(ray.radius_after(middle));
                    (0..3).for_each(|i| column[i] += here[i] * length);
                }
                self.columns.push(column);
            }
        }
    }

    /// The column from a point to the end of the air, along a direction that does not meet the
    /// ground.
    fn column(&self, ray: Ray) -> Amounts {
        let horizon = (TOP_KM * TOP_KM - GROUND_KM * GROUND_KM).sqrt();
        let rho = (ray.r * ray.r - GROUND_KM * GROUND_KM).max(0.0).sqrt();
        let d = ray.distance_to(TOP_KM, true);
        let (nearest, farthest) = (TOP_KM - ray.r, rho + horizon);
        let share = (d - nearest) / (farthest - nearest).max(1e-9);
        bilinear(&self.columns, COLUMN_COSINES, rho / horizon, share, |sum, item, weight| {
            (0..3).for_each(|i| sum[i] += weight * item[i]);
        })
    }

    /// The share of sunlight that reaches a height: the transmittance of the air, times the share
    /// of the sun's disc above the horizon. `mu` is the cosine of the sun's zenith angle.
    pub(super) fn sunlight(&self, height_km: f64, mu: f64) -> Spectrum {
        self.sunlight_at(GROUND_KM + height_km.max(0.0), mu)
    }

    fn sunlight_at(&self, r: f64, mu: f64) -> Spectrum {
        let sine = (GROUND_KM / r).min(1.0);
        let horizon = -(1.0 - sine * sine).max(0.0).sqrt();
        let reach = sine * SUN_RADIUS_RAD;
        let visible = ((mu - horizon + reach) / (2.0 * reach)).clamp(0.0, 1.0);
        if visible <= 0.0 {
            return [0.0; BANDS];
        }
        let column = self.column(Ray { r, mu: mu.max(horizon) });
        self.transmitted(&column).map(|share| share * visible * visible * (3.0 - 2.0 * visible))
    }

    /// The multiply scattered light (second order and above) at a point, in any direction.
    fn many_at(&self, r: f64, mu: f64) -> Spectrum {
        let height = ((r - GROUND_KM) / (TOP_KM - GROUND_KM)).clamp(0.0, 1.0).sqrt();
        let share = ((mu - LEAST_COSINE) / (1.0 - LEAST_COSINE)).clamp(0.0, 1.0);
        bilinear(&self.many, MANY_COSINES, height, share, |sum, item, weight| {
            (0..BANDS).for_each(|band| sum[band] += weight * item[band]);
        })
    }

    fn fill_many(&mut self) {
        let mut many = Vec::with_capacity(MANY_HEIGHTS * MANY_COSINES);
        for i in 0..MANY_HEIGHTS {
            let share = i as f64 / (MANY_HEIGHTS - 1) as f64;
            let r = GROUND_KM + share * share * (TOP_KM - GROUND_KM);
            for j in 0..MANY_COSINES {
                let share = j as f64 / (MANY_COSINES - 1) as f64;
                many.push(self.many_from(r, LEAST_COSINE + share * (1.0 - LEAST_COSINE)));
            }
        }
        self.many = many;
    }

    /// Hillaire 2020, equations 5 to 10: the light of second order, and the ratio of each order to
    /// the previous one, both as means over all directions.
    fn many_from(&self, r: f64, sun: f64) -> Spectrum {
        const POLAR: usize = 12;
        const AZIMUTHS: usize = 4;
        let sun_sine = (1.0 - sun * sun).max(0.0).sqrt();
        let mut second = [0.0; BANDS];
        let mut passed_on = [0.0; BANDS];
        // Equal steps of the cosine are equal solid angles; the sky is symmetric about the sun.
        for i in 0..POLAR {
            let mu = -1.0 + 2.0 * (i as f64 + 0.5) / POLAR as f64;
            let sine = (1.0 - mu * mu).sqrt();
            for j in 0..AZIMUTHS {
                let azimuth = PI * (j as f64 + 0.5) / AZIMUTHS as f64;
                let to_sun = mu * sun + sine * sun_sine * azimuth.cos();
                let marched = self.march(Ray { r, mu }, sun, to_sun, MANY_STEPS, None);
                let weight = 1.0 / (POLAR * AZIMUTHS) as f64;
                for band in 0..BANDS {
                    second[band] += weight * marched.radiance[band];
                    passed_on[band] += weight * marched.scattered[band];
                }
            }
        }
        std::array::from_fn(|band| second[band] / (1.0 - passed_on[band]).max(1e-6))
    }

    /// Radiance that reaches the ground from a direction at a zenith angle of cosine `mu`, for a
    /// sun of irradiance 1 outside of the air; `sun` is the cosine of the sun's zenith angle,
    /// `to_sun` of the angle between sun and direction.
    pub(super) fn radiance(&self, mu: f64, sun: f64, to_sun: f64) -> Spectrum {
        // A metre above the ground: the horizon is then below the lowest row of any map.
        let ray = Ray { r: GROUND_KM + 0.001, mu };
        let phases = [
            // The phase functions of Rayleigh, and of Cornette and Shanks (1992).
            3.0 / (16.0 * PI) * (1.0 + to_sun * to_sun),
            cornette_shanks(to_sun),
        ];
        self.march(ray, sun, to_sun, VIEW_STEPS, Some(phases)).radiance
    }

    /// Integrates along a ray. With `phases`, the shares of the sun's light that molecules and
    /// aerosol scatter towards the eye, higher orders are added. Without `phases`, scattering is
    /// isotropic, and the ray sees the ground.
    fn march(
        &self,
        ray: Ray,
        sun: f64,
        to_sun: f64,
        count: usize,
        phases: Option<[f64; 2]>,
    ) -> Marched {
        let length = ray.length();
        let mut left = [1.0; BANDS];
        let mut marched = Marched { radiance: [0.0; BANDS], scattered: [0.0; BANDS] };
        let isotropic = 1.0 / (4.0 * PI);
        let [molecules, aerosol] = phases.unwrap_or([isotropic; 2]);
        for (middle, step) in steps(length, count) {
            let r = ray.radius_after(middle);
            let sun_here = ((ray.r * sun + middle * to_sun) / r).clamp(-1.0, 1.0);
            let here = densities(r);
            let sunlight = self.sunlight_at(r, sun_here);
            let many = phases.map(|_| self.many_at(r, sun_here));
            for band in 0..BANDS {
                let by_molecules = self.molecules[band] * here[0];
                let by_aerosol = AEROSOL_ALBEDO * self.aerosol[band] * here[1];
                let both = by_molecules + by_aerosol;
                let extinction = self.optical_depth(band, &here);
                let mut source = (by_molecules * molecules + by_aerosol * aerosol) * sunlight[band];
                if let Some(many) = &many {
                    source += both * many[band];
                }
                // The integral over the step of a source that is constant along it: Hillaire 2015,
                // "Physically based and unified volumetric rendering in Frostbite", slide 28.
                let passed = (-extinction * step).exp();
                let reach = left[band] * (1.0 - passed) / extinction.max(1e-12);
                marched.radiance[band] += reach * source;
                marched.scattered[band] += reach * both;
                left[band] *= passed;
            }
        }
        if phases.is_none() && ray.meets_ground() {
            let sun_there = (ray.r * sun + length * to_sun) / GROUND_KM;
            let sunlight = self.sunlight_at(GROUND_KM, sun_there.clamp(-1.0, 1.0));
            for band in 0..BANDS {
                let reflected = self.ground_albedo / PI * sun_there.max(0.0) * sunlight[band];
                marched.radiance[band] += left[band] * reflected;
            }
        }
        marched
    }
}

/// The integrals along a ray.
struct Marched {
    radiance: Spectrum,
    /// The radiance that a uniform radiance of 1 scatters into the ray.
    scattered: Spectrum,
}

/// Cornette and Shanks 1992, "Physically reasonable analytic expression for the single-scattering
/// phase function", equation 8.
fn cornette_shanks(cosine: f64) -> f64 {
    let g = AEROSOL_ASYMMETRY;
    let base = 1.0 + g * g - 2.0 * g * cosine;
    3.0 / (8.0 * PI) * (1.0 - g * g) * (1.0 + cosine * cosine) / ((2.0 + g * g) * base.powf(1.5))
}

/// Bilinear lookup in a table of rows, at coordinates from 0 to 1 along its height and along a row.
fn bilinear<const N: usize>(
    table: &[[f64; N]],
    row_length: usize,
    row: f64,
    column: f64,
    add: impl Fn(&mut [f64; N], &[f64; N], f64),
) -> [f64; N] {
    let rows = table.len() / row_length;
    let split = |share: f64, count: usize| {
        let place = share.clamp(0.0, 1.0) * (count - 1) as f64;
        let first = (place as usize).min(count - 2);
        (first, place - first as f64)
    };
    let ((i, up), (j, along)) = (split(row, rows), split(column, row_length));
    let mut sum = [0.0; N];
    for (di, wi) in [(0, 1.0 - up), (1, up)] {
        for (dj, wj) in [(0, 1.0 - along), (1, along)] {
            add(&mut sum, &table[(i + di) * row_length + j + dj], wi * wj);
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phase_functions_integrate_to_one() {
        let steps = 20_000;
        let integral = |phase: fn(f64) -> f64| -> f64 {
            (0..steps)
                .map(|i| phase(-1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(steps)))
                .sum::<f64>()
                * 4.0
                * PI
                / f64::from(steps)
        };
        assert!((integral(cornette_shanks) - 1.0).abs() < 1e-4);
        assert!((integral(|c| 3.0 / (16.0 * PI) * (1.0 + c * c)) - 1.0).abs() < 1e-4);
    }

    /// Straight up, columns are the scale heights; along the horizon, Chapman's function gives the
    /// square root of pi/2 r H for an exponential (Chapman 1931).
    #[test]
    fn optical_depths_match_closed_forms() {
        let air = Atmosphere::new(1.0, 0.0);
        let up = air.column(Ray { r: GROUND_KM, mu: 1.0 });
        assert!((up[0] / MOLECULES_KM - 1.0).abs() < 5e-3, "{up:?}");
        assert!((up[1] / AEROSOL_KM - 1.0).abs() < 2e-2, "{up:?}");
        assert!((up[2] / OZONE_HALF_KM - 1.0).abs() < 1e-2, "{up:?}");
        let along = air.column(Ray { r: GROUND_KM, mu: 0.0 });
        let chapman = (0.5 * PI * GROUND_KM * MOLECULES_KM).sqrt();
        assert!((along[0] / chapman - 1.0).abs() < 2e-2, "{along:?} {chapman}");
    }
}
