//! Path-traced pictures of the poses of a sequence, cached in a folder.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use glam::UVec2;
use lumivox_app::parts::{ProgressDisplay, check_wish};
use lumivox_render::Gpu;
use lumivox_render::compare::LinearPicture;
use lumivox_render::reference::{
    PathTracer, ReferenceLayers, ReferenceProgress, ReferenceSettings,
};
use lumivox_scene::{Camera, Scene};

use super::figures::Known;
use super::moves::Pose;

/// The truth of one pose.
#[derive(Clone, Debug)]
pub struct Truth {
    picture: LinearPicture,
    picture_variance: Vec<f32>,
    full: LinearPicture,
    full_variance: Vec<f32>,
}

impl Truth {
    fn new(layers: ReferenceLayers) -> Self {
        Self {
            picture: layers.layer(&layers.radiance),
            full: layers.layer(&layers.full),
            picture_variance: layers.radiance_variance,
            full_variance: layers.full_variance,
        }
    }

    /// The picture.
    pub fn picture(&self) -> Known<'_> {
        Known { picture: &self.picture, variance: &self.picture_variance }
    }

    /// Irradiance by all light except direct light of lamps.
    pub fn full(&self) -> Known<'_> {
        Known { picture: &self.full, variance: &self.full_variance }
    }
}

/// Traces poses of one scene, each once.
#[derive(Debug)]
pub struct Truths<'a> {
    gpu: &'a Gpu,
    size: UVec2,
    samples: u32,
    folder: Option<&'a Path>,
    known: Vec<(Pose, Rc<Truth>)>,
}

impl<'a> Truths<'a> {
    /// Traces pictures with at least 17 samples a pixel, which their noise estimate needs. With a
    /// folder, existing files are read, and missing ones traced and written.
    pub fn new(gpu: &'a Gpu, size: UVec2, samples: u32, folder: Option<&'a Path>) -> Self {
        Self { gpu, size, samples, folder, known: Vec::new() }
    }

    /// The truth of a pose; scene and camera must be in this pose.
    ///
    /// Each pose has its own seed, so that the noise of two steps is independent.
    ///
    /// # Errors
    /// When a file cannot be read or written, the device fails, or the user stops the work.
    pub fn at(
        &mut self,
        pose: &Pose,
        (scene, camera): (&Scene, &Camera),
        progress: &ProgressDisplay,
    ) -> anyhow::Result<Rc<Truth>> {
        if let Some((_, truth)) = self.known.iter().find(|(known, _)| known == pose) {
            return Ok(truth.clone());
        }
        let settings = ReferenceSettings {
            size: self.size,
            samples: self.samples,
            seed: self.known.len() as u32,
            ..ReferenceSettings::default()
        };
        let mut tracer =
            pollster::block_on(PathTracer::new(self.gpu, scene, Some(camera), settings.clone()))?;
        let file = self.folder.map(|folder| {
            folder.join(file_name(tracer.fingerprint(), self.samples, settings.seed))
        });
        let layers = if let Some(file) = file.as_ref().filter(|file| file.exists()) {
            ReferenceLayers::read_exr(file)?
        } else {
            let mut hear = |_: ReferenceProgress| progress.goes_on();
            pollster::block_on(tracer.render(&mut hear))?;
            check_wish(progress)?;
            let layers = tracer.layers();
            if let Some(file) = &file {
                layers.write_exr(file)?;
            }
            layers
        };
        let truth = Rc::new(Truth::new(layers));
        self.known.push((pose.clone(), truth.clone()));
        Ok(truth)
    }
}

/// The file of a truth; the fingerprint identifies scene, camera and size.
fn file_name(fingerprint: u64, samples: u32, seed: u32) -> PathBuf {
    format!("{fingerprint:016x}-{samples}-{seed}.exr").into()
}
