//! User presence: the last key, the window focus and the window size.

use std::time::Duration;

use novamind_record::trajectory::record::PresenceEvent;
use novamind_session::IdleWatch;

/// A new window size is recorded after the size has been stable for this long.
const RESIZE_DELAY: Duration = Duration::from_secs(1);

/// An event to record: its kind, milliseconds without input, and the window size.
pub type PresenceRecord = (PresenceEvent, Option<u64>, Option<(u16, u16)>);

/// Determines from input and window events whether the user is present.
#[derive(Debug, Default)]
pub struct PresenceWatch {
    idle: IdleWatch,
    unfocused: bool,
    /// The new window size and the time of the change.
    resized: Option<((u16, u16), Duration)>,
}

impl PresenceWatch {
    /// Starts tracking with the user present.
    pub fn start(&mut self, now: Duration) {
        *self = PresenceWatch::default();
        self.idle.start(now);
    }

    /// Handles a key, a paste or mouse input. The mouse can be used over a window without focus.
    pub fn handle_input(&mut self, by_mouse: bool, now: Duration) -> Vec<PresenceRecord> {
        let active = self.idle.handle_input(now).map(|(event, idle_ms)| (event, Some(idle_ms), None));
        // Some terminals do not report regained focus, so key input counts as regained focus.
        let focus = if by_mouse { None } else { self.set_focus(true) };
        focus.into_iter().chain(active).collect()
    }

    /// Handles a focus change. Returns an event if the focus changed.
    pub fn set_focus(&mut self, has: bool) -> Option<PresenceRecord> {
        let changed = self.unfocused == has;
        self.unfocused = !has;
        let event = if has { PresenceEvent::FocusGained } else { PresenceEvent::FocusLost };
        changed.then_some((event, None, None))
    }

    /// Handles a new window size.
    pub fn set_window(&mut self, window: (u16, u16), now: Duration) {
        self.resized = Some((window, now));
    }

    /// Returns the presence events that are due at the given time.
    pub fn check_time(&mut self, now: Duration) -> Vec<PresenceRecord> {
        let mut noted = Vec::new();
        if let Some((window, _)) = self.resized.take_if(|(_, since)| now >= *since + RESIZE_DELAY) {
            noted.push((PresenceEvent::Resized, None, Some(window)));
        }
        noted.extend(self.idle.check_time(now).map(|(event, idle_ms)| (event, Some(idle_ms), None)));
        noted
    }

    /// Returns the time at which the next presence event is due if there is no input.
    pub fn next_deadline(&self) -> Option<Duration> {
        let idle = self.idle.next_deadline();
        let resized = self.resized.map(|(_, since)| since + RESIZE_DELAY);
        [idle, resized].into_iter().flatten().min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn idle_period_lasts_from_one_minute_without_input_to_the_next_key() {
        let at = Duration::from_secs;
        let mut watch = PresenceWatch::default();
        watch.start(at(10));
        assert_eq!((watch.handle_input(false, at(20)), watch.next_deadline()), (Vec::new(), Some(at(80))));
        assert_eq!(watch.check_time(at(79)), []);
        assert_eq!(watch.check_time(at(80)), [(PresenceEvent::Idle, Some(60_000), None)]);
        assert_eq!((watch.check_time(at(99)), watch.next_deadline()), (Vec::new(), None));
        assert_eq!(watch.handle_input(false, at(100)), [(PresenceEvent::Active, Some(80_000), None)]);
        assert_eq!(watch.handle_input(false, at(101)), []);
    }

    #[test]
    fn resizing_is_recorded_once() {
        let at = Duration::from_millis;
        let mut watch = PresenceWatch::default();
        watch.start(at(0));
        watch.set_window((90, 30), at(100));
        watch.set_window((100, 30), at(300));
        assert_eq!((watch.check_time(at(1200)), watch.next_deadline()), (Vec::new(), Some(at(1300))));
        assert_eq!(watch.check_time(at(1300)), [(PresenceEvent::Resized, None, Some((100, 30)))]);
    }

    #[test]
    fn focus_gain_requires_a_previous_loss() {
        let mut watch = PresenceWatch::default();
        assert_eq!(watch.set_focus(true), None);
        assert!(
            watch.set_focus(false).is_some()
                && watch.set_focus(false).is_none()
                && watch.set_focus(true).is_some()
        );
        watch.set_focus(false);
        assert_eq!(watch.handle_input(true, Duration::ZERO), []);
        assert_eq!(watch.handle_input(false, Duration::ZERO), [(PresenceEvent::FocusGained, None, None)]);
    }
}
