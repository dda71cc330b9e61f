//! Settings of an app: the component on cameras, and the marker of excluded entities.

use bevy::camera::Hdr;
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass, MotionVectorPrepass};
use bevy::prelude::*;
use lumivox::{CascadeOptions, Preset, TraceSettings};

/// Global illumination for a camera. Every value may change at run time.
///
/// It replaces the camera's ambient light and environment map, which would light closed rooms, by
/// light that walls block: from outside the voxels, from all lamps and suns, and from emissive
/// surfaces, with all bounces. Direct light and its shadows stay Bevy's.
///
/// The camera renders deferred (Bevy's [`DeferredPrepass`]) without multisampling, unless the
/// plugin is [`LumivoxPlugin::forward`](crate::LumivoxPlugin::forward); use TAA, SMAA or FXAA for
/// smooth edges. Cameras with the same [`volume`](Self::volume) share its voxels.
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_lumivox::{GiQuality, GiVolume, LumivoxGi};
/// # fn setup(mut commands: Commands) {
/// commands.spawn((
///     Camera3d::default(),
///     LumivoxGi { quality: GiQuality::High, ..LumivoxGi::default() },
/// ));
/// # }
/// ```
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
pub struct LumivoxGi {
    /// Trades noise and sharpness against the cost of cones, on screen and in the voxels.
    pub quality: GiQuality,
    /// Place and resolution of the voxels. After a change, the new volume is made in the
    /// background, and replaces the old one when it is ready.
    pub volume: GiVolume,
    /// The most voxel faces that gather light in a frame. If there are more, they take turns, and
    /// changed light needs more frames to converge. 0: all faces in each frame. Default: 16 384.
    pub faces_per_frame: u32,
    /// Whether glossy surfaces mirror indirect light. Default: true.
    pub reflections: bool,
}

impl Default for LumivoxGi {
    fn default() -> Self {
        Self {
            quality: GiQuality::default(),
            volume: GiVolume::default(),
            faces_per_frame: 16_384,
            reflections: true,
        }
    }
}

/// Quality against cost, with the same physics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum GiQuality {
    /// Nine cones for one pixel in four, without temporal reuse: noisy.
    Fast,
    /// As `Fast`, and reuses the light of earlier frames: smooth, and changes are seen at once.
    #[default]
    Realtime,
    /// Nine cones for every pixel, without temporal reuse: for stills that accumulate, and for
    /// comparison.
    Balanced,
    /// Twelve cones for every pixel: the least noise and error, at about six times the cost of
    /// `Fast`.
    High,
}

/// The place of the voxels.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum GiVolume {
    /// A box around all meshes, fitted again when they outgrow it or become much smaller.
    Scene {
        /// Voxels along its longest edge, a multiple of 8 from 16 to 1024; default 128.
        resolution: u32,
    },
    /// A fixed box. Light from outside is Bevy's ambient light or environment map.
    Box {
        /// Minimum corner, m.
        min: Vec3,
        /// Maximum corner, m.
        max: Vec3,
        /// Voxels along its longest edge, a multiple of 8 from 16 to 1024.
        resolution: u32,
    },
    /// Nested boxes around the camera, which move with it, each twice as wide as the one inside.
    /// For large worlds.
    Cascades {
        /// Number of boxes, 1 to 16; large ones allow fewer.
        count: u32,
        /// Voxels along an edge of each, a multiple of 8 from 32 to 256.
        resolution: u32,
        /// Edge of the finest voxels, m.
        voxel_size: f32,
    },
}

impl Default for GiVolume {
    fn default() -> Self {
        Self::Scene { resolution: 128 }
    }
}

/// The entity neither adds nor blocks light in the voxels, as if it did not exist: for gizmos,
/// first-person hands, or very many small objects. Bevy still draws it, lit by everything else.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Default, Debug, Clone)]
pub struct NotInGi;

/// Adds the G-buffer that cones start from. It is an observer, since `Camera` would require
/// multisampling before [`LumivoxGi`] could require [`Msaa::Off`]. It adds no normal prepass: with
/// one, Bevy 0.20 shades transparent objects with normals of surfaces behind them.
pub(crate) fn draw_gbuffer(added: On<Add<LumivoxGi>>, mut commands: Commands) {
    let gbuffer = (DepthPrepass, MotionVectorPrepass, DeferredPrepass);
    commands.entity(added.entity).insert_if_new((Hdr, gbuffer)).insert(Msaa::Off);
}

/// Makes every 3D camera render deferred, with or without global illumination: opaque materials are
/// deferred, and other cameras would not show them.
pub(crate) fn draw_deferred(added: On<Add<Camera3d>>, mut commands: Commands) {
    commands.entity(added.entity).insert_if_new((DepthPrepass, DeferredPrepass)).insert(Msaa::Off);
}

impl LumivoxGi {
    /// The settings that its cones are traced with.
    pub(crate) fn trace_settings(&self) -> TraceSettings {
        let preset = match self.quality {
            GiQuality::Fast => Preset::Fast,
            GiQuality::Realtime => Preset::Realtime,
            GiQuality::Balanced => Preset::Balanced,
            GiQuality::High => Preset::High,
        };
        TraceSettings { specular: self.reflections, ..TraceSettings::preset(preset) }
    }

    pub(crate) fn face_budget(&self) -> Option<u32> {
        (self.faces_per_frame > 0).then_some(self.faces_per_frame)
    }
}

impl GiVolume {
    /// The cascades, if it has any.
    pub(crate) fn cascades(&self) -> Option<CascadeOptions> {
        match *self {
            Self::Cascades { count, resolution, voxel_size } => {
                Some(CascadeOptions { count, resolution, voxel_size_m: voxel_size })
            }
            _ => None,
        }
    }
}
