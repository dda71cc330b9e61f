//! The settings of a rendering: [`RenderSettings`] stores them, [`parameters`] describes each, and
//! [`preset`] has starting points.

pub mod parameters;
pub(crate) mod preset;
mod view;

use std::sync::Arc;

use glam::{UVec2, Vec3};
use lumivox::gpu::Timing;
use lumivox::hooks::{ConeModel, Injection, OctreeBuilding, Voxelization};
use lumivox::{CascadeOptions, Directionality, GiConfig, GiError, Grid, TraceSettings, VolumeKind};
use lumivox_scene::{Bounds, Fineness, Scene, ShadowMapFineness};

use crate::look::{Look, LookChoice};
use crate::passes::overlay::LineRecord;
use crate::passes::{near_shadows, shadow_layers};
use crate::renderer::beside;
use crate::{Overlay, RenderError, Wires};

use parameters::{Choices as _, PARAMETERS};
pub use view::{COST_SCALE_SAMPLES, HISTORY_SCALE_FRAMES, View};

/// The mapping of radiance to brightness.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Exposure {
    /// The geometric mean of the picture's luminance becomes 0.18, a middle grey (Reinhard et al.
    /// 2002, section 3.1). Pixels without a surface and black ones do not count.
    #[default]
    Auto,
    /// Like `Auto`, but each picture of a sequence is metered separately.
    AutoEach,
    /// The tone-mapped value is radiance in cd/m² times 2 to the power of this many stops.
    Stops(f32),
}

/// The curve from exposed radiance to the range of a screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ToneMap {
    /// Khronos PBR Neutral (2024): keeps hue and saturation below white; only compresses and
    /// desaturates highlights.
    #[default]
    Neutral,
    /// Narkowicz's fit (2015) of the ACES film curve: more contrast, highlights shift in hue.
    Aces,
    /// No curve: values above 1 are clipped.
    Linear,
    /// No curve, and no screen encoding: values are the display code from 0 to 1, clamped. For
    /// looks that compute with display values; any other picture comes out too dark.
    Raw,
}

impl ToneMap {
    /// All curves.
    pub const ALL: [Self; 4] = [Self::Neutral, Self::Aces, Self::Linear, Self::Raw];

    /// The curve's name in lower case.
    pub fn name(self) -> &'static str {
        self.choice()
    }

    /// The name of the curve's constant in the shaders; its value is `self as u32`.
    pub(crate) fn constant(self) -> &'static str {
        match self {
            Self::Neutral => "TONE_MAP_NEUTRAL",
            Self::Aces => "TONE_MAP_ACES",
            Self::Linear => "TONE_MAP_LINEAR",
            Self::Raw => "TONE_MAP_RAW",
        }
    }
}

/// The method for shadows of lamps and sun.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ShadowMethod {
    /// Depth maps: sharp, and exact to a texel. Lights that do not fit into the maps use cones.
    #[default]
    Map,
    /// Cones through the voxels, as wide as the source: soft, and as coarse as the voxels.
    Cone,
}

/// The name of the physical passes in lists of looks.
pub const PHYSICAL: &str = "physical";

/// Parameters of a rendering.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// Width and height in pixels, at least 1, at most the device's `max_texture_dimension_2d`.
    /// Default: 640 x 360. Cost and memory (about 130 bytes) are per pixel.
    pub size: UVec2,
    /// Voxels along the scene's longest axis, a multiple of 8 from 16 to 1024. Default: 128. Higher
    /// resolves finer detail and leaks less; memory and time for voxels grow with its square.
    pub resolution: u32,
    /// Shift of the voxel grid in voxels, each at least 0 and below 1. Default: 0. Errors depend on
    /// the positions of walls in the grid, so measurements try several shifts.
    pub grid_offset: Vec3,
    /// The box that the grid is fitted to; the shadow maps cover at least this box. Default:
    /// `None`, that of [`Scene::voxel_bounds`](lumivox_scene::Scene::voxel_bounds). A scene that
    /// moves needs the union over all its poses: a grid that follows a pose would make the light
    /// flicker. Surfaces outside have no voxels.
    pub grid_bounds: Option<Bounds>,
    /// Whether voxels store a radiance for each direction. Default: six lobes.
    pub directionality: Directionality,
    /// The storage of the cells. Default: dense.
    pub volume: VolumeKind,
    /// The size of a clipmap around the camera, for [`VolumeKind::Cascades`]. Default: eight
    /// cascades of 64 voxels, the finest of 0.125 m, which reach 1 km. They follow the camera;
    /// `resolution` and `grid_bounds` are then ignored.
    pub cascades: CascadeOptions,
    /// The method that builds an octree's nodes. Default: `None`, by ranks. A dense volume has no
    /// nodes.
    pub octree_builder: Option<Arc<dyn OctreeBuilding>>,
    /// The most bytes of the volume. Default: `None`, the device's limit.
    pub volume_memory: Option<u64>,
    /// The most bytes of vertices and indices on the GPU. Default: `None`, unlimited. In a larger
    /// scene, the part nearest to the camera is streamed in and out; the rest is neither drawn nor
    /// voxelized ([`Renderer::streamed`](crate::Renderer::streamed)).
    pub geometry_budget: Option<u64>,
    /// The voxelization method. Default: `None`, exact.
    pub voxelizer: Option<Arc<dyn Voxelization>>,
    /// The method that injects the light of lamps and sun into the voxels. Default: `None`, direct
    /// light, face by face.
    pub injection: Option<Arc<dyn Injection>>,
    /// The look of the picture. Default: physical.
    pub look: LookChoice,
    /// The cones.
    pub trace: TraceSettings,
    /// The origin, the direction and the samples of the cones. Default: `None`, physical.
    pub cone_model: Option<Arc<dyn ConeModel>>,
    /// Reflections of indirect light, including the one at the visible surface, 0 to 64: 0 is only
    /// direct light, 1 is light via one other surface. Default: 8, which leaves out a^8 of the
    /// light in a room of albedo a: 0.4 % at one half, 2 % at 0.6. Each costs one gather at the
    /// voxels per relighting.
    pub bounces: u32,
    /// Frames that are averaged, 1 to 65 536. Default: 16. More: smoother edges and less noise, at
    /// proportional cost. A single frame has no anti-aliasing.
    pub frames: u32,
    /// The content of the picture.
    pub view: View,
    /// Other views of surfaces that are averaged over the same frames, for
    /// [`Renderer::read_beside`](crate::Renderer::read_beside); only with [`View::Final`] and
    /// without a look. Default: none. Each takes 52 bytes a pixel.
    pub beside: Vec<View>,
    /// The level of the cells in the views of voxels, [`View::Lod`] and [`Overlay::wire_voxels`]. 0
    /// (the default) is the finest; each next level has cubes of twice the edge.
    pub voxel_level: u32,
    /// The overlay over the picture on the screen. Default: none.
    pub overlay: Overlay,
    /// The exposure. Default: automatic.
    pub exposure: Exposure,
    /// The curve that maps radiance to the screen's range. Default: neutral.
    pub tone_map: ToneMap,
    /// The method for shadows. Default: maps.
    pub shadows: ShadowMethod,
    /// Edge of a shadow map in texels, 16 to the device's `max_texture_dimension_2d`. Default:
    /// 1024. Higher: sharper shadows that begin nearer to their caster; four bytes a texel, six
    /// maps for a point light. Photons need texels of at most half a voxel.
    pub shadow_resolution: u32,
    /// The method for timing stages. Default: off.
    pub timing: Timing,
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            size: UVec2::new(640, 360),
            resolution: 128,
            grid_offset: Vec3::ZERO,
            grid_bounds: None,
            directionality: Directionality::default(),
            volume: VolumeKind::default(),
            cascades: CascadeOptions::default(),
            octree_builder: None,
            volume_memory: None,
            geometry_budget: None,
            voxelizer: None,
            injection: None,
            look: None,
            trace: TraceSettings::default(),
            cone_model: None,
            bounces: 16,
            frames: 16,
            view: View::default(),
            beside: Vec::new(),
            voxel_level: 0,
            overlay: Overlay::default(),
            exposure: Exposure::default(),
            tone_map: ToneMap::default(),
            shadows: ShadowMethod::default(),
            shadow_resolution: 1024,
            timing: Timing::Off,
        }
    }
}

impl RenderSettings {
    /// The grid for these settings: fitted to bounds, or with cascades around the camera.
    ///
    /// # Errors
    /// As [`Grid::fit`] and [`Grid::cascades`].
    pub fn grid(&self, bounds: Bounds, camera: Vec3) -> Result<Grid, GiError> {
        if self.volume == VolumeKind::Cascades {
            return Grid::cascades(camera, &self.cascades, self.grid_offset);
        }
        let bounds = self.grid_bounds.unwrap_or(bounds);
        Grid::fit(bounds.min, bounds.max, self.resolution, self.grid_offset)
    }

    /// The sizes of voxels and of shadow-map texels, to warn if they are coarse for the visible
    /// scene.
    pub fn fineness(&self, scene: &Scene) -> Fineness {
        let grid = self.grid(scene.voxel_bounds(), Vec3::ZERO).ok();
        let boxes = grid.as_ref().map(shadow_layers::fine_boxes).unwrap_or_default();
        let resolution = self.shadow_resolution;
        let shadow_maps = match boxes.first() {
            None => near_shadows::fineness(resolution),
            Some(largest) => ShadowMapFineness {
                resolution,
                squares: boxes.len() as u32,
                step: shadow_layers::STEP,
                reach_m: Some(largest.radius_m()),
            },
        };
        Fineness {
            // Cascades have voxels of several sizes.
            voxel_m: grid.filter(|_| boxes.is_empty()).map(|grid| grid.voxel_size_m),
            shadow_maps: (self.shadows == ShadowMethod::Map).then_some(shadow_maps),
        }
    }

    /// The configuration of the library for these settings.
    pub fn gi_config(&self, grid: Grid) -> GiConfig {
        GiConfig {
            grid,
            directionality: self.directionality,
            volume: self.volume,
            keeps_cells: self.shows_cells(),
            octree_builder: self.octree_builder.clone(),
            memory_budget: self.volume_memory,
            voxelizer: self.voxelizer.clone(),
            injection: self.injection.clone(),
            cones: self.cone_model.clone(),
            ..GiConfig::new(grid)
        }
    }

    /// Whether a picture, an overlay or a look may show the volume's cells.
    pub(crate) fn shows_cells(&self) -> bool {
        let mut views = std::iter::once(&self.view).chain(&self.beside);
        views.any(|view| view.is_of_voxels() || *view == View::Lod)
            || self.overlay.wire_voxels != Wires::Off
            || self.look.is_some()
    }

    /// The number of bounces in the voxels; the view of lit voxels needs none.
    pub(crate) fn voxel_bounces(&self) -> u32 {
        if self.view == View::Lit { 0 } else { self.bounces }
    }

    /// The name of the look; [`PHYSICAL`] if there is none.
    pub fn look_name(&self) -> &'static str {
        self.look.as_ref().map_or(PHYSICAL, |look| look.name())
    }

    /// The look that draws the view; `None` if no look does. With a look the volume needs no light.
    pub(crate) fn shown_look(&self) -> Option<&dyn Look> {
        self.look.as_deref().filter(|look| look.shows(self.view))
    }

    /// The coarsest level of voxels that can be shown with a grid. A look may have more levels at
    /// any resolution; if the grid has fewer, its last level is shown.
    pub fn last_level(&self, grid: &Grid) -> u32 {
        let last = grid.level_count() - 1;
        self.shown_look().map_or(last, |look| last.max(look.last_level()))
    }

    /// Checks every value against its range and the device's limits.
    ///
    /// # Errors
    /// [`RenderError::Setting`] or [`RenderError::Limit`] for the first one that is out of range.
    pub fn validate(&self, limits: &wgpu::Limits) -> Result<(), RenderError> {
        validate_size(self.size, limits)?;
        for parameter in PARAMETERS.iter().filter(|parameter| parameter.means_something(self)) {
            let value = parameter.get(self);
            if !parameter.kind.allows(value) {
                return Err(parameter.error(&value.to_string()).into());
            }
        }
        if let Some(model) = &self.cone_model {
            model.validate()?;
        }
        if let Some(look) = &self.look {
            look.validate()?;
        }
        let most = limits.max_texture_dimension_2d;
        if self.shadow_resolution > most {
            return Err(RenderError::Setting {
                name: "shadow_resolution",
                value: self.shadow_resolution.to_string(),
                expected: format!("at most {most}, this device's max_texture_dimension_2d"),
            });
        }
        if self.view.needs_octree() && !matches!(self.volume, VolumeKind::Octree) {
            return Err(RenderError::Setting {
                name: "view",
                value: self.view.name().to_owned(),
                expected: "a view that the volume has; nodes and bricks are those of an octree \
                           (--volume octree)"
                    .to_owned(),
            });
        }
        let shown = [self.view].into_iter().chain(self.beside.iter().copied());
        if let Some(view) = shown.into_iter().find(|view| view.needs_past())
            && !self.trace.temporal
        {
            return Err(RenderError::Setting {
                name: "view",
                value: view.name().to_owned(),
                expected:
                    "a view of single frames; history and disocclusion are those of the light of \
                           earlier frames (--temporal, or --preset realtime)"
                        .to_owned(),
            });
        }
        if let (VolumeKind::Cascades, Some(injection)) = (self.volume, &self.injection) {
            return Err(RenderError::Setting {
                name: "volume",
                value: format!("cascades, with the injection {}", injection.name()),
                expected: "dense or an octree with such an injection, as the preset report has it"
                    .to_owned(),
            });
        }
        if self.geometry_budget.is_some() && self.look_name() != PHYSICAL {
            return Err(RenderError::Setting {
                name: "geometry_budget",
                value: format!("with the look {}", self.look_name()),
                expected: "unlimited, or with the look physical: others draw all of a scene"
                    .to_owned(),
            });
        }
        beside::validate(self)?;
        validate_lines(self.overlay.lines.len(), limits)
    }
}

fn validate_lines(count: usize, limits: &wgpu::Limits) -> Result<(), RenderError> {
    let needed = count as u64 * size_of::<LineRecord>() as u64;
    // Leave memory for the lines of the grid's box.
    let available = limits.max_storage_buffer_binding_size - (1 << 12);
    if needed <= available {
        return Ok(());
    }
    Err(RenderError::Limit {
        what: format!("an overlay of {count} lines"),
        needed,
        unit: "bytes",
        limit: "max_storage_buffer_binding_size",
        available,
        remedy: format!("draw at most {}", available / size_of::<LineRecord>() as u64),
    })
}

fn validate_size(size: UVec2, limits: &wgpu::Limits) -> Result<(), RenderError> {
    let most = limits.max_texture_dimension_2d;
    if size.min_element() == 0 {
        return Err(RenderError::Setting {
            name: "size",
            value: format!("{}x{}", size.x, size.y),
            expected: format!("at least 1x1 and at most {most}x{most} pixels"),
        });
    }
    if size.max_element() > most {
        return Err(RenderError::Limit {
            what: format!("a picture of {}x{}", size.x, size.y),
            needed: size.max_element().into(),
            unit: "pixels along an edge",
            limit: "max_texture_dimension_2d",
            available: most.into(),
            remedy: format!("ask for at most {most}x{most}"),
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn error_of(settings: &RenderSettings) -> RenderError {
        settings.validate(&wgpu::Limits::default()).expect_err("out of range")
    }

    #[test]
    fn the_defaults_are_valid() {
        RenderSettings::default().validate(&wgpu::Limits::default()).expect("valid");
    }

    #[test]
    fn impossible_sizes_name_the_limit() {
        let nothing = RenderSettings { size: UVec2::ZERO, ..Default::default() };
        assert!(matches!(error_of(&nothing), RenderError::Setting { name: "size", .. }));
        let huge = RenderSettings { size: UVec2::splat(100_000), ..Default::default() };
        let error = error_of(&huge);
        assert!(
            matches!(error, RenderError::Limit { limit: "max_texture_dimension_2d", .. }),
            "{error}"
        );
        assert!(error.to_string().contains("100000x100000"), "{error}");
        assert!(error.to_string().contains("at most 8192x8192"), "{error}");
    }

    #[test]
    fn invalid_settings_are_refused() {
        let cases = [
            RenderSettings { bounces: 65, ..Default::default() },
            RenderSettings { frames: 0, ..Default::default() },
            RenderSettings { shadow_resolution: 8, ..Default::default() },
            RenderSettings { exposure: Exposure::Stops(f32::NAN), ..Default::default() },
            RenderSettings { beside: vec![View::Voxels], ..Default::default() },
            RenderSettings { beside: vec![View::History], ..Default::default() },
            RenderSettings { beside: vec![View::Cost], view: View::Direct, ..Default::default() },
        ];
        for settings in cases {
            assert!(matches!(error_of(&settings), RenderError::Setting { .. }), "{settings:?}");
        }
    }

    #[test]
    fn history_views_require_temporal_settings() {
        for view in [View::History, View::Disocclusion] {
            let alone = RenderSettings { view, ..Default::default() };
            let told = error_of(&alone).to_string();
            assert!(told.contains(view.name()) && told.contains("--temporal"), "{told}");
            let trace = TraceSettings { temporal: true, ..TraceSettings::default() };
            let blended = RenderSettings { trace, ..alone };
            assert!(blended.validate(&wgpu::Limits::default()).is_ok());
        }
    }

    #[test]
    fn more_lines_than_a_buffer_holds_are_refused() {
        let limits = wgpu::Limits::default();
        let most = (limits.max_storage_buffer_binding_size - (1 << 12)) / 48;
        assert!(validate_lines(most as usize, &limits).is_ok());
        let error = validate_lines(most as usize + 1, &limits).expect_err("too many");
        assert!(error.to_string().contains("draw at most 2796"), "{error}");
    }

    #[test]
    fn enum_codes_equal_their_index_in_all() {
        for (index, view) in View::ALL.into_iter().enumerate() {
            assert_eq!(view as usize, index);
        }
        for (index, tone_map) in ToneMap::ALL.into_iter().enumerate() {
            assert_eq!(tone_map as usize, index);
        }
    }
}
