//! The environment, which cones see outside the grid: a constant radiance, or a picture.
//!
//! A picture becomes a cube map whose mips are means over their solid angle, computed in f32 on the
//! CPU ([`cube`]). A cone that leaves the grid continues to infinity: it reads the mip whose texels
//! are as wide as a share of the cone (`environment.wgsl`). Cone directions are jittered over the
//! whole hemisphere, so that the mean over frames is the integral over the mips.
//!
//! A few rays rarely hit a sun: it would be noise, and its shadow as wide as a cone. Compact peaks
//! are therefore cut out ([`peaks`]) and become directional lights, with shadow maps and exact
//! highlights; the rest is the *soft* cube. The *sharp* cube contains everything, for the
//! background and for lobes that are narrower than the peaks: mirrors show the sun's disc instead
//! of the highlight of its light.
//!
//! The cubes store half floats, in multiples of a power of two near the picture's mean: from 1 / 16
//! 000 000 of the mean to 65 504 times the mean. Brighter texels are clipped only in the sharp
//! cube, since the sun's energy is in its light.
//!
//! A cube's texels have about the same size in all directions. It is laid out in one 2D texture,
//! with borders for filtering across its edges ([`atlas`]), because not every driver filters cube
//! textures correctly.
//!
//! A cube texture of an engine's sky is converted to the same layout on the GPU ([`cubed`]).

mod atlas;
mod cube;
mod cubed;
mod peaks;
#[cfg(test)]
mod tests;

use crate::gpu::{Texture, TextureView};
use glam::{Mat3, Vec3};
use half::f16;

use crate::{GiError, Light, LightSource, Shadow};
use cube::Cube;
#[cfg(test)]
pub(crate) use cubed::{CubeLevel, CubeLight};
pub use cubed::{CubeUse, EnvironmentCube};

/// Maximum edge of a face of the sharp cube: 9 texels per degree in a face's middle, 74 MiB.
const MAX_SHARP_EDGE: u32 = 1024;
/// Maximum edge of a face of the soft cube, which narrow lobes do not read: 19 MiB.
const MAX_SOFT_EDGE: u32 = 512;
/// Format of the cubes: filterable in WebGPU without a feature.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// A picture of all directions: equirectangular, that is, longitude by latitude.
///
/// The texel in the middle is in the direction -z; from there columns go to the right (+x). Rows go
/// down from +y at the top edge to -y at the bottom edge.
#[derive(Clone, Copy, Debug)]
pub struct Panorama<'a> {
    /// Texels around, 360 degrees.
    pub width: u32,
    /// Texels from top to bottom, 180 degrees.
    pub height: u32,
    /// Radiance of each texel, row by row from the top: finite, at least 0, in any unit.
    pub rgb: &'a [[f32; 3]],
}

/// A compact bright part of a panorama.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// Direction towards the peak, in the panorama's frame; unit length.
    pub direction: Vec3,
    /// Irradiance on a surface that faces the peak, above that of its surroundings.
    pub irradiance: Vec3,
    /// Half the peak's angular diameter, rad.
    pub angular_radius_rad: f32,
    /// The middle of the cap that was cut out; unit length.
    pub cap_direction: Vec3,
    /// Half the angle of that cap, rad.
    pub cap_rad: f32,
    /// Radiance around the cap. In the cap, radiance above this belongs to the peak, per channel.
    pub around: Vec3,
}

/// A panorama, reduced to the maximum size, and its peaks.
#[derive(Clone, Debug, PartialEq)]
pub struct PanoramaWithPeaks {
    /// Texels around.
    pub width: u32,
    /// Texels from top to bottom.
    pub height: u32,
    /// Radiance of each texel, peaks included.
    pub rgb: Vec<[f32; 3]>,
    /// The peaks, brightest first.
    pub peaks: Vec<Peak>,
}

/// A panorama on the GPU, prefiltered for cones.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    /// The whole panorama.
    pub(crate) sharp: TextureView,
    /// The panorama without its peaks.
    pub(crate) soft: TextureView,
    /// Factor for the textures' values.
    pub(crate) unit: f32,
    peaks: Vec<Peak>,
    bytes: u64,
}

/// The light that cones see outside the grid.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnvironmentLight<'a> {
    /// Constant radiance; with a map, the map's factor.
    pub radiance: Vec3,
    /// A picture of the environment, whose peaks become lights.
    pub map: Option<&'a EnvironmentMap>,
    /// Rotation of the map about the y axis, rad, counter-clockwise seen from above.
    pub rotation_rad: f32,
}

impl From<Vec3> for EnvironmentLight<'_> {
    /// Constant radiance without a map.
    fn from(radiance: Vec3) -> Self {
        Self { radiance, ..Self::default() }
    }
}

impl Panorama<'_> {
    /// Finds the peaks that [`EnvironmentMap`] converts to lights, in the panorama at the size of
    /// the map. For renderers that sample the panorama themselves and need the same lights.
    ///
    /// # Errors
    /// As [`EnvironmentMap::new`].
    pub fn with_peaks(self) -> Result<PanoramaWithPeaks, GiError> {
        self.validate()?;
        let reduced = cube::reduced(self, 4 * MAX_SHARP_EDGE);
        let panorama = reduced.as_ref().map_or(self, cube::Image::panorama);
        Ok(PanoramaWithPeaks {
            width: panorama.width,
            height: panorama.height,
            rgb: panorama.rgb.to_vec(),
            peaks: peaks::split(panorama).peaks,
        })
    }

    fn validate(self) -> Result<(), GiError> {
        let texels = u64::from(self.width) * u64::from(self.height);
        if texels == 0 || self.rgb.len() as u64 != texels {
            return Err(GiError::Setting {
                name: "panorama",
                value: format!("{} texels for {} x {}", self.rgb.len(), self.width, self.height),
                expected: "a texel for each, at least one".to_owned(),
            });
        }
        Ok(())
    }
}

impl EnvironmentMap {
    /// Cuts the peaks out of a panorama, and uploads both parts as cubes with mips.
    ///
    /// The work is done on the CPU, and takes a few seconds on one core for 4096 x 2048 texels;
    /// larger panoramas are first reduced to that size.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::Vec3;
    /// # use lumivox::{EnvironmentLight, EnvironmentMap, Gi, GiConfig, Grid, Panorama};
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// // A grey sky with a sun.
    /// let mut rgb = vec![[0.5_f32; 3]; 64 * 32];
    /// rgb[64 * 8 + 20] = [5000.0; 3];
    /// let panorama = Panorama { width: 64, height: 32, rgb: &rgb };
    /// let map = EnvironmentMap::new(&device, &queue, panorama)?;
    /// let (radiance, rotation_rad) = (Vec3::ONE, 0.3);
    /// let environment = EnvironmentLight { radiance, map: Some(&map), rotation_rad };
    /// let lights = gi.bind_lights(&[], environment, None);
    /// assert_eq!(lights.count, 1, "the sun");
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::Setting`] if the panorama has no texels, or their number does not match its size.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        panorama: Panorama<'_>,
    ) -> Result<Self, GiError> {
        panorama.validate()?;
        let reduced = cube::reduced(panorama, 4 * MAX_SHARP_EDGE);
        let panorama = reduced.as_ref().map_or(panorama, cube::Image::panorama);
        let split = peaks::split(panorama);
        let unit = unit_of(panorama);
        // A face is 90 degrees, a quarter of the panorama's width.
        let edge = panorama.width.div_ceil(4).next_power_of_two().clamp(2, MAX_SHARP_EDGE);
        let mut bytes = 0;
        let mut texture = |label, panorama, edge| {
            let texture = upload(device, queue, label, Cube::project(panorama, edge), unit);
            bytes += u64::from(texture.width()) * u64::from(texture.height()) * 8;
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let sharp = texture("environment", panorama, edge);
        let soft = match &split.rest {
            Some(rest) => {
                let edge = edge.min(MAX_SOFT_EDGE);
                texture("environment without its peaks", rest.panorama(), edge)
            }
            None => sharp.clone(),
        };
        Ok(Self { sharp, soft, unit, peaks: split.peaks, bytes })
    }

    /// A white map, for a uniform environment.
    pub(crate) fn white(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let cube = Cube { edge: 2, texels: vec![Vec3::ONE; 24] };
        let texture = upload(device, queue, "no environment map", cube, 1.0);
        let bytes = u64::from(texture.width()) * u64::from(texture.height()) * 8;
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { sharp: view.clone(), soft: view, unit: 1.0, peaks: Vec::new(), bytes }
    }

    /// The peaks, brightest first.
    pub fn peaks(&self) -> &[Peak] {
        &self.peaks
    }

    /// The lights of the peaks, for an [`EnvironmentLight`] with this radiance and rotation, with
    /// cone shadows. [`crate::Gi::bind_lights`] adds them unless you pass such lights yourself, as
    /// with shadow maps.
    pub fn lights(&self, radiance: Vec3, rotation_rad: f32) -> Vec<Light> {
        let turn = Mat3::from_rotation_y(rotation_rad);
        self.peaks
            .iter()
            .map(|peak| {
                let source = LightSource::Environment {
                    direction: -(turn * peak.direction),
                    irradiance: peak.irradiance * radiance,
                    angular_radius_rad: peak.angular_radius_rad,
                };
                Light { source, shadow: Shadow::Cone }
            })
            .collect()
    }

    /// Bytes on the GPU.
    pub fn memory(&self) -> u64 {
        self.bytes
    }
}

/// The power of two closest to the mean of the texels' largest channels.
fn unit_of(panorama: Panorama<'_>) -> f32 {
    let largest = |texel: &[f32; 3]| f64::from(Vec3::from(*texel).max_element());
    let sum: f64 = panorama.rgb.iter().map(largest).sum();
    let mean = sum / panorama.rgb.len() as f64;
    if mean > 0.0 { mean.log2().round().clamp(-100.0, 100.0).exp2() as f32 } else { 1.0 }
}

/// A cube with all its mips.
fn upload(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    cube: Cube,
    unit: f32,
) -> Texture {
    let (size, texels) = atlas::flatten(cube);
    let extent = wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 };
    let texture = Texture::new(
        device,
        &wgpu::TextureDescriptor {
            label: Some(label),
            size: extent,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        },
    );
    let most = Vec3::splat(f16::MAX.to_f32());
    let halves: Vec<[f16; 4]> = texels
        .iter()
        .map(|texel| (*texel / unit).min(most).extend(1.0).to_array().map(f16::from_f32))
        .collect();
    queue.write_texture(
        texture.as_image_copy(),
        bytemuck::cast_slice(&halves),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(size.x * 8),
            rows_per_image: Some(size.y),
        },
        extent,
    );
    texture
}
