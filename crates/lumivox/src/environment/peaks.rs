//! Compact bright parts of a panorama, cut out to become lights.
//!
//! A peak is the light above its surroundings within a cap of directions. The cap starts around the
//! brightest texel of the brightest region, half as wide as the wider diffuse cones of the finest
//! preset, and shrinks until it is four times as wide as the circle that contains half of the
//! peak's light. This strips a sun of its glow, which stays in the panorama. The surroundings are
//! the mean of the ring around the cap.
//!
//! A peak is cut out if it is
//!
//! - *compact*: its radius (that of a uniform disc with as much light within the same circle) is at
//!   most a quarter of those cones' half angle. In the map, its shadows would be as soft as the
//!   cone; as a light it has nearly the shadows of a source of its size; and
//! - *strong*: its irradiance on a surface that faces it exceeds that from a cone of average
//!   radiance, pi / 12 times the mean of the rest. A single cone that hits it would then be more
//!   than twice as bright as its neighbours.
//!
//! Both criteria follow from the cones; nothing is tuned to a scene. No light is lost: every
//! channel of each texel is the sum of the rest and the part cut out, and a light's irradiance is
//! the integral of the part cut out times the cosine to the light's direction, so a surface that
//! faces it gets exactly as much as before. Ties are broken by position, and all sums run in a
//! fixed order: the same panorama gives the same lights.

use glam::{DVec3, Vec3};

use super::cube::Image;
use super::{Panorama, Peak};

/// Maximum number of lights: each has a shadow map.
const MAX_PEAKS: usize = 4;
/// Maximum number of regions to try, brightest first.
const MAX_TRIES: usize = 24;
/// Diffuse cones of the finest preset.
const MOST_CONES: f64 = 12.0;
/// Half angle of the wider cones, in the outer ring, rad: acos(1 - sqrt(2/3) / 8), see
/// `cones/hemisphere.wgsl`.
const CONE_RAD: f64 = 0.456;
/// Maximum radius of a cap, rad.
const CAP_RAD: f64 = 0.5 * CONE_RAD;
/// Maximum radius of a compact peak, rad.
const COMPACT_RAD: f64 = 0.25 * CONE_RAD;
/// Maximum number of steps by which a cap shrinks; a step of less than a tenth has converged.
const MAX_STEPS: usize = 24;
/// Number of regions from top to bottom; twice that number around. Each is about as wide as the
/// cap's radius.
const REGION_ROWS: u32 = 16;

/// Luminance of linear RGB: ITU-R BT.709-6, section 3.2.
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// A panorama, split into peaks and the rest.
pub(super) struct Split {
    /// The peaks, brightest first.
    pub(super) peaks: Vec<Peak>,
    /// The rest; `None` if nothing was cut out.
    pub(super) rest: Option<Image>,
}

pub(super) fn split(panorama: Panorama<'_>) -> Split {
    let mut rest =
        Image { width: panorama.width, height: panorama.height, rgb: panorama.rgb.to_vec() };
    let mut peaks: Vec<Peak> = Vec::new();
    let mut regions = Regions::new(panorama);
    for _ in 0..MAX_TRIES {
        let Some((region, center)) = regions.brightest(rest.panorama()) else { break };
        let mean = mean_luminance(rest.panorama());
        let cap_sr = std::f64::consts::TAU * (1.0 - CAP_RAD.cos());
        // No remaining region can contain a strong peak.
        if regions.luminance[region] * cap_sr < threshold(mean) {
            break;
        }
        let found = find(rest.panorama(), center);
        match found.filter(|found| found.is_strong(mean) && found.radius_rad <= COMPACT_RAD) {
            Some(found) => {
                peaks.push(found.cut(&mut rest));
                regions.update(rest.panorama());
                if peaks.len() == MAX_PEAKS {
                    break;
                }
            }
            None => regions.is_done[region] = true,
        }
    }
    let brightness = |peak: &Peak| peak.irradiance.as_dvec3().dot(LUMINANCE);
    peaks.sort_by(|a, b| brightness(b).total_cmp(&brightness(a)));
    Split { rest: (!peaks.is_empty()).then_some(rest), peaks }
}

/// The irradiance from one cone with a radiance.
fn threshold(mean: f64) -> f64 {
    std::f64::consts::PI / MOST_CONES * mean
}

fn luminance(rgb: Vec3) -> f64 {
    rgb.as_dvec3().dot(LUMINANCE)
}

fn mean_luminance(panorama: Panorama<'_>) -> f64 {
    let rows = (0..panorama.height).map(|y| {
        let row: f64 = (0..panorama.width).map(|x| luminance(panorama.at(x, y))).sum();
        row * panorama.solid_angle_sr(y)
    });
    rows.sum::<f64>() / (4.0 * std::f64::consts::PI)
}

/// Blocks of the panorama, to find the brightest.
struct Regions {
    rows: u32,
    columns: u32,
    /// Mean luminance of each region.
    luminance: Vec<f64>,
    /// `true` for each region that was tried without finding a peak.
    is_done: Vec<bool>,
}

impl Regions {
    fn new(panorama: Panorama<'_>) -> Self {
        let rows = REGION_ROWS.min(panorama.height);
        let columns = (2 * REGION_ROWS).min(panorama.width);
        let count = (rows * columns) as usize;
        let mut regions =
            Self { rows, columns, luminance: vec![0.0; count], is_done: vec![false; count] };
        regions.update(panorama);
        regions
    }

    fn of(&self, panorama: Panorama<'_>, x: u32, y: u32) -> usize {
        let scaled =
            |i: u32, count: u32, of: u32| (u64::from(i) * u64::from(count) / u64::from(of)) as u32;
        let row = scaled(y, self.rows, panorama.height);
        (row * self.columns + scaled(x, self.columns, panorama.width)) as usize
    }

    fn update(&mut self, panorama: Panorama<'_>) {
        let mut sums = vec![(0.0, 0.0); self.luminance.len()];
        for y in 0..panorama.height {
            let weight = panorama.solid_angle_sr(y);
            for x in 0..panorama.width {
                let sum = &mut sums[self.of(panorama, x, y)];
                sum.0 += weight * luminance(panorama.at(x, y));
                sum.1 += weight;
            }
        }
        for (luminance, (sum, weight)) in self.luminance.iter_mut().zip(sums) {
            *luminance = sum / f64::max(weight, f64::MIN_POSITIVE);
        }
    }

    /// The brightest region that is not done, and the direction of its brightest texel.
    fn brightest(&self, panorama: Panorama<'_>) -> Option<(usize, DVec3)> {
        let mut best: Option<usize> = None;
        for region in (0..self.luminance.len()).filter(|&region| !self.is_done[region]) {
            if best.is_none_or(|best| self.luminance[region] > self.luminance[best]) {
                best = Some(region);
            }
        }
        let region = best?;
        let (mut most, mut center) = (-1.0, DVec3::Y);
        let span = |index: u32, count: u32, of: u32| {
            let edge = |i: u32| (u64::from(i) * u64::from(of)).div_ceil(u64::from(count)) as u32;
            edge(index)..edge(index + 1)
        };
        let (row, column) = (region as u32 / self.columns, region as u32 % self.columns);
        for y in span(row, self.rows, panorama.height) {
            for x in span(column, self.columns, panorama.width) {
                let here = luminance(panorama.at(x, y));
                if here > most {
                    most = here;
                    center = panorama.direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
                }
            }
        }
        Some((region, center))
    }
}

/// A cap of directions and the radiance around it.
struct Found {
    center: DVec3,
    cap_rad: f64,
    /// Mean of the ring around the cap.
    around: Vec3,
    /// Luminous irradiance of the light above `around`.
    irradiance: f64,
    radius_rad: f64,
}

impl Found {
    fn is_strong(&self, mean: f64) -> bool {
        let rest = mean - self.irradiance / (4.0 * std::f64::consts::PI);
        self.irradiance > 0.0 && self.irradiance > threshold(rest.max(0.0))
    }

    /// Cuts the peak out of the image.
    fn cut(&self, image: &mut Image) -> Peak {
        let texels = within(image.panorama(), self.center, self.cap_rad);
        let mut toward = DVec3::ZERO;
        for texel in &texels {
            let above = (texel.rgb - self.around).max(Vec3::ZERO);
            toward += luminance(above) * texel.solid_angle_sr * texel.direction;
        }
        let direction = toward.normalize_or(self.center);
        let mut irradiance = DVec3::ZERO;
        for texel in texels {
            let stays = texel.rgb.min(self.around);
            let weight = texel.solid_angle_sr * texel.direction.dot(direction);
            irradiance += weight * (texel.rgb - stays).as_dvec3();
            image.rgb[texel.index] = stays.to_array();
        }
        Peak {
            direction: direction.as_vec3(),
            irradiance: irradiance.as_vec3(),
            angular_radius_rad: self.radius_rad as f32,
            cap_direction: self.center.as_vec3(),
            cap_rad: self.cap_rad as f32,
            around: self.around,
        }
    }
}

fn find(panorama: Panorama<'_>, center: DVec3) -> Option<Found> {
    let texel_rad = std::f64::consts::PI / f64::from(panorama.height);
    let mut found =
        Found { center, cap_rad: CAP_RAD, around: Vec3::ZERO, irradiance: 0.0, radius_rad: 0.0 };
    for _ in 0..MAX_STEPS {
        // The ring is half as wide as the cap's radius, but at least two texels.
        let ring_rad = found.cap_rad + (0.5 * found.cap_rad).max(2.0 * texel_rad);
        let (edge, mut ring, mut ring_sr) = (found.cap_rad.cos(), DVec3::ZERO, 0.0);
        let mut inside = Vec::new();
        for texel in within(panorama, found.center, ring_rad) {
            if texel.direction.dot(found.center) >= edge {
                inside.push(texel);
            } else {
                ring += texel.solid_angle_sr * texel.rgb.as_dvec3();
                ring_sr += texel.solid_angle_sr;
            }
        }
        if ring_sr > 0.0 {
            found.around = (ring / ring_sr).as_vec3();
        }
        let mut toward = DVec3::ZERO;
        let mut weighted: Vec<(DVec3, f64, f64)> = Vec::with_capacity(inside.len());
        for texel in inside {
            let above = luminance((texel.rgb - found.around).max(Vec3::ZERO));
            if above > 0.0 {
                let flux = above * texel.solid_angle_sr;
                toward += flux * texel.direction;
                weighted.push((texel.direction, flux, texel.solid_angle_sr));
            }
        }
        let center = toward.try_normalize()?;
        let moved_rad = center.distance(found.center);
        found.center = center;
        found.irradiance = weighted.iter().map(|(_, flux, _)| flux).sum();
        found.radius_rad = radius(found.center, &weighted, found.irradiance);
        // Four times the radius of the circle with half of the light, 2.8 times that of the disc.
        let next = (4.0 * found.radius_rad / 2.0_f64.sqrt()).max(2.5 * texel_rad).min(CAP_RAD);
        // A cap around another center may contain more light, as at the end of a bright tube.
        let has_settled = next > 0.9 * found.cap_rad && moved_rad < 0.1 * found.cap_rad;
        if has_settled {
            return Some(found);
        }
        found.cap_rad = next.min(found.cap_rad);
    }
    None
}

/// The radius of the uniform disc that has half of its light in the same circle, that is, the
/// circle's radius times the square root of two; at least that of one texel.
fn radius(center: DVec3, weighted: &[(DVec3, f64, f64)], irradiance: f64) -> f64 {
    let mut by_angle: Vec<(f64, f64, f64)> = weighted
        .iter()
        // The chord resolves small angles better than the cosine.
        .map(|(direction, flux, sr)| {
            (2.0 * (0.5 * direction.distance(center)).min(1.0).asin(), *flux, *sr)
        })
        .collect();
    by_angle.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    for (angle, flux, sr) in by_angle {
        sum += flux;
        if sum >= 0.5 * irradiance {
            return (angle * 2.0_f64.sqrt()).max((sr / std::f64::consts::PI).sqrt());
        }
    }
    0.0
}

struct Texel {
    index: usize,
    direction: DVec3,
    solid_angle_sr: f64,
    rgb: Vec3,
}

/// The texels whose centers are within an angle of a direction, in order.
fn within(panorama: Panorama<'_>, center: DVec3, angle_rad: f64) -> Vec<Texel> {
    let (width, height) = (panorama.width, panorama.height);
    let per_rad = f64::from(height) / std::f64::consts::PI;
    let polar = center.y.clamp(-1.0, 1.0).acos();
    let first = ((polar - angle_rad) * per_rad).floor().max(0.0) as u32;
    let last = (((polar + angle_rad) * per_rad).ceil() as u32).min(height);
    // All columns around a pole; elsewhere the columns between the cap's tangents.
    let reach = if polar - angle_rad <= 0.0 || polar + angle_rad >= std::f64::consts::PI {
        std::f64::consts::PI
    } else {
        (angle_rad.sin() / polar.sin()).min(1.0).asin()
    };
    let azimuth = center.x.atan2(-center.z);
    let column = |angle: f64| (angle / std::f64::consts::TAU + 0.5) * f64::from(width);
    let left = column(azimuth - reach).floor() as i64;
    let right = (column(azimuth + reach).ceil() as i64).min(left + i64::from(width));
    let mut columns: Vec<u32> =
        (left..right).map(|x| x.rem_euclid(i64::from(width)) as u32).collect();
    columns.sort_unstable();
    let edge = angle_rad.cos();
    let mut texels = Vec::new();
    for y in first..last {
        let solid_angle_sr = panorama.solid_angle_sr(y);
        for &x in &columns {
            let direction = panorama.direction(f64::from(x) + 0.5, f64::from(y) + 0.5);
            if direction.dot(center) >= edge {
                let index = y as usize * width as usize + x as usize;
                texels.push(Texel { index, direction, solid_angle_sr, rgb: panorama.at(x, y) });
            }
        }
    }
    texels
}
