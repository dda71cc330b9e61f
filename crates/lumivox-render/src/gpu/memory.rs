//! What takes GPU memory.

/// The memory of one thing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryUse {
    /// What it is, such as `shadow maps`.
    pub name: String,
    /// How much it takes, without what a driver adds for alignment.
    pub bytes: u64,
}

impl MemoryUse {
    /// A thing by its name.
    pub fn new(name: &str, bytes: u64) -> Self {
        Self { name: name.to_owned(), bytes }
    }
}

/// Bytes of main memory that are free for use; `None` where the system does not tell.
pub(crate) fn available_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok().map(|kib| kib << 10)
}
