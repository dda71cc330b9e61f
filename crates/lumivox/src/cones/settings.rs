//! Settings of the cones: units, ranges, and neutral defaults.

use crate::GiError;
use crate::settings::{self, Choice, Choices, Kind, Redoes, Setting, Value};

/// Quality and cost of the cones. All presets have the same physics; they differ in noise and
/// sharpness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// 9 diffuse cones at half resolution.
    Fast,
    /// [`Self::Fast`] with light of earlier frames.
    Realtime,
    /// 9 diffuse cones at full resolution.
    #[default]
    Balanced,
    /// 12 diffuse cones at full resolution.
    High,
}

/// The pixels for which cones are traced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TraceResolution {
    /// Every pixel.
    #[default]
    Full,
    /// One pixel of each 2x2 block, a different one in every frame; the rest by depth- and
    /// normal-aware upsampling.
    Half,
}

impl Choices for TraceResolution {
    const VALUES: &'static [Self] = &[Self::Full, Self::Half];
    const CHOICES: &'static [Choice] = &[
        Choice::new("full", "cones from every pixel"),
        Choice::new("half", "cones from one pixel of each 2x2 block"),
    ];
}

impl TraceResolution {
    /// Pixels per traced pixel, along each axis.
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
    /// Diffuse cones of a point in a frame: 6, 9 or 12. Higher values reduce noise and bias; the
    /// cost is proportional.
    pub diffuse_cones: u32,
    /// Width of the samples of an environment map as a share of the cone's diameter, 0.05 to 1.
    /// Lower is sharper and noisier. In marched cones, also the edge of the sampled voxels.
    pub voxel_per_diameter: f32,
    /// In marched cones ([`crate::hooks::ConeModel`]), the maximum growth of the sampled voxels,
    /// per metre and per cosine to the normal, so that they do not reach the plane that the cone
    /// starts from. 0 (off) or 0.1 to 1; default 1/3.
    pub clearance: f32,
    /// In marched cones, the distance of their start above the surface, along its normal, in
    /// voxels, 0 to 4; default 0.5.
    pub normal_offset_voxels: f32,
    /// In marched cones, the distance between samples as a share of the sampled voxel's edge, 0.25
    /// to 1; default 1.
    pub step_per_voxel: f32,
    /// Marched cones end when less than this share of light is left, 0 to 0.25; default 0.15. The
    /// rest is assumed to look like the surfaces so far.
    pub min_transmittance: f32,
    /// `true` to trace glossy cones.
    pub specular: bool,
    /// Width of a glossy cone: the share of the lobe's solid angle that one frame's cone covers,
    /// 0.02 to 1; default 0.25. Frames draw different directions of the lobe, so their mean covers
    /// the whole lobe.
    pub specular_share: f32,
    /// Reach of ambient occlusion, m; infinite by default. Surfaces beyond it do not occlude. It
    /// changes only the occlusion, not the light.
    pub occlusion_distance_m: f32,
    /// Resolution of the trace.
    pub resolution: TraceResolution,
    /// `true` to reuse light of earlier frames, reprojected with its surfaces; off by default. For
    /// moving pictures: each frame then has the noise of many frames' mean.
    pub temporal: bool,
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
            diffuse_cones: 9,
            voxel_per_diameter: 0.125,
            clearance: 1.0 / 3.0,
            normal_offset_voxels: 0.5,
            step_per_voxel: 1.0,
            min_transmittance: 0.15,
            specular: true,
            specular_share: 0.25,
            occlusion_distance_m: f32::INFINITY,
            resolution: TraceResolution::Full,
            temporal: false,
        };
        match preset {
            Preset::Fast => Self {
                voxel_per_diameter: 0.5,
                clearance: 0.5,
                resolution: TraceResolution::Half,
                ..balanced
            },
            Preset::Realtime => Self { temporal: true, ..Self::preset(Preset::Fast) },
            Preset::Balanced => balanced,
            Preset::High => {
                Self { diffuse_cones: 12, voxel_per_diameter: 0.0625, clearance: 0.0, ..balanced }
            }
        }
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// [`GiError::Setting`] for the first value that is out of range.
    pub fn validate(&self) -> Result<(), GiError> {
        settings::check(Self::SETTINGS, self).map_err(GiError::from)
    }

    /// The table of the settings: names, ranges and meaning.
    pub const SETTINGS: &'static [Setting<Self>] = &[
        Setting {
            name: "cones",
            unit: "",
            summary: "Diffuse cones of a pixel in a frame",
            help: "More: less noise and bias, at proportional cost.",
            kind: Kind::Choice(&[
                Choice::new("6", "the cheapest"),
                Choice::new("9", "in between"),
                Choice::new("12", "the least noise"),
            ]),
            get: |s| match s.diffuse_cones {
                6 => Value::Choice("6"),
                9 => Value::Choice("9"),
                12 => Value::Choice("12"),
                other => Value::Whole(other),
            },
            set: |s, v| s.diffuse_cones = v.name().parse().unwrap_or(s.diffuse_cones),
            ..MARCHED
        },
        Setting {
            name: "trace_resolution",
            summary: "Cones from every pixel, or from one of each 2x2 block",
            help: "In each frame another pixel of the block is traced; the rest is filled in by depth and normal. half \
                   is a quarter of the cost, and softer at edges.",
            kind: Kind::Choice(TraceResolution::CHOICES),
            shorthands: &[("half", Value::Choice("half")), ("full", Value::Choice("full"))],
            redoes: Redoes::Targets,
            get: |s| Value::Choice(s.resolution.choice()),
            set: |s, v| s.resolution.choose(v),
            ..CONES
        },
        Setting {
            name: "temporal",
            summary: "Light of earlier frames, carried along with the surfaces that it is on",
            help: "For moving pictures: a frame then has the noise of many. What changes is seen at once, and direct light \
                   never takes this way.",
            shorthands: &[("no_temporal", Value::Switch(false))],
            redoes: Redoes::Targets,
            get: |s| Value::Switch(s.temporal),
            set: |s, v| s.temporal = v.is_on(),
            ..CONES
        },
        Setting {
            name: "voxel_per_diameter",
            unit: "share",
            summary: "Width of samples of the environment as a share of the cone's diameter",
            help: "Finer (lower): sharper, and noisier. Where a cone model marches, the edge of the sampled voxels as well.",
            kind: Kind::number(0.05, 1.0),
            get: |s| Value::Number(s.voxel_per_diameter),
            set: |s, v| s.voxel_per_diameter = number(v),
            ..CONES
        },
        Setting {
            name: "clearance",
            unit: "ratio",
            summary: "Greatest growth of the sampled voxels by metre and cosine; 0 is off",
            help: "Only where a cone model marches, as in the preset report. Keeps cones at grazing angles clear of the surface that they start from. Lower: finer \
                   samples near the surface, at a higher cost.",
            kind: Kind::Number { low: 0.1, high: 1.0, words: &[], off: Some(0.0) },
            get: |s| Value::Number(s.clearance),
            set: |s, v| s.clearance = number(v),
            ..MARCHED
        },
        Setting {
            name: "normal_offset",
            unit: "voxels",
            summary: "Start of the cones above the surface",
            help: "Only where a cone model marches, as in the preset report. Cones move away from walls beside them automatically. Higher passes over near detail, lower makes \
                   oblique surfaces darken themselves.",
            kind: Kind::number(0.0, 4.0),
            get: |s| Value::Number(s.normal_offset_voxels),
            set: |s, v| s.normal_offset_voxels = number(v),
            ..MARCHED
        },
        Setting {
            name: "step",
            unit: "share",
            summary: "Distance between samples as a share of the sampled voxel's edge",
            help: "Only where a cone model marches, as in the preset report. Lower: less noise at a higher cost. The brightness does not depend on it.",
            kind: Kind::number(0.25, 1.0),
            get: |s| Value::Number(s.step_per_voxel),
            set: |s, v| s.step_per_voxel = number(v),
            ..MARCHED
        },
        Setting {
            name: "min_transmittance",
            unit: "share",
            summary: "Share of light below which a cone ends",
            help: "Only where a cone model marches, as in the preset report. The rest of the cone is assumed to look like what it met. With a lower share a bright sky leaks \
                   into closed rooms; with a higher one the light through dark glass is lost.",
            kind: Kind::number(0.0, 0.25),
            get: |s| Value::Number(s.min_transmittance),
            set: |s, v| s.min_transmittance = number(v),
            ..MARCHED
        },
        Setting {
            name: "specular",
            summary: "Glossy reflections of indirect light",
            shorthands: &[("no_specular", Value::Switch(false))],
            redoes: Redoes::Frames,
            get: |s| Value::Switch(s.specular),
            set: |s, v| s.specular = v.is_on(),
            ..CONES
        },
        Setting {
            name: "specular_share",
            unit: "share",
            summary: "Width of a glossy cone as a share of the lobe's solid angle",
            help: "Lower: sharper but noisier reflections. Each frame draws other directions, so their mean is the whole \
                   lobe.",
            kind: Kind::number(0.02, 1.0),
            redoes: Redoes::Frames,
            get: |s| Value::Number(s.specular_share),
            set: |s, v| s.specular_share = number(v),
            ..CONES
        },
        Setting {
            name: "occlusion_distance",
            unit: "m",
            summary: "Reach of ambient occlusion; it never changes the light",
            help: "It only changes the view `occlusion`.",
            kind: Kind::Number { low: 0.0, high: 1e9, words: &[UNLIMITED], off: None },
            redoes: Redoes::Frames,
            get: |s| match s.occlusion_distance_m {
                f32::INFINITY => Value::Word(UNLIMITED),
                reach_m => Value::Number(reach_m),
            },
            set: |s, v| s.occlusion_distance_m = v.number().unwrap_or(f32::INFINITY),
            ..CONES
        },
    ];
}

/// The word for an unlimited reach.
const UNLIMITED: &str = "unlimited";

/// Base of rows whose changes relight the voxels.
const CONES: Setting<TraceSettings> = Setting { redoes: Redoes::Light, ..Setting::ROW };

/// Base of rows whose changes relight the voxels only if cones march.
const MARCHED: Setting<TraceSettings> = Setting { redoes: Redoes::MarchedLight, ..Setting::ROW };

/// The value of a row that only has numbers.
fn number(value: Value) -> f32 {
    value.number().unwrap_or(f32::NAN)
}
