//! Other views of the picture's frames, from the same G-buffer and the same cones, each with a
//! separate mean. For measurements of quantities that the view on the screen does not show.

use lumivox::gpu::Recorder;
use lumivox::{Gi, GiView, Lights};

use super::Renderer;
use crate::gpu::readback::read_texture;
use crate::gpu::textures::ScreenTextures;
use crate::passes::accumulate::AccumulatePass;
use crate::passes::composite::{Composed, CompositePass, CompositeTargets};
use crate::{RenderError, RenderSettings, View};

/// One other view.
#[derive(Debug)]
pub(crate) struct BesideView {
    view: View,
    composite: CompositeTargets,
    accumulate: AccumulatePass,
    /// Bytes of the view's textures.
    bytes: u64,
}

impl BesideView {
    /// Adds the first of `samples` samples of a traced frame, which has index `frame` in the mean.
    pub(super) fn record(
        &mut self,
        recorder: &mut Recorder,
        pass: &CompositePass,
        lit: (&Gi, &Lights, &GiView),
        (composed, is_relit, (frame, samples)): (Composed, bool, (u32, u32)),
    ) {
        let composed = Composed { view: self.view, ..composed };
        pass.record(recorder, lit, &self.composite, composed);
        self.accumulate.number(frame);
        let samples = if self.view.is_light() { samples } else { 1 };
        let shown = (self.view, frame, samples);
        add_frame(&mut self.accumulate, recorder, shown, (lit.2, is_relit));
    }

    /// Adds a further sample of the newest frame, of the same surfaces as the picture's sample.
    pub(super) fn record_further(
        &mut self,
        recorder: &mut Recorder,
        pass: &CompositePass,
        lit: (&Gi, &Lights, &GiView),
        (composed, [sample, samples]): (Composed, [u32; 2]),
    ) {
        if self.view.is_light() {
            let composed = Composed { view: self.view, ..composed };
            pass.record(recorder, lit, &self.composite, composed);
            self.accumulate.record_further(recorder, sample, samples);
        }
    }

    /// Discards the frames so far.
    pub(crate) fn forget(&mut self) {
        self.accumulate.forget();
    }
}

/// Adds the first of `samples` samples of frame `frame` to a view's mean. In views of known light,
/// the sample replaces the mean.
pub(super) fn add_frame(
    accumulate: &mut AccumulatePass,
    recorder: &mut Recorder,
    (view, frame, samples): (View, u32, u32),
    of: (&GiView, bool),
) {
    if view.needs_past() {
        accumulate.forget();
    }
    accumulate.record(recorder, Some(of), samples);
    accumulate.number(frame + 1);
}

/// Checks [`RenderSettings::beside`]: the views must be of surfaces, beside [`View::Final`] and
/// without a look.
///
/// # Errors
/// [`RenderError::Setting`] with the first value that is not allowed.
pub(crate) fn validate(settings: &RenderSettings) -> Result<(), RenderError> {
    if settings.beside.is_empty() {
        return Ok(());
    }
    let is_of_surfaces = |view: &View| !view.is_of_voxels() && *view != View::Lod;
    let refused = settings.beside.iter().find(|view| !is_of_surfaces(view));
    let refused = match refused {
        Some(view) => Some(view.name()),
        None if settings.look.is_some() => Some(settings.look_name()),
        None if settings.view != View::Final => Some(settings.view.name()),
        None => None,
    };
    refused.map_or(Ok(()), |name| {
        Err(RenderError::Setting {
            name: "beside",
            value: name.to_owned(),
            expected: "views of surfaces beside the final picture, without a look".to_owned(),
        })
    })
}

impl Renderer {
    /// Creates the views that the settings ask for and that do not exist yet.
    pub(super) fn prepare_beside(&mut self) -> Result<(), RenderError> {
        let Self { gpu, settings, gi, passes, targets, .. } = self;
        if targets.beside.iter().map(|beside| beside.view).eq(settings.beside.iter().copied()) {
            return Ok(());
        }
        let device = &gpu.pipelines;
        targets.bytes -= targets.beside.drain(..).map(|beside| beside.bytes).sum::<u64>();
        for &view in &settings.beside {
            let mut textures = ScreenTextures::new(device, settings.size);
            let composite = passes.composite.targets(
                device,
                &mut textures,
                &targets.gbuffer_textures,
                &targets.direct,
                &targets.view,
            );
            let picture = &composite.picture;
            let accumulate = AccumulatePass::new(
                device,
                &passes.shaders,
                &mut textures,
                settings.size,
                (picture, targets.view.is_temporal().then_some(gi)),
            )?;
            let bytes = textures.bytes;
            targets.beside.push(BesideView { view, composite, accumulate, bytes });
            targets.bytes += bytes;
        }
        Ok(())
    }

    /// The mean over the frames so far of a view in [`RenderSettings::beside`], row by row from the
    /// top: light in cd/m², other quantities in the view's unit. `None` if the settings do not
    /// contain the view, or before the first frame.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn read_beside(&self, view: View) -> Result<Option<Vec<[f32; 4]>>, RenderError> {
        let beside = self.targets.beside.iter().find(|beside| beside.view == view);
        let Some(beside) = beside.filter(|_| self.frame_count() > 0) else { return Ok(None) };
        let mut pixels: Vec<[f32; 4]> = read_texture(&self.gpu, beside.accumulate.mean()).await?;
        if view.is_light() {
            let unit = self.scene.radiance_unit;
            for pixel in &mut pixels {
                *pixel = [pixel[0] * unit, pixel[1] * unit, pixel[2] * unit, pixel[3]];
            }
        }
        self.gpu.check("reading a view beside the picture")?;
        Ok(Some(pixels))
    }
}
