//! The hook for a caller's own model of cones.

use std::any::Any;
use std::fmt::Debug;

use crate::settings::SettingError;

/// A model of where cones start and point, and how much each of their samples shows.
///
/// Without one, cones are rays that meet surface exactly. With one, they march through the cells of the volume, faces gather by such
/// cones, and emission is found by cones instead of drawn.
///
/// Write one to distribute the cones of a hemisphere in another way, for an artistic falloff of
/// light, to find the effect of one of Lumivox's measures, or to repeat what others have published.
/// It applies to the bounces in the voxels and to [`crate::Gi::trace`]; shadow cones only count
/// coverage, which it does not change.
pub trait ConeModel: Any + Debug + Send + Sync {
    /// The name; models of the same name must have the same module.
    fn name(&self) -> &'static str;

    /// The WGSL source of `package::cones::model`, with all functions of Lumivox's own
    /// (`cones/model.wgsl`). It may import Lumivox's modules, among them `package::cones::start`
    /// and `package::cones::hemisphere`.
    fn module(&self) -> &'static str;

    /// The values that its functions receive as `values`. [`crate::Gi::set_cone_values`] changes
    /// them. Default: zeros.
    fn values(&self) -> [f32; 4] {
        [0.0; 4]
    }

    /// Checks the settings that the values are made of, for callers that check all of theirs.
    /// Default: nothing is wrong.
    ///
    /// # Errors
    /// [`SettingError`] for the first one that is out of range.
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
