//! The setup of fuzz targets.

/// Makes the fuzzer's own thread the only worker: inputs are too small to share, and handing each
/// over to another thread would take longer than loading it.
pub fn one_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("the first to ask");
}
