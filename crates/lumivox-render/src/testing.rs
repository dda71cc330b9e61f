//! Shared by the tests inside and outside the crate: the device, and a scene.

#[path = "../tests/it/common/device.rs"]
mod device;
#[path = "../tests/it/common/zoo.rs"]
pub(crate) mod zoo;

pub(crate) use device::{gpu, own_gpu};
