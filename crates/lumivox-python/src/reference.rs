//! The path tracer, and comparison with its pictures.

use std::ops::ControlFlow;
use std::path::PathBuf;

use glam::UVec2;
use lumivox_render::compare::{ErrorFigures, LinearPicture};
use lumivox_render::reference::{
    PathTracer, ReferenceLayers, ReferenceMerge, ReferencePart, ReferenceProgress,
    ReferenceSettings,
};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};

use crate::error::Fault;
use crate::gpu::open;
use crate::records::CameraRecord;
use crate::scene::Scene;
use crate::stage::{CameraArgument, stage};
use crate::work::{Progress, array, detached, numbers};

/// A path-traced picture with its layers.
#[pyclass(frozen, module = "lumivox._lumivox")]
pub struct Reference {
    layers: ReferenceLayers,
    camera: Option<lumivox_scene::Camera>,
    /// The encoded part, if this is a part.
    part: Option<Vec<u8>>,
}

#[pymethods]
impl Reference {
    /// Traces all samples, as a part from `first_batch` if `is_part`.
    #[staticmethod]
    #[expect(clippy::too_many_arguments, reason = "they are those of the package's function")]
    fn trace(
        py: Python<'_>,
        scene: &Scene,
        camera: Option<CameraArgument>,
        size: (u32, u32),
        samples: u32,
        seed: u32,
        first_batch: u32,
        is_part: bool,
        bounces: Option<u32>,
        surroundings: String,
        adapter: Option<String>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let mut progress = Progress::new(progress);
        detached(py, || {
            let size = UVec2::from(size);
            let aspect = size.x as f32 / size.y.max(1) as f32;
            let settings = ReferenceSettings {
                size,
                samples,
                seed,
                first_batch,
                bounces,
                ..ReferenceSettings::default()
            };
            let gpu = open(adapter.as_deref())?;
            let staged = stage(&scene.model(), camera, aspect, &surroundings)?;
            let tracer = PathTracer::new(&gpu, &staged.scene, Some(&staged.camera), settings);
            let mut tracer = pollster::block_on(tracer)?;
            let mut tell = |step: ReferenceProgress| -> ControlFlow<()> {
                progress.step("samples", step.samples, step.total)
            };
            pollster::block_on(tracer.render(&mut tell))?;
            progress.end()?;
            let part = is_part.then(|| tracer.part().to_bytes());
            Ok(Self { layers: tracer.layers(), camera: Some(staged.camera), part })
        })
    }

    /// Reads a file of the command `reference`.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        detached(py, || {
            Ok(Self { layers: ReferenceLayers::read_exr(&path)?, camera: None, part: None })
        })
    }

    /// Merges the parts of an iterable.
    #[staticmethod]
    fn merge(py: Python<'_>, parts: &Bound<'_, PyAny>, allow_mixed: bool) -> PyResult<Self> {
        let mut merge = ReferenceMerge::new(allow_mixed);
        // Load one part at a time: it may be large, and come over a network.
        for (number, part) in parts.try_iter()?.enumerate() {
            let part = part?;
            let kind = |_| Fault::input(format!("parts[{number}]: must be bytes")).raise(py);
            let bytes = part.cast::<PyBytes>().map_err(kind)?.as_bytes();
            let added =
                py.detach(|| ReferencePart::from_bytes(bytes).and_then(|part| merge.add(part)));
            added.map_err(|error| Fault::input(format!("parts[{number}]: {error}")).raise(py))?;
        }
        let layers = merge.layers().map_err(|error| Fault::from(error).raise(py))?;
        let layers = layers.ok_or_else(|| Fault::input("parts: has none").raise(py))?;
        Ok(Self { layers, camera: None, part: None })
    }

    /// The encoded part, if this is a part.
    fn part<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyBytes>> {
        self.part.as_ref().map(|bytes| PyBytes::new(py, bytes))
    }

    /// Writes all layers as `OpenEXR`.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        detached(py, || Ok(self.layers.write_exr(&path)?))
    }

    #[getter]
    fn size(&self) -> (u32, u32) {
        self.layers.size.into()
    }

    #[getter]
    fn samples(&self) -> u32 {
        self.layers.samples
    }

    #[getter]
    fn camera(&self) -> Option<CameraRecord> {
        self.camera.as_ref().map(Into::into)
    }

    /// The layers by name, with their channels.
    fn arrays<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Vec<(&'static str, Bound<'py, PyByteArray>, usize)>> {
        let layers = &self.layers;
        let colors = [
            ("radiance", &layers.radiance),
            ("direct", &layers.direct),
            ("one_bounce", &layers.one_bounce),
            ("irradiance", &layers.full),
            ("albedo", &layers.albedo),
            ("normal", &layers.normal),
        ];
        let scalars = [
            ("occlusion", &layers.occlusion),
            ("depth", &layers.depth_m),
            ("coverage", &layers.coverage),
            ("radiance_variance", &layers.radiance_variance),
            ("direct_variance", &layers.direct_variance),
            ("one_bounce_variance", &layers.one_bounce_variance),
            ("irradiance_variance", &layers.full_variance),
            ("occlusion_variance", &layers.occlusion_variance),
        ];
        let mut arrays = Vec::with_capacity(colors.len() + scalars.len());
        for (name, values) in colors {
            arrays.push((name, array(py, values)?, 3));
        }
        for (name, values) in scalars {
            arrays.push((name, array(py, values)?, 1));
        }
        Ok(arrays)
    }
}

/// The errors of a picture against a reference, as `lumivox compare` names them: bias, RMSE, RMSE
/// with the reference's noise and p95 in percent, FLIP, noise in percent.
#[pyfunction]
#[expect(clippy::type_complexity, reason = "the figures, in their order")]
pub fn figures(
    py: Python<'_>,
    size: (u32, u32),
    reference: &Bound<'_, PyBytes>,
    variance: Option<Bound<'_, PyBytes>>,
    picture: &Bound<'_, PyBytes>,
) -> PyResult<(f64, f64, f64, f64, Option<f64>, Option<f64>)> {
    let raise = |fault: Fault| fault.raise(py);
    let reference = numbers::<[f32; 3]>("reference", reference).map_err(raise)?;
    let picture = numbers::<[f32; 3]>("picture", picture).map_err(raise)?;
    let variance = variance.map(|bytes| numbers::<f32>("variance", &bytes)).transpose();
    let variance = variance.map_err(raise)?;
    detached(py, || {
        let size = UVec2::from(size);
        let reference = LinearPicture { size, rgb: reference };
        let picture = LinearPicture { size, rgb: picture };
        let is_known = |values: &&Vec<f32>| values.iter().all(|value| value.is_finite());
        let variance = variance.as_ref().filter(is_known).map(Vec::as_slice);
        let figures = ErrorFigures::new(&reference, variance, &picture)?;
        Ok((
            figures.bias_percent,
            figures.rmse_percent,
            figures.rmse_with_noise_percent,
            figures.p95_percent,
            figures.flip,
            figures.noise_percent,
        ))
    })
}
