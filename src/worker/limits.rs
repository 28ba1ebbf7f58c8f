//! The session's thread with time limits: it looks at them every second while the rules have some.

use std::time::{Duration, Instant};

use super::{Open, SessionThread};
use crate::message::News;
use novamind_session::TimeLeft;

const BETWEEN_LOOKS: Duration = Duration::from_secs(1);

impl SessionThread {
    /// Looks at the limits when it is time.
    pub(super) fn look_at_limits(&mut self) {
        let now = Instant::now();
        if self.limits.is_none_or(|due| due > now) {
            return;
        }
        self.limits = Some(now + BETWEEN_LOOKS);
        let Some(Open::Played(session)) = &mut self.open else { return };
        let reached = session.activity().check_limits();
        let left = session.log().time_left();
        let minutes: Vec<i64> = left.iter().map(TimeLeft::whole_minutes).collect();
        if minutes != self.minutes_left {
            self.minutes_left = minutes;
            self.say(News::TimeLeft(left));
        }
        reached.into_iter().for_each(|limit| self.say(News::Limit(limit)));
    }
}
