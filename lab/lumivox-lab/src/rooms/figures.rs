//! The figures of one room.

use std::fmt;

use lumivox_render::reference::Reading;
use serde::{Deserialize, Serialize};

use super::random::{Room, SKY_RADIANCE};

/// A room is dark if its truth's mean is below this share of the illuminance outside.
const DARK_SHARE: f64 = 1e-3;
/// A room is always dark if its truth's mean is below this, in lux.
const DARK_LUX: f64 = 1e-6;

/// The errors of one room at one resolution.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct RoomFigures {
    /// The kind and the seed.
    pub name: String,
    pub seed: u32,
    pub kind: String,
    /// The thickness of the walls in metres; 0 for sheets.
    pub wall_m: f32,
    pub is_double_sided: bool,
    /// Whether the room is turned against the grid.
    pub is_turned: bool,
    pub light: String,
    /// `true` if there is a window or another opening.
    pub is_open: bool,
    /// Voxels along the longest axis.
    pub resolution: u32,
    /// Readings of the sensors by cones, lux; `None` if not finite.
    pub cones: Vec<Option<f32>>,
    /// Readings of the sensors by paths, lux.
    pub paths: Vec<f32>,
    /// The sensors' mean by cones divided by that by paths, minus 1, in per cent; `None` in
    /// darkness, or if a reading is not finite.
    pub error_percent: Option<f64>,
    /// The standard error of the mean by paths, in per cent of it; `None` in darkness.
    pub noise_percent: Option<f64>,
    /// The brightest sensor by cones, in per cent of the illuminance outside; `None` if the room is
    /// lit, a reading is not finite, or there is no light outside.
    pub leak_percent: Option<f64>,
    /// The bias of the picture with all bounces, in per cent of its truth's mean; `None` in
    /// darkness, or if a pixel is not finite.
    pub bias_percent: Option<f64>,
    /// The RMSE of this picture, without the truth's noise.
    pub rmse_percent: Option<f64>,
    /// Pixels of this picture that are negative or not finite.
    pub faulty_pixels: usize,
    /// Seconds that cones took, and paths.
    pub cone_seconds: f64,
    pub path_seconds: f64,
}

impl RoomFigures {
    /// The figures of sensors; figures of the picture are still missing.
    pub fn of_sensors(room: &Room, resolution: u32, cones: &[f32], readings: &[Reading]) -> Self {
        let outside_lux = if room.scene.environment.radiance.x > 0.0 {
            std::f64::consts::PI * f64::from(SKY_RADIANCE)
        } else {
            0.0
        };
        let paths: Vec<f32> = readings.iter().map(|reading| reading.value).collect();
        let variance = |reading: &Reading| f64::from(reading.standard_error).powi(2);
        let noise = readings.iter().map(variance).sum::<f64>().sqrt() / readings.len() as f64;
        let mean = |values: &[f32]| {
            values.iter().copied().map(f64::from).sum::<f64>() / values.len() as f64
        };
        let truth = mean(&paths);
        let is_dark = truth < (DARK_SHARE * outside_lux).max(DARK_LUX);
        let is_finite = cones.iter().all(|value| value.is_finite());
        let brightest = f64::from(cones.iter().copied().fold(f32::MIN, f32::max));
        Self {
            name: room.scene.name.clone(),
            seed: room.seed,
            kind: room.kind.name().to_owned(),
            wall_m: room.wall_m,
            is_double_sided: room.is_double_sided,
            is_turned: room.is_turned,
            light: room.light.name().to_owned(),
            is_open: room.is_open,
            resolution,
            cones: cones
                .iter()
                .map(|value| Some(*value).filter(|value| value.is_finite()))
                .collect(),
            paths,
            error_percent: (!is_dark && is_finite).then(|| 100.0 * (mean(cones) / truth - 1.0)),
            noise_percent: (!is_dark).then(|| 100.0 * noise / truth),
            leak_percent: (is_dark && is_finite && outside_lux > 0.0)
                .then(|| 100.0 * brightest / outside_lux),
            bias_percent: None,
            rmse_percent: None,
            faulty_pixels: 0,
            cone_seconds: 0.0,
            path_seconds: 0.0,
        }
    }

    /// Whether the truth is dark.
    pub fn is_dark(&self) -> bool {
        self.noise_percent.is_none()
    }

    /// Whether a reading or a pixel is negative or not finite.
    pub fn is_faulty(&self) -> bool {
        let is_bad = |value: &Option<f32>| value.is_none_or(|value| value < 0.0);
        self.faulty_pixels > 0 || self.cones.iter().any(is_bad)
    }
}

impl fmt::Display for RoomFigures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {} voxels: ", self.name, self.resolution)?;
        let figures = [
            ("error", self.error_percent),
            ("leak", self.leak_percent),
            ("bias", self.bias_percent),
            ("RMSE", self.rmse_percent),
        ];
        for (name, percent) in figures {
            if let Some(percent) = percent {
                write!(f, "{name} {percent:+.1} %, ")?;
            }
        }
        if self.is_faulty() {
            write!(f, "negative or not finite, ")?;
        }
        let opening = if self.is_open { "open" } else { "closed" };
        let sides = if self.is_double_sided { "two-sided" } else { "one-sided" };
        let turn = if self.is_turned { "turned" } else { "along the grid" };
        let wall_cm = 100.0 * self.wall_m;
        write!(f, "{}, {opening}, {wall_cm:.0} cm, {sides}, {turn}; lux", self.light)?;
        for (cones, paths) in self.cones.iter().zip(&self.paths) {
            let cones = cones.map_or("none".to_owned(), |lux| format!("{lux:.1}"));
            write!(f, " {cones}/{paths:.1}")?;
        }
        write!(f, ", {:.1} + {:.1} s", self.cone_seconds, self.path_seconds)
    }
}

#[cfg(test)]
impl RoomFigures {
    /// A room for tests, two-sided with walls of 20 cm.
    pub fn example(kind: &str, error_percent: Option<f64>, leak_percent: Option<f64>) -> Self {
        Self {
            name: format!("{kind}-1"),
            seed: 1,
            kind: kind.to_owned(),
            wall_m: 0.2,
            is_double_sided: true,
            is_turned: false,
            light: "lamp".to_owned(),
            is_open: false,
            resolution: 64,
            cones: vec![Some(70.0)],
            paths: vec![100.0],
            error_percent,
            noise_percent: error_percent.map(|_| 0.5),
            leak_percent,
            bias_percent: Some(-4.0),
            rmse_percent: Some(5.0),
            faulty_pixels: 0,
            cone_seconds: 1.0,
            path_seconds: 2.0,
        }
    }
}
