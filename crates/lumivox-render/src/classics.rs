//! Methods of earlier renderers that settings can name. Only this file of the crate knows
//! `lumivox-classics`. `None` is Lumivox's own method.

use std::sync::Arc;

use lumivox::hooks::{Injection, Voxelization};
use lumivox::settings::Choice;
use lumivox_classics::photons::{self, photons};
use lumivox_classics::raster::Raster;
pub use lumivox_classics::report::ReportCones;

use crate::RenderSettings;

/// The method that lights the voxels, as [`lumivox::GiConfig::injection`] takes it.
pub type InjectionChoice = Option<Arc<dyn Injection>>;

/// The method that turns triangles into voxels, as [`lumivox::GiConfig::voxelizer`] takes it.
pub type VoxelizerChoice = Option<Arc<dyn Voxelization>>;

/// The voxelizers.
pub const VOXELIZERS: &[Choice] = &[
    Choice::new("exact", "every voxel that is touched, with the surface in it"),
    Choice::new(
        Raster::DominantAxis.name(),
        "rasterized along the normal's largest axis: has gaps",
    ),
    Choice::new(Raster::Conservative.name(), "the same, every pixel touched: some voxels too many"),
    Choice::new(Raster::ThreePlane.name(), "rasterized along all three axes: fewer gaps"),
];

/// The name of a voxelizer.
pub fn voxelizer_name(voxelizer: &VoxelizerChoice) -> &'static str {
    voxelizer.as_ref().map_or(VOXELIZERS[0].name, |voxelizer| voxelizer.name())
}

/// The voxelizer of a name; Lumivox's own if there is none of that name.
pub fn voxelizer(name: &str) -> VoxelizerChoice {
    let raster = Raster::ALL.into_iter().find(|raster| raster.name() == name)?;
    Some(Arc::new(raster))
}

/// The injections of light into the voxels.
pub const INJECTIONS: &[Choice] = &[
    Choice::new("direct", "each face of a voxel asks each light"),
    Choice::new(photons::NAME, "each texel of a shadow map carries its share of the light's flux"),
];

/// The name of an injection.
pub fn injection_name(injection: &InjectionChoice) -> &'static str {
    injection.as_ref().map_or(INJECTIONS[0].name, |injection| injection.name())
}

/// The injection of a name; Lumivox's own if there is none of that name.
pub fn injection(name: &str) -> InjectionChoice {
    (name == photons::NAME).then(photons)
}

/// Whether light starts from the texels of shadow maps, which must then be fine enough.
pub(crate) fn is_by_photons(settings: &RenderSettings) -> bool {
    injection_name(&settings.injection) == photons::NAME
}
