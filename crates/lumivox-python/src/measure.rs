//! Light at points and along rays by the path tracer, the figures of workplanes, and their
//! pictures.

use std::ops::ControlFlow;

use glam::{UVec2, Vec3};
use lumivox_app::FalseColor;
use lumivox_render::measure::{Summary, Workplane};
use lumivox_render::reference::{LightMeter, MeterSettings, ReferenceProgress, Sensor};
use lumivox_scene::Camera;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};

use crate::gpu::open;
use crate::scene::Scene;
use crate::stage::{CameraArgument, stage};
use crate::work::{Progress, array, detached, numbers};

/// Traces the light at points with normals or, if `is_along_rays`, the light that arrives from
/// directions. Returns for each the total RGB, the direct RGB, lux or cd/m², its standard error,
/// and the openness.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "they are those of the package's functions")]
pub fn measure<'py>(
    py: Python<'py>,
    scene: &Scene,
    points: &Bound<'py, PyBytes>,
    directions: &Bound<'py, PyBytes>,
    is_along_rays: bool,
    samples: u32,
    seed: u32,
    bounces: Option<u32>,
    surroundings: String,
    adapter: Option<String>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyByteArray>> {
    let points = numbers::<Vec3>("points", points).map_err(|fault| fault.raise(py))?;
    let directions = numbers::<Vec3>("directions", directions).map_err(|fault| fault.raise(py))?;
    let mut progress = Progress::new(progress);
    let readings = detached(py, || {
        let gpu = open(adapter.as_deref())?;
        // The camera only affects the light that is added to the scene.
        let anywhere = Camera::look_at(Vec3::Z, Vec3::ZERO, 1.0);
        let camera = (surroundings == "none").then(|| CameraArgument::Given((&anywhere).into()));
        let staged = stage(&scene.model(), camera, 1.0, &surroundings)?;
        let sensors = points.iter().zip(&directions).map(|(&at, &direction)| {
            if is_along_rays {
                Sensor::Radiance { at, direction }
            } else {
                Sensor::Irradiance { at, normal: direction }
            }
        });
        let sensors: Vec<Sensor> = sensors.collect();
        let settings = MeterSettings { samples, seed, bounces };
        let meter = LightMeter::new(&gpu, &staged.scene, &sensors, settings);
        let mut meter = pollster::block_on(meter)?;
        let mut tell = |step: ReferenceProgress| -> ControlFlow<()> {
            progress.step("samples", step.samples, step.total)
        };
        pollster::block_on(meter.measure(&mut tell))?;
        progress.end()?;
        Ok(meter.readings())
    })?;
    let flat: Vec<[f32; 9]> = readings
        .iter()
        .map(|light| {
            let ([a, b, c], [d, e, f]) = (light.total, light.direct);
            [a, b, c, d, e, f, light.value, light.standard_error, light.openness]
        })
        .collect();
    array(py, &flat)
}

/// The points of a workplane: a corner, two edges, rows and columns.
#[pyfunction]
pub fn workplane_points(
    py: Python<'_>,
    origin: [f32; 3],
    along: [f32; 3],
    across: [f32; 3],
    shape: (u32, u32),
) -> PyResult<Bound<'_, PyByteArray>> {
    let [origin, along, across] = [origin, along, across].map(Vec3::from);
    let plane = Workplane { origin, along, across, columns: shape.1, rows: shape.0 };
    array(py, &plane.points())
}

/// Mean, minimum, maximum and uniformity.
#[pyfunction]
pub fn summary(py: Python<'_>, values: &Bound<'_, PyBytes>) -> PyResult<(f64, f64, f64, f64)> {
    let values = numbers::<f32>("values", values).map_err(|fault| fault.raise(py))?;
    let Summary { mean, minimum, maximum, uniformity } = Summary::of(&values);
    Ok((mean, minimum, maximum, uniformity))
}

/// The PNG of readings in false colours with a scale.
#[pyfunction]
pub fn false_color<'py>(
    py: Python<'py>,
    values: &Bound<'py, PyBytes>,
    size: (u32, u32),
    texts: (String, String, String),
    range: Option<(f32, f32)>,
) -> PyResult<Bound<'py, PyBytes>> {
    let values = numbers::<f32>("values", values).map_err(|fault| fault.raise(py))?;
    let bytes = detached(py, || {
        let (title, figures, unit) = (texts.0.as_str(), texts.1.as_str(), texts.2.as_str());
        let size = UVec2::from(size);
        let light = FalseColor { title, figures, values: &values, size, unit, range };
        Ok(lumivox_app::false_color_png(&light)?)
    })?;
    Ok(PyBytes::new(py, &bytes))
}
