//! The settings and presets of `lumivox-classics` and `lumivox-vxct`. Nothing else in this crate
//! depends on them.
//!
//! Each value is a hook of the library or the renderer; `None` is Lumivox's own method.

use std::sync::Arc;

use lumivox::hooks::{Injection, OctreeBuilding, Voxelization};
use lumivox::{Directionality, VolumeKind};
use lumivox_classics::locks::{self, locks};
use lumivox_classics::photons::{self, photons};
use lumivox_classics::raster::Raster;
use lumivox_classics::report::ReportCones;
use lumivox_render::{AddedPreset, Companions, PHYSICAL, PresetChoice, RenderSettings};

use super::{Choice, Group, Kind, Parameter, Redoes, Setting, Value};

type Row = Setting<RenderSettings>;

/// The tuning of the sparse voxel octree report.
pub(super) const REPORT: PresetChoice = PresetChoice::Added(&AddedPreset {
    name: "report",
    summary: "the SVO report's tuning, which is not physical, with an isotropic octree, photons and one bounce",
    trace: ReportCones::trace_settings,
    look: |_| None,
    // The picture shows photons that were reflected once.
    companions: |usual| Companions {
        directionality: Directionality::Isotropic,
        volume: VolumeKind::Octree,
        injection: Some(photons()),
        cone_model: ReportCones::REPORT.model(),
        bounces: 1,
        ..usual
    },
});

/// The rows in the table's order, each with the renderer's row that it precedes. A row without one
/// ends its group or, if the table does not have that group, the table.
pub(super) fn rows() -> Vec<(Parameter, Option<&'static str>)> {
    let mut rows = vec![
        (Parameter::own(Group::Volume, OCTREE_BUILDER), Some("cascades")),
        (Parameter::own(Group::Volume, VOXELIZER), None),
        (Parameter::own(Group::Light, INJECTION), Some("bounces")),
    ];
    rows.extend(ReportCones::SETTINGS.map(|row| (of_report(row), None)));
    rows.push((Parameter::own(lumivox_vxct::GROUP, LOOK), None));
    rows.extend(lumivox_vxct::parameters().map(|row| (row, None)));
    rows
}

/// How an octree's nodes are made.
const OCTREE_BUILDER: Row = Row {
    name: "octree_builder",
    summary: "How an octree's nodes are made; selects an octree",
    kind: Kind::Choice(&[
        Choice::new(RANKS, "numbered by ranks in bit masks"),
        Choice::new(locks::NAME, "threads descend together and split nodes under locks"),
    ]),
    needs: Some(("volume", "octree")),
    redoes: Redoes::Voxels,
    get: |s| Value::Choice(s.octree_builder.as_ref().map_or(RANKS, |builder| builder.name())),
    set: |s, v| {
        s.octree_builder = octree_builder(v.name());
        s.volume = VolumeKind::Octree;
    },
    ..Row::ROW
};

const RANKS: &str = "ranks";

fn octree_builder(name: &str) -> Option<Arc<dyn OctreeBuilding>> {
    (name == locks::NAME).then(locks)
}

/// How triangles become voxels.
const VOXELIZER: Row = Row {
    name: "voxelizer",
    summary: "How triangles become voxels",
    help: "All but the exact way use the GPU's rasterizer, and are there to be compared with it.",
    kind: Kind::Choice(&[
        Choice::new(EXACT, "every voxel that is touched, with the surface in it"),
        Choice::new(
            Raster::DominantAxis.name(),
            "rasterized along the normal's largest axis: has gaps",
        ),
        Choice::new(
            Raster::Conservative.name(),
            "the same, every pixel touched: some voxels too many",
        ),
        Choice::new(Raster::ThreePlane.name(), "rasterized along all three axes: fewer gaps"),
    ]),
    redoes: Redoes::Voxels,
    get: |s| Value::Choice(s.voxelizer.as_ref().map_or(EXACT, |voxelizer| voxelizer.name())),
    set: |s, v| s.voxelizer = voxelizer(v.name()),
    ..Row::ROW
};

const EXACT: &str = "exact";

fn voxelizer(name: &str) -> Option<Arc<dyn Voxelization>> {
    let raster = Raster::ALL.into_iter().find(|raster| raster.name() == name)?;
    Some(Arc::new(raster))
}

/// How light is injected into the voxels.
const INJECTION: Row = Row {
    name: "injection",
    summary: "How light comes into the voxels",
    help: "Both ways give the same light in the mean. Photons scatter with the texels that a voxel is seen by, and \
           follow shadows within a voxel. Lights without shadow maps are injected directly.",
    kind: Kind::Choice(&[
        Choice::new(DIRECT, "each face of a voxel asks each light"),
        Choice::new(
            photons::NAME,
            "each texel of a shadow map carries its share of the light's flux",
        ),
    ]),
    redoes: Redoes::Voxels,
    get: |s| Value::Choice(s.injection.as_ref().map_or(DIRECT, |injection| injection.name())),
    set: |s, v| s.injection = injection(v.name()),
    ..Row::ROW
};

const DIRECT: &str = "direct";

fn injection(name: &str) -> Option<Arc<dyn Injection>> {
    (name == photons::NAME).then(photons)
}

/// A non-physical setting of the cones.
fn of_report(row: Setting<ReportCones>) -> Parameter {
    let get = |s: &RenderSettings| ReportCones::of(s.cone_model.as_deref());
    Parameter::of_part(Group::Cones, row, get, |s, cones| s.cone_model = cones.model())
}

const LOOK: Row = Row {
    name: "look",
    summary: "How the picture is made; preset vxct also sets what this look needs",
    kind: Kind::Choice(&[
        Choice::new(PHYSICAL, "direct light with shadow maps, and cones that gather radiance"),
        lumivox_vxct::CHOICE,
    ]),
    redoes: Redoes::Frames,
    get: |s| Value::Choice(s.look_name()),
    set: |s, v| {
        s.look = match v {
            Value::Choice(lumivox_vxct::NAME) => Some(Arc::new(lumivox_vxct::settings_of(s))),
            _ => None,
        }
    },
    ..Row::ROW
};
