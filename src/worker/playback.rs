//! Playback on the session thread: opening a recorded run, seeking and playing.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::{ActiveRun, DAY_REPORT_INTERVAL, SessionThread};
use crate::company::DisplayedCompany;
use crate::message::{Message, OpenFallback, PlaybackUpdate, Response};
use crate::request::RecordSource;
use novamind_record::error::RunError;
use novamind_record::folder::runs::{find_run, find_run_to_read};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::DetachCause;
use novamind_session::{Playback, SeekResult, SeekTarget};

const FOLLOW_INTERVAL: Duration = Duration::from_millis(400);

impl SessionThread {
    fn playback(&mut self) -> Option<&mut Playback> {
        match &mut self.active_run {
            Some(ActiveRun::Playback(playback)) => Some(playback),
            _ => None,
        }
    }

    /// Returns the time until the next scheduled task, or `None` if no task is scheduled.
    pub(super) fn time_until_next_task(&mut self) -> Option<Duration> {
        let follows = self.playback().is_some_and(|playback| playback.is_following());
        let next_poll = follows.then(|| self.last_poll + FOLLOW_INTERVAL);
        let next =
            [self.next_week_at, next_poll, self.repair_at, self.next_limit_check].into_iter().flatten().min();
        next.map(|moment| moment.saturating_duration_since(Instant::now()))
    }

    /// Runs due tasks: showing the next week of the playback, polling a followed run, checking time limits and
    /// repairing the database.
    pub(super) fn run_due_tasks(&mut self) {
        self.retry_database_repair();
        self.check_time_limits();
        let now = Instant::now();
        if self.next_week_at.is_some_and(|due| due <= now) {
            self.next_week_at = None;
            let never = AtomicBool::new(false);
            if let Some(arrival) = self.seek_to(SeekTarget::Weeks(1), &never) {
                self.send_response(Response::PlaybackAdvanced(Box::new(arrival)));
            }
        }
        if now.saturating_duration_since(self.last_poll) >= FOLLOW_INTERVAL {
            self.last_poll = now;
            self.poll_followed_run();
        }
    }

    fn poll_followed_run(&mut self) {
        let Some(playback) = self.playback().filter(|playback| playback.is_following()) else { return };
        let at_end = playback.is_at_end();
        let arrival = match playback.poll_new_lines() {
            Ok(false) => return,
            Ok(true) if at_end => self.seek_to(SeekTarget::Last, &AtomicBool::new(false)),
            // The position does not change, but the record has new lines.
            Ok(true) => Some(PlaybackUpdate { company: None, position: playback.position(), problem: None }),
            Err(problem) => {
                let problem = Some(format!("{problem}. The playback no longer follows the run"));
                Some(PlaybackUpdate { company: None, position: playback.position(), problem })
            }
        };
        if let Some(arrival) = arrival {
            self.send_response(Response::PlaybackAdvanced(Box::new(arrival)));
        }
    }

    /// Opens a recorded run and closes the current run. If opening fails, the current run stays open.
    pub(super) fn replay_run(&mut self, recorded: RecordSource, goal: SeekTarget, follow: bool) {
        let id = match &recorded {
            RecordSource::Run(id) => id.clone(),
            RecordSource::File(_) => String::new(),
        };
        let path = match recorded {
            RecordSource::File(path) => Ok(path),
            RecordSource::Run(id) if follow => find_run(&self.runs_folder, &id),
            RecordSource::Run(id) => find_run_to_read(&self.runs_folder, &id),
        };
        let opened = path.and_then(|path| self.open_playback(&path, goal, follow));
        let playback = match opened {
            Ok(playback) => playback,
            Err(problem) => {
                let damaged = matches!(problem, RunError::Damaged { .. }) && !id.is_empty();
                let instead = damaged.then_some(OpenFallback::Recover(id));
                return self.send_response(Response::NotOpened(problem.to_string(), instead));
            }
        };
        // Ignore errors: all confirmed actions are on the disk; only database rows can be missing.
        let _ = self.detach(DetachCause::Quit);
        self.queries.connect(playback.session());
        let company = Arc::new(playback_company(&playback, None));
        let place = playback.position();
        (self.last_company, self.next_week_at, self.inspection_run) = (Some(company.clone()), None, None);
        self.active_run = Some(ActiveRun::Playback(Box::new(playback)));
        self.send_response(Response::PlaybackOpened(company, Box::new(place)));
    }

    fn open_playback(&self, path: &Path, goal: SeekTarget, follow: bool) -> Result<Playback, RunError> {
        let mut playback = Playback::open(path)?;
        if follow {
            playback.start_following();
        }
        let mut instant = Instant::now();
        playback.seek(goal, &mut |day| self.report_day(&mut instant, day))?;
        Ok(playback)
    }

    /// Reports a replayed day, at most once per [`DAY_REPORT_INTERVAL`].
    fn report_day(&self, instant: &mut Instant, day: u32) -> ControlFlow<()> {
        if instant.elapsed() >= DAY_REPORT_INTERVAL {
            *instant = Instant::now();
            let _ = self.messages.send(Message::Response(Response::DaySimulated(day, None)));
        }
        ControlFlow::Continue(())
    }

    pub(super) fn seek(&mut self, goal: SeekTarget, stop: &AtomicBool) {
        self.next_week_at = None;
        if let Some(arrival) = self.seek_to(goal, stop) {
            self.send_response(Response::SeekResult(Box::new(arrival)));
        }
    }

    fn seek_to(&mut self, goal: SeekTarget, stop: &AtomicBool) -> Option<PlaybackUpdate> {
        let Some(ActiveRun::Playback(mut playback)) = self.active_run.take() else { return None };
        let mut instant = Instant::now();
        let went = playback.seek(goal, &mut |day| match stop.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => self.report_day(&mut instant, day),
        });
        // A failed seek also creates a new session.
        let is_new_session = !matches!(went, Ok(SeekResult::Reached | SeekResult::Stopped));
        if is_new_session {
            self.queries.connect(playback.session());
        }
        let before = self.last_company.take().filter(|_| !is_new_session);
        let company = Arc::new(playback_company(&playback, before.as_deref()));
        self.last_company = Some(company.clone());
        let place = playback.position();
        self.active_run = Some(ActiveRun::Playback(playback));
        let problem = match went {
            Ok(SeekResult::Stopped) => Some("seeking stopped".to_owned()),
            Ok(_) => None,
            Err(error) => Some(error.to_string()),
        };
        Some(PlaybackUpdate { company: Some(company), position: place, problem })
    }

    pub(super) fn take_over(&mut self, mode: Mode) {
        let Some(playback) = self.playback() else { return };
        let branch = playback.create_branch(mode);
        let parent = playback.session().manifest().id.clone();
        match branch {
            Ok(session) => {
                let (text, day) = (session.manifest().id.clone(), session.day());
                let remark = format!("now playing run {text} from day {day}; run {parent} is unchanged");
                self.show_opened_run(Ok(session), "", Some(remark));
            }
            Err(rejection) => self.send_response(Response::NotOpened(rejection.to_string(), None)),
        }
    }
}

/// Returns the company at a position of a playback. Notes that were written after this position are excluded.
fn playback_company(playback: &Playback, before: Option<&DisplayedCompany>) -> DisplayedCompany {
    let memo = playback.notes().unwrap_or_default();
    let can_inspect = playback.can_inspect();
    DisplayedCompany {
        notes: memo,
        is_playback: true,
        can_inspect,
        ..DisplayedCompany::update_from_session(playback.session(), before)
    }
}
