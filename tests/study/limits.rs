//! Time limits while a participant leaves and returns, with a controlled clock and in both interfaces: however the
//! participant leaves, nothing is gained.

use std::path::{Path, PathBuf};
use std::time::Duration;

use novamind::record::clock::{ScriptedClock, parse_nanoseconds};
use novamind::record::consent::{ConsentDetails, ConsentMeans};
use novamind::record::folder::configuration::Configuration;
use novamind::record::trajectory::Trajectory;
use novamind::record::trajectory::record::{DetachCause, LimitEvent, LimitScope};
use novamind::session::{Attendance, Interface, Session};
use novamind::study::ParticipantSession;

use crate::CLOCK;
use crate::lab::StudyLab;

/// A participant's run with a limit of ten minutes per week.
struct LimitedRun<'a> {
    visit: ParticipantSession,
    folder: PathBuf,
    session: Option<Session>,
    interface: Interface,
    clock: &'a ScriptedClock,
}

impl<'a> LimitedRun<'a> {
    fn begin(lab: &StudyLab, label: &str, name: &'static str, clock: &'a ScriptedClock) -> LimitedRun<'a> {
        let visit =
            ParticipantSession::start(lab.read_study(), &lab.machine(name), label, 0).expect("a valid label");
        let consent = ConsentDetails { means: ConsentMeans::Prompt, scrolled_to_end: true, read_ms: 1 };
        let session = visit.create_run(false, Some(consent.agree_now()), &Configuration::bundled());
        let mut session = session.expect("a run");
        let interface = Interface { name, window: None };
        session.activity().attach(interface);
        let folder = visit.runs().join(&session.manifest().id);
        LimitedRun { visit, folder, session: Some(session), interface, clock }
    }

    fn session(&mut self) -> &mut Session {
        self.session.as_mut().expect("the run is open")
    }

    fn wait(&self, seconds: u64) {
        self.clock.advance(Duration::from_secs(seconds));
    }

    /// Leaves with a cause, or is killed without one, stays away, and returns.
    fn leave(&mut self, cause: Option<DetachCause>, seconds: u64) {
        if let Some(cause) = cause {
            self.session().activity().detach(cause);
        }
        self.session = None;
        self.wait(seconds);
        let mut session = self.visit.open_run(&self.folder).expect("it opens");
        session.activity().attach(self.interface);
        self.session = Some(session);
    }

    /// Returns the seconds left for the week.
    fn seconds_left(&mut self) -> f64 {
        let left = self.session().log().time_left();
        left.iter().find(|left| left.scope == LimitScope::Week).expect("a limit").seconds
    }

    fn events(&mut self) -> Vec<LimitEvent> {
        self.session().activity().check_limits().into_iter().map(|limit| limit.event).collect()
    }
}

/// Returns active and away seconds in the tables.
fn active_and_away(folder: &Path) -> (f64, f64) {
    let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("it reads");
    let attendance = Attendance::from_lines(&trajectory.lines);
    let spent = attendance.spent_between(0, attendance.end_ns());
    (spent.active_seconds(), spent.away_seconds())
}

#[test]
fn leaving_and_returning_gains_no_time() {
    let _clock = CLOCK.lock();
    let lab = StudyLab::new();
    let clock = ScriptedClock::start(parse_nanoseconds("2026-03-02T09:00:00Z"));
    let causes = [None, Some(DetachCause::Quit), Some(DetachCause::Hangup), Some(DetachCause::Signal)];
    for (number, cause) in causes.into_iter().enumerate() {
        for (name, offset) in [("console", 1), ("plain", 5)] {
            let about = format!("{cause:?} in {name}");
            let mut run = LimitedRun::begin(&lab, &format!("P{:02}", number + offset), name, &clock);
            run.wait(120);
            assert_eq!(run.seconds_left(), 480.0, "{about}");
            // The participant closes the window to think for three minutes.
            run.leave(cause, 180);
            assert_eq!(run.seconds_left(), 300.0, "{about}");
            // Pausing is the only way to stop the limit, also while the program is closed.
            run.session().activity().stop_clock(Some("tea")).expect("it stops");
            run.leave(cause, 500);
            assert_eq!(run.seconds_left(), 300.0, "{about}");
            // A break of half an hour does not count, except the unrecorded minute before a kill.
            run.leave(cause, 1800);
            let unseen = if cause.is_none() { 60.0 } else { 0.0 };
            assert_eq!(run.seconds_left(), 300.0 - unseen, "{about}");
            run.leave(cause, 240);
            assert_eq!(
                run.events(),
                if cause.is_none() { [LimitEvent::FiledNaively] } else { [LimitEvent::Warned] }
            );
            // After a kill at the moment of the limit, the limit takes effect again.
            run.leave(None, 70);
            assert_eq!(run.events(), [LimitEvent::FiledNaively], "{about}");
            let (active, away) = active_and_away(&run.folder);
            assert_eq!(active + away, 120.0 + 180.0 + 500.0 + 1800.0 + 240.0 + 70.0, "{about}");
            // The two minutes before a kill are away too, because the record does not show when the program ended.
            assert_eq!(active, if cause.is_none() { 0.0 } else { 120.0 }, "{about}");
        }
    }
}
