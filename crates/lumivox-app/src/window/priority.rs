//! The window goes before what it shows.
//!
//! Software GPUs compute on the cores that the window draws with. So the worker and the threads of its device, which are
//! those that its driver starts while the device is opened, give way to the window: on two busy cores that is the
//! difference between panels that lag by frames of the picture and panels that answer at once.

/// What background work has in Unix: a tenth of what the window gets, where both want a core.
#[cfg(target_os = "linux")]
const NICE: i32 = 10;

/// Lets this thread, and those that it starts, give way to the others. On Linux priorities are a thread's; elsewhere they
/// are the process's, and everything stays as it is.
pub fn give_way() {
    #[cfg(target_os = "linux")]
    if let Err(error) = rustix::process::nice(NICE) {
        tracing::debug!("the thread that renders keeps its priority: {error}");
    }
}
