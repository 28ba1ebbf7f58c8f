//! Time of a run by kind: active, idle, away. Tables and time limits use this definition.
//!
//! Time passes between two lines. `session` and `clock` lines define its kind. Before the first of them, and in runs
//! without them, a gap of more than ten minutes is a break. Time in which the program simulates days or waits for a
//! language model does not count. All times are whole nanoseconds, so that sums are exact.

use serde::ser::{Serialize, SerializeStruct, Serializer};

use novamind_record::trajectory::record::{Activity, ClockEvent, LimitScope, Presence, PresenceEvent};
use novamind_record::trajectory::{Line, Record};

/// Without `session` lines, a gap of more than this many seconds is a break: ten minutes.
pub const BREAK_SECONDS: f64 = 600.0;

const BREAK: i64 = BREAK_SECONDS as i64 * SECOND;
const SECOND: i64 = 1_000_000_000;
const MILLISECOND: i64 = 1_000_000;

/// The interface that watches every key and records idle times.
pub(super) const WATCHES_KEYS: &str = "console";

/// How a participant spent a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Attention {
    /// Playing.
    Active,
    /// Answering questions of the study.
    Answering,
    /// Idle: no key was pressed, or, if keys are not watched, no line was written for more than ten minutes.
    Idle,
    /// Away: the run was not open or was suspended, or another window had the focus.
    Away,
    /// The clock was stopped.
    Paused,
    /// The program simulated days.
    Simulating,
}

/// Time by kind.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TimeSpent {
    active: i64,
    answering: i64,
    idle: i64,
    /// Nanoseconds away, including those with a stopped clock.
    away: i64,
    paused: i64,
}

impl TimeSpent {
    /// Returns the seconds of playing, to the millisecond.
    pub fn active_seconds(&self) -> f64 {
        to_seconds(self.active)
    }

    /// Returns the seconds of answering questions, to the millisecond.
    pub fn answering_seconds(&self) -> f64 {
        to_seconds(self.answering)
    }

    /// Returns the idle seconds, to the millisecond.
    pub fn idle_seconds(&self) -> f64 {
        to_seconds(self.idle)
    }

    /// Returns the seconds away, including those with a stopped clock, to the millisecond.
    pub fn away_seconds(&self) -> f64 {
        to_seconds(self.away)
    }

    /// Returns the seconds with a stopped clock, to the millisecond.
    pub fn paused_seconds(&self) -> f64 {
        to_seconds(self.paused)
    }

    /// Returns the seconds of all kinds, to the millisecond.
    pub fn elapsed_seconds(&self) -> f64 {
        to_seconds(self.active + self.answering + self.idle + self.away)
    }

    /// Returns the milliseconds of playing, as time limits count them.
    pub fn active_ms(&self) -> u64 {
        (self.active / MILLISECOND).max(0) as u64
    }

    fn add(&mut self, attention: Attention, passed: i64) {
        match attention {
            Attention::Active => self.active += passed,
            Attention::Answering => self.answering += passed,
            Attention::Idle => self.idle += passed,
            Attention::Away => self.away += passed,
            Attention::Paused => {
                self.away += passed;
                self.paused += passed;
            }
            Attention::Simulating => {}
        }
    }
}

impl Serialize for TimeSpent {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("TimeSpent", 6)?;
        fields.serialize_field("elapsed_seconds", &self.elapsed_seconds())?;
        fields.serialize_field("active_seconds", &self.active_seconds())?;
        fields.serialize_field("answering_seconds", &self.answering_seconds())?;
        fields.serialize_field("idle_seconds", &self.idle_seconds())?;
        fields.serialize_field("away_seconds", &self.away_seconds())?;
        fields.serialize_field("paused_seconds", &self.paused_seconds())?;
        fields.end()
    }
}

impl std::ops::AddAssign for TimeSpent {
    fn add_assign(&mut self, other: TimeSpent) {
        self.active += other.active;
        self.answering += other.answering;
        self.idle += other.idle;
        self.away += other.away;
        self.paused += other.paused;
    }
}

/// Converts nanoseconds to seconds with three decimals, rounding half up.
fn to_seconds(nanoseconds: i64) -> f64 {
    ((nanoseconds + MILLISECOND / 2) / MILLISECOND) as f64 / 1e3
}

/// A span of time of one kind. Times are nanoseconds since the first line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AttendedTime {
    /// Start, nanoseconds.
    pub from: i64,
    /// End, nanoseconds.
    pub to: i64,
    /// How the time was spent.
    pub attention: Attention,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum Openness {
    /// No `session` line so far: gaps determine breaks.
    #[default]
    Untold,
    /// The program has closed the run.
    Left,
    /// The program has opened the run.
    Open {
        /// The program records idle times.
        watches_keys: bool,
    },
}

/// The times of a run, line by line.
///
/// Times are nanoseconds since the first line. If the wall clock was set back, no time passes.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Attendance {
    times: Vec<AttendedTime>,
    /// Time of the last line.
    place: i64,
    /// Wall-clock time of the last line, nanoseconds since 1970.
    moment: Option<i64>,
    sitting: Openness,
    is_paused: bool,
    is_idle: bool,
    is_suspended: bool,
    has_focus_elsewhere: bool,
    /// Questions of this session without an answer.
    open_questions: u32,
    clock_set_back: u32,
    weeks: Vec<AttendedWeek>,
    week_from: i64,
    sitting_from: i64,
}

impl Attendance {
    /// Computes the times of lines.
    pub fn of(lines: &[Line]) -> Attendance {
        let mut attendance = Attendance::default();
        lines.iter().for_each(|line| attendance.note(line.nanoseconds(), &line.record));
        attendance
    }

    /// Adds the next line, written at `moment` in nanoseconds since 1970.
    pub fn note(&mut self, moment: i64, record: &Record) {
        let passed = moment - self.moment.unwrap_or(moment);
        if passed < 0 {
            self.clock_set_back += 1;
        }
        self.moment = Some(moment);
        let passed = passed.max(0);
        self.push(passed, self.attention(passed, Some(record)));
        match record {
            Record::Activity(Activity::Session(presence)) => self.take_presence(presence),
            Record::Activity(Activity::Question(_)) => self.open_questions += 1,
            Record::Activity(Activity::Clock(clock)) => self.is_paused = clock.event == ClockEvent::Stopped,
            // The inherited lines of a branch were played in another run, at another time.
            Record::Branch(_) => {
                self.times.clear();
                self.weeks.iter_mut().for_each(|week| week.inherited = true);
                (self.week_from, self.sitting_from) = (self.place, self.place);
            }
            record if record.closing().is_some() => {
                self.weeks.push(AttendedWeek { from: self.week_from, to: self.place, inherited: false });
                self.week_from = self.place;
            }
            record if is_act(record) => (self.is_idle, self.has_focus_elsewhere) = (false, false),
            _ => {}
        }
        if matches!(record, Record::Activity(Activity::Answer(_))) {
            self.open_questions = self.open_questions.saturating_sub(1);
        }
    }

    /// Returns the time of the last line.
    pub fn place(&self) -> i64 {
        self.place
    }

    /// Returns how often the wall clock was set back between two lines.
    pub fn clock_set_back(&self) -> u32 {
        self.clock_set_back
    }

    /// Returns the weeks, or single days, in order.
    pub fn weeks(&self) -> &[AttendedWeek] {
        &self.weeks
    }

    /// Returns the time at which the current week starts.
    pub fn week_from(&self) -> i64 {
        self.week_from
    }

    /// Returns the spans in order. They have no gaps, except for lines inherited from another run.
    pub fn times(&self) -> &[AttendedTime] {
        &self.times
    }

    /// Returns the time between two points, by kind.
    pub fn between(&self, from: i64, to: i64) -> TimeSpent {
        let mut spent = TimeSpent::default();
        let first = self.times.partition_point(|time| time.to <= from);
        for time in self.times[first..].iter().take_while(|time| time.from < to) {
            spent.add(time.attention, time.to.min(to) - time.from.max(from));
        }
        spent
    }

    /// Returns the time so far in the scope of a limit, at `moment` in nanoseconds since 1970. Time without a key
    /// counts as active until the program records the idle time.
    pub fn so_far(&self, scope: LimitScope, moment: i64) -> TimeSpent {
        let from = match scope {
            LimitScope::Week => self.week_from,
            LimitScope::Session => self.sitting_from,
            LimitScope::Study => 0,
        };
        let mut spent = self.between(from, self.place);
        let passed = (moment - self.moment.unwrap_or(moment)).max(0);
        spent.add(self.attention(passed, None), passed);
        spent
    }

    /// Returns the kind of the time since the last line. `record` is the line that ends it.
    fn attention(&self, passed: i64, record: Option<&Record>) -> Attention {
        let long = passed > BREAK;
        let simulates = |record: &Record| record.closing().is_some() || matches!(record, Record::Voice(_));
        if record.is_some_and(simulates) {
            return Attention::Simulating;
        }
        if self.is_paused {
            return Attention::Paused;
        }
        let is_opened_again = record.and_then(presence_of) == Some(PresenceEvent::Opened);
        match self.sitting {
            Openness::Untold if long => Attention::Away,
            Openness::Untold => Attention::Active,
            Openness::Left => Attention::Away,
            // The run was not closed: it is unknown when the program stopped.
            Openness::Open { .. } if is_opened_again => Attention::Away,
            Openness::Open { .. } if self.is_suspended || self.has_focus_elsewhere => Attention::Away,
            Openness::Open { .. } if self.is_idle => Attention::Idle,
            Openness::Open { watches_keys: false } if long => Attention::Idle,
            Openness::Open { .. } if self.open_questions > 0 => Attention::Answering,
            Openness::Open { .. } => Attention::Active,
        }
    }

    fn push(&mut self, passed: i64, attention: Attention) {
        let from = self.place;
        self.place += passed;
        match self.times.last_mut() {
            Some(last) if last.attention == attention && last.to == from => last.to = self.place,
            _ if passed == 0 => {}
            _ => self.times.push(AttendedTime { from, to: self.place, attention }),
        }
    }

    fn take_presence(&mut self, presence: &Presence) {
        match presence.event {
            PresenceEvent::Opened => {
                let watches_keys = presence.interface.as_deref() == Some(WATCHES_KEYS);
                self.sitting = Openness::Open { watches_keys };
                self.sitting_from = self.place;
                // Questions without an answer are asked again.
                self.open_questions = 0;
                (self.is_idle, self.is_suspended, self.has_focus_elsewhere) = (false, false, false);
            }
            PresenceEvent::Closed => self.sitting = Openness::Left,
            PresenceEvent::Idle => {
                self.is_idle = true;
                let since = presence.idle_ms.unwrap_or(0).min(i64::MAX as u64 / MILLISECOND as u64);
                self.was_idle_since(self.place - since as i64 * MILLISECOND);
            }
            PresenceEvent::Active => self.is_idle = false,
            PresenceEvent::FocusLost => self.has_focus_elsewhere = true,
            PresenceEvent::FocusGained => self.has_focus_elsewhere = false,
            PresenceEvent::Suspended => self.is_suspended = true,
            PresenceEvent::Resumed => self.is_suspended = false,
            PresenceEvent::Resized => {}
        }
    }

    /// Changes active time since `since` to idle.
    fn was_idle_since(&mut self, since: i64) {
        let first = self.times.partition_point(|time| time.to <= since);
        let found = self.times.split_off(first);
        for time in found {
            let cut = since.clamp(time.from, time.to);
            let later = match time.attention {
                Attention::Active | Attention::Answering => Attention::Idle,
                other => other,
            };
            let parts = [(time.from, cut, time.attention), (cut, time.to, later)];
            for (from, to, attention) in parts.into_iter().filter(|(from, to, _)| from < to) {
                match self.times.last_mut() {
                    Some(last) if last.attention == attention && last.to == from => last.to = to,
                    _ => self.times.push(AttendedTime { from, to, attention }),
                }
            }
        }
    }

    /// Returns the number of weeks that were decided implausibly fast.
    pub fn fast_weeks(&self) -> u32 {
        let is_fast = |week: &&AttendedWeek| week.is_implausibly_fast(&self.between(week.from, week.to));
        self.weeks().iter().filter(is_fast).count() as u32
    }
}

fn presence_of(record: &Record) -> Option<PresenceEvent> {
    match record {
        Record::Activity(Activity::Session(presence)) => Some(presence.event),
        _ => None,
    }
}

/// Whether only a present user can cause this line. Weeks do not count, because a time limit can submit them.
fn is_act(record: &Record) -> bool {
    match record {
        Record::Call(_) | Record::Query(_) | Record::Note(_) | Record::Memo(_) => true,
        Record::Activity(activity) => matches!(
            activity,
            Activity::Select(_)
                | Activity::Dialog(_)
                | Activity::Help(_)
                | Activity::Draft(_)
                | Activity::Answer(_)
        ),
        _ => false,
    }
}

/// A week with fewer active seconds was decided implausibly fast.
pub const FAST_WEEK_SECONDS: f64 = 10.0;

/// The span of a week, or of single days.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AttendedWeek {
    /// End of the week before, nanoseconds.
    pub from: i64,
    /// End of the week, nanoseconds.
    pub to: i64,
    /// The week was inherited from the parent run.
    pub inherited: bool,
}

impl AttendedWeek {
    /// Whether it was decided in this run, in less than [`FAST_WEEK_SECONDS`] active seconds.
    pub fn is_implausibly_fast(&self, time: &TimeSpent) -> bool {
        !self.inherited && time.active_seconds() < FAST_WEEK_SECONDS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::trajectory::record::{
        Branch, Clock, Closing, Help, LeavingCause, PresenceEvent, View,
    };

    fn attendance(lines: &[(i64, Record)]) -> Attendance {
        let mut attendance = Attendance::default();
        lines.iter().for_each(|(seconds, record)| attendance.note(seconds * SECOND, record));
        attendance
    }

    fn session(event: PresenceEvent, interface: Option<&str>, idle_ms: Option<u64>) -> Record {
        Record::Activity(Activity::Session(Box::new(Presence {
            event,
            cause: (event == PresenceEvent::Closed).then_some(LeavingCause::Quit),
            interface: interface.map(str::to_owned),
            machine: String::new(),
            boot: String::new(),
            monotonic_ms: 0,
            window: None,
            version: None,
            idle_ms,
            worlds: None,
        })))
    }

    fn on(event: PresenceEvent) -> Record {
        session(event, None, None)
    }

    fn opened(interface: &str) -> Record {
        session(PresenceEvent::Opened, Some(interface), None)
    }

    fn clock(event: ClockEvent) -> Record {
        Record::Activity(Activity::Clock(Clock { event, reason: None, stood_ms: None }))
    }

    fn help() -> Record {
        Record::Activity(Activity::Help(Help { term: String::new(), place: String::new() }))
    }

    fn look() -> Record {
        Record::Activity(Activity::View(View { screen: String::new(), from: String::new(), for_ms: 0 }))
    }

    fn week() -> Record {
        let (figures, state_hash, parts) = Default::default();
        Record::Week(Closing { days_run: 7, figures, cash: 0.0, state_hash, parts })
    }

    /// Active, idle, away and paused seconds.
    fn all(attendance: &Attendance) -> [f64; 4] {
        let spent = attendance.between(0, attendance.place());
        [spent.active_seconds(), spent.idle_seconds(), spent.away_seconds(), spent.paused_seconds()]
    }

    #[test]
    fn without_lines_of_presence_a_long_gap_is_a_break() {
        let run = attendance(&[(0, help()), (600, help()), (1201, help()), (1200, help()), (1230, help())]);
        assert_eq!(all(&run), [630.0, 0.0, 601.0, 0.0]);
        assert_eq!(run.clock_set_back(), 1);
    }

    #[test]
    fn reading_is_no_break_and_whoever_is_found_idle_was_since_the_last_key() {
        let run = attendance(&[
            (0, opened("console")),
            (660, look()),
            (760, session(PresenceEvent::Idle, None, Some(120_000))),
            (1000, on(PresenceEvent::Active)),
            (1010, help()),
        ]);
        assert_eq!(all(&run), [650.0, 360.0, 0.0, 0.0]);
        let plain = attendance(&[(0, opened("plain")), (660, help()), (700, help())]);
        assert_eq!(all(&plain), [40.0, 660.0, 0.0, 0.0], "plain mode does not watch keys");
    }

    #[test]
    fn the_program_left_stopped_or_in_the_background_is_away() {
        let run = attendance(&[
            (0, opened("console")),
            (10, on(PresenceEvent::FocusLost)),
            (20, on(PresenceEvent::FocusGained)),
            (25, on(PresenceEvent::Suspended)),
            (125, on(PresenceEvent::Resumed)),
            (130, clock(ClockEvent::Stopped)),
            (330, clock(ClockEvent::Started)),
            (335, on(PresenceEvent::Closed)),
            (1335, opened("console")),
            (1340, look()),
            // The program was killed.
            (1400, opened("console")),
            (1401, on(PresenceEvent::FocusLost)),
            (1403, help()),
            (1405, help()),
        ]);
        assert_eq!(all(&run), [10.0 + 5.0 + 5.0 + 5.0 + 5.0 + 1.0 + 2.0, 0.0, 1372.0, 200.0]);
        assert_eq!(run.between(0, run.place()).elapsed_seconds(), 1405.0);
    }

    #[test]
    fn a_clock_that_stands_while_the_program_is_left_is_found_forgotten() {
        let run = attendance(&[
            (0, opened("console")),
            (5, clock(ClockEvent::Stopped)),
            (9, on(PresenceEvent::Closed)),
            (100, opened("console")),
            (101, clock(ClockEvent::Forgotten)),
            (105, look()),
        ]);
        assert_eq!(all(&run), [9.0, 0.0, 96.0, 96.0]);
    }

    #[test]
    fn simulated_days_and_those_of_a_parent_are_nobodys_time() {
        let run = attendance(&[
            (0, help()),
            (60, week()),
            (70, Record::Branch(Branch { from: None })),
            (75, opened("console")),
            (80, look()),
            (100, week()),
            (103, look()),
        ]);
        assert_eq!(all(&run), [13.0, 0.0, 0.0, 0.0]);
        let at = |scope| run.so_far(scope, 110 * SECOND).active_ms();
        let scopes = [LimitScope::Week, LimitScope::Session, LimitScope::Study].map(at);
        assert_eq!(scopes, [10_000, 15_000, 20_000]);
    }

    #[test]
    fn seconds_are_rounded_once() {
        assert_eq!([499_999, 500_000, 1_499_999].map(to_seconds), [0.0, 0.001, 0.001]);
    }
}
