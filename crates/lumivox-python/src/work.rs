//! Work without the global lock: progress, Ctrl-C, and the bytes of arrays.

use std::ops::ControlFlow;
use std::sync::{Mutex, MutexGuard, PoisonError};

use bytemuck::Pod;
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};

use crate::error::Fault;

/// The progress of a piece of work, and the exception that stops it.
pub struct Progress {
    callback: Option<Py<PyAny>>,
    raised: Option<PyErr>,
}

impl Progress {
    /// Progress that calls `callback(stage, done, total)`, if there is one.
    pub fn new(callback: Option<Py<PyAny>>) -> Self {
        Self { callback, raised: None }
    }

    /// Reports a step. It breaks once the callback has raised an exception or Ctrl-C was pressed.
    pub fn step(&mut self, stage: &str, done: f64, total: u32) -> ControlFlow<()> {
        if self.raised.is_none() {
            let told = Python::attach(|py| {
                py.check_signals()?;
                let Some(callback) = &self.callback else { return Ok(()) };
                callback.call1(py, (stage, done, total)).map(|_| ())
            });
            self.raised = told.err();
        }
        if self.raised.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Ends the work.
    ///
    /// # Errors
    /// The exception that stopped it.
    pub fn end(&mut self) -> Result<(), Fault> {
        self.raised.take().map_or(Ok(()), |error| Err(Fault::Python(error)))
    }
}

/// Does work without the global lock, and converts its error to an exception.
///
/// # Errors
/// The exception.
pub fn detached<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, Fault> + Send,
) -> PyResult<T> {
    py.detach(work).map_err(|fault| fault.raise(py))
}

/// Takes a lock even if work panicked under it: the state is checked again.
pub fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The numbers of an array; `name` is the argument's.
///
/// # Errors
/// When the bytes are not a whole number of values.
pub fn numbers<T: Pod>(name: &str, bytes: &Bound<'_, PyBytes>) -> Result<Vec<T>, Fault> {
    let bytes = bytes.as_bytes();
    if !bytes.len().is_multiple_of(size_of::<T>()) {
        let item = size_of::<T>();
        return Err(Fault::input(format!(
            "{name}: has {} bytes, but must have a multiple of {item}",
            bytes.len()
        )));
    }
    Ok(bytemuck::pod_collect_to_vec(bytes))
}

/// The bytes of a new array.
///
/// # Errors
/// When there is no memory for it.
pub fn array<'py, T: Pod>(py: Python<'py>, values: &[T]) -> PyResult<Bound<'py, PyByteArray>> {
    let bytes: &[u8] = bytemuck::cast_slice(values);
    PyByteArray::new_with(py, bytes.len(), |to| {
        to.copy_from_slice(bytes);
        Ok(())
    })
}
