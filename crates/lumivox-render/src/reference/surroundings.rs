//! The panorama for rays: radiance with cumulative probabilities.

use std::f64::consts::PI;

use lumivox::{Panorama, PanoramaWithPeaks};
use lumivox_scene::EnvironmentMap;

use super::records::{MOST_PEAKS, PeakRecord};
use crate::RenderError;
use crate::picture::tone_map::luminance;

/// The surroundings of a scene.
#[derive(Clone, Debug)]
pub(super) struct Surroundings {
    pub(super) size: [u32; 2],
    /// Radiance of each texel; in a, the cumulative probability within its row.
    pub(super) texels: Vec<[f32; 4]>,
    /// The cumulative probability of each row.
    pub(super) rows: Vec<f32>,
    pub(super) peaks: Vec<PeakRecord>,
}

impl Surroundings {
    /// Constant radiance in all directions.
    pub(super) fn even() -> Self {
        Self { size: [1, 1], texels: vec![[1.0; 4]], rows: vec![1.0], peaks: Vec::new() }
    }

    /// A panorama, sampled in proportion to solid angle times luminance.
    pub(super) fn of_map(map: &EnvironmentMap) -> Result<Self, RenderError> {
        let panorama = Panorama { width: map.width, height: map.height, rgb: &map.rgb };
        let PanoramaWithPeaks { width, height, rgb, peaks } = panorama.with_peaks()?;
        let mut texels = Vec::with_capacity(rgb.len());
        let mut row_sums = Vec::with_capacity(height as usize);
        let mut sum = 0.0;
        for (row, columns) in rgb.chunks_exact(width as usize).enumerate() {
            let cosine = |edge: usize| (PI * edge as f64 / f64::from(height)).cos();
            let solid_angle = cosine(row) - cosine(row + 1);
            let luminances: Vec<f64> = columns.iter().map(|rgb| luminance(*rgb)).collect();
            let whole: f64 = luminances.iter().sum();
            let mut cumulated = 0.0;
            for (rgb, luminance) in columns.iter().zip(luminances) {
                cumulated += luminance;
                let share = if whole > 0.0 { cumulated / whole } else { 1.0 };
                texels.push([rgb[0], rgb[1], rgb[2], share as f32]);
            }
            sum += whole * solid_angle;
            row_sums.push(sum);
        }
        let share = |row: f64| if sum > 0.0 { (row / sum) as f32 } else { 1.0 };
        let peaks = peaks.iter().take(MOST_PEAKS).map(|peak| PeakRecord {
            direction: peak.cap_direction.to_array(),
            cos_cap: peak.cap_rad.cos(),
            around: peak.around.to_array(),
            padding: 0.0,
        });
        Ok(Self {
            size: [width, height],
            texels,
            rows: row_sums.into_iter().map(share).collect(),
            peaks: peaks.collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_are_sampled_in_proportion_to_brightness() {
        let mut map = EnvironmentMap { width: 4, height: 2, ..EnvironmentMap::default() };
        map.rgb = vec![[1.0; 3]; 8];
        map.rgb[1] = [3.0; 3];
        let made = Surroundings::of_map(&map).expect("a panorama");
        let shares: Vec<f32> = made.texels[..4].iter().map(|texel| texel[3]).collect();
        assert_eq!(shares, [1.0 / 6.0, 4.0 / 6.0, 5.0 / 6.0, 1.0]);
        assert_eq!(made.rows, [0.6, 1.0]);
        map.rgb = vec![[0.0; 3]; 8];
        let dark = Surroundings::of_map(&map).expect("a panorama");
        assert_eq!(dark.rows, [1.0, 1.0]);
    }
}
