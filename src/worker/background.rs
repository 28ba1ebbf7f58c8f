//! Background work that reports a result even after a panic.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::Sender;
use std::sync::{Mutex, MutexGuard};

use crate::message::{Message, Response};
use novamind_tools::Rejection;

/// Runs `work` on a new thread and reports its result. Reports a panic as a rejection, so that no pane waits forever.
/// Reports nothing if `work` returns `None` because the user has cancelled the work.
pub fn answer_on_thread<T>(
    messages: Sender<Message>,
    work: impl FnOnce() -> Result<Option<T>, Rejection> + Send + 'static,
    report: impl FnOnce(Result<T, Rejection>) -> Response + Send + 'static,
) {
    std::thread::spawn(move || {
        let result = catch_panic(work).unwrap_or_else(Err);
        if let Some(result) = result.transpose() {
            let _ = messages.send(Message::Response(report(result)));
        }
    });
}

/// Runs `work`, and returns a rejection if `work` panics.
///
/// # Errors
/// `internal_error`: `work` has panicked. Values that `work` used may be inconsistent.
pub(super) fn catch_panic<T>(work: impl FnOnce() -> T) -> Result<T, Rejection> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let reason = panic_message(&*panic);
        let message =
            format!("internal error ({reason}); nothing was changed, the run is safe and you can continue");
        Rejection::new("internal_error", message)
    })
}

pub(super) fn panic_message(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("an unknown reason").to_owned()
}

/// Locks a cache. Replaces its content with the default if a panic may have left it inconsistent.
pub(super) fn lock_cache<T: Default>(kept: &Mutex<T>) -> MutexGuard<'_, T> {
    kept.lock().unwrap_or_else(|poisoned| {
        let mut guard = poisoned.into_inner();
        *guard = T::default();
        kept.clear_poison();
        guard
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::mpsc::channel;

    use super::*;

    fn report(result: Result<u32, Rejection>) -> Response {
        Response::FilesWritten(result.map(|value| value.to_string()).map_err(|rejection| rejection.message))
    }

    #[test]
    fn answer_on_thread_reports_a_result_a_rejection_and_a_panic() {
        let answered = |work: fn() -> Result<Option<u32>, Rejection>| {
            let (sender, messages) = channel();
            answer_on_thread(sender, work, report);
            // The channel closes after the thread has ended.
            messages
                .into_iter()
                .map(|message| match message {
                    Message::Response(Response::FilesWritten(written)) => written,
                    _ => panic!("an unexpected message"),
                })
                .collect::<Vec<_>>()
        };
        assert_eq!(answered(|| Ok(Some(7))), [Ok("7".to_owned())]);
        assert_eq!(answered(|| Ok(None)), []);
        assert_eq!(answered(|| Err(Rejection::new("no", "refused"))), [Err("refused".to_owned())]);
        let defect = answered(|| panic!("row 3 is missing"));
        let [Err(words)] = defect.as_slice() else { panic!("{defect:?}") };
        assert!(words.starts_with("internal error (row 3 is missing); nothing was changed"), "{words}");
    }

    #[test]
    fn lock_cache_resets_after_a_panic() {
        let kept = Arc::new(Mutex::new(vec![1]));
        assert_eq!(*lock_cache(&kept), [1]);
        let panicked = catch_panic(|| {
            let mut guard = lock_cache(&kept);
            guard.push(2);
            panic!("half done")
        });
        assert_eq!(panicked.map(|()| 0).expect_err("a panic").code, "internal_error");
        assert!(lock_cache(&kept).is_empty());
        assert!(!kept.is_poisoned());
    }
}
