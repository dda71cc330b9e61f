//! The worker's lower priority.
//!
//! Software GPUs compute on the cores that the window draws with. So the worker and the threads
//! that its driver starts with the device have a lower priority than the window. On two busy cores,
//! panels then respond at once, instead of lagging by frames of the picture.

/// Niceness of the worker, which gives it a tenth of the window's share of a contended core.
#[cfg(target_os = "linux")]
const NICE: i32 = 10;

/// Lowers the priority of this thread, and of threads that it starts. Only on Linux: elsewhere,
/// priorities belong to the process.
pub fn give_way() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::nice(NICE) {
        tracing::debug!("the thread that renders keeps its priority: {error}");
    }
}
