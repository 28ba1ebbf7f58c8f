//! Parallel execution of simulations.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::ThreadPoolBuilder;

/// A flag that one simulation sets to stop all others.
pub(crate) struct StopFlag(AtomicBool);

impl StopFlag {
    pub(crate) fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Returns `Break` if the flag is set.
pub fn continue_unless_stopped(stop: &AtomicBool) -> ControlFlow<()> {
    match stop.load(Ordering::Relaxed) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
}

/// Applies a function to tasks in parallel and returns the results in order. If one task is stopped, stops all tasks
/// and returns `None`.
///
/// Each processor runs one thread, so memory contains at most one company per processor.
pub(crate) fn parallel_map<T: Sync, R: Send>(
    tasks: &[T],
    work: impl Fn(&T, &StopFlag) -> Option<R> + Sync,
) -> Option<Vec<R>> {
    let (next, stopped) = (AtomicUsize::new(0), StopFlag(AtomicBool::new(false)));
    let run_tasks = || {
        let mut found = Vec::new();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(task) = tasks.get(at).filter(|_| !stopped.is_set()) else { return found };
            match work(task, &stopped) {
                Some(result) => found.push((at, result)),
                None => stopped.0.store(true, Ordering::Relaxed),
            }
        }
    };
    let alone = || match ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool.install(run_tasks),
        Err(_) => run_tasks(),
    };
    let workers = rayon::current_num_threads().min(tasks.len());
    let mut found = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..workers).map(|_| scope.spawn(alone)).collect();
        workers.into_iter().filter_map(|worker| worker.join().ok()).flatten().collect::<Vec<_>>()
    });
    found.sort_by_key(|(at, _)| *at);
    (found.len() == tasks.len()).then(|| found.into_iter().map(|(_, result)| result).collect())
}
