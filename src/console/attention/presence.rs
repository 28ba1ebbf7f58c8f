//! User presence: the last key, the window focus and the window size.

use std::time::Duration;

use super::stopwatch::ms;
use novamind_record::trajectory::record::PresenceEvent;
use novamind_session::IDLE_AFTER;

/// A window size is recorded after it has been stable for this long.
const SETTLED: Duration = Duration::from_secs(1);

/// An event to record: its kind, milliseconds without input, and the window size.
pub type Noted = (PresenceEvent, Option<u64>, Option<(u16, u16)>);

/// Tracks input and window events.
#[derive(Debug, Default)]
pub struct PresenceWatch {
    last_key: Duration,
    idle: bool,
    unfocused: bool,
    /// The new window size, and since when.
    resized: Option<((u16, u16), Duration)>,
}

impl PresenceWatch {
    /// Starts tracking with the user present.
    pub fn begin(&mut self, now: Duration) {
        *self = PresenceWatch { last_key: now, ..PresenceWatch::default() };
    }

    /// Handles a key, a paste or mouse input. The mouse can be used over a window without focus.
    pub fn key(&mut self, by_mouse: bool, now: Duration) -> Vec<Noted> {
        let idle = ms(now.saturating_sub(self.last_key));
        self.last_key = now;
        // Some terminals do not report regained focus; key input implies it.
        let focus = if by_mouse { None } else { self.focus(true) };
        let active = std::mem::take(&mut self.idle).then_some((PresenceEvent::Active, Some(idle), None));
        focus.into_iter().chain(active).collect()
    }

    /// Handles a focus change. Returns an event if the focus changed.
    pub fn focus(&mut self, has: bool) -> Option<Noted> {
        let changed = self.unfocused == has;
        self.unfocused = !has;
        let event = if has { PresenceEvent::FocusGained } else { PresenceEvent::FocusLost };
        changed.then_some((event, None, None))
    }

    /// Handles a new window size.
    pub fn resize(&mut self, window: (u16, u16), now: Duration) {
        self.resized = Some((window, now));
    }

    /// Returns the events that are due at a time.
    pub fn pass(&mut self, now: Duration) -> Vec<Noted> {
        let mut noted = Vec::new();
        if let Some((window, _)) = self.resized.take_if(|(_, since)| now >= *since + SETTLED) {
            noted.push((PresenceEvent::Resized, None, Some(window)));
        }
        if !self.idle && now >= self.last_key + IDLE_AFTER {
            self.idle = true;
            noted.push((PresenceEvent::Idle, Some(ms(now.saturating_sub(self.last_key))), None));
        }
        noted
    }

    /// Returns when the next event is due without input.
    pub fn next(&self) -> Option<Duration> {
        let idle = (!self.idle).then_some(self.last_key + IDLE_AFTER);
        let resized = self.resized.map(|(_, since)| since + SETTLED);
        [idle, resized].into_iter().flatten().min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn idleness_begins_after_a_minute_and_ends_with_a_key() {
        let at = Duration::from_secs;
        let mut watch = PresenceWatch::default();
        watch.begin(at(10));
        assert_eq!((watch.key(false, at(20)), watch.next()), (Vec::new(), Some(at(80))));
        assert_eq!(watch.pass(at(79)), []);
        assert_eq!(watch.pass(at(80)), [(PresenceEvent::Idle, Some(60_000), None)]);
        assert_eq!((watch.pass(at(99)), watch.next()), (Vec::new(), None));
        assert_eq!(watch.key(false, at(100)), [(PresenceEvent::Active, Some(80_000), None)]);
        assert_eq!(watch.key(false, at(101)), []);
    }

    #[test]
    fn a_window_that_is_dragged_is_recorded_once() {
        let at = Duration::from_millis;
        let mut watch = PresenceWatch::default();
        watch.begin(at(0));
        watch.resize((90, 30), at(100));
        watch.resize((100, 30), at(300));
        assert_eq!((watch.pass(at(1200)), watch.next()), (Vec::new(), Some(at(1300))));
        assert_eq!(watch.pass(at(1300)), [(PresenceEvent::Resized, None, Some((100, 30)))]);
    }

    #[test]
    fn a_focus_that_was_not_lost_is_not_gained() {
        let mut watch = PresenceWatch::default();
        assert_eq!(watch.focus(true), None);
        assert!(watch.focus(false).is_some() && watch.focus(false).is_none() && watch.focus(true).is_some());
        watch.focus(false);
        assert_eq!(watch.key(true, Duration::ZERO), []);
        assert_eq!(watch.key(false, Duration::ZERO), [(PresenceEvent::FocusGained, None, None)]);
    }
}
