//! Buffers checked against the device's limits.

use crate::GiError;
use crate::gpu::{Buffer, storage_buffer};

/// Creates storage buffers that fit the device.
#[derive(Clone, Copy, Debug)]
pub struct Memory<'a> {
    device: &'a wgpu::Device,
}

/// Suggestion in the error if a buffer does not fit.
#[derive(Clone, Copy, Debug)]
pub enum Remedy {
    /// A lower resolution than the given current one: the buffer grows with its third power.
    Volume(u32),
    /// A lower resolution than the given current one: the buffer grows with the surface, that is,
    /// with the square of the resolution.
    Surface(u32),
    /// More batches: the buffer grows with the triangles of a batch.
    Batch,
}

impl Remedy {
    /// The suggestion in words; `share` is available / needed memory.
    pub(super) fn words(self, share: f64) -> String {
        let lower = |resolution: u32, share: f64| {
            let fits = (f64::from(resolution) * share) as u32 / 8 * 8;
            format!("a resolution of {} would fit", fits.max(crate::MIN_RESOLUTION))
        };
        match self {
            // The bits cover a cube whose edge is a power of two.
            Self::Volume(resolution) => {
                let halvings = (-share.log2() / 3.0).ceil();
                let edge = f64::from(resolution.next_power_of_two());
                lower(edge as u32, (-halvings).exp2())
            }
            Self::Surface(resolution) => lower(resolution, share.sqrt()),
            Self::Batch => "divide the geometry into several batches".to_owned(),
        }
    }
}

impl<'a> Memory<'a> {
    /// Buffers on a device.
    pub fn new(device: &'a wgpu::Device) -> Self {
        Self { device }
    }

    /// The device that the buffers are on.
    pub fn device(&self) -> &'a wgpu::Device {
        self.device
    }

    /// A storage buffer of zeros for `count` elements of `stride` bytes.
    ///
    /// # Errors
    /// [`GiError::Limit`] if the device cannot allocate it or bind it as a whole.
    pub fn buffer(
        &self,
        label: &str,
        count: u64,
        stride: u64,
        remedy: Remedy,
    ) -> Result<Buffer, GiError> {
        let bytes = self.check(label, count, stride, remedy)?;
        Ok(storage_buffer(self.device, label, bytes))
    }

    /// The bytes of a buffer that the caller will create.
    ///
    /// # Errors
    /// As [`Self::buffer`].
    pub fn check(
        &self,
        label: &str,
        count: u64,
        stride: u64,
        remedy: Remedy,
    ) -> Result<u64, GiError> {
        let bytes = count * stride;
        let limits = self.device.limits();
        for (limit, available) in [
            ("max_storage_buffer_binding_size", limits.max_storage_buffer_binding_size),
            ("max_buffer_size", limits.max_buffer_size),
        ] {
            if bytes > available {
                return Err(GiError::Limit {
                    what: format!("the buffer of {label}"),
                    needed: bytes,
                    unit: "bytes",
                    limit,
                    available,
                    remedy: remedy.words(available as f64 / bytes as f64),
                });
            }
        }
        Ok(bytes)
    }
}
