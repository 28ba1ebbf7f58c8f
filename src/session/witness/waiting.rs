//! Whether a witness is not reached, as the queue beside a run tells whoever looks at it from outside.

use std::path::Path;
use std::time::Duration;

use super::queue::FILE;
use super::record::Told;
use crate::session::trajectory::{now, seconds};

/// Seconds after which a line that still waits is no line on its way.
const ON_ITS_WAY: f64 = 5.0;
/// Pause before the second look. The queue holds each line for the moment in which it is told, also one whose own moment is
/// long past; only one that is still the first has not been told.
const SECOND_LOOK: Duration = Duration::from_millis(200);

/// Lines of a run that its witness could not be told.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::session) struct WaitingLines {
    /// The moment that the first of them carries, RFC 3339.
    pub since: String,
    /// How many wait.
    pub lines: usize,
}

/// The lines that wait beside a run, where the first has waited for longer than telling takes.
pub(in crate::session) fn waiting_lines(run: &Path) -> Option<WaitingLines> {
    let first = queued(run)?;
    if seconds(&now()) - seconds(&first.since) < ON_ITS_WAY {
        return None;
    }
    std::thread::sleep(SECOND_LOOK);
    queued(run).filter(|second| second.since == first.since)
}

fn queued(run: &Path) -> Option<WaitingLines> {
    let text = std::fs::read_to_string(run.join(FILE)).ok()?;
    let first: Told = serde_json::from_str(text.lines().next()?).ok()?;
    Some(WaitingLines { since: first.at, lines: text.lines().count() })
}

#[cfg(test)]
mod tests {
    use super::super::Witness;
    use super::*;

    #[test]
    fn only_a_witness_that_is_not_reached_leaves_lines_that_wait() {
        let place = tempfile::tempdir().expect("a folder");
        let (run, share) = (place.path().join("run"), place.path().join("share"));
        std::fs::create_dir(&run).expect("a folder");
        assert_eq!(waiting_lines(&run), None);
        // A queue that is open and empty is no outage, nor is a line that was written just now.
        std::fs::write(run.join(FILE), "").expect("written");
        assert_eq!(waiting_lines(&run), None);
        let tell = |at: &str| Witness::start(&share, "m", "0123abcd", &run).tell(1, "aa", at);
        tell(&now());
        assert_eq!(waiting_lines(&run), None);
        std::fs::remove_file(run.join(FILE)).expect("gone");
        let at = "2026-11-21T10:00:00Z";
        tell(at);
        tell("2026-11-21T10:00:09Z");
        assert_eq!(waiting_lines(&run), Some(WaitingLines { since: at.to_owned(), lines: 2 }));
        assert!(!share.exists(), "a share that is not there is not made");
        std::fs::create_dir(&share).expect("it is back");
        tell("2026-11-21T10:00:10Z");
        assert_eq!(waiting_lines(&run), None);
    }
}
