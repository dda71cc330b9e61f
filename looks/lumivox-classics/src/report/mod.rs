//! The cones of the sparse voxel octree report, with the constants that make its look
//! (docs/looks.md).
//!
//! Each departure from the physics is a setting, off by default ([`ReportCones`]). The values are a
//! uniform of the model, so they can change while a picture is shown.

use std::any::Any;
use std::sync::Arc;

use lumivox::TraceSettings;
use lumivox::hooks::ConeModel;
use lumivox::settings::{Kind, Redoes, Setting, SettingError, Value, check};

/// Departures of the report's cones from the physics. The default is the physics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReportCones {
    /// Whether cones draw their directions at random, again in each frame. If not, a fixed set of
    /// cones points at the middle of the cells: less noise, but bands, and the mean over frames
    /// helps little.
    pub jitter: bool,
    /// Whether cones start farther out if there is a wall at their start. If not, only the constant
    /// offset applies, and light leaks along walls.
    pub clear_of_walls: bool,
    /// Share of a sample's radiance that is lost per cone width, in longest sides of the grid, 0 to
    /// 64. 0 is the physics: radiance does not change with distance. Higher: darker, mostly far
    /// samples of wide cones.
    pub width_attenuation: f32,
    /// Factor of a sample's radiance for each level above the finest, 1 to 8. 1 is the physics.
    /// Higher: brighter where coarse levels are read, up to the radiance of full cells.
    pub level_gain: f32,
}

impl Default for ReportCones {
    fn default() -> Self {
        Self { jitter: true, clear_of_walls: true, width_attenuation: 0.0, level_gain: 1.0 }
    }
}

impl ReportCones {
    /// The report's own tuning, which also has isotropic voxels, photons and one bounce.
    pub const REPORT: Self =
        Self { jitter: false, clear_of_walls: false, width_attenuation: 1.0, level_gain: 8.0 };

    /// The cones' other settings for [`Self::REPORT`].
    pub fn trace_settings() -> TraceSettings {
        TraceSettings {
            voxel_per_diameter: 1.0,
            clearance: 0.0,
            diffuse_cones: 6,
            normal_offset_voxels: 1.0,
            specular_share: 1.0,
            ..TraceSettings::default()
        }
    }

    /// The model for [`lumivox::GiConfig::cones`]; `None` for the physics, since Lumivox's own
    /// model is faster.
    pub fn model(self) -> Option<Arc<dyn ConeModel>> {
        (self != Self::default()).then(|| Arc::new(self) as Arc<dyn ConeModel>)
    }

    /// The departures of a model from [`Self::model`]; the default for any other model.
    pub fn of(model: Option<&dyn ConeModel>) -> Self {
        let model = model.map(|model| model as &dyn Any);
        model.and_then(|model| model.downcast_ref()).copied().unwrap_or_default()
    }

    /// The table of the settings: names, ranges and meaning.
    pub const SETTINGS: [Setting<Self>; 4] = [
        Setting {
            name: "jitter",
            summary: "Draw the cones' directions at random, in each frame others",
            help: "Without, a fixed set of cones makes bands in place of noise.",
            get: |s| Value::Switch(s.jitter),
            set: |s, v| s.jitter = v.is_on(),
            ..ROW
        },
        Setting {
            name: "clear_of_walls",
            summary: "Start cones farther where a wall is felt at their start",
            help: "Without, only the offset along the normal counts, and light leaks along walls.",
            get: |s| Value::Switch(s.clear_of_walls),
            set: |s, v| s.clear_of_walls = v.is_on(),
            ..ROW
        },
        Setting {
            name: "width_attenuation",
            summary: "Radiance that is lost for the cone's width; 0 is the physics",
            help: "The share of a sample's radiance that is lost when the cone is as wide as the scene. Higher dims what is \
                   far away.",
            kind: Kind::number(0.0, 64.0),
            get: |s| Value::Number(s.width_attenuation),
            set: |s, v| s.width_attenuation = number(v),
            ..ROW
        },
        Setting {
            name: "level_gain",
            unit: "factor",
            summary: "Radiance that is gained with each level; 1 is the physics",
            help: "A sample's radiance is multiplied by it for each level of its voxel. Higher brightens what is far away, \
                   up to what full voxels would give.",
            kind: Kind::number(1.0, 8.0),
            get: |s| Value::Number(s.level_gain),
            set: |s, v| s.level_gain = number(v),
            ..ROW
        },
    ];
}

/// Defaults of a row: the same cones gather the light of voxels and picture.
const ROW: Setting<ReportCones> = Setting { redoes: Redoes::Light, ..Setting::ROW };

/// The value as a number; NaN if it is of another kind.
fn number(value: Value) -> f32 {
    value.number().unwrap_or(f32::NAN)
}

impl ConeModel for ReportCones {
    fn name(&self) -> &'static str {
        "report"
    }

    fn module(&self) -> &'static str {
        include_str!("model.wgsl")
    }

    fn values(&self) -> [f32; 4] {
        let switch = |on| f32::from(u8::from(on));
        let gain_stops = self.level_gain.log2();
        [self.width_attenuation, gain_stops, switch(self.jitter), switch(self.clear_of_walls)]
    }

    fn validate(&self) -> Result<(), SettingError> {
        check(&Self::SETTINGS, self)
    }
}
