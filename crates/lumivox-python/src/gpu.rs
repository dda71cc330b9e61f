//! The device of the process, opened at its first use.

use std::sync::Mutex;

use lumivox_render::{Gpu, GpuOptions};
use pyo3::prelude::*;

use crate::error::Fault;
use crate::work::{detached, lock};

/// An open device, with the process and the options that opened it.
struct Opened {
    process: u32,
    options: GpuOptions,
    gpu: Gpu,
}

static OPENED: Mutex<Vec<Opened>> = Mutex::new(Vec::new());

/// The process's device on an adapter, on the fastest if `None`. A lost device is opened again.
///
/// # Errors
/// When there is no such adapter, and in a process that was forked after a device was opened.
pub fn open(adapter: Option<&str>) -> Result<Gpu, Fault> {
    let options = GpuOptions {
        adapter: adapter.map(str::to_owned),
        portable: false,
        pipeline_cache: lumivox_render::pipeline_cache_folder(),
    };
    let mut opened = lock(&OPENED);
    opened.retain(|opened| !opened.gpu.is_lost());
    for known in opened.iter() {
        check_process(known.process)?;
        if known.options == options {
            return Ok(known.gpu.clone());
        }
    }
    let gpu = pollster::block_on(Gpu::new(&options))?;
    opened.push(Opened { process: std::process::id(), options, gpu: gpu.clone() });
    Ok(gpu)
}

/// Checks that the process is still the one that opened a device: drivers do not survive a fork.
///
/// # Errors
/// In another process.
pub fn check_process(opener: u32) -> Result<(), Fault> {
    if opener == std::process::id() {
        return Ok(());
    }
    Err(Fault::input(
        "this process was forked after Lumivox had opened the GPU, which GPU drivers do not survive; start \
         processes with multiprocessing.get_context(\"spawn\"), or use Lumivox only in the child",
    ))
}

/// The adapters of this machine, the fastest first.
#[pyfunction]
pub fn adapters(py: Python<'_>) -> Vec<String> {
    py.detach(|| pollster::block_on(Gpu::adapters()).iter().map(lumivox_render::describe).collect())
}

/// The description of an adapter's device.
#[pyfunction]
#[pyo3(signature = (adapter=None))]
pub fn description(py: Python<'_>, adapter: Option<String>) -> PyResult<String> {
    detached(py, || Ok(lumivox_render::describe(&open(adapter.as_deref())?.adapter_info)))
}
