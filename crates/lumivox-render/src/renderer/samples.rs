//! Several samples per pixel in the first frames of a mean, so that edges and textures are smooth
//! from the first frame.
//!
//! Indirect light is smooth and takes most of a frame's time, so it is traced only for a frame's
//! first sample. Further samples draw the surfaces and their direct light at other positions in the
//! pixel, and reuse the indirect light of nearby traced samples of the same surface
//! (`composite.wgsl`). All samples of a frame have the same weight.

use glam::{UVec2, Vec2};
use lumivox::CameraView;
use lumivox::gpu::StageTime;
use lumivox_scene::Camera;

use super::Renderer;
use crate::passes::accumulate::weight_of_sample;
use crate::passes::composite::Composed;
use crate::passes::gbuffer;
use crate::{RenderError, ShadowMethod, View};

/// Frames that have several samples.
const SAMPLED_FRAMES: u32 = 16;

/// Samples of a frame while camera, light or objects move. Each costs a tenth to a fifth of a
/// frame.
const MOVING_SAMPLES: u32 = 2;

/// The number of samples of frame `frame`: 16, 8, 4, 4, then 2, and 1 from the 17th. So a new frame
/// hardly adds error at edges, although blended frames at first have a weight of half or more.
fn samples_of(frame: u32) -> u32 {
    match frame {
        0 => 16,
        1 => 8,
        2 | 3 => 4,
        4..SAMPLED_FRAMES => 2,
        _ => 1,
    }
}

/// The number of the first sample of frame `frame`, in all views, even with one sample a frame.
pub(super) fn samples_before(frame: u32) -> u32 {
    let several = frame.min(SAMPLED_FRAMES);
    (0..several).map(samples_of).sum::<u32>() + (frame - several)
}

/// The camera of a frame, given the frame's number (`None`: the last one's plus 1) and jitter, px.
pub(super) fn camera_view(
    camera: &Camera,
    size: UVec2,
    (frame, jitter): (Option<u32>, Vec2),
) -> CameraView {
    let mut view = CameraView::new(gbuffer::clip_from_world(camera, size), camera.position);
    (view.frame, view.jitter) = (frame, jitter);
    view
}

impl Renderer {
    /// Whether the first frames have several samples: only in views of light, if direct light is
    /// cheap. A picture of one frame in other views has the depths and normals of surfaces, not
    /// their means.
    fn is_sampled(&self) -> bool {
        let settings = &self.settings;
        settings.view.is_light()
            && !settings.view.is_of_voxels()
            && settings.view != View::Lod
            && settings.shown_look().is_none()
            && settings.shadows == ShadowMethod::Map
    }

    /// The number of samples of the next frame; 1 if the mean continues from an earlier picture,
    /// whose edges are already smooth. While something moves, each frame starts a new mean and has
    /// fewer; the first frame without a change has all samples again.
    pub(super) fn take_samples(&mut self) -> u32 {
        if !self.is_sampled() || self.targets.accumulate.has_past() {
            return 1;
        }
        // A picture of one frame always has all samples.
        let is_mean = self.settings.frames > 1;
        if is_mean && self.restarts > 1 && self.frame_count() == 1 {
            self.targets.accumulate.reset();
            self.restarts = 0;
        }
        let frame = self.frame_count();
        let moves = is_mean && frame == 0 && self.restarts > 0;
        self.restarts = if frame == 0 { self.restarts + 1 } else { 0 };
        if moves { MOVING_SAMPLES } else { samples_of(frame) }
    }

    /// Makes the next frame the first one: nothing of earlier frames remains.
    pub(super) fn start_like_new(&mut self) {
        (self.samples_drawn, self.restarts) = (0, 0);
    }

    /// The number of the first sample of the next frame, which has index `frame`. Blended frames
    /// must not repeat each other.
    pub(super) fn first_sample(&self, frame: u32) -> u32 {
        if self.targets.view.is_temporal() { self.samples_drawn } else { samples_before(frame) }
    }

    /// The offset of a frame's first sample in its pixel. A single frame shows depths and normals
    /// at the pixel's centre.
    pub(super) fn first_in_pixel(&self, sample: u32) -> Vec2 {
        if self.settings.frames <= 1 { Vec2::ZERO } else { gbuffer::jitter(sample) }
    }

    /// Adds the further samples of the last frame, if `samples` is above 1. Returns their times.
    ///
    /// # Errors
    /// When the device fails.
    pub(super) async fn draw_further_samples(
        &mut self,
        samples: u32,
    ) -> Result<Vec<StageTime>, RenderError> {
        let mut times = Vec::new();
        if samples == 1 {
            return Ok(times);
        }
        let frame = self.frame_count() - 1;
        let is_temporal = self.targets.view.is_temporal();
        let first = if is_temporal {
            self.samples_drawn.wrapping_sub(samples)
        } else {
            samples_before(frame)
        };
        let traced = self.first_in_pixel(first);
        for sample in 1..samples {
            let mut recorder = self.recorder();
            let Self { settings, camera, scene, gi, lights, near_shadows, passes, targets, .. } =
                self;
            let jitter = gbuffer::jitter(first + sample);
            let seen = camera_view(camera, settings.size, (Some(frame), jitter));
            targets.view.set_camera(&self.gpu.queue, seen);
            let view = &targets.view;

            recorder.stage("further sample");
            let textures = &targets.gbuffer_textures;
            passes.gbuffer.record(&mut recorder, scene, textures, (view, first + sample));
            // Without lights the first sample's direct light, none, is that of all samples.
            if settings.view.needs_direct() && lights.count > 0 {
                let (device, lit_by) = (&self.gpu.device, (&*lights, &*near_shadows));
                passes.direct.record(device, &mut recorder, gi, lit_by, view, &targets.direct);
            }
            let lit = (&*gi, &*lights, view);
            let has_cones = settings.view.needs_cones(settings.bounces);
            let to_traced = Some(jitter - traced);
            let weight = weight_of_sample(1.0 / (frame as f32 + 1.0), sample, samples);
            let composed = Composed { view: settings.view, has_cones, weight, to_traced };
            passes.composite.record(&mut recorder, lit, &targets.composite, composed);
            targets.accumulate.record_further(&mut recorder, sample, samples);
            for beside in &mut targets.beside {
                let counted = (composed, [sample, samples]);
                beside.record_further(&mut recorder, &passes.composite, lit, counted);
            }
            times.extend(recorder.finish().await?);
        }
        Ok(times)
    }
}
