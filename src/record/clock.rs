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
static SCRIPTED_MOMENT: AtomicI64 = AtomicI64::new(0);

/// The clock of a script. It replaces both clocks for the whole process and advances only through [`ScriptedClock::advance`].
#[derive(Debug)]
pub struct ScriptedClock(());

impl ScriptedClock {
    /// Starts the clock at a moment, in nanoseconds since 1970.
    pub fn start(moment: i64) -> ScriptedClock {
        SCRIPTED_MOMENT.store(moment, Ordering::SeqCst);
        ScriptedClock(())
    }

    /// Advances the clock.
    pub fn advance(&self, time: Duration) {
        SCRIPTED_MOMENT.fetch_add(i64::try_from(time.as_nanos()).unwrap_or(0), Ordering::SeqCst);
    }

    /// Returns the current moment, in nanoseconds since 1970.
    pub fn moment(&self) -> i64 {
        SCRIPTED_MOMENT.load(Ordering::SeqCst)
    }
}

fn scripted_moment() -> Option<i64> {
    Some(SCRIPTED_MOMENT.load(Ordering::SeqCst)).filter(|moment| *moment != 0)
}

/// Returns the current moment in RFC 3339.
pub fn now() -> String {
    match scripted_moment() {
        Some(moment) => format_moment(moment),
        None => OffsetDateTime::now_utc().format(&Rfc3339).unwrap_or_default(),
    }
}

/// Returns the monotonic time since a fixed moment of this process.
pub fn monotonic_time() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    scripted_monotonic_time().unwrap_or_else(|| START.get_or_init(Instant::now).elapsed())
}

/// Returns the time of the scripted clock since 1970, or `None` if no scripted clock is active.
pub fn scripted_monotonic_time() -> Option<Duration> {
    scripted_moment().map(|moment| Duration::from_nanos(moment.unsigned_abs()))
}

/// Formats nanoseconds since 1970 in RFC 3339.
pub fn format_moment(nanoseconds: i64) -> String {
    let moment = OffsetDateTime::from_unix_timestamp_nanos(i128::from(nanoseconds)).ok();
    moment.and_then(|moment| moment.format(&Rfc3339).ok()).unwrap_or_default()
}

/// Parses the moment of a line to nanoseconds since 1970. Returns 0 if it cannot be parsed.
pub fn parse_nanoseconds(at: &str) -> i64 {
    let moment = OffsetDateTime::parse(at, &Rfc3339).map_or(0, OffsetDateTime::unix_timestamp_nanos);
    i64::try_from(moment).unwrap_or(0)
}

/// Parses the moment of a line to seconds since 1970. Returns 0 if it cannot be parsed.
pub fn parse_seconds(at: &str) -> f64 {
    OffsetDateTime::parse(at, &Rfc3339).map_or(0.0, |moment| moment.unix_timestamp_nanos() as f64 / 1e9)
}
