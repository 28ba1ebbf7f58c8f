//! A stopwatch for active time, which is paused while the clock is stopped and while the program is suspended.

use std::time::Duration;

use novamind_record::clock::monotonic_time;

/// A stopwatch that can be paused. All recorded durations are measured with a stopwatch of this type.
#[derive(Debug)]
pub struct Stopwatch {
    started_at: Duration,
    /// Active time that passed before `since`.
    elapsed_before: Duration,
    halted: bool,
}

impl Default for Stopwatch {
    fn default() -> Self {
        Stopwatch { started_at: monotonic_time(), elapsed_before: Duration::ZERO, halted: false }
    }
}

impl Stopwatch {
    /// Returns the time that has passed while the stopwatch was running.
    pub fn elapsed(&self) -> Duration {
        if self.halted {
            self.elapsed_before
        } else {
            self.elapsed_before + monotonic_time().saturating_sub(self.started_at)
        }
    }

    /// Pauses the stopwatch.
    pub fn pause(&mut self) {
        (self.elapsed_before, self.halted) = (self.elapsed(), true);
    }

    /// Resumes the stopwatch.
    pub fn resume(&mut self) {
        if self.halted {
            (self.started_at, self.halted) = (monotonic_time(), false);
        }
    }

    /// Returns whether the stopwatch is paused.
    pub fn is_paused(&self) -> bool {
        self.halted
    }

    /// Advances the stopwatch without waiting, for tests.
    pub fn advance(&mut self, by: Duration) {
        if !self.halted {
            self.elapsed_before += by;
        }
    }
}

/// Converts a duration to whole milliseconds.
pub fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paused_stopwatch_does_not_advance() {
        let mut watch = Stopwatch::default();
        watch.advance(Duration::from_secs(5));
        watch.pause();
        let stood = watch.elapsed();
        watch.advance(Duration::from_secs(100));
        assert_eq!(watch.elapsed(), stood);
        watch.resume();
        watch.advance(Duration::from_secs(1));
        assert!(
            watch.elapsed() >= stood + Duration::from_secs(1)
                && watch.elapsed() < stood + Duration::from_secs(60)
        );
    }
}
