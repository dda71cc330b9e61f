//! What an app sets: the component on a camera, and the mark of things that are left out.

use bevy::camera::Hdr;
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass, MotionVectorPrepass};
use bevy::prelude::*;
use lumivox::{CascadeOptions, Preset, TraceSettings};

/// Global illumination for a camera: every value may change at run time.
///
/// It replaces the camera's ambient light and environment map, which light closed rooms, by light that finds its way: theirs
/// from outside the voxels, that of all lamps and suns, and that of emissive surfaces, with all bounces. Direct light and its
/// shadows stay Bevy's.
///
/// The camera renders deferred (Bevy's [`DeferredPrepass`]) without multisampling, unless the plugin is
/// [`LumivoxPlugin::forward`](crate::LumivoxPlugin::forward); take TAA, SMAA or FXAA for smooth edges.
/// Cameras of the same [`volume`](Self::volume) share its voxels.
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
    /// Noise and sharpness against cost of the cones on screen and in the voxels.
    pub quality: GiQuality,
    /// Where the voxels are, and how fine. Another one is made in the background, and replaces the former when it is ready.
    pub volume: GiVolume,
    /// The most sides of voxels that gather light in a frame; fewer take turns, so that light that changes needs more frames
    /// to settle. 0: all in each frame. Default: 16 384.
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

/// Quality against cost. All obey the same physics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum GiQuality {
    /// Six cones for one pixel of four, coarse: a frame by itself, with its noise.
    Fast,
    /// As `Fast`, with the light of earlier frames carried along: smooth, and what changes is seen at once.
    #[default]
    Realtime,
    /// Six finer cones for every pixel, without memory: for stills that accumulate, and for comparison.
    Balanced,
    /// Twelve cones for every pixel: the least noise and error, at some six times the cost of `Fast`.
    High,
}

/// Where the voxels are.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
pub enum GiVolume {
    /// A box around all meshes, made again when they have outgrown it.
    Scene {
        /// Voxels along its longest edge, a multiple of 8 from 8 to 512; default 128.
        resolution: u32,
    },
    /// A box of the app's own; light outside is Bevy's ambient light.
    Box {
        /// Its corner of least coordinates, m.
        min: Vec3,
        /// Its corner of greatest coordinates, m.
        max: Vec3,
        /// Voxels along its longest edge, a multiple of 8 from 8 to 512.
        resolution: u32,
    },
    /// Nested boxes around the camera, each twice as wide as the one inside: for worlds. They move with the camera.
    Cascades {
        /// How many, 1 to 8.
        count: u32,
        /// Voxels along an edge of each, 32 to 128.
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

/// The entity lends no light to the voxels and keeps none off, as if it were not there: for gizmos, first-person hands, or
/// very many small things. Bevy draws it as ever, lit by all the others.
#[derive(Component, Clone, Copy, Debug, Default, Reflect)]
#[reflect(Component, Default, Debug, Clone)]
pub struct NotInGi;

/// Gives a camera the G-buffer that its cones start from, by an observer: a camera requires multisampling before the component
/// could require that there is none.
/// A prepass of normals is not among it: with one, Bevy 0.20 shades transparent things with the normals of what is behind them.
pub(crate) fn draw_gbuffer(added: On<Add<LumivoxGi>>, mut commands: Commands) {
    let gbuffer = (DepthPrepass, MotionVectorPrepass, DeferredPrepass);
    commands.entity(added.entity).insert_if_new((Hdr, gbuffer)).insert(Msaa::Off);
}

/// Opaque materials are drawn deferred, for cameras without global illumination as well: others would not see them.
pub(crate) fn draw_deferred(added: On<Add<Camera3d>>, mut commands: Commands) {
    commands.entity(added.entity).insert_if_new((DepthPrepass, DeferredPrepass)).insert(Msaa::Off);
}

impl LumivoxGi {
    /// What the cones of it are traced with.
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
