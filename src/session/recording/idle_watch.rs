//! Detects that a user is idle. The console and plain mode use the same rule.

use std::time::Duration;

use super::activity::IDLE_TIMEOUT;
use novamind_record::trajectory::record::PresenceEvent;

/// Tracks the time since the last input: a key in the console, a line in plain mode.
#[derive(Debug, Default)]
pub struct IdleWatch {
    last_input: Duration,
    is_idle: bool,
}

impl IdleWatch {
    /// Starts tracking with the user present.
    pub fn start(&mut self, now: Duration) {
        *self = IdleWatch { last_input: now, is_idle: false };
    }

    /// Handles an input. Returns the event that ends an idle period, with the milliseconds without input.
    pub fn handle_input(&mut self, now: Duration) -> Option<(PresenceEvent, u64)> {
        let idle = millis(now.saturating_sub(self.last_input));
        self.last_input = now;
        std::mem::take(&mut self.is_idle).then_some((PresenceEvent::Active, idle))
    }

    /// Returns the event that starts an idle period if it is due, with the milliseconds without input.
    pub fn check_time(&mut self, now: Duration) -> Option<(PresenceEvent, u64)> {
        let is_due = self.next_deadline().is_some_and(|due| now >= due);
        self.is_idle |= is_due;
        is_due.then(|| (PresenceEvent::Idle, millis(now.saturating_sub(self.last_input))))
    }

    /// Returns the time at which the user becomes idle without input, or `None` if the user is idle.
    pub fn next_deadline(&self) -> Option<Duration> {
        (!self.is_idle).then_some(self.last_input + IDLE_TIMEOUT)
    }
}

fn millis(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn idle_period_lasts_from_one_minute_without_input_to_the_next_input() {
        let at = Duration::from_secs;
        let mut watch = IdleWatch::default();
        watch.start(at(10));
        assert_eq!((watch.handle_input(at(20)), watch.next_deadline()), (None, Some(at(80))));
        assert_eq!(watch.check_time(at(79)), None);
        assert_eq!(watch.check_time(at(80)), Some((PresenceEvent::Idle, 60_000)));
        assert_eq!((watch.check_time(at(99)), watch.next_deadline()), (None, None));
        assert_eq!(watch.handle_input(at(100)), Some((PresenceEvent::Active, 80_000)));
        assert_eq!(watch.handle_input(at(101)), None);
    }
}
