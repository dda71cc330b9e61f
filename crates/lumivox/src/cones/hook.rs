//! Hook for a caller's own cone model.

use std::any::Any;
use std::fmt::Debug;

use crate::settings::SettingError;

/// A model of where cones start and point, and how much each of their samples shows.
///
/// Without a model, cones are rays that hit surfaces exactly. With one, they march through the
/// cells of the volume, faces gather by such cones, and emission is found by cones instead of by
/// emitter sampling.
///
/// Implement it to distribute the cones of a hemisphere differently, for an artistic falloff of
/// light, to study the effect of one of Lumivox's measures, or to reproduce published methods. It
/// applies to the bounces in the voxels and to [`crate::Gi::trace`]. Shadow cones only count
/// coverage, which it does not change.
pub trait ConeModel: Any + Debug + Send + Sync {
    /// The name; models with the same name must have the same module.
    fn name(&self) -> &'static str;

    /// The WGSL source of `package::cones::model`, with all functions of Lumivox's own
    /// (`cones/model.wgsl`). It may import Lumivox's modules, including `package::cones::start` and
    /// `package::cones::hemisphere`.
    fn module(&self) -> &'static str;

    /// The values that its functions receive as `values`. [`crate::Gi::set_cone_values`] changes
    /// them. Default: zeros.
    fn values(&self) -> [f32; 4] {
        [0.0; 4]
    }

    /// Checks the settings behind the values, for callers that validate all settings. Default: no
    /// error.
    ///
    /// # Errors
    /// [`SettingError`] for the first setting that is out of range.
    fn validate(&self) -> Result<(), SettingError> {
        Ok(())
    }
}

/// Models are compared by their names and values.
impl PartialEq for dyn ConeModel {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name() && self.values() == other.values()
    }
}
