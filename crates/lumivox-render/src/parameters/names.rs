//! Names for the values of the library's types, as on the command line.

use lumivox::{
    Directionality, Duplication, Mipmapping, OctreeBuilder, OctreeOptions, TraceResolution,
    VolumeKind,
};

use crate::{Look, RenderSettings, ShadowMethod, VxctSettings, Wireframe, Wires};

/// A type with a few values, each with a name.
pub(super) trait Named: Copy + PartialEq + 'static {
    const NAMED: &'static [(&'static str, Self)];

    fn name(self) -> &'static str {
        Self::NAMED.iter().find(|(_, value)| *value == self).map_or("", |(name, _)| *name)
    }

    fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(known, _)| *known == name).map(|(_, value)| *value)
    }
}

impl Named for Directionality {
    const NAMED: &'static [(&'static str, Self)] =
        &[("six_lobes", Self::SixLobes), ("isotropic", Self::Isotropic)];
}

impl Named for ShadowMethod {
    const NAMED: &'static [(&'static str, Self)] = &[("map", Self::Map), ("cone", Self::Cone)];
}

impl Named for TraceResolution {
    const NAMED: &'static [(&'static str, Self)] = &[("full", Self::Full), ("half", Self::Half)];
}

impl Named for OctreeBuilder {
    const NAMED: &'static [(&'static str, Self)] =
        &[("ranks", Self::Ranks), ("locks", Self::Locks)];
}

impl Named for Duplication {
    const NAMED: &'static [(&'static str, Self)] =
        &[("ranks", Self::Ranks), ("pointers", Self::Pointers), ("search", Self::Search)];
}

impl Named for Mipmapping {
    const NAMED: &'static [(&'static str, Self)] =
        &[("occupied", Self::Occupied), ("every", Self::Every)];
}

impl Named for Wireframe {
    const NAMED: &'static [(&'static str, Self)] =
        &[("off", Self::Off), ("over", Self::Over), ("through", Self::Through)];
}

impl Named for Wires {
    const NAMED: &'static [(&'static str, Self)] =
        &[("off", Self::Off), ("over", Self::Over), ("through", Self::Through)];
}

/// What VXCT's look is made with, or would be.
pub(super) fn vxct(settings: &RenderSettings) -> VxctSettings {
    match settings.look {
        Look::Vxct(vxct) => vxct,
        Look::Physical => VxctSettings::for_resolution(settings.resolution),
    }
}

/// What an octree is made with, or would be.
pub(super) fn octree(settings: &RenderSettings) -> OctreeOptions {
    match settings.volume {
        VolumeKind::Octree(options) => options,
        VolumeKind::Dense => OctreeOptions::default(),
    }
}
