//! Measures the errors of a scene: compares renderings with its reference, traced or read.

use std::cell::OnceCell;
use std::path::Path;

use glam::Vec3;
use lumivox_console::Failure;
use lumivox_render::compare::{
    Cost, LayerFigures, LinearPicture, RenderedLayers, leak_percent, render_layers,
};
use lumivox_render::reference::{
    PathTracer, ReferenceLayers, ReferenceProgress, ReferenceSettings,
};
use lumivox_render::{Gpu, RenderSettings};
use lumivox_scene::{Camera, Scene};
use serde::{Deserialize, Serialize};

use super::Row;
use crate::progress::{ProgressDisplay, words};

/// Names of the cameras in two rooms, to measure light that leaks between them.
const DARK_ROOM: &str = "dark room";
const LIT_ROOM: &str = "lit room";
/// Samples per pixel for the mean of the lit room.
const LIT_SAMPLES: u32 = 64;

/// A scene to measure.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// The GPU.
    pub gpu: &'a Gpu,
    /// The scene.
    pub scene: &'a Scene,
    /// Its camera.
    pub camera: &'a Camera,
    /// Shows the progress.
    pub progress: &'a ProgressDisplay,
}

/// The errors of a rendering against the reference.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The mean over grid positions.
    pub figures: LayerFigures,
    /// Light that leaks through walls; `None` unless the scene has two rooms.
    pub leak: Option<Leak>,
    /// The cost at the first grid position.
    pub cost: Cost,
    /// The pictures at the first grid position.
    pub layers: RenderedLayers,
    first: LayerFigures,
}

/// Light in a dark room that came through its walls, in percent of the light in the room next door.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
pub struct Leak {
    /// Leak after one bounce.
    pub one_bounce_percent: f64,
    /// Leak after all bounces.
    pub full_percent: f64,
}

/// A reference, as pictures.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Its layers.
    pub layers: ReferenceLayers,
    one_bounce: LinearPicture,
    full: LinearPicture,
    picture: LinearPicture,
    /// References of the two rooms, traced on first use.
    rooms: OnceCell<Option<Rooms>>,
}

/// The reference of a scene: read from `file` if it exists, else traced and written there.
///
/// # Errors
/// When the file belongs to another scene or has fewer samples, or tracing or writing fails.
pub fn reference(
    subject: &Subject<'_>,
    settings: ReferenceSettings,
    file: Option<&Path>,
) -> anyhow::Result<Truth> {
    let Subject { gpu, scene, camera, progress } = *subject;
    progress.set("preparing the reference", 0, 1);
    let samples = settings.samples;
    let mut tracer = pollster::block_on(PathTracer::new(gpu, scene, Some(camera), settings))?;
    if let Some(file) = file.filter(|file| file.exists()) {
        let layers = ReferenceLayers::read_exr(file)?;
        let problem = if layers.fingerprint != tracer.fingerprint() {
            Some("it shows another scene, another camera or another size".to_owned())
        } else if layers.samples < samples {
            Some(format!("it has {} samples a pixel, not {samples}", layers.samples))
        } else {
            None
        };
        return match problem {
            None => Ok(Truth::new(layers)),
            Some(problem) => Err(Failure::input(format!(
                "{}: {problem}; delete it to trace it again, or name another file",
                file.display()
            ))
            .into()),
        };
    }
    let mut hear = |step: ReferenceProgress| {
        progress.set_within("path sample", step.samples as u32, step.total, step.samples.fract());
        progress.goes_on()
    };
    pollster::block_on(tracer.render(&mut hear))?;
    check_wish(progress)?;
    let layers = tracer.layers();
    if let Some(file) = file {
        layers.write_exr(file)?;
    }
    Ok(Truth::new(layers))
}

/// Fails if the user has asked to stop.
///
/// # Errors
/// [`Failure::stopped`].
pub fn check_wish(progress: &ProgressDisplay) -> Result<(), Failure> {
    if progress.is_stopped() {
        Err(Failure::stopped("stopped; nothing was written"))
    } else {
        Ok(())
    }
}

impl Truth {
    fn new(layers: ReferenceLayers) -> Self {
        Self {
            one_bounce: layers.layer(&layers.one_bounce),
            full: layers.layer(&layers.full),
            picture: layers.layer(&layers.radiance),
            rooms: OnceCell::new(),
            layers,
        }
    }
}

impl Subject<'_> {
    /// The scene's camera of that name.
    fn camera(&self, name: &str) -> Option<&Camera> {
        self.scene.cameras.iter().find(|camera| camera.name == name)
    }

    fn render(&self, settings: &RenderSettings, camera: &Camera) -> anyhow::Result<RenderedLayers> {
        let mut tell = |step: lumivox_render::RenderProgress| {
            self.progress.set(words(step.stage), step.done, step.total);
        };
        let rendering = render_layers(self.gpu, self.scene, camera, settings, &mut tell);
        Ok(pollster::block_on(rendering)?)
    }
}

/// The grid offset of measurement number `index`: the first is the requested one, the others are
/// spread evenly (the three-dimensional additive recurrence of Roberts 2018, "The unreasonable
/// effectiveness of quasirandom sequences").
fn offset(first: Vec3, index: u32) -> Vec3 {
    (first + Vec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5) * index as f32).fract()
}

/// The references of the two rooms.
#[derive(Clone, Debug)]
struct Rooms {
    /// Reference of the dark room; `None` if the subject's camera is in it.
    dark: Option<Box<Truth>>,
    lit: Box<Truth>,
}

impl Rooms {
    /// Traces the rooms; `None` if the scene does not have both cameras.
    fn of(subject: &Subject<'_>, layers: &ReferenceLayers) -> anyhow::Result<Option<Self>> {
        let Some((dark, lit)) = subject.camera(DARK_ROOM).zip(subject.camera(LIT_ROOM)) else {
            return Ok(None);
        };
        let trace = |camera, samples| {
            let settings =
                ReferenceSettings { size: layers.size, samples, ..ReferenceSettings::default() };
            reference(&Subject { camera, ..*subject }, settings, None).map(Box::new)
        };
        let is_subject = dark == subject.camera;
        Ok(Some(Self {
            dark: if is_subject { None } else { Some(trace(dark, layers.samples)?) },
            lit: trace(lit, LIT_SAMPLES)?,
        }))
    }

    fn leak(
        &self,
        subject: &Subject<'_>,
        truth: &Truth,
        ours: &RenderedLayers,
        settings: &RenderSettings,
    ) -> anyhow::Result<Leak> {
        let rendered;
        let (dark_truth, dark_ours) = match (&self.dark, subject.camera(DARK_ROOM)) {
            (Some(dark_truth), Some(camera)) => {
                rendered = subject.render(settings, camera)?;
                (dark_truth.as_ref(), &rendered)
            }
            _ => (truth, ours),
        };
        let lit = &self.lit;
        Ok(Leak {
            one_bounce_percent: leak_percent(
                &dark_truth.one_bounce,
                &dark_ours.one_bounce,
                &lit.one_bounce,
            )?,
            full_percent: leak_percent(&dark_truth.full, &dark_ours.full, &lit.full)?,
        })
    }
}

impl Measured {
    /// Renders the subject at several grid positions, and compares it with its reference.
    ///
    /// # Errors
    /// When rendering fails or a value is not finite.
    pub fn new(
        subject: &Subject<'_>,
        truth: &Truth,
        settings: &RenderSettings,
        offsets: u32,
    ) -> anyhow::Result<Self> {
        let mut figures = Vec::new();
        let mut leaks = Vec::new();
        let mut first: Option<RenderedLayers> = None;
        if truth.rooms.get().is_none() {
            // Cannot fail: the cell is empty.
            let _ = truth.rooms.set(Rooms::of(subject, &truth.layers)?);
        }
        let rooms = truth.rooms.get().and_then(Option::as_ref);
        for index in 0..offsets {
            check_wish(subject.progress)?;
            let settings = RenderSettings {
                grid_offset: offset(settings.grid_offset, index),
                ..settings.clone()
            };
            let ours = subject.render(&settings, subject.camera)?;
            figures.push(LayerFigures::new(&truth.layers, &ours)?);
            if let Some(rooms) = rooms {
                leaks.push(rooms.leak(subject, truth, &ours, &settings)?);
            }
            first.get_or_insert(ours);
        }
        let layers = first.ok_or_else(|| Failure::input("at least one place of the grid"))?;
        let mean = |of: fn(&Leak) -> f64| leaks.iter().map(of).sum::<f64>() / leaks.len() as f64;
        Ok(Self {
            first: figures[0].clone(),
            figures: LayerFigures::mean(&figures),
            leak: (!leaks.is_empty()).then(|| Leak {
                one_bounce_percent: mean(|leak| leak.one_bounce_percent),
                full_percent: mean(|leak| leak.full_percent),
            }),
            cost: layers.cost,
            layers,
        })
    }

    /// Pictures at the first grid position, with their own figures, for a strip.
    pub fn rows<'a>(&'a self, truth: &'a Truth) -> Vec<Row<'a>> {
        let rows = [
            ("one bounce", &truth.one_bounce, &self.layers.one_bounce, &self.first.one_bounce),
            ("all bounces", &truth.full, &self.layers.full, &self.first.full),
            ("picture", &truth.picture, &self.layers.picture, &self.first.picture),
        ];
        let row = |(label, reference, ours, figures): (
            &'a str,
            &'a LinearPicture,
            &'a LinearPicture,
            &'a Option<_>,
        )| {
            let figures = figures.as_ref()?;
            Some(Row { label, reference, ours, figures })
        };
        rows.into_iter().filter_map(row).collect()
    }
}
