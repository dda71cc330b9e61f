//! The noise of a mean of frames; a picture with little noise needs no more frames.

use std::ops::ControlFlow;

use glam::UVec2;
use lumivox_render::{Picture, RenderProgress, Renderer};

/// Noise at which no more frames are needed: the relative error that 95 % of the blocks of a
/// picture stay below.
const ENOUGH: f32 = 0.04;
/// The edge of a block, pixels: viewers see noise over several pixels together.
const BLOCK: usize = 8;
/// Least luminance that block errors are relative to, as a share of the median block's: noise in
/// the dark is invisible.
const DARK: f32 = 0.1;

/// Renders the frames of the settings; fewer if `may_stop` and the noise is low, and only then
/// returns the noise. `None` if `tell` breaks between two frames.
///
/// # Errors
/// When the device fails.
pub fn render(
    renderer: &mut Renderer,
    may_stop: bool,
    tell: &mut dyn FnMut(RenderProgress) -> ControlFlow<()>,
) -> anyhow::Result<Option<(Picture, Option<f32>)>> {
    let (total, size) = (renderer.settings().frames, renderer.settings().size);
    let mut meter = NoiseMeter::default();
    while may_stop && renderer.frame_count() < total / 2 {
        let done = renderer.frame_count();
        if tell(RenderProgress { stage: "render", done, total }).is_break() {
            return Ok(None);
        }
        pollster::block_on(renderer.render_frame())?;
        let frames = renderer.frame_count();
        if frames < 2 || !frames.is_power_of_two() {
            continue;
        }
        let mean = pollster::block_on(renderer.read_mean())?;
        let noise = meter.measure(frames, &mean, size);
        if let Some(noise) = noise.filter(|noise| *noise <= ENOUGH) {
            return Ok(Some((pollster::block_on(renderer.finish())?, Some(noise))));
        }
    }
    Ok(pollster::block_on(renderer.render_until(tell))?.map(|picture| (picture, None)))
}

/// Measures noise by the difference between a mean of frames and the mean of the first half of
/// them: the variance of that difference is the variance of the mean itself.
#[derive(Debug, Default)]
struct NoiseMeter {
    /// The luminance of the last mean, after 2, 4, 8, ... frames; the next mean is compared with
    /// it.
    half: Option<Vec<f32>>,
}

impl NoiseMeter {
    /// The noise of the mean of `frames` frames, which must double at each call; `None` at the
    /// first call and below 4 frames.
    fn measure(&mut self, frames: u32, mean: &[[f32; 4]], size: UVec2) -> Option<f32> {
        // ITU-R BT.709-6, section 3.2.
        let luminance = |&[r, g, b, _]: &[f32; 4]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let mean: Vec<f32> = mean.iter().map(luminance).collect();
        let half = self.half.replace(mean)?;
        let blocks = errors_of_blocks(self.half.as_ref()?, &half, size.x as usize);
        (frames >= 4).then(|| percentile_95(blocks))
    }
}

/// The root mean square of the difference in each block, relative to the luminance of the block.
fn errors_of_blocks(mean: &[f32], half: &[f32], width: usize) -> Vec<f32> {
    let columns = width.div_ceil(BLOCK);
    let rows = (mean.len() / width.max(1)).div_ceil(BLOCK);
    // Sums in each block: count, luminance, squared difference.
    let mut blocks = vec![[0.0_f32; 3]; columns * rows];
    for (pixel, (now, before)) in mean.iter().zip(half).enumerate() {
        let block = &mut blocks[pixel / width / BLOCK * columns + pixel % width / BLOCK];
        let added = [1.0, *now, (now - before) * (now - before)];
        block.iter_mut().zip(added).for_each(|(sum, value)| *sum += value);
    }
    let mut luminances: Vec<f32> = blocks.iter().map(|[count, sum, _]| sum / count).collect();
    luminances.sort_by(f32::total_cmp);
    let least = DARK * luminances.get(luminances.len() / 2).copied().unwrap_or(0.0);
    let error = |[count, sum, squares]: &[f32; 3]| {
        (squares / count).sqrt() / (sum / count).max(least).max(f32::MIN_POSITIVE)
    };
    blocks.iter().map(error).collect()
}

fn percentile_95(mut errors: Vec<f32>) -> f32 {
    errors.sort_by(f32::total_cmp);
    errors
        .get((errors.len() * 95 / 100).min(errors.len().saturating_sub(1)))
        .copied()
        .unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means of frames with independent noise of a standard deviation of 0.3 around one.
    fn means(counts: &[u32], size: UVec2) -> Vec<Vec<[f32; 4]>> {
        let mut state = 7_u32;
        let mut sums = vec![0.0_f32; (size.x * size.y) as usize];
        let mut means = Vec::new();
        for frame in 1..=counts.iter().copied().max().unwrap_or(0) {
            for sum in &mut sums {
                // Linear congruential generator; twelve uniform numbers sum to a nearly normal one.
                let normal: f32 = (0..12)
                    .map(|_| {
                        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                        (state >> 8) as f32 / (1 << 24) as f32
                    })
                    .sum();
                *sum += 1.0 + 0.3 * (normal - 6.0);
            }
            if counts.contains(&frame) {
                let mean = |sum: &f32| [sum / frame as f32; 4];
                means.push(sums.iter().map(mean).collect());
            }
        }
        means
    }

    #[test]
    fn noise_meter_estimates_the_noise_of_the_mean() {
        let size = UVec2::new(67, 45);
        let counts = [2, 4, 8, 16];
        let mut meter = NoiseMeter::default();
        let measured: Vec<Option<f32>> = means(&counts, size)
            .iter()
            .zip(counts)
            .map(|(mean, frames)| meter.measure(frames, mean, size))
            .collect();
        assert_eq!(measured[0], None);
        for (noise, frames) in measured[1..].iter().zip(&counts[1..]) {
            let expected = 0.3 / (*frames as f32).sqrt();
            let noise = noise.expect("noise") / expected;
            // The 95th percentile over blocks of 64 pixels is a little above the root mean square.
            assert!((1.0..1.4).contains(&noise), "{frames} frames: {noise} of {expected}");
        }
    }

    #[test]
    fn black_pictures_have_no_noise() {
        let (size, black) = (UVec2::splat(9), vec![[0.0; 4]; 81]);
        let mut meter = NoiseMeter::default();
        assert_eq!(meter.measure(2, &black, size), None);
        assert_eq!(meter.measure(4, &black, size), Some(0.0));
    }
}
