//! The ways of the literature that settings can name, by their names on the command line: nothing else of this crate
//! knows `lumivox-classics`. `None` is Lumivox's own way.

use std::sync::Arc;

use lumivox::hooks::{Injection, Voxelization};
use lumivox_classics::photons::{self, photons};
use lumivox_classics::raster::Raster;

use crate::RenderSettings;

/// How the light of lamps comes into the voxels, as [`lumivox::GiConfig::injection`] takes it.
pub type InjectionChoice = Option<Arc<dyn Injection>>;

/// How triangles become voxels, as [`lumivox::GiConfig::voxelizer`] takes it.
pub type VoxelizerChoice = Option<Arc<dyn Voxelization>>;

/// The names of the ways from triangles to voxels.
pub const VOXELIZERS: [&str; 4] =
    ["exact", Raster::DominantAxis.name(), Raster::Conservative.name(), Raster::ThreePlane.name()];

/// The name of a way from triangles to voxels.
pub fn voxelizer_name(voxelizer: &VoxelizerChoice) -> &'static str {
    voxelizer.as_ref().map_or(VOXELIZERS[0], |voxelizer| voxelizer.name())
}

/// The way of a name; Lumivox's own if there is none of that name.
pub fn voxelizer(name: &str) -> VoxelizerChoice {
    let raster = Raster::ALL.into_iter().find(|raster| raster.name() == name)?;
    Some(Arc::new(raster))
}

/// The names of the ways for light into the voxels.
pub const INJECTIONS: [&str; 2] = ["direct", photons::NAME];

/// The name of a way for light into the voxels.
pub fn injection_name(injection: &InjectionChoice) -> &'static str {
    injection.as_ref().map_or(INJECTIONS[0], |injection| injection.name())
}

/// The way of a name; Lumivox's own if there is none of that name.
pub fn injection(name: &str) -> InjectionChoice {
    (name == photons::NAME).then(photons)
}

/// Whether light comes from the texels of shadow maps, which then must be fine enough.
pub(crate) fn is_by_photons(settings: &RenderSettings) -> bool {
    injection_name(&settings.injection) == photons::NAME
}
