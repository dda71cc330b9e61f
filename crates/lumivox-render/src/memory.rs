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
    pub(crate) fn new(name: &str, bytes: u64) -> Self {
        Self { name: name.to_owned(), bytes }
    }
}
