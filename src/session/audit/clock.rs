//! Whether the clock of a machine was set while a run was played.

use crate::session::trajectory::record::{Activity, Presence};
use crate::session::trajectory::{CLOCK_CORRECTION, Line, Record, clock_went_back};

/// Places where the clock was set: the line, and in words.
pub(super) fn settings_of_clock(lines: &[Line]) -> Vec<(&Line, String)> {
    let words = |back: f64| format!("the clock went back by {back:.0} seconds before this line");
    let mut found: Vec<(&Line, String)> =
        clock_went_back(lines).map(|(_, line, back)| (line, words(back))).collect();
    let sittings: Vec<(&Line, &Presence)> = lines.iter().filter_map(presence).collect();
    for pair in sittings.windows(2) {
        let ((before, earlier), (line, later)) = (pair[0], pair[1]);
        if earlier.boot != later.boot {
            continue;
        }
        let steady = later.monotonic_ms as f64 / 1e3 - earlier.monotonic_ms as f64 / 1e3;
        let off = line.moment() - before.moment() - steady;
        let known = found.iter().any(|(known, _)| (before.seq..=line.seq).contains(&known.seq));
        if off.abs() > CLOCK_CORRECTION && !known {
            let way = if off < 0.0 { "back" } else { "forward" };
            let words =
                format!("the clock was set {way} by {:.0} seconds since line {}", off.abs(), before.seq + 1);
            found.push((line, words));
        }
    }
    found.sort_by_key(|(line, _)| line.seq);
    found
}

fn presence(line: &Line) -> Option<(&Line, &Presence)> {
    match &line.record {
        Record::Activity(Activity::Session(presence)) => Some((line, presence)),
        _ => None,
    }
}
