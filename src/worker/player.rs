//! Playback on the session thread: opening a recorded run, seeking, and playing.

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::{BETWEEN_DAYS, Open, SessionThread};
use crate::company::Company;
use crate::message::{Arrival, Instead, Message, News};
use crate::request::Recorded;
use novamind_record::error::RunError;
use novamind_record::folder::runs::{find_run, find_run_to_read};
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::LeavingCause;
use novamind_session::{Goal, Playback, SeekResult};

const BETWEEN_LOOKS: Duration = Duration::from_millis(400);

impl SessionThread {
    fn playback(&mut self) -> Option<&mut Playback> {
        match &mut self.open {
            Some(Open::Replayed(playback)) => Some(playback),
            _ => None,
        }
    }

    /// Returns the time until the next scheduled task, or `None` if none is scheduled.
    pub(super) fn patience(&mut self) -> Option<Duration> {
        let follows = self.playback().is_some_and(|playback| playback.follows());
        let look = follows.then(|| self.looked + BETWEEN_LOOKS);
        let next = [self.due, look, self.mending, self.limits].into_iter().flatten().min();
        next.map(|moment| moment.saturating_duration_since(Instant::now()))
    }

    /// Runs due tasks: the next week of the playback, polling of a followed run, repair of the database.
    pub(super) fn go_on(&mut self) {
        self.mend();
        self.look_at_limits();
        let now = Instant::now();
        if self.due.is_some_and(|due| due <= now) {
            self.due = None;
            let never = AtomicBool::new(false);
            if let Some(arrival) = self.arrive(Goal::Weeks(1), &never) {
                self.say(News::WentOn(Box::new(arrival)));
            }
        }
        if now.saturating_duration_since(self.looked) >= BETWEEN_LOOKS {
            self.looked = now;
            self.look_for_more();
        }
    }

    fn look_for_more(&mut self) {
        let Some(playback) = self.playback().filter(|playback| playback.follows()) else { return };
        let at_end = playback.at_end();
        let arrival = match playback.look_for_more() {
            Ok(false) => return,
            Ok(true) if at_end => self.arrive(Goal::Last, &AtomicBool::new(false)),
            // The position stays, and the record grows.
            Ok(true) => Some(Arrival { company: None, place: playback.place(), problem: None }),
            Err(problem) => {
                let problem = Some(format!("{problem}. No longer following the run"));
                Some(Arrival { company: None, place: playback.place(), problem })
            }
        };
        if let Some(arrival) = arrival {
            self.say(News::WentOn(Box::new(arrival)));
        }
    }

    /// Opens a recorded run and closes the current one, which stays open if that fails.
    pub(super) fn replay(&mut self, recorded: Recorded, goal: Goal, follow: bool) {
        let id = match &recorded {
            Recorded::Run(id) => id.clone(),
            Recorded::File(_) => String::new(),
        };
        let path = match recorded {
            Recorded::File(path) => Ok(path),
            Recorded::Run(id) if follow => find_run(&self.runs, &id),
            Recorded::Run(id) => find_run_to_read(&self.runs, &id),
        };
        let opened = path.and_then(|path| self.open_playback(&path, goal, follow));
        let playback = match opened {
            Ok(playback) => playback,
            Err(problem) => {
                let damaged = matches!(problem, RunError::Damaged { .. }) && !id.is_empty();
                let instead = damaged.then_some(Instead::Rescue(id));
                return self.say(News::NotOpened(problem.to_string(), instead));
            }
        };
        // All confirmed actions are on disk; only derived rows can be missing.
        let _ = self.put_down(LeavingCause::Quit);
        self.queries.connect(playback.session());
        let company = Arc::new(company_of(&playback, None));
        let place = playback.place();
        (self.company, self.due, self.inside) = (Some(company.clone()), None, None);
        self.open = Some(Open::Replayed(Box::new(playback)));
        self.say(News::Replays(company, Box::new(place)));
    }

    fn open_playback(&self, path: &Path, goal: Goal, follow: bool) -> Result<Playback, RunError> {
        let mut playback = Playback::open(path)?;
        if follow {
            playback.follow();
        }
        let mut told = Instant::now();
        playback.go(goal, &mut |day| self.tell(&mut told, day))?;
        Ok(playback)
    }

    /// Reports a day, with a minimum interval.
    fn tell(&self, told: &mut Instant, day: u32) -> ControlFlow<()> {
        if told.elapsed() >= BETWEEN_DAYS {
            *told = Instant::now();
            let _ = self.news.send(Message::News(News::Day(day, None)));
        }
        ControlFlow::Continue(())
    }

    pub(super) fn go(&mut self, goal: Goal, stop: &AtomicBool) {
        self.due = None;
        if let Some(arrival) = self.arrive(goal, stop) {
            self.say(News::SeekResult(Box::new(arrival)));
        }
    }

    fn arrive(&mut self, goal: Goal, stop: &AtomicBool) -> Option<Arrival> {
        let Some(Open::Replayed(mut playback)) = self.open.take() else { return None };
        let mut told = Instant::now();
        let went = playback.go(goal, &mut |day| match stop.load(Ordering::Relaxed) {
            true => ControlFlow::Break(()),
            false => self.tell(&mut told, day),
        });
        // Errors during seeking have created a new session, too.
        let anew = !matches!(went, Ok(SeekResult::There | SeekResult::Stopped));
        if anew {
            self.queries.connect(playback.session());
        }
        let before = self.company.take().filter(|_| !anew);
        let company = Arc::new(company_of(&playback, before.as_deref()));
        self.company = Some(company.clone());
        let place = playback.place();
        self.open = Some(Open::Replayed(playback));
        let problem = match went {
            Ok(SeekResult::Stopped) => Some("seeking stopped".to_owned()),
            Ok(_) => None,
            Err(error) => Some(error.to_string()),
        };
        Some(Arrival { company: Some(company), place, problem })
    }

    pub(super) fn take_over(&mut self, mode: Mode) {
        let Some(playback) = self.playback() else { return };
        let branch = playback.take_over(mode);
        let parent = playback.session().manifest().id.clone();
        match branch {
            Ok(session) => {
                let (own, day) = (session.manifest().id.clone(), session.day());
                let remark = format!("now playing run {own} from day {day}; run {parent} is unchanged");
                self.take(Ok(session), "", Some(remark));
            }
            Err(refusal) => self.say(News::NotOpened(refusal.to_string(), None)),
        }
    }
}

/// Returns the company at a position. Notes that were written later are excluded.
fn company_of(playback: &Playback, before: Option<&Company>) -> Company {
    let memo = playback.memo().unwrap_or_default();
    let may_look_inside = playback.may_look_inside();
    Company { memo, replayed: true, may_look_inside, ..Company::after(playback.session(), before) }
}
