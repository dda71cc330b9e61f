//! Traces cones from the pixels of a camera and adds their light to its picture.

pub(crate) mod compose;
pub(crate) mod gbuffer;
pub(crate) mod views;

use bevy::camera::MainPassResolutionOverride;
use bevy::core_pipeline::prepass::ViewPrepassTextures;
use bevy::prelude::*;
use bevy::render::camera::{ExtractedCamera, TemporalJitter};
use bevy::render::diagnostic::{DiagnosticsRecorder, RecordDiagnostics};
use bevy::render::renderer::{RenderContext, RenderQueue, ViewQuery};
use bevy::render::view::{ExtractedView, ViewTarget};
use lumivox::gpu::{Buffer, Recorder, uniform_buffer};
use lumivox::hooks::Resource as Bound;
use lumivox::{CameraView, GBuffer, GiView, TraceSettings, wgpu};

use crate::report::{LumivoxEvent, Reports};
use crate::screen::compose::{ComposeView, PICTURE_FORMAT};
use crate::screen::views::GiViews;
use crate::volumes::voxels::Voxels;
use crate::volumes::{VolumeKey, Volumes};

/// State of a view that is kept between frames.
#[derive(Component)]
pub(crate) struct Screen {
    key: VolumeKey,
    /// `Voxels::number` that this was made for.
    number: u64,
    view: GiView,
    compose: ComposeView,
    /// The textures that `view` binds.
    bound: [wgpu::Texture; 3],
    /// `Place` of `gbuffer.wgsl`.
    place: Buffer,
    origin: UVec2,
    /// Whether everything is ready in this frame.
    is_ready: bool,
}

/// `Place` of `gbuffer.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Place {
    origin: [u32; 2],
    padding: [u32; 2],
}

/// A camera in this frame.
struct Camera<'a> {
    view: &'a ExtractedView,
    jitter: Option<&'a TemporalJitter>,
    size: UVec2,
    origin: UVec2,
}

impl Camera<'_> {
    /// The camera in Lumivox's form.
    fn to_lumivox(&self) -> CameraView {
        let view_from_world = self.view.world_from_view.to_matrix().inverse();
        let mut clip_from_view = self.view.clip_from_view;
        let pixels = self.jitter.map_or(Vec2::ZERO, |jitter| -jitter.offset);
        if let Some(jitter) = self.jitter.filter(|_| clip_from_view.w_axis.w == 1.0) {
            // Bevy shears orthographic pictures: far surfaces move by more than the jitter.
            jitter.jitter_projection(&mut clip_from_view, self.size.as_vec2());
            let shift = -2.0 * pixels * Vec2::new(1.0, -1.0) / self.size.as_vec2();
            clip_from_view = Mat4::from_translation(shift.extend(0.0)) * clip_from_view;
        }
        let position = self.view.world_from_view.translation();
        let mut camera = CameraView::new(clip_from_view * view_from_world, position);
        camera.jitter = pixels;
        camera
    }
}

/// Creates and binds the resources of all views, once Bevy's textures of this frame exist.
pub(crate) fn prepare_screens(
    mut commands: Commands,
    gi_views: Res<GiViews>,
    volumes: Res<Volumes>,
    mut views: Query<(
        &ExtractedView,
        &ViewTarget,
        Option<&ViewPrepassTextures>,
        Option<&TemporalJitter>,
        Option<&MainPassResolutionOverride>,
        Option<&mut Screen>,
    )>,
    all: Query<Entity, With<Screen>>,
    queue: Res<RenderQueue>,
    reports: Res<Reports>,
) {
    for entity in &all {
        if !gi_views.views.iter().any(|view| view.entity == entity) {
            commands.entity(entity).remove::<Screen>();
        }
    }
    for gi_view in &gi_views.views {
        let Ok((view, target, textures, jitter, size, screen)) = views.get_mut(gi_view.entity)
        else {
            continue;
        };
        let Some(voxels) = volumes.shown(&gi_view.key) else { continue };
        // There are none in forward mode.
        let Some((views, ids)) = textures.and_then(bound_textures) else { continue };
        if target.main_texture_format() != PICTURE_FORMAT {
            let error = "a camera's picture is not Rgba16Float; give the camera `Hdr`, and a render target that is \
                         Rgba16Float or not high dynamic range";
            reports.once(LumivoxEvent::Failed { error: error.to_owned() });
            continue;
        }
        let viewport = view.viewport;
        let camera = Camera {
            view,
            jitter,
            size: size.map_or(UVec2::new(viewport.z, viewport.w), |size| size.0),
            origin: UVec2::new(viewport.x, viewport.y),
        };
        if camera.size.min_element() == 0 {
            continue;
        }
        let settings = gi_view.gi.trace_settings();
        let is_right = |screen: &Screen| {
            screen.number == voxels.number
                && screen.view.resolution() == settings.resolution
                && screen.view.is_temporal() == settings.temporal
                && screen.view.size() == camera.size
        };
        let factor = volumes.unit() * gi_view.exposure;
        match screen {
            Some(mut screen) if is_right(&screen) => {
                screen.view.settings = settings;
                screen.set_frame(voxels, (&views, ids), &camera, &queue);
                screen.compose.set(&queue, factor);
            }
            _ => {
                let mut screen = Screen::new(voxels, (&views, ids), &camera, settings, &queue);
                screen.key = gi_view.key;
                screen.compose.set(&queue, factor);
                commands.entity(gi_view.entity).insert(screen);
            }
        }
    }
}

/// The prepass textures in the order of the module's bindings. Bevy creates new views every frame,
/// so only the textures themselves can be compared.
fn bound_textures(textures: &ViewPrepassTextures) -> Option<([Bound; 3], [wgpu::Texture; 3])> {
    let views =
        [textures.deferred_view()?, textures.depth_only_view()?, textures.motion_vectors_view()?];
    Some((
        views.map(|view| Bound::View((**view).clone())),
        views.map(|view| view.texture().clone()),
    ))
}

impl Screen {
    fn new(
        voxels: &Voxels,
        (views, ids): (&[Bound; 3], [wgpu::Texture; 3]),
        camera: &Camera<'_>,
        settings: TraceSettings,
        queue: &wgpu::Queue,
    ) -> Self {
        let gi = &voxels.gi;
        let origin = Place { origin: camera.origin.to_array(), padding: [0; 2] };
        let place = uniform_buffer(gi.pipelines().device(), "place of the viewport", &origin);
        let gbuffer = resources(views, &place);
        let mut view = gi.view(GBuffer::Own(&gbuffer), camera.size, &settings);
        view.set_camera(queue, camera.to_lumivox());
        Self {
            key: VolumeKey::new(&crate::GiVolume::default(), Entity::PLACEHOLDER),
            number: voxels.number,
            compose: voxels.compose.view(gi, &view),
            view,
            bound: ids,
            place,
            origin: camera.origin,
            is_ready: true,
        }
    }

    /// Sets the next frame's camera and textures; size and settings are unchanged.
    fn set_frame(
        &mut self,
        voxels: &Voxels,
        (views, ids): (&[Bound; 3], [wgpu::Texture; 3]),
        camera: &Camera<'_>,
        queue: &wgpu::Queue,
    ) {
        if self.origin != camera.origin {
            self.origin = camera.origin;
            let place = Place { origin: camera.origin.to_array(), padding: [0; 2] };
            queue.write_buffer(&self.place, 0, bytemuck::bytes_of(&place));
        }
        if self.bound != ids {
            let gbuffer = resources(views, &self.place);
            voxels.gi.bind_gbuffer(&mut self.view, GBuffer::Own(&gbuffer));
            self.bound = ids;
        }
        self.view.set_camera(queue, camera.to_lumivox());
        self.is_ready = true;
    }
}

/// The resources in the order of the module's bindings.
fn resources(views: &[Bound; 3], place: &Buffer) -> [Bound; 4] {
    let [deferred, depth, motion] = views.clone();
    [deferred, depth, motion, Bound::Buffer((**place).clone())]
}

/// Traces the cones of a camera and adds their light to its picture, between the opaque and the
/// transparent pass.
pub(crate) fn light_screen(
    view: ViewQuery<(&ViewTarget, &ExtractedCamera, &mut Screen)>,
    mut context: RenderContext,
    volumes: Res<Volumes>,
    queue: Res<RenderQueue>,
    diagnostics: Option<Res<DiagnosticsRecorder>>,
    reports: Res<Reports>,
) {
    let (target, camera, mut screen) = view.into_inner();
    if !std::mem::take(&mut screen.is_ready) {
        return;
    }
    let Some(voxels) = volumes.shown(&screen.key).filter(|voxels| voxels.number == screen.number)
    else {
        return;
    };
    let device = context.render_device().wgpu_device().clone();
    let encoder = context.command_encoder();
    let span = diagnostics.as_ref().map(|to| to.time_span(encoder, "lumivox/trace"));
    let mut recorder = Recorder::on(&device, &queue, encoder);
    let traced = voxels.gi.trace(&mut recorder, &mut screen.view, &voxels.lights);
    match traced {
        Ok(()) => {
            let picture = [Some(target.get_color_attachment())];
            recorder.render("lumivox compose", &picture, None, |pass| {
                if let Some(viewport) = &camera.viewport {
                    let (place, size) = (viewport.physical_position, viewport.physical_size);
                    let [x, y, width, height] =
                        [place.x, place.y, size.x, size.y].map(|n| n as f32);
                    pass.set_viewport(x, y, width, height, 0.0, 1.0);
                }
                voxels.compose.draw(pass, &screen.compose, &screen.view);
            });
        }
        Err(error) => reports.once(LumivoxEvent::Failed { error: error.to_string() }),
    }
    drop(recorder);
    if let Some(span) = span {
        span.end(encoder);
    }
}
