//! Everything that can be set about the cones, in one type: units, ranges, and neutral defaults.

use crate::GiError;

/// How much is spent on the cones. All presets but the last obey the same physics; they differ in noise and
/// sharpness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// 6 diffuse cones at half resolution, voxels of half the cone's diameter.
    Fast,
    /// 6 diffuse cones at full resolution, voxels of an eighth of the cone's diameter.
    #[default]
    Balanced,
    /// 12 diffuse cones at full resolution, voxels of a sixteenth of the cone's diameter.
    High,
    /// The tuning of the sparse voxel octree report, for comparison (docs/report-look.md): it is not physical.
    /// Isotropic voxels and photons belong to it, which are settings of [`crate::GiConfig`].
    Report,
}

/// The share of the picture's pixels that cones are traced for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TraceResolution {
    /// Every pixel.
    #[default]
    Full,
    /// One pixel of each 2x2 block, another one every frame; the rest by depth- and normal-aware upsampling.
    Half,
}

impl TraceResolution {
    /// Pixels along each axis that one traced pixel stands for.
    pub(crate) fn scale(self) -> u32 {
        match self {
            Self::Full => 1,
            Self::Half => 2,
        }
    }
}

/// Parameters of the cones. `TraceSettings::default()` is [`Preset::Balanced`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceSettings {
    /// Diffuse cones a point and frame: 6, 9 or 12. More: less noise and bias, proportional cost.
    pub diffuse_cones: u32,
    /// Edge of the sampled voxels as a share of the cone's diameter, 0.05 to 1. Finer: sharper
    /// indirect light from more samples. What it does to the error is in ARCHITECTURE.md.
    pub voxel_per_diameter: f32,
    /// Growth of the sampled voxels, per metre travelled and per cosine against the normal, at most: the
    /// footprint keeps clear of the plane that the cone starts from. 0 (off) or 0.1 to 1; default 1/3.
    pub clearance: f32,
    /// Where cones start: distance above the surface along its normal, in voxels, 0 to 4; default 0.5.
    /// Where walls are felt that must not be, cones start farther by themselves. Higher, and they pass over near
    /// detail; lower, and oblique surfaces darken themselves.
    pub normal_offset_voxels: f32,
    /// Distance between samples as a share of the sampled voxel's edge, 0.25 to 1; default 1. Opacity is
    /// corrected for it, so that it changes cost and noise, not brightness.
    pub step_per_voxel: f32,
    /// Cones end when less than this share of light would still pass, 0 to 0.25; default 0.15. What is left is
    /// taken to look like what was met. Lower: light of a bright sky leaks into closed rooms. Higher: what shines
    /// through dark glass and dense leaves is lost. At oblique walls cones go on until the wall is over.
    pub min_transmittance: f32,
    /// Whether glossy cones are traced.
    pub specular: bool,
    /// Width of a glossy cone: the share of the lobe's solid angle that one frame's cone takes, 0.02 to 1;
    /// default 0.25. Frames draw different directions of the lobe, so that their mean is the whole lobe.
    pub specular_share: f32,
    /// Reach of ambient occlusion, m; infinite by default: what a cone has not met by then does not occlude.
    /// It changes the occlusion alone, never the light.
    pub occlusion_distance_m: f32,
    /// Full or half resolution.
    pub resolution: TraceResolution,
    /// Whether cones draw their directions at random, in each frame others. Default: yes. Without, a fixed set of
    /// cones stands in the middle of the cells: less noise, but bands, and the mean over frames brings little.
    pub jitter: bool,
    /// Whether cones start farther where a wall is felt at their start. Default: yes. Without, the constant offset
    /// alone counts, and light leaks along walls.
    pub clear_of_walls: bool,
    /// What a sample's radiance loses for the cone's width there, as a share for each longest side of the grid, 0 to
    /// 64. 0, the default, is the physics: radiance does not change with distance. Higher: darker, most of all
    /// what wide cones see from afar.
    pub width_attenuation: f32,
    /// What a sample's radiance is multiplied by for each level above the finest, 1 to 8. 1, the default, is the
    /// physics. Higher: brighter where coarse levels are read, up to what they would give if they were full.
    pub level_gain: f32,
}

impl Default for TraceSettings {
    fn default() -> Self {
        Self::preset(Preset::default())
    }
}

impl TraceSettings {
    /// The settings of a preset.
    pub fn preset(preset: Preset) -> Self {
        let balanced = Self {
            diffuse_cones: 6,
            voxel_per_diameter: 0.125,
            clearance: 1.0 / 3.0,
            normal_offset_voxels: 0.5,
            step_per_voxel: 1.0,
            min_transmittance: 0.15,
            specular: true,
            specular_share: 0.25,
            occlusion_distance_m: f32::INFINITY,
            resolution: TraceResolution::Full,
            jitter: true,
            clear_of_walls: true,
            width_attenuation: 0.0,
            level_gain: 1.0,
        };
        match preset {
            Preset::Fast => Self {
                voxel_per_diameter: 0.5,
                clearance: 0.5,
                resolution: TraceResolution::Half,
                ..balanced
            },
            Preset::Balanced => balanced,
            Preset::High => {
                Self { diffuse_cones: 12, voxel_per_diameter: 0.0625, clearance: 0.0, ..balanced }
            }
            Preset::Report => Self {
                voxel_per_diameter: 1.0,
                clearance: 0.0,
                normal_offset_voxels: 1.0,
                specular_share: 1.0,
                jitter: false,
                clear_of_walls: false,
                width_attenuation: 1.0,
                level_gain: 8.0,
                ..balanced
            },
        }
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// [`GiError::Setting`], naming the first one that is out of range.
    pub fn validate(&self) -> Result<(), GiError> {
        let check = |name, value: f32, low: f32, high: f32| {
            if value.is_nan() || value < low || value > high {
                let expected = format!("from {low} to {high}");
                return Err(GiError::Setting { name, value: value.to_string(), expected });
            }
            Ok(())
        };
        if ![6, 9, 12].contains(&self.diffuse_cones) {
            return Err(GiError::Setting {
                name: "diffuse cones",
                value: self.diffuse_cones.to_string(),
                expected: "6, 9 or 12".to_owned(),
            });
        }
        check("voxel per diameter", self.voxel_per_diameter, 0.05, 1.0)?;
        if self.clearance != 0.0 {
            check("clearance", self.clearance, 0.1, 1.0)?;
        }
        check("normal offset", self.normal_offset_voxels, 0.0, 4.0)?;
        check("step per voxel", self.step_per_voxel, 0.25, 1.0)?;
        check("least transmittance", self.min_transmittance, 0.0, 0.25)?;
        check("specular share", self.specular_share, 0.02, 1.0)?;
        check("width attenuation", self.width_attenuation, 0.0, 64.0)?;
        check("level gain", self.level_gain, 1.0, 8.0)?;
        check("occlusion distance", self.occlusion_distance_m, 0.0, f32::INFINITY)
    }
}
