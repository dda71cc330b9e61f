//! A clear sky in real units from first principles, and the sunlight that the air transmits.
//!
//! The input is spectra of the sun outside the air, of molecules, aerosol and ozone (`spectrum`,
//! `atmosphere`). The output is luminance in cd/m² and illuminance in lux. The colours result from
//! that: the blue zenith, the white horizon, the red sunset, dusk.
//!
//! Published fits (Preetham et al. 1999; Hosek and Wilkie 2012) end at sunset. A computed sky
//! continues through dusk, and the colour of its sun is consistent with the light scattered into
//! the sky. It takes about half a second on one core.

mod atmosphere;
mod spectrum;

use std::f64::consts::PI;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

use glam::{DVec3, Vec3};

use self::atmosphere::{Atmosphere, SUN_RADIUS_RAD};
use self::spectrum::{Observer, Spectrum, solar};
use crate::{Environment, EnvironmentMap, Light, LightKind, SceneError};

/// The settings of a sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkySettings {
    /// Direction towards the sun, in the world; any length above 0. A sun below the horizon gives
    /// dusk. Below about 18 degrees the sky is black (to a millionth of a lux), since there are no
    /// stars and no moon. Default: 45 degrees high, halfway between -z and +x.
    pub sun_direction: Vec3,
    /// The haze of the air: its optical depth over that of its molecules. 1 (the clearest possible)
    /// to 10 (thick haze); default 2, a clear day. Higher: a paler sky, brighter around the sun,
    /// and a weaker sun.
    pub turbidity: f32,
    /// The share of light that the ground below the horizon reflects, 0 to 1; default 0.2, for
    /// meadows and soil. Snow has 0.8.
    pub ground_albedo: f32,
    /// Texels around the horizon, even, 16 to 4096; half as many from top to bottom. Default: 512.
    /// A clear sky has no finer detail, and the time grows with the square.
    pub width: u32,
}

impl Default for SkySettings {
    fn default() -> Self {
        Self {
            sun_direction: Vec3::new(1.0, 2.0_f32.sqrt(), -1.0),
            turbidity: 2.0,
            ground_albedo: 0.2,
            width: 512,
        }
    }
}

/// A sky and its sun. Daylight is the sum of both; neither includes the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    /// The sky without the sun's disc, and the lit ground below the horizon, cd/m²; use it with a
    /// radiance of 1 and no rotation.
    pub map: EnvironmentMap,
    /// The sun: lux, an angular radius of 0.00465 rad. Its colour is that of the transmitted light,
    /// at luminance 1. `None` if no part of its disc is above the horizon.
    pub sun: Option<Light>,
}

impl Sky {
    /// Name of the sun in a scene's lights.
    pub const SUN: &str = "sun of the sky";

    /// Replaces a scene's environment by the sky, and its directional lights by the sun. Returns
    /// the names of the replaced lights, except for the sun of an earlier sky.
    pub fn surround(self, environment: &mut Environment, lights: &mut Vec<Light>) -> Vec<String> {
        *environment = Arc::new(self.map).into();
        let is_sun = |light: &mut Light| light.kind.is_parallel();
        let replaced = lights.extract_if(.., is_sun).map(|light| light.name);
        let replaced = replaced.filter(|name| name != Self::SUN).collect();
        lights.extend(self.sun.map(|sun| Light { name: Self::SUN.to_owned(), ..sun }));
        replaced
    }
}

/// The weights of linear sRGB in luminance: ITU-R BT.709-6, section 3.2.
const LUMINANCE: DVec3 = DVec3::new(0.2126, 0.7152, 0.0722);

/// The atmosphere of the default settings, which most skies use: computing it takes as long as
/// computing a sky.
static CLEAR: LazyLock<Atmosphere> = LazyLock::new(|| air(&SkySettings::default()));

/// Computes a sky.
///
/// # Errors
/// [`SceneError::OutOfRange`] when a setting is out of its range.
pub fn sky(settings: &SkySettings) -> Result<Sky, SceneError> {
    check(settings)?;
    let SkySettings { sun_direction, width, .. } = *settings;
    let is_clear = *settings == SkySettings { sun_direction, width, ..SkySettings::default() };
    Ok(if is_clear { sky_through(&CLEAR, settings) } else { sky_through(&air(settings), settings) })
}

fn air(settings: &SkySettings) -> Atmosphere {
    Atmosphere::new(settings.turbidity.into(), settings.ground_albedo.into())
}

/// Computes the sky of valid settings from their atmosphere.
fn sky_through(air: &Atmosphere, settings: &SkySettings) -> Sky {
    let to_sun = settings.sun_direction.as_dvec3().normalize();
    let observer = Observer::new();
    let solar = solar();
    let times_sun = |spectrum: Spectrum| -> DVec3 {
        observer.rgb(&std::array::from_fn(|band| spectrum[band] * solar[band]))
    };

    let sun_rgb = times_sun(air.sunlight(0.0, to_sun.y));
    let (width, height) = (settings.width, settings.width / 2);
    let rgb = vec![[0.0; 3]; width as usize * height as usize];
    let name = "sky".to_owned();
    let mut map = EnvironmentMap { name, width, height, rgb, warnings: Vec::new() };

    // The sky is symmetric about the sun: each row is computed for azimuths of half a turn from the
    // sun, finest near it, and texels interpolate between them.
    let azimuths = (width / 4).max(16) as usize;
    let sun_azimuth = to_sun.x.atan2(-to_sun.z);
    let sun_sine = (1.0 - to_sun.y * to_sun.y).max(0.0).sqrt();
    let mut on_ground = sun_rgb * to_sun.y.max(0.0);
    for row in 0..height.div_ceil(2) {
        let polar = (f64::from(row) + 0.5) / f64::from(height) * PI;
        let (sine, mu) = polar.sin_cos();
        let half_turn: Vec<DVec3> = (0..=azimuths)
            .map(|i| {
                let azimuth = PI * (i as f64 / azimuths as f64).powi(2);
                let cosine = mu * to_sun.y + sine * sun_sine * azimuth.cos();
                // The lowest row of an odd height straddles the horizon: it shows the air above.
                times_sun(air.radiance(mu.max(1e-6), to_sun.y, cosine.clamp(-1.0, 1.0)))
            })
            .collect();
        let weight = map.solid_angle_sr(row) * mu.max(0.0);
        for column in 0..width {
            let azimuth = ((f64::from(column) + 0.5) / f64::from(width) - 0.5) * 2.0 * PI;
            let turn = (azimuth - sun_azimuth).rem_euclid(2.0 * PI);
            let place = (turn.min(2.0 * PI - turn) / PI).sqrt() * azimuths as f64;
            let first = (place as usize).min(azimuths - 1);
            let radiance = half_turn[first].lerp(half_turn[first + 1], place - first as f64);
            on_ground += radiance * weight;
            map.rgb[(row * width + column) as usize] = radiance.as_vec3().to_array();
        }
    }
    let ground = on_ground * (f64::from(settings.ground_albedo) / PI);
    let below = (height.div_ceil(2) * width) as usize;
    map.rgb[below..].fill(ground.as_vec3().to_array());
    Sky { map, sun: sun(to_sun, sun_rgb) }
}

fn sun(to_sun: DVec3, rgb: DVec3) -> Option<Light> {
    let illuminance = rgb.dot(LUMINANCE);
    // A dimmer sun is invisible by day and night.
    if illuminance < 1e-6 {
        return None;
    }
    Some(Light {
        name: "sun".to_owned(),
        kind: LightKind::Directional,
        intensity: illuminance as f32,
        angular_radius_rad: SUN_RADIUS_RAD as f32,
        color: (rgb / illuminance).as_vec3(),
        direction: -to_sun.as_vec3(),
        ..Light::default()
    })
}

fn check(settings: &SkySettings) -> Result<(), SceneError> {
    let in_range = |part: &str, value: f32, low: f32, high: f32| {
        if (low..=high).contains(&value) {
            return Ok(());
        }
        Err(out_of_range(part, value.to_string(), format!("from {low} to {high}")))
    };
    in_range("the turbidity", settings.turbidity, 1.0, 10.0)?;
    in_range("the ground's albedo", settings.ground_albedo, 0.0, 1.0)?;
    in_range("the map's width", settings.width as f32, 16.0, 4096.0)?;
    if !settings.width.is_multiple_of(2) {
        let (value, expected) = (settings.width.to_string(), "even".to_owned());
        return Err(out_of_range("the map's width", value, expected));
    }
    let length = settings.sun_direction.as_dvec3().length();
    if !length.is_finite() || length <= 0.0 {
        let (value, expected) = (settings.sun_direction.to_string(), "a direction".to_owned());
        return Err(out_of_range("the sun's direction", value, expected));
    }
    Ok(())
}

fn out_of_range(part: &str, value: String, expected: String) -> SceneError {
    SceneError::OutOfRange { file: PathBuf::from("sky"), part: part.to_owned(), value, expected }
}

#[cfg(test)]
mod tests;
