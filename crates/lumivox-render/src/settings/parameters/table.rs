//! The rows of the table, except those of the cones.

use lumivox::{
    CascadeOptions, Directionality, MAX_CASCADES, MAX_RESOLUTION, MIN_RESOLUTION, VolumeKind,
};

use super::{Choice, Choices as _, Kind, Redoes, Setting, Value};
use crate::{Exposure, RenderSettings, ShadowMethod, ToneMap, View, Wireframe, Wires};

type Row = Setting<RenderSettings>;

/// Frames, exposure, curve.
pub(super) const PICTURE: &[Row] = &[
    Row {
        name: "frames",
        unit: "frames",
        summary: "Frames to average",
        help: "More: less noise, at proportional cost. Unless it is given, `lumivox render` stops earlier once the noise is below 4 %.",
        // With this many frames, a new one still changes the mean in f32, by a 65 536th.
        kind: Kind::whole(1, 65_536),
        redoes: Redoes::Frames,
        get: |s| Value::Whole(s.frames),
        set: |s, v| s.frames = v.whole(),
        ..Row::ROW
    },
    Row {
        name: "exposure",
        unit: "stops",
        summary: "Radiance in cd/m2 times 2 to this power is shown; auto makes the average a middle grey",
        help: "auto stays within the range of cameras (EV100 -6 to 17) and goes up to 1.5 stops brighter or two darker so that \
               white is nearly white; a warning says if that is not enough. All pictures of a sequence have the \
               median of the exposures of five of them, so that they do not flicker; with auto-each every picture has its \
               own. No effect on OpenEXR.",
        kind: Kind::Number {
            low: -MAX_STOPS,
            high: MAX_STOPS,
            words: &[AUTO, AUTO_EACH],
            off: None,
        },
        get: |s| match s.exposure {
            Exposure::Auto => Value::Word(AUTO),
            Exposure::AutoEach => Value::Word(AUTO_EACH),
            Exposure::Stops(stops) => Value::Number(stops),
        },
        set: |s, v| {
            s.exposure = match v {
                Value::Number(stops) => Exposure::Stops(stops),
                Value::Word(AUTO_EACH) => Exposure::AutoEach,
                _ => Exposure::Auto,
            }
        },
        ..Row::ROW
    },
    Row {
        name: "tone_map",
        summary: "Curve from radiance to the screen's range",
        help: "Only for PNG and the screen; OpenEXR holds radiance.",
        kind: Kind::Choice(ToneMap::CHOICES),
        get: |s| Value::Choice(s.tone_map.choice()),
        set: |s, v| s.tone_map.choose(v),
        ..Row::ROW
    },
];

/// The view.
pub(super) const VIEW: &[Row] = &[
    Row {
        name: "view",
        summary: "What the picture shows",
        help: "Views of light are exposed and tone mapped in PNG and in cd/m2 in OpenEXR. The others are data: the \
               quantity itself.",
        kind: Kind::Choice(View::CHOICES),
        redoes: Redoes::Frames,
        get: |s| Value::Choice(s.view.choice()),
        set: |s, v| s.view.choose(v),
        ..Row::ROW
    },
    Row {
        name: "level",
        summary: "Level of the shown voxels; 0 is the finest",
        help: "For the views lod, voxels, wire-voxels, lit, nodes and bricks and for wire_voxels. Each next level has \
               voxels of twice the edge.",
        kind: Kind::whole(0, MAX_RESOLUTION.ilog2()),
        redoes: Redoes::Frames,
        get: |s| Value::Whole(s.voxel_level),
        set: |s, v| s.voxel_level = v.whole(),
        ..Row::ROW
    },
];

/// The overlay.
pub(super) const OVERLAY: &[Row] = &[
    Row {
        name: "wireframe",
        summary: "Edges of triangles over the picture: only visible ones, or all",
        help: "Overlays are only in PNG and on the screen, not in OpenEXR.",
        kind: Kind::Choice(Wireframe::CHOICES),
        get: |s| Value::Choice(s.overlay.wireframe.choice()),
        set: |s, v| s.overlay.wireframe.choose(v),
        ..Row::ROW
    },
    Row {
        name: "wire_voxels",
        summary: "Voxels as wire cubes over the picture: only visible ones, or all",
        help: "The cubes are those of one level; faces between two voxels are left out.",
        kind: Kind::Choice(Wires::CHOICES),
        get: |s| Value::Choice(s.overlay.wire_voxels.choice()),
        set: |s, v| s.overlay.wire_voxels.choose(v),
        ..Row::ROW
    },
    Row {
        name: "show_grid",
        summary: "The box of the voxel grid",
        help: "It is faint behind surfaces.",
        get: |s| Value::Switch(s.overlay.grid_box),
        set: |s, v| s.overlay.grid_box = v.is_on(),
        ..Row::ROW
    },
    Row {
        name: "hide_surfaces",
        summary: "A plain background instead of the picture under the overlay",
        help: "Surfaces still hide the parts of the overlay behind them.",
        get: |s| Value::Switch(s.overlay.hides_surfaces),
        set: |s, v| s.overlay.hides_surfaces = v.is_on(),
        ..Row::ROW
    },
];

/// Voxels, and where they are stored.
pub(super) const VOLUME: &[Row] = &[
    Row {
        name: "resolution",
        unit: "voxels",
        summary: "Voxels along the longest axis",
        help: "Higher resolves finer detail. Memory and time grow with the square. Views of voxels have cells besides, in a dense \
               volume with the cube (165 MiB at 128 for a cube-shaped scene; `lumivox info` says what fits).",
        kind: Kind::Whole { low: MIN_RESOLUTION, high: MAX_RESOLUTION, multiple: 8 },
        redoes: Redoes::Voxels,
        get: |s| Value::Whole(s.resolution),
        set: |s, v| s.resolution = v.whole(),
        ..Row::ROW
    },
    Row {
        name: "grid_offset",
        unit: "voxels",
        summary: "Shift of the grid against the scene",
        help: "Errors of voxels depend on where walls fall in the grid; measurements try several.",
        kind: Kind::Vector { low: 0.0, below: 1.0 },
        redoes: Redoes::Voxels,
        get: |s| Value::Vector(s.grid_offset),
        set: |s, v| s.grid_offset = v.vector(),
        ..Row::ROW
    },
    Row {
        name: "directionality",
        summary: "A radiance for each of six directions, or one a cell",
        help: "Of the cells that views of voxels show, and that the cones of the preset report and of VXCT march through. One a cell \
               takes a ninth of a dense volume's memory, or half of an octree's; but then thin walls leak there.",
        kind: Kind::Choice(Directionality::CHOICES),
        shorthands: &[
            ("isotropic", Value::Choice("isotropic")),
            ("six_lobes", Value::Choice("six_lobes")),
        ],
        redoes: Redoes::Voxels,
        get: |s| Value::Choice(s.directionality.choice()),
        set: |s, v| s.directionality.choose(v),
        ..Row::ROW
    },
    Row {
        name: "volume",
        summary: "Where cells are stored, or cascades",
        help: "Rays meet faces, so pictures are the same. Dense cells are made for views of voxels alone, and take memory with the \
               cube of the resolution; an octree takes it with the surface. Cascades have fine voxels near the camera and coarse \
               ones far away, for scenes that are much larger than what is seen closely.",
        kind: Kind::Choice(&[
            Choice::new("dense", "3D textures over the whole grid"),
            Choice::new("octree", "nodes and bricks where there is surface"),
            Choice::new(
                "cascades",
                "boxes around the camera, each with voxels twice as large as the one within it",
            ),
        ]),
        redoes: Redoes::Voxels,
        get: |s| {
            Value::Choice(match s.volume {
                VolumeKind::Dense => "dense",
                VolumeKind::Cascades => "cascades",
                VolumeKind::Octree => "octree",
            })
        },
        set: |s, v| {
            s.volume = match v {
                Value::Choice("octree") => VolumeKind::Octree,
                Value::Choice("cascades") => VolumeKind::Cascades,
                _ => VolumeKind::Dense,
            };
            if !matches!(s.volume, VolumeKind::Octree) {
                s.octree_builder = None;
            }
        },
        ..Row::ROW
    },
    Row {
        name: "cascades",
        summary: "Boxes around the camera; selects cascades",
        help: "The outermost one has an edge of cascade_resolution times cascade_voxel times 2^(cascades - 1), and there is no \
               light from voxels beyond it. Each takes 20 MiB with 64 voxels, 160 MiB with 128, if all blocks are used.",
        kind: Kind::whole(1, MAX_CASCADES as u32),
        get: |s| Value::Whole(s.cascades.count),
        set: |s, v| set_cascades(s, |cascades| cascades.count = v.whole()),
        ..OF_CASCADES
    },
    Row {
        name: "cascade_resolution",
        unit: "voxels",
        summary: "Voxels along each axis of a cascade; selects cascades",
        help: "Higher: coarser voxels begin farther from the camera. Memory grows with the cube.",
        kind: Kind::Whole { low: 32, high: 256, multiple: 8 },
        get: |s| Value::Whole(s.cascades.resolution),
        set: |s, v| set_cascades(s, |cascades| cascades.resolution = v.whole()),
        ..OF_CASCADES
    },
    Row {
        name: "cascade_voxel",
        unit: "m",
        summary: "Edge of the voxels of the finest cascade; selects cascades",
        help: "Lower resolves finer detail near the camera, and reaches less far.",
        kind: Kind::number(0.001, 1000.0),
        get: |s| Value::Number(s.cascades.voxel_size_m),
        set: |s, v| {
            let size = v.number().unwrap_or(s.cascades.voxel_size_m);
            set_cascades(s, |cascades| cascades.voxel_size_m = size);
        },
        ..OF_CASCADES
    },
    Row {
        name: "volume_memory",
        unit: "MiB",
        summary: "The most memory of the volume",
        help: "A volume that does not fit is refused before it is allocated, with both numbers.",
        kind: Kind::Number { low: 0.0, high: 1_048_576.0, words: &[UNLIMITED], off: None },
        redoes: Redoes::Voxels,
        get: |s| match s.volume_memory {
            None => Value::Word(UNLIMITED),
            Some(bytes) => Value::Number(bytes as f32 / MIB),
        },
        set: |s, v| s.volume_memory = v.number().map(|mib| (mib * MIB) as u64),
        ..Row::ROW
    },
    Row {
        name: "geometry_budget",
        unit: "MiB",
        summary: "The most memory on the GPU for vertices and indices",
        help: "Of larger scenes what is nearest to the camera is there, and comes and goes with it; nothing of the rest is drawn or \
               voxelized. The scene is uploaded again when it changes.",
        kind: Kind::Number { low: 1.0, high: 1_048_576.0, words: &[UNLIMITED], off: None },
        redoes: Redoes::Voxels,
        get: |s| match s.geometry_budget {
            None => Value::Word(UNLIMITED),
            Some(bytes) => Value::Number(bytes as f32 / MIB),
        },
        set: |s, v| s.geometry_budget = v.number().map(|mib| (mib * MIB) as u64),
        ..Row::ROW
    },
];

/// Light in the voxels, and shadows.
pub(super) const LIGHT: &[Row] = &[
    Row {
        name: "bounces",
        summary: "Bounces of indirect light, including the one at the visible surface",
        help: "0 is only direct light, 1 is light by way of one other surface. N bounces leave out about the share a^N of the light \
               in a room of albedo a. Each costs one more gather in the voxels, once.",
        // With an albedo of 0.9, a 65th bounce would still add 0.01 % of the light.
        kind: Kind::whole(0, 64),
        redoes: Redoes::Light,
        get: |s| Value::Whole(s.bounces),
        set: |s, v| s.bounces = v.whole(),
        ..Row::ROW
    },
    Row {
        name: "shadows",
        summary: "How shadows of lamps and sun are found",
        kind: Kind::Choice(ShadowMethod::CHOICES),
        redoes: Redoes::Light,
        get: |s| Value::Choice(s.shadows.choice()),
        set: |s, v| s.shadows.choose(v),
        ..Row::ROW
    },
    Row {
        name: "shadow_resolution",
        unit: "texels",
        summary: "Edge of a shadow map",
        help: "Higher: sharper shadows that begin nearer to their caster, and photons that scatter less. Four bytes a texel; \
               a point light has six maps, a sun four. The GPU may allow less.",
        kind: Kind::whole(16, 32_768),
        redoes: Redoes::Light,
        get: |s| Value::Whole(s.shadow_resolution),
        set: |s, v| s.shadow_resolution = v.whole(),
        ..Row::ROW
    },
];

/// The word for unlimited memory.
const UNLIMITED: &str = "unlimited";
/// The words for automatic exposure: one for a whole sequence, or one for each picture.
const AUTO: &str = "auto";
const AUTO_EACH: &str = "auto-each";

/// Larger values overflow f32.
pub const MAX_STOPS: f32 = 64.0;

const MIB: f32 = 1_048_576.0;

/// The base row of the cascades' options; setting one selects cascades.
const OF_CASCADES: Row =
    Row { needs: Some(("volume", "cascades")), redoes: Redoes::Voxels, ..Row::ROW };

/// Selects cascades with a changed option.
fn set_cascades(settings: &mut RenderSettings, change: impl FnOnce(&mut CascadeOptions)) {
    change(&mut settings.cascades);
    settings.volume = VolumeKind::Cascades;
    settings.octree_builder = None;
}
