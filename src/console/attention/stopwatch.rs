//! Active time: paused while the clock is stopped and while the program is suspended.

use std::time::Duration;

use novamind_record::clock::steady;

/// A stopwatch that can be paused. All recorded durations are measured with it.
#[derive(Debug)]
pub struct Stopwatch {
    since: Duration,
    /// Time that passed before `since`.
    before: Duration,
    halted: bool,
}

impl Default for Stopwatch {
    fn default() -> Self {
        Stopwatch { since: steady(), before: Duration::ZERO, halted: false }
    }
}

impl Stopwatch {
    /// Returns the time that has passed while it was running.
    pub fn now(&self) -> Duration {
        if self.halted { self.before } else { self.before + steady().saturating_sub(self.since) }
    }

    /// Pauses it.
    pub fn halt(&mut self) {
        (self.before, self.halted) = (self.now(), true);
    }

    /// Resumes it.
    pub fn run(&mut self) {
        if self.halted {
            (self.since, self.halted) = (steady(), false);
        }
    }

    /// Returns whether it is paused.
    pub fn is_halted(&self) -> bool {
        self.halted
    }

    /// Advances it without waiting, for tests.
    pub fn turn_on(&mut self, by: Duration) {
        if !self.halted {
            self.before += by;
        }
    }
}

/// Converts a duration to whole milliseconds.
pub fn ms(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_time_passes_while_it_is_halted() {
        let mut watch = Stopwatch::default();
        watch.turn_on(Duration::from_secs(5));
        watch.halt();
        let stood = watch.now();
        watch.turn_on(Duration::from_secs(100));
        assert_eq!(watch.now(), stood);
        watch.run();
        watch.turn_on(Duration::from_secs(1));
        assert!(
            watch.now() >= stood + Duration::from_secs(1) && watch.now() < stood + Duration::from_secs(60)
        );
    }
}
