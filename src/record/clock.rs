//! Wall clock and monotonic clock for recorded times.
//!
//! A script that plays a session replaces both clocks with a scripted clock. The scripted clock advances only on
//! request, so recorded times are reproducible.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{Duration, Instant};

use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

/// Current time of the scripted clock, in nanoseconds since the Unix epoch; 0 if no scripted clock is active.
static SCRIPTED_TIME_NS: AtomicI64 = AtomicI64::new(0);

/// A clock that a script controls. The scripted clock replaces the wall clock and the monotonic clock of the whole
/// process. The scripted clock advances only through [`ScriptedClock::advance`].
#[derive(Debug)]
pub struct ScriptedClock(());

impl ScriptedClock {
    /// Starts the scripted clock at `moment`, in nanoseconds since the Unix epoch.
    pub fn start(moment: i64) -> ScriptedClock {
        SCRIPTED_TIME_NS.store(moment, Ordering::SeqCst);
        ScriptedClock(())
    }

    /// Advances the scripted clock by `time`.
    pub fn advance(&self, time: Duration) {
        SCRIPTED_TIME_NS.fetch_add(i64::try_from(time.as_nanos()).unwrap_or(0), Ordering::SeqCst);
    }

    /// Returns the current time of the scripted clock, in nanoseconds since the Unix epoch.
    pub fn time_ns(&self) -> i64 {
        SCRIPTED_TIME_NS.load(Ordering::SeqCst)
    }
}

fn scripted_time_ns() -> Option<i64> {
    Some(SCRIPTED_TIME_NS.load(Ordering::SeqCst)).filter(|moment| *moment != 0)
}

/// Returns the current time as an RFC 3339 timestamp.
pub fn now() -> String {
    match scripted_time_ns() {
        Some(moment) => format_timestamp(moment),
        None => OffsetDateTime::now_utc().format(&Rfc3339).unwrap_or_default(),
    }
}

/// Returns the monotonic time since a fixed point in the life of this process.
pub fn monotonic_time() -> Duration {
    static START: OnceLock<Instant> = OnceLock::new();
    scripted_monotonic_time().unwrap_or_else(|| START.get_or_init(Instant::now).elapsed())
}

/// Returns the time since the Unix epoch on the scripted clock, or `None` if no scripted clock is active.
pub fn scripted_monotonic_time() -> Option<Duration> {
    scripted_time_ns().map(|moment| Duration::from_nanos(moment.unsigned_abs()))
}

/// Formats a time, in nanoseconds since the Unix epoch, as an RFC 3339 timestamp.
pub fn format_timestamp(nanoseconds: i64) -> String {
    let moment = OffsetDateTime::from_unix_timestamp_nanos(i128::from(nanoseconds)).ok();
    moment.and_then(|moment| moment.format(&Rfc3339).ok()).unwrap_or_default()
}

/// Converts the RFC 3339 timestamp of a line to nanoseconds since the Unix epoch. Returns 0 if the timestamp is
/// invalid.
pub fn parse_nanoseconds(at: &str) -> i64 {
    let moment = OffsetDateTime::parse(at, &Rfc3339).map_or(0, OffsetDateTime::unix_timestamp_nanos);
    i64::try_from(moment).unwrap_or(0)
}

/// Converts the RFC 3339 timestamp of a line to seconds since the Unix epoch. Returns 0 if the timestamp is invalid.
pub fn parse_seconds(at: &str) -> f64 {
    OffsetDateTime::parse(at, &Rfc3339).map_or(0.0, |moment| moment.unix_timestamp_nanos() as f64 / 1e9)
}
