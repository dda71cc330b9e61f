//! Hook for a caller's own cone model.

use std::any::Any;
use std::fmt::Debug;

use crate::settings::SettingError;

/// A model of cones: their start, their direction, and the share that each sample shows.
///
/// Without a model, cones are rays that hit surfaces exactly. With one, cones of faces and pixels
/// march through the cells of the volume, and find emission instead of emitter sampling.
///
/// Implement it to distribute the cones of a hemisphere differently, for an artistic falloff of
/// light, to study one of Lumivox's methods, or to reproduce published ones. It applies to the
/// bounces in the voxels and to [`crate::Gi::trace`], but not to shadow cones, which only count
/// coverage.
pub trait ConeModel: Any + Debug + Send + Sync {
    /// The name; models with the same name must have the same module.
    fn name(&self) -> &'static str;

    /// The WGSL source of `package::cones::model`, with all functions of Lumivox's own model
    /// (`cones/model.wgsl`). It may import Lumivox's modules, including `package::cones::start` and
    /// `package::cones::hemisphere`.
    fn module(&self) -> &'static str;

    /// The argument `values` of the module's functions. [`crate::Gi::set_cone_values`] changes
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
