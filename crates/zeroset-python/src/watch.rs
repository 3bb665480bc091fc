//! Long work beside a waiting Python: progress out, Ctrl-C and exceptions in.
//!
//! Work runs on a thread of its own while the GIL is released. The caller's thread wakes twenty times a second, takes the GIL, looks for
//! signals, and tells the callback what is new. So the callback runs on the thread that called, and only that one sees Ctrl-C.

use std::num::NonZeroUsize;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use zeroset::monitor::Monitor;

use crate::error::Failure;

/// Time between two looks.
const PERIOD: Duration = Duration::from_millis(50);
/// Stack of the thread that works: solids may be a few hundred operands deep.
const STACK: usize = 8 << 20;

/// How a call runs.
pub(crate) struct Running<'py> {
    pub(crate) progress: Option<Bound<'py, PyAny>>,
    pub(crate) threads: Option<usize>,
}

/// What the work has told.
#[derive(Default)]
struct State {
    /// Stages with the share of the whole that is done, those that the callback has not heard of.
    news: Vec<(String, f64)>,
    stage: String,
    share: f64,
    is_done: bool,
}

#[derive(Default)]
struct Watch {
    state: Mutex<State>,
    done: Condvar,
    is_cancelled: AtomicBool,
}

impl Watch {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a while or for the end; returns what is new, and whether it is the end.
    fn wait(&self) -> (Vec<(String, f64)>, bool) {
        let waited = self.done.wait_timeout_while(self.state(), PERIOD, |state| !state.is_done);
        let mut state = waited.unwrap_or_else(PoisonError::into_inner).0;
        (std::mem::take(&mut state.news), state.is_done)
    }
}

impl Monitor for Watch {
    fn stage(&self, name: &str) {
        let mut state = self.state();
        name.clone_into(&mut state.stage);
        let news = (name.to_owned(), state.share);
        state.news.push(news);
    }

    fn share(&self, done: f64) {
        let mut state = self.state();
        state.share = state.share.max(done);
        let news = (state.stage.clone(), state.share);
        match state.news.last_mut() {
            Some(last) if last.0 == news.0 => *last = news,
            _ => state.news.push(news),
        }
    }

    fn cancelled(&self) -> bool {
        self.is_cancelled.load(Ordering::Relaxed)
    }
}

/// Says that the work is done, even if it panicked.
struct Done<'a>(&'a Watch);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.state().is_done = true;
        self.0.done.notify_all();
    }
}

impl Running<'_> {
    /// Without a callback, on all threads.
    pub(crate) fn quiet() -> Self {
        Self { progress: None, threads: None }
    }

    /// Does the work.
    ///
    /// # Errors
    /// What the work says; `KeyboardInterrupt` after Ctrl-C; whatever the callback raises.
    pub(crate) fn run<T, E>(self, py: Python<'_>, work: impl FnOnce(&dyn Monitor) -> Result<T, E> + Send) -> PyResult<T>
    where
        T: Send,
        E: Into<Failure> + Send,
    {
        let pool = self.threads.map(pool).transpose()?;
        let watch = Watch::default();
        let callback = self.progress.map(Bound::unbind);
        let looked = py.detach(|| {
            thread::scope(|scope| {
                let worker = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, || {
                    let _done = Done(&watch);
                    match &pool {
                        Some(pool) => pool.install(|| work(&watch)),
                        None => work(&watch),
                    }
                })?;
                let mut raised = None;
                loop {
                    let (news, is_done) = watch.wait();
                    if raised.is_none() {
                        raised = Python::attach(|py| look(py, callback.as_ref(), news)).err();
                        if raised.is_some() {
                            watch.is_cancelled.store(true, Ordering::Relaxed);
                        }
                    }
                    if is_done {
                        break;
                    }
                }
                Ok::<_, std::io::Error>((worker.join(), raised))
            })
        });
        match looked? {
            (_, Some(raised)) => Err(raised),
            (Ok(result), None) => result.map_err(|error| error.into().into()),
            (Err(panic), None) => resume_unwind(panic),
        }
    }
}

/// Looks for signals, and tells what is new.
fn look(py: Python<'_>, callback: Option<&Py<PyAny>>, news: Vec<(String, f64)>) -> PyResult<()> {
    py.check_signals()?;
    if let Some(callback) = callback {
        news.into_iter().try_for_each(|(stage, share)| callback.call1(py, (stage, share)).map(drop))?;
    }
    Ok(())
}

/// So many threads of their own.
fn pool(threads: usize) -> PyResult<rayon::ThreadPool> {
    let threads = NonZeroUsize::new(threads)
        .ok_or_else(|| Failure::parameter("0 threads do nothing; give 1 or more, or None"))?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build();
    pool.map_err(|why| Failure::parameter(format!("{threads} threads cannot be started: {why}; give fewer")).into())
}
