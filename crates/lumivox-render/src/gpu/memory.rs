//! GPU memory by its use.

/// The memory of one use.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MemoryUse {
    /// The use, such as `shadow maps`.
    pub name: String,
    /// Its size, without what a driver adds for alignment.
    pub bytes: u64,
}

impl MemoryUse {
    /// A thing by its name.
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
