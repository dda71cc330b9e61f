//! GPU memory by its use.

/// The memory of one use.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryUse {
    /// The kind of use, such as `shadow maps`.
    pub name: String,
    /// Bytes, without the driver's alignment.
    pub bytes: u64,
}

impl MemoryUse {
    /// Memory of a named use.
    pub fn new(name: &str, bytes: u64) -> Self {
        Self { name: name.to_owned(), bytes }
    }
}

/// Free bytes of main memory; `None` if the system does not report them.
pub(crate) fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib << 10)
}
