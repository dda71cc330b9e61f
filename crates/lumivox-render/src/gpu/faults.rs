//! Errors of a device that no call has returned, stored until they are polled.
//!
//! wgpu reports such an error within the call that raised it, on the calling thread; error scopes
//! belong to a thread as well. So each thread that shares a device receives its own errors.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

thread_local! {
    /// Dropped when its thread ends, which invalidates weak references.
    static SIGN_OF_LIFE: Arc<()> = Arc::default();
}

/// The errors of one device.
#[derive(Debug, Default)]
pub(crate) struct Faults(Mutex<Kept>);

#[derive(Debug, Default)]
struct Kept {
    threads: Vec<Thread>,
    loss: Option<String>,
}

#[derive(Debug)]
struct Thread {
    sign_of_life: Weak<()>,
    has_asked: bool,
    first: Option<String>,
}

impl Faults {
    /// Stores an error of this thread, unless there is an earlier one.
    pub(crate) fn keep(&self, message: String) {
        tracing::error!("GPU: {message}");
        self.lock().this_thread().first.get_or_insert(message);
    }

    /// Records that the device is lost, which concerns every thread.
    pub(crate) fn lose(&self, message: String) {
        tracing::error!("GPU: {message}");
        self.lock().loss.get_or_insert(message);
    }

    /// Takes this thread's error. If there is none, takes an error of a thread that has ended or
    /// never polls, such as one that compiles pipelines, so that no error is ignored. A lost device
    /// is reported each time.
    pub(crate) fn take(&self) -> Option<String> {
        let mut kept = self.lock();
        let own = kept.this_thread();
        own.has_asked = true;
        let fault = own.first.take().or_else(|| kept.of_others()).or_else(|| kept.loss.clone());
        kept.threads.retain(|thread| !thread.has_ended() || thread.first.is_some());
        fault
    }

    fn lock(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Kept {
    fn this_thread(&mut self) -> &mut Thread {
        // A thread that is shutting down counts as ended.
        let sign_of_life = SIGN_OF_LIFE.try_with(Arc::downgrade).unwrap_or_default();
        let is_this = |thread: &Thread| thread.sign_of_life.ptr_eq(&sign_of_life);
        let place = self.threads.iter().position(is_this).unwrap_or_else(|| {
            self.threads.push(Thread { sign_of_life, has_asked: false, first: None });
            self.threads.len() - 1
        });
        &mut self.threads[place]
    }

    fn of_others(&mut self) -> Option<String> {
        let mut silent = self.threads.iter_mut().filter(|t| !t.has_asked || t.has_ended());
        silent.find_map(|thread| thread.first.take())
    }
}

impl Thread {
    fn has_ended(&self) -> bool {
        self.sign_of_life.strong_count() == 0
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;
    use std::thread;

    use super::*;

    #[test]
    fn a_thread_gets_only_its_own_errors() {
        let faults = &Faults::default();
        let ((failed, has_failed), (go_on, may_go_on)) = (channel(), channel());
        thread::scope(move |scope| {
            let other = scope.spawn(move || {
                assert_eq!(faults.take(), None);
                faults.keep("theirs".to_owned());
                failed.send(()).expect("somebody waits");
                may_go_on.recv().expect("a word");
                faults.take()
            });
            has_failed.recv().expect("a word");
            assert_eq!(faults.take(), None, "the other thread asks for itself");
            faults.keep("ours".to_owned());
            faults.keep("what followed from it".to_owned());
            assert_eq!(faults.take().as_deref(), Some("ours"));
            assert_eq!(faults.take(), None, "the first one is enough");
            go_on.send(()).expect("somebody waits");
            assert_eq!(other.join().expect("no panic").as_deref(), Some("theirs"));
        });
        assert_eq!(faults.take(), None);
    }

    #[test]
    fn uncollected_errors_go_to_the_next_asking_thread() {
        let faults = Faults::default();
        thread::scope(|scope| {
            let helper = scope.spawn(|| faults.keep("a helper's".to_owned()));
            helper.join().expect("no panic");
            let checked = scope.spawn(|| {
                assert_eq!(faults.take().as_deref(), Some("a helper's"));
                faults.keep("after the last question".to_owned());
            });
            checked.join().expect("no panic");
        });
        assert_eq!(faults.take().as_deref(), Some("after the last question"));
        assert_eq!(faults.take(), None);
        assert_eq!(faults.lock().threads.len(), 1, "nothing is kept of threads that have ended");
    }

    #[test]
    fn every_thread_learns_of_a_lost_device() {
        let faults = Faults::default();
        faults.keep("an error".to_owned());
        faults.lose("lost".to_owned());
        assert_eq!(faults.take().as_deref(), Some("an error"));
        for _ in 0..2 {
            assert_eq!(faults.take().as_deref(), Some("lost"));
            let other = thread::scope(|scope| scope.spawn(|| faults.take()).join());
            assert_eq!(other.expect("no panic").as_deref(), Some("lost"));
        }
    }
}
