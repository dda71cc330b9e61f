//! The hook for a caller's own model of cones.

use std::any::Any;
use std::fmt::Debug;

use crate::settings::SettingError;

/// Where cones start and point, and how much each of their samples shows, instead of what the
/// physics asks for.
///
/// Write one to spread the cones of a hemisphere by a distribution of your own, for light that
/// falls off as a style wants it, to see what a single one of Lumivox's measures is worth, or to
/// repeat what others have published. It holds for the bounces in the voxels and for
/// [`crate::Gi::trace`]; the shadows of cones only count what is covered, which it does not change.
pub trait ConeModel: Any + Debug + Send + Sync {
    /// The name; two models of one name have the same module.
    fn name(&self) -> &'static str;

    /// The WGSL source of `package::cones::model`, with all functions of Lumivox's own
    /// (`cones/model.wgsl`). It may import Lumivox's modules, `package::cones::start` and
    /// `package::cones::hemisphere` among them.
    fn module(&self) -> &'static str;

    /// The values that its functions are given as `values`. [`crate::Gi::set_cone_values`] changes
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
