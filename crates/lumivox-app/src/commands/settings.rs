//! The settings of a rendering: from the command line, and back under its names.

use glam::UVec2;
use lumivox::{Directionality, TraceResolution};
use lumivox_render::{Companions, Look, RenderSettings, classics, vxct_display};
use lumivox_scene::Scene;
use serde::Serialize;

use crate::args::choices::{self, VolumeChoice};
use crate::args::cones::ConeArgs;
use crate::args::number::ExposureChoice;
use crate::cli::{LightArgs, PictureArgs, VoxelArgs};

/// How pictures are exposed: as the command line says, or as the preset does.
pub fn exposure(picture: &PictureArgs, cones: &ConeArgs) -> ExposureChoice {
    picture.exposure.unwrap_or_else(|| Companions::of(cones.preset()).exposure.into())
}

/// Where the look of VXCT shows a scene in physical units, its white and its curve are the scene's, unless the
/// command line says otherwise.
pub fn expose_for_look(settings: &mut RenderSettings, picture: &PictureArgs, scene: &Scene) {
    if settings.look == Look::Physical {
        return;
    }
    let display = vxct_display(scene);
    if picture.exposure.is_none() {
        settings.exposure = display.exposure;
    }
    settings.tone_map = picture.tone_map.unwrap_or(display.tone_map);
}

/// What the arguments ask for of a picture, or of the first one; times are not taken.
pub fn of(
    picture: &PictureArgs,
    voxels: &VoxelArgs,
    light: &LightArgs,
    cones: &ConeArgs,
) -> RenderSettings {
    let companions = Companions::of(cones.preset());
    RenderSettings {
        view: picture.view,
        voxel_level: picture.level,
        overlay: picture.overlay.overlay(),
        exposure: exposure(picture, cones).first(),
        tone_map: picture.tone_map.unwrap_or(companions.tone_map),
        ..still(picture.size, picture.frames, voxels, light, cones)
    }
}

/// A picture of that size; how it is shown is left at the defaults.
pub fn still(
    size: UVec2,
    frames: u32,
    voxels: &VoxelArgs,
    light: &LightArgs,
    cones: &ConeArgs,
) -> RenderSettings {
    let companions = Companions::of(cones.preset());
    RenderSettings {
        size,
        frames,
        resolution: voxels.resolution,
        grid_offset: voxels.grid_offset,
        directionality: voxels.directionality().unwrap_or(companions.directionality),
        volume: voxels.volume(VolumeChoice::of(companions.volume)),
        volume_memory: voxels.volume_memory,
        voxelizer: voxels.voxelizer.clone(),
        injection: light.injection.clone().unwrap_or(companions.injection),
        look: cones.look(voxels.resolution),
        trace: cones.settings(),
        bounces: light.bounces.unwrap_or(companions.bounces),
        shadows: light.shadows,
        shadow_resolution: light.shadow_resolution,
        ..RenderSettings::default()
    }
}

/// The settings under the names of the command line.
#[allow(clippy::struct_excessive_bools)] // Switches of the command line.
#[derive(Clone, Debug, Serialize)]
pub struct SettingsReport {
    pub resolution: u32,
    grid_offset: [f32; 3],
    isotropic: bool,
    look: &'static str,
    volume: &'static str,
    voxelizer: &'static str,
    bounces: u32,
    pub frames: u32,
    pub view: &'static str,
    level: u32,
    wireframe: &'static str,
    wire_voxels: &'static str,
    show_grid: bool,
    hide_surfaces: bool,
    tone_map: &'static str,
    shadows: &'static str,
    shadow_resolution: u32,
    injection: &'static str,
    cones: u32,
    half: bool,
    voxel_per_diameter: f32,
    clearance: f32,
    normal_offset: f32,
    step: f32,
    min_transmittance: f32,
    specular: bool,
    specular_share: f32,
    /// None is unlimited.
    occlusion_distance: Option<f32>,
    jitter: bool,
    clear_of_walls: bool,
    width_attenuation: f32,
    level_gain: f32,
}

impl SettingsReport {
    /// The report on settings.
    pub fn new(settings: &RenderSettings) -> Self {
        let trace = &settings.trace;
        let reach_m = trace.occlusion_distance_m;
        Self {
            resolution: settings.resolution,
            grid_offset: settings.grid_offset.to_array(),
            isotropic: settings.directionality == Directionality::Isotropic,
            look: match settings.look {
                Look::Physical => "physical",
                Look::Vxct(_) => "vxct",
            },
            volume: choices::volume_name(settings.volume),
            voxelizer: classics::voxelizer_name(&settings.voxelizer),
            bounces: settings.bounces,
            frames: settings.frames,
            view: settings.view.name(),
            level: settings.voxel_level,
            wireframe: settings.overlay.wireframe.name(),
            wire_voxels: settings.overlay.wire_voxels.name(),
            show_grid: settings.overlay.grid_box,
            hide_surfaces: settings.overlay.hides_surfaces,
            tone_map: settings.tone_map.name(),
            shadows: choices::shadows_name(settings.shadows),
            shadow_resolution: settings.shadow_resolution,
            injection: classics::injection_name(&settings.injection),
            cones: trace.diffuse_cones,
            half: trace.resolution == TraceResolution::Half,
            voxel_per_diameter: trace.voxel_per_diameter,
            clearance: trace.clearance,
            normal_offset: trace.normal_offset_voxels,
            step: trace.step_per_voxel,
            min_transmittance: trace.min_transmittance,
            specular: trace.specular,
            specular_share: trace.specular_share,
            occlusion_distance: reach_m.is_finite().then_some(reach_m),
            jitter: trace.jitter,
            clear_of_walls: trace.clear_of_walls,
            width_attenuation: trace.width_attenuation,
            level_gain: trace.level_gain,
        }
    }
}
