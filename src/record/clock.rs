//! Time sources of the record: the wall clock and the monotonic clock.
//!
//! A script that plays a session replaces both with a clock that advances only on request, so that recorded times are
//! reproducible.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{Duration, Instant};

use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

/// Moment of the scripted clock, in nanoseconds since 1970; 0 if there is none.
static SCRIPTED: AtomicI64 = AtomicI64::new(0);

/// The clock of a script. It replaces both clocks for the whole process and advances only through [`ScriptedClock::pass`].
#[derive(Debug)]
pub struct ScriptedClock(());

impl ScriptedClock {
    /// Starts the clock at a moment, in nanoseconds since 1970.
    pub fn start(moment: i64) -> ScriptedClock {
        SCRIPTED.store(moment, Ordering::SeqCst);
        ScriptedClock(())
    }

    /// Advances the clock.
    pub fn pass(&self, time: Duration) {
        SCRIPTED.fetch_add(i64::try_from(time.as_nanos()).unwrap_or(0), Ordering::SeqCst);
    }

    /// Returns the current moment, in nanoseconds since 1970.
    pub fn moment(&self) -> i64 {
        SCRIPTED.load(Ordering::SeqCst)
    }
}

fn scripted() -> Option<i64> {
    Some(SCRIPTED.load(Ordering::SeqCst)).filter(|moment| *moment != 0)
}

/// Returns the current moment in RFC 3339.
pub fn now() -> String {
    match scripted() {
        Some(moment) => written_moment(moment),
        None => OffsetDateTime::now_utc().format(&Rfc3339).unwrap_or_default(),
    }
}

/// Returns the monotonic time since a fixed moment of this process.
pub fn steady() -> Duration {
    static BEGAN: OnceLock<Instant> = OnceLock::new();
    scripted_steady().unwrap_or_else(|| BEGAN.get_or_init(Instant::now).elapsed())
}

/// Returns the time of the scripted clock since 1970, or `None` if no scripted clock is active.
pub fn scripted_steady() -> Option<Duration> {
    scripted().map(|moment| Duration::from_nanos(moment.unsigned_abs()))
}

/// Formats nanoseconds since 1970 in RFC 3339.
pub fn written_moment(nanoseconds: i64) -> String {
    let moment = OffsetDateTime::from_unix_timestamp_nanos(i128::from(nanoseconds)).ok();
    moment.and_then(|moment| moment.format(&Rfc3339).ok()).unwrap_or_default()
}

/// Parses the moment of a line to nanoseconds since 1970. Returns 0 if it cannot be parsed.
pub fn nanoseconds(at: &str) -> i64 {
    let moment = OffsetDateTime::parse(at, &Rfc3339).map_or(0, OffsetDateTime::unix_timestamp_nanos);
    i64::try_from(moment).unwrap_or(0)
}

/// Parses the moment of a line to seconds since 1970. Returns 0 if it cannot be parsed.
pub fn seconds(at: &str) -> f64 {
    OffsetDateTime::parse(at, &Rfc3339).map_or(0.0, |moment| moment.unix_timestamp_nanos() as f64 / 1e9)
}
