//! Pictures for screens and files.

use glam::UVec2;
use lumivox_explorer::parameters::find_parameter;
use lumivox_render::{ImageFormat, Picture, RenderError, RenderSettings};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};

use crate::error::Fault;
use crate::gpu::open;
use crate::work::{array, detached, numbers};

/// Converts radiance in cd/m² to screen pixels, 8 bits per channel (RGBA), and the bytes of their
/// PNG file. Automatic exposure uses the pixels that show a surface.
#[pyfunction]
pub fn develop<'py>(
    py: Python<'py>,
    size: (u32, u32),
    radiance: &Bound<'py, PyBytes>,
    coverage: &Bound<'py, PyBytes>,
    exposure: String,
    tone_map: String,
    adapter: Option<String>,
) -> PyResult<(Bound<'py, PyByteArray>, Bound<'py, PyBytes>)> {
    let radiance = numbers::<[f32; 3]>("radiance", radiance).map_err(|fault| fault.raise(py))?;
    let coverage = numbers::<f32>("coverage", coverage).map_err(|fault| fault.raise(py))?;
    let (ldr, png) = detached(py, || {
        let mut settings = RenderSettings::default();
        for (name, text) in [("exposure", exposure), ("tone_map", tone_map)] {
            if let Some(parameter) = find_parameter(name) {
                let value = parameter.parse(&text).map_err(RenderError::from)?;
                parameter.set(&mut settings, value).map_err(RenderError::from)?;
            }
        }
        let gpu = open(adapter.as_deref())?;
        let pixels = radiance.iter().zip(&coverage);
        let hdr = pixels.map(|([r, g, b], coverage)| [*r, *g, *b, *coverage]).collect();
        let (exposure, curve) = (settings.exposure, settings.tone_map);
        let developed = Picture::develop(&gpu, UVec2::from(size), hdr, exposure, curve);
        let developed = pollster::block_on(developed)?;
        let png = developed.encode(ImageFormat::Png).map_err(anyhow::Error::from)?;
        Ok((developed.ldr, png))
    })?;
    Ok((array(py, &ldr)?, PyBytes::new(py, &png)))
}

/// Encodes radiance in cd/m² as `OpenEXR`.
#[pyfunction]
pub fn encode_exr<'py>(
    py: Python<'py>,
    size: (u32, u32),
    radiance: &Bound<'py, PyBytes>,
) -> PyResult<Bound<'py, PyBytes>> {
    let radiance = numbers::<[f32; 3]>("radiance", radiance).map_err(|fault| fault.raise(py))?;
    let bytes = detached(py, || {
        let expected = u64::from(size.0) * u64::from(size.1);
        if radiance.len() as u64 != expected {
            return Err(Fault::input("radiance: its size does not match its number of pixels"));
        }
        let hdr = radiance.iter().map(|&[r, g, b]| [r, g, b, 1.0]).collect();
        let picture = Picture { size: UVec2::from(size), hdr, ldr: Vec::new() };
        Ok(picture.encode(ImageFormat::Exr)?)
    })?;
    Ok(PyBytes::new(py, &bytes))
}
