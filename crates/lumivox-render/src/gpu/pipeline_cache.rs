//! Compiled pipelines, cached in a file across runs, for drivers without a cache of their own
//! (Vulkan only).

use std::fs;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The folder for compiled pipelines: `LUMIVOX_PIPELINE_CACHE` if it is set, else
/// `lumivox/pipelines` in the user's cache folder. `None` if the variable is `off`, or the user has
/// no cache folder.
pub fn pipeline_cache_folder() -> Option<PathBuf> {
    match std::env::var_os("LUMIVOX_PIPELINE_CACHE") {
        Some(folder) if folder == "off" => None,
        Some(folder) if !folder.is_empty() => Some(folder.into()),
        _ => {
            let folders = directories::ProjectDirs::from("", "", "lumivox")?;
            Some(folders.cache_dir().join("pipelines"))
        }
    }
}

/// The compiled pipelines of one device; saved when the last clone of its `Gpu` is dropped.
#[derive(Debug)]
pub(super) struct PipelineFile {
    path: PathBuf,
    /// The adapter, driver and Lumivox version for which the content is valid.
    identity: String,
    pub(super) cache: wgpu::PipelineCache,
    /// The checksum of the file's content.
    saved: Mutex<Option<u64>>,
}

impl PipelineFile {
    /// Opens the file of a device in a folder; `None` if the device has no pipeline cache.
    pub(super) fn open(
        device: &wgpu::Device,
        info: &wgpu::AdapterInfo,
        folder: &Path,
    ) -> Option<Self> {
        if !device.features().contains(wgpu::Features::PIPELINE_CACHE) {
            return None;
        }
        let path = folder.join(wgpu::util::pipeline_cache_key(info)?);
        let identity = format!(
            "{} {} {:x}:{:x} {} {}",
            env!("CARGO_PKG_VERSION"),
            info.name,
            info.vendor,
            info.device,
            info.driver,
            info.driver_info
        );
        let data = read(&path).and_then(|file| unpack(&identity, file));
        let descriptor = wgpu::PipelineCacheDescriptor {
            label: Some("lumivox"),
            data: data.as_deref(),
            fallback: true,
        };
        // SAFETY: the data came from `get_data` of the same adapter, driver and version: `unpack`
        // has compared the identity and the checksum that `save` wrote.
        #[allow(unsafe_code, reason = "wgpu has no other way to give a driver its data back")]
        let cache = unsafe { device.create_pipeline_cache(&descriptor) };
        Some(Self { path, identity, cache, saved: Mutex::new(data.as_deref().map(checksum)) })
    }

    /// Writes the pipelines that the device has compiled, if there are new ones. A failed write
    /// only costs time at the next start.
    pub(super) fn save(&self) {
        let Some(data) = self.cache.get_data() else { return };
        let mut saved = self.saved.lock().unwrap_or_else(PoisonError::into_inner);
        let sum = Some(checksum(&data));
        if *saved == sum {
            return;
        }
        match self.write(&pack(&self.identity, &data)) {
            Ok(()) => *saved = sum,
            Err(error) => {
                tracing::debug!("pipelines are not saved in {}: {error}", self.path.display());
            }
        }
    }

    /// Replaces the file atomically, so that no other process reads half of it.
    fn write(&self, bytes: &[u8]) -> std::io::Result<()> {
        if let Some(folder) = self.path.parent() {
            fs::create_dir_all(folder)?;
        }
        let name = format!("{}.{:p}.new", std::process::id(), self);
        let new = self.path.with_extension(name);
        let written = fs::write(&new, bytes).and_then(|()| fs::rename(&new, &self.path));
        if written.is_err() {
            let _ = fs::remove_file(&new);
        }
        written
    }
}

impl Drop for PipelineFile {
    fn drop(&mut self) {
        self.save();
    }
}

/// The content of a file; `None` if it cannot be read, or is larger than any driver's cache.
fn read(path: &Path) -> Option<Vec<u8>> {
    let about = fs::metadata(path).ok()?;
    let is_likely = about.is_file() && about.len() <= 1 << 30;
    is_likely.then(|| fs::read(path).ok()).flatten()
}

/// The hash may differ between Rust versions; the file is then rewritten.
fn checksum(data: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    data.hash(&mut hasher);
    hasher.finish()
}

/// The content of the file: a line with the identity, the checksum, and the driver's data.
fn pack(identity: &str, data: &[u8]) -> Vec<u8> {
    let head = format!("lumivox pipelines 1 {identity}\n");
    [head.as_bytes(), &checksum(data).to_le_bytes(), data].concat()
}

/// The driver's data in a file; `None` if it is damaged or of another identity.
fn unpack(identity: &str, mut file: Vec<u8>) -> Option<Vec<u8>> {
    let head = format!("lumivox pipelines 1 {identity}\n");
    let start = head.len() + size_of::<u64>();
    let sum = u64::from_le_bytes(file.get(head.len()..start)?.try_into().ok()?);
    let is_whole = file.starts_with(head.as_bytes()) && checksum(&file[start..]) == sum;
    is_whole.then(|| file.split_off(start))
}

#[cfg(test)]
mod tests {
    use super::{pack, unpack};

    #[test]
    fn damaged_and_foreign_files_are_ignored() {
        let file = pack("GPU 1.0", b"pipelines");
        assert_eq!(unpack("GPU 1.0", file.clone()).as_deref(), Some(&b"pipelines"[..]));
        assert_eq!(unpack("GPU 1.1", file.clone()), None);
        for length in 0..file.len() {
            assert_eq!(unpack("GPU 1.0", file[..length].to_vec()), None, "{length} bytes");
        }
        for place in 0..file.len() {
            let mut damaged = file.clone();
            damaged[place] ^= 1;
            assert_eq!(unpack("GPU 1.0", damaged), None, "byte {place}");
        }
    }

    #[test]
    fn pipelines_are_saved_and_read_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let open = || {
            let options = crate::GpuOptions {
                pipeline_cache: Some(folder.path().join("new")),
                ..crate::GpuOptions::default()
            };
            pollster::block_on(crate::Gpu::new(&options)).expect("a device")
        };
        let gpu = open();
        let is_kept = gpu.device.features().contains(wgpu::Features::PIPELINE_CACHE);
        let compile = |gpu: &crate::Gpu| {
            let shaders = lumivox::shaders::library();
            lumivox::internal::Scan::new(&gpu.pipelines, &shaders).expect("it links");
            pollster::block_on(gpu.pipelines.compile(&mut |_, _| {}));
        };
        compile(&gpu);
        drop(gpu);
        let files: Vec<_> = std::fs::read_dir(folder.path().join("new"))
            .map(|entries| entries.map(|entry| entry.expect("it is listed").path()).collect())
            .unwrap_or_default();
        assert_eq!(files.len(), usize::from(is_kept), "{files:?}");
        let Some(file) = files.first() else { return };
        let content = std::fs::read(file).expect("it is there");
        // An unchanged file is not rewritten; a damaged file is replaced.
        let written = std::fs::metadata(file).expect("it is there").modified().expect("a time");
        let gpu = open();
        compile(&gpu);
        drop(gpu);
        assert_eq!(
            std::fs::metadata(file).expect("it is there").modified().expect("a time"),
            written
        );
        std::fs::write(file, b"damaged").expect("it can be written");
        let gpu = open();
        compile(&gpu);
        drop(gpu);
        assert_eq!(std::fs::read(file).expect("it is there"), content);
    }
}
