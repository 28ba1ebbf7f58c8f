//! Periodic tasks of the session thread: checking time limits, and repairing the database after a failed write.

use std::time::{Duration, Instant};

use super::{ActiveRun, SessionThread};
use crate::message::Response;
use novamind_session::TimeLeft;

const LIMIT_CHECK_INTERVAL: Duration = Duration::from_secs(1);

/// Time between attempts to repair the database. An attempt may simulate weeks again, so attempts are spaced out.
const REPAIR_INTERVAL: Duration = Duration::from_secs(3);

impl SessionThread {
    pub(super) fn check_time_limits(&mut self) {
        let now = Instant::now();
        if self.next_limit_check.is_none_or(|due| due > now) {
            return;
        }
        self.next_limit_check = Some(now + LIMIT_CHECK_INTERVAL);
        let Some(ActiveRun::Live(session)) = &mut self.active_run else { return };
        let reached = session.activity().check_limits();
        let left = session.log().time_left();
        let minutes: Vec<i64> = left.iter().map(TimeLeft::whole_minutes).collect();
        if minutes != self.minutes_left {
            self.minutes_left = minutes;
            self.send_response(Response::TimeLeft(left));
        }
        reached.into_iter().for_each(|limit| self.send_response(Response::Limit(limit)));
    }

    /// Reports a failed write of the database, once per failure.
    pub(super) fn check_database(&mut self) {
        let Some(ActiveRun::Live(session)) = &self.active_run else { return };
        // Use the last known failure: waiting for the writer would delay the user.
        if self.repair_at.is_none()
            && let Some(problem) = session.database().failure()
        {
            self.repair_at = Some(Instant::now() + REPAIR_INTERVAL);
            self.send_response(Response::DatabaseBehind(problem.0));
        }
    }

    pub(super) fn retry_database_repair(&mut self) {
        if self.repair_at.is_none_or(|due| due > Instant::now()) {
            return;
        }
        let Some(ActiveRun::Live(session)) = &mut self.active_run else { return };
        if session.repair_database().is_err() {
            self.repair_at = Some(Instant::now() + REPAIR_INTERVAL);
            return;
        }
        self.repair_at = None;
        let Some(ActiveRun::Live(session)) = &self.active_run else { return };
        self.queries.connect(session);
        self.send_response(Response::DatabaseCurrent);
    }
}
