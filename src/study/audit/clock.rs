//! Detects changes of a machine's clock during a run.

use novamind_record::trajectory::record::{Activity, Presence};
use novamind_record::trajectory::{Line, Record};

/// Largest correction of a running clock that is not reported, seconds.
const MAX_CORRECTION_SECONDS: f64 = 2.0;
/// Largest drift between the two clocks that is not reported, seconds per second: the highest rate at which the Linux
/// kernel slews a clock.
const MAX_DRIFT: f64 = 500e-6;

/// Returns the lines before which the wall clock was changed, each with an explanation. The wall clock must
/// not go back between two lines. Between two `session` lines that were written since the same start of the
/// machine, it must advance by as much as the monotonic clock.
pub(super) fn clock_changes<'a>(lines: impl IntoIterator<Item = &'a Line>) -> Vec<(&'a Line, String)> {
    let (mut found, mut before, mut earlier) = (Vec::new(), None::<&Line>, None::<(&Line, &Presence)>);
    let mut is_known = false;
    for line in lines {
        let back = before.replace(line).map_or(0.0, |before| before.at_seconds() - line.at_seconds());
        if back > MAX_CORRECTION_SECONDS {
            found.push((line, format!("the wall clock went back by {back:.0} seconds before this line")));
            is_known = true;
        }
        let Record::Activity(Activity::Session(presence)) = &line.record else { continue };
        if let Some(earlier) = earlier.replace((line, presence.as_ref())).filter(|_| !is_known) {
            found.extend(clock_disagreement(earlier, (line, presence)).map(|words| (line, words)));
        }
        is_known = false;
    }
    found
}

/// Returns an explanation if the wall clock and the monotonic clock disagree between two `session` lines.
fn clock_disagreement(earlier: (&Line, &Presence), later: (&Line, &Presence)) -> Option<String> {
    let ((before, from), (line, to)) = (earlier, later);
    let steady = (to.monotonic_ms as f64 - from.monotonic_ms as f64) / 1e3;
    let ahead = line.at_seconds() - before.at_seconds() - steady;
    if from.boot != to.boot || ahead.abs() <= MAX_CORRECTION_SECONDS + MAX_DRIFT * steady.abs() {
        return None;
    }
    let way = if ahead < 0.0 { "behind" } else { "ahead of" };
    let cause = match ahead < 0.0 {
        true => "the wall clock was set back or slowed",
        false => {
            "the wall clock was set forward, or the monotonic clock stopped while the machine was suspended"
        }
    };
    Some(format!(
        "the wall clock moved {:.0} seconds {way} the monotonic clock since line {}: {cause}",
        ahead.abs(),
        before.seq + 1
    ))
}
