//! The ways of the literature that settings can name, by their names on the command line: nothing else of this crate
//! knows `lumivox-classics`. `None` is Lumivox's own way.

use std::sync::Arc;

use lumivox::hooks::{Injection, Voxelization};
use lumivox::settings::Choice;
use lumivox_classics::photons::{self, photons};
use lumivox_classics::raster::Raster;
pub use lumivox_classics::report::ReportCones;

use crate::RenderSettings;

/// How the light of lamps comes into the voxels, as [`lumivox::GiConfig::injection`] takes it.
pub type InjectionChoice = Option<Arc<dyn Injection>>;

/// How triangles become voxels, as [`lumivox::GiConfig::voxelizer`] takes it.
pub type VoxelizerChoice = Option<Arc<dyn Voxelization>>;

/// The ways from triangles to voxels.
pub const VOXELIZERS: &[Choice] = &[
    Choice::new("exact", "every voxel that is touched, with the surface in it"),
    Choice::new(
        Raster::DominantAxis.name(),
        "rasterized along the normal's largest axis: has gaps",
    ),
    Choice::new(Raster::Conservative.name(), "the same, every pixel touched: some voxels too many"),
    Choice::new(Raster::ThreePlane.name(), "rasterized along all three axes: fewer gaps"),
];

/// The name of a way from triangles to voxels.
pub fn voxelizer_name(voxelizer: &VoxelizerChoice) -> &'static str {
    voxelizer.as_ref().map_or(VOXELIZERS[0].name, |voxelizer| voxelizer.name())
}

/// The way of a name; Lumivox's own if there is none of that name.
pub fn voxelizer(name: &str) -> VoxelizerChoice {
    let raster = Raster::ALL.into_iter().find(|raster| raster.name() == name)?;
    Some(Arc::new(raster))
}

/// The ways for light into the voxels.
pub const INJECTIONS: &[Choice] = &[
    Choice::new("direct", "each face of a voxel asks each light"),
    Choice::new(photons::NAME, "each texel of a shadow map carries its share of the light's flux"),
];

/// The name of a way for light into the voxels.
pub fn injection_name(injection: &InjectionChoice) -> &'static str {
    injection.as_ref().map_or(INJECTIONS[0].name, |injection| injection.name())
}

/// The way of a name; Lumivox's own if there is none of that name.
pub fn injection(name: &str) -> InjectionChoice {
    (name == photons::NAME).then(photons)
}

/// Whether light comes from the texels of shadow maps, which then must be fine enough.
pub(crate) fn is_by_photons(settings: &RenderSettings) -> bool {
    injection_name(&settings.injection) == photons::NAME
}
