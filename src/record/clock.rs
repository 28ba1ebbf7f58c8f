//! Where the times of a record come from: the wall clock, and a clock that nobody sets.
//!
//! A script that plays a session has a clock of its own: it stands until the script lets time pass, so that everything a
//! record measures is what the script did.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::{Duration, Instant};

use time::OffsetDateTime;
use time::format_description::well_known::Rfc3339;

/// Moment of a scripted clock, in nanoseconds since 1970; 0 while there is none.
static SCRIPTED: AtomicI64 = AtomicI64::new(0);

/// The clock of a script. It takes the place of both clocks for the whole process, and stands until it is moved on.
#[derive(Debug)]
pub struct ScriptedClock(());

impl ScriptedClock {
    /// Stands at a moment, in nanoseconds since 1970.
    pub fn start(moment: i64) -> ScriptedClock {
        SCRIPTED.store(moment, Ordering::SeqCst);
        ScriptedClock(())
    }

    /// Lets time pass.
    pub fn pass(&self, time: Duration) {
        SCRIPTED.fetch_add(i64::try_from(time.as_nanos()).unwrap_or(0), Ordering::SeqCst);
    }

    /// Where it stands, in nanoseconds since 1970.
    pub fn moment(&self) -> i64 {
        SCRIPTED.load(Ordering::SeqCst)
    }
}

fn scripted() -> Option<i64> {
    Some(SCRIPTED.load(Ordering::SeqCst)).filter(|moment| *moment != 0)
}

/// The present moment, RFC 3339.
pub fn now() -> String {
    match scripted() {
        Some(moment) => written_moment(moment),
        None => OffsetDateTime::now_utc().format(&Rfc3339).unwrap_or_default(),
    }
}

/// Time by the clock that nobody sets, since some moment that stays the same while the program runs.
pub fn steady() -> Duration {
    static BEGAN: OnceLock<Instant> = OnceLock::new();
    scripted_steady().unwrap_or_else(|| BEGAN.get_or_init(Instant::now).elapsed())
}

/// The same of a scripted clock, which is one for all machines.
pub fn scripted_steady() -> Option<Duration> {
    scripted().map(|moment| Duration::from_nanos(moment.unsigned_abs()))
}

/// A moment in nanoseconds since 1970, RFC 3339.
pub fn written_moment(nanoseconds: i64) -> String {
    let moment = OffsetDateTime::from_unix_timestamp_nanos(i128::from(nanoseconds)).ok();
    moment.and_then(|moment| moment.format(&Rfc3339).ok()).unwrap_or_default()
}

/// Nanoseconds since 1970 of a moment of a line; 0 if it cannot be read.
pub fn nanoseconds(at: &str) -> i64 {
    let moment = OffsetDateTime::parse(at, &Rfc3339).map_or(0, OffsetDateTime::unix_timestamp_nanos);
    i64::try_from(moment).unwrap_or(0)
}

/// Seconds since 1970 of a moment of a line.
pub fn seconds(at: &str) -> f64 {
    OffsetDateTime::parse(at, &Rfc3339).map_or(0.0, |moment| moment.unix_timestamp_nanos() as f64 / 1e9)
}
