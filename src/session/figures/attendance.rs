//! Time spent in a run, by kind: active, idle, away. Tables and time limits use these definitions.
//!
//! Time is measured between two lines. `session` and `clock` lines determine the kind of the time. Before the first
//! `session` line, a gap of more than ten minutes is a break. Time in which the program simulates days or waits for a
//! language model does not count. All times are whole nanoseconds, so that sums are exact.

use serde::ser::{Serialize, SerializeStruct, Serializer};

use crate::recording::activity::IDLE_TIMEOUT;
use novamind_record::trajectory::record::{Activity, ClockEvent, LimitScope, Presence, PresenceEvent};
use novamind_record::trajectory::{Line, Record};

/// Minimum gap between lines that counts as a break if there are no `session` lines: ten minutes, in seconds.
pub const MIN_BREAK_SECONDS: f64 = 600.0;

/// Time away after which a session ends, and the next opening of the run starts a new session: 30 minutes, in seconds.
///
/// A shorter absence belongs to the session, however the program ended, and time limits run on. Closing or killing the
/// program and opening the run again therefore gains no time.
pub const SESSION_BREAK_SECONDS: f64 = 1800.0;

/// Longest time without a line while the user is playing. After it, the program records that the user is idle.
const MAX_UNSEEN_NS: i64 = IDLE_TIMEOUT.as_secs() as i64 * NS_PER_SECOND;
const SESSION_BREAK_NS: i64 = SESSION_BREAK_SECONDS as i64 * NS_PER_SECOND;
const MIN_BREAK_NS: i64 = MIN_BREAK_SECONDS as i64 * NS_PER_SECOND;
const NS_PER_SECOND: i64 = 1_000_000_000;
const NS_PER_MS: i64 = 1_000_000;

/// The interface that monitors key presses and records idle times.
pub(super) const KEY_WATCHING_INTERFACE: &str = "console";

/// How a participant spent a period of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUse {
    /// The participant played.
    Active,
    /// The participant answered questions of the study.
    Answering,
    /// The participant was idle: no key was pressed. If the interface does not monitor keys, a gap of more than ten
    /// minutes between lines counts as idle.
    Idle,
    /// The participant was away: the program was closed or suspended, or another window had the focus.
    Away,
    /// The clock was stopped.
    Paused,
    /// The program simulated days.
    Simulating,
}

/// Time of a participant by kind, in nanoseconds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TimeSpent {
    active: i64,
    answering: i64,
    idle: i64,
    /// Time away, including the time with a stopped clock.
    away: i64,
    paused: i64,
}

impl TimeSpent {
    /// Returns the active time in seconds, rounded to milliseconds.
    pub fn active_seconds(&self) -> f64 {
        to_seconds(self.active)
    }

    /// Returns the time spent on study questions in seconds, rounded to milliseconds.
    pub fn answering_seconds(&self) -> f64 {
        to_seconds(self.answering)
    }

    /// Returns the idle time in seconds, rounded to milliseconds.
    pub fn idle_seconds(&self) -> f64 {
        to_seconds(self.idle)
    }

    /// Returns the time away in seconds, rounded to milliseconds. Includes the time with a stopped clock.
    pub fn away_seconds(&self) -> f64 {
        to_seconds(self.away)
    }

    /// Returns the time with a stopped clock in seconds, rounded to milliseconds.
    pub fn paused_seconds(&self) -> f64 {
        to_seconds(self.paused)
    }

    /// Returns the time of all kinds in seconds, rounded to milliseconds.
    pub fn elapsed_seconds(&self) -> f64 {
        to_seconds(self.active + self.answering + self.idle + self.away)
    }

    /// Returns the active time in milliseconds, as counted by time limits.
    pub fn active_ms(&self) -> u64 {
        (self.active / NS_PER_MS).max(0) as u64
    }

    fn add(&mut self, time_use: TimeUse, passed: i64) {
        match time_use {
            TimeUse::Active => self.active += passed,
            TimeUse::Answering => self.answering += passed,
            TimeUse::Idle => self.idle += passed,
            TimeUse::Away => self.away += passed,
            TimeUse::Paused => {
                self.away += passed;
                self.paused += passed;
            }
            TimeUse::Simulating => {}
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
    ((nanoseconds + NS_PER_MS / 2) / NS_PER_MS) as f64 / 1e3
}

/// A period of time of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeSpan {
    /// Start of the period, nanoseconds since the first line.
    pub from: i64,
    /// End of the period, nanoseconds since the first line.
    pub to: i64,
    /// How the time was spent.
    pub time_use: TimeUse,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
enum ConnectionState {
    /// No `session` line has been read yet, so long gaps count as breaks.
    #[default]
    Unknown,
    /// The program has closed the run.
    Closed,
    /// The program has opened the run.
    Open {
        /// Whether the program monitors keys and records idle times.
        watches_keys: bool,
    },
}

/// How the participant spent the time of a run, computed line by line.
///
/// Times are nanoseconds since the first line. If the wall clock was set back between two lines, the time between them
/// counts as zero.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Attendance {
    spans: Vec<TimeSpan>,
    /// Time of the last line, nanoseconds since the first line.
    end_ns: i64,
    /// Wall-clock time of the last line, nanoseconds since the Unix epoch.
    last_time_ns: Option<i64>,
    connection: ConnectionState,
    is_paused: bool,
    is_idle: bool,
    is_suspended: bool,
    has_lost_focus: bool,
    /// Number of questions in this session that are shown and not answered.
    open_questions: u32,
    clock_set_back_count: u32,
    weeks: Vec<AttendedWeek>,
    week_start_ns: i64,
    session_start_ns: i64,
    limit_time: LimitTime,
}

/// Time that counts for time limits, in nanoseconds.
///
/// All time of a session counts, except while the clock is stopped, days are simulated, or questions of the study are
/// open: also idle time, time in other windows, and time for which the program was closed. Between two sessions, no time
/// counts.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
struct LimitTime {
    week: i64,
    session: i64,
    study: i64,
}

impl LimitTime {
    fn add(&mut self, passed: i64) {
        self.week += passed;
        self.session += passed;
        self.study += passed;
    }

    fn in_scope(&self, scope: LimitScope) -> i64 {
        match scope {
            LimitScope::Week => self.week,
            LimitScope::Session => self.session,
            LimitScope::Study => self.study,
        }
    }
}

impl Attendance {
    /// Computes the attendance from the lines of a run.
    pub fn from_lines(lines: &[Line]) -> Attendance {
        let mut attendance = Attendance::default();
        lines.iter().for_each(|line| attendance.add_line(line.at_nanoseconds(), &line.record));
        attendance
    }

    /// Adds the next line. `moment` is the time at which the line was written, in nanoseconds since the Unix epoch.
    pub fn add_line(&mut self, moment: i64, record: &Record) {
        let passed = moment - self.last_time_ns.unwrap_or(moment);
        if passed < 0 {
            self.clock_set_back_count += 1;
        }
        self.last_time_ns = Some(moment);
        let passed = passed.max(0);
        let time_use = self.classify_gap(passed, Some(record));
        let starts_session = self.starts_new_session(passed, record);
        let counted = match (starts_session, self.connection) {
            (false, _) => passed,
            // The program was killed: the user may have played for a while after the last line.
            (true, ConnectionState::Open { .. }) => passed.min(MAX_UNSEEN_NS),
            (true, _) => 0,
        };
        if self.counts_for_limits(time_use) {
            self.limit_time.add(counted);
        }
        self.push_span(passed, time_use);
        match record {
            Record::Activity(Activity::Session(presence)) => {
                if starts_session {
                    (self.session_start_ns, self.limit_time.session) = (self.end_ns, 0);
                }
                self.apply_presence(presence);
            }
            Record::Activity(Activity::Question(_)) => self.open_questions += 1,
            Record::Activity(Activity::Clock(clock)) => self.is_paused = clock.event == ClockEvent::Stopped,
            // The copied lines of a branch were played in the parent run, at another time.
            Record::Branch(_) => {
                self.spans.clear();
                self.weeks.iter_mut().for_each(|week| week.is_inherited = true);
                (self.week_start_ns, self.session_start_ns) = (self.end_ns, self.end_ns);
                self.limit_time = LimitTime::default();
            }
            record if record.closed_days().is_some() => {
                self.weeks.push(AttendedWeek {
                    from: self.week_start_ns,
                    to: self.end_ns,
                    is_inherited: false,
                });
                self.week_start_ns = self.end_ns;
                self.limit_time.week = 0;
            }
            record if is_user_action(record) => (self.is_idle, self.has_lost_focus) = (false, false),
            _ => {}
        }
        if matches!(record, Record::Activity(Activity::Answer(_))) {
            self.open_questions = self.open_questions.saturating_sub(1);
        }
    }

    /// Returns the time of the last line, in nanoseconds since the first line.
    pub fn end_ns(&self) -> i64 {
        self.end_ns
    }

    /// Returns the number of times that the wall clock was set back between two lines.
    pub fn clock_set_back_count(&self) -> u32 {
        self.clock_set_back_count
    }

    /// Returns the periods of all simulated weeks and single days, in order.
    pub fn weeks(&self) -> &[AttendedWeek] {
        &self.weeks
    }

    /// Returns the start of the current week, in nanoseconds since the first line.
    pub fn week_start_ns(&self) -> i64 {
        self.week_start_ns
    }

    /// Returns the periods in order. The periods have no gaps, except for lines that were copied from another run.
    pub fn spans(&self) -> &[TimeSpan] {
        &self.spans
    }

    /// Returns the time spent from `from` to `to`, by kind. Both arguments are in nanoseconds since the first line.
    pub fn spent_between(&self, from: i64, to: i64) -> TimeSpent {
        let mut spent = TimeSpent::default();
        let first = self.spans.partition_point(|time| time.to <= from);
        for time in self.spans[first..].iter().take_while(|time| time.from < to) {
            spent.add(time.time_use, time.to.min(to) - time.from.max(from));
        }
        spent
    }

    /// Returns the time spent in the scope of a limit up to `moment`, in nanoseconds since the Unix epoch. Time without
    /// key presses counts as active until the program records the idle time.
    pub fn spent_until(&self, scope: LimitScope, moment: i64) -> TimeSpent {
        let from = match scope {
            LimitScope::Week => self.week_start_ns,
            LimitScope::Session => self.session_start_ns,
            LimitScope::Study => 0,
        };
        let mut spent = self.spent_between(from, self.end_ns);
        let passed = (moment - self.last_time_ns.unwrap_or(moment)).max(0);
        spent.add(self.classify_gap(passed, None), passed);
        spent
    }

    /// Returns the milliseconds that count for a limit up to `moment`, in nanoseconds since the Unix epoch.
    pub fn limit_ms_until(&self, scope: LimitScope, moment: i64) -> u64 {
        let passed = (moment - self.last_time_ns.unwrap_or(moment)).max(0);
        let counted = if self.counts_for_limits(self.classify_gap(passed, None)) { passed } else { 0 };
        ((self.limit_time.in_scope(scope) + counted) / NS_PER_MS).max(0) as u64
    }

    /// Returns whether time of this kind since the last line counts for time limits.
    fn counts_for_limits(&self, time_use: TimeUse) -> bool {
        let is_counted_kind = match time_use {
            TimeUse::Active | TimeUse::Idle | TimeUse::Away => true,
            TimeUse::Answering | TimeUse::Paused | TimeUse::Simulating => false,
        };
        is_counted_kind && self.open_questions == 0
    }

    /// Returns whether a line opens the run after an absence that ended the earlier session.
    fn starts_new_session(&self, passed: i64, record: &Record) -> bool {
        presence_event(record) == Some(PresenceEvent::Opened)
            && (self.connection == ConnectionState::Unknown || passed >= SESSION_BREAK_NS)
    }

    /// Returns how the time since the last line was spent. `record` is the event of the next line, if there is one.
    fn classify_gap(&self, passed: i64, record: Option<&Record>) -> TimeUse {
        let long = passed > MIN_BREAK_NS;
        let simulates =
            |record: &Record| record.closed_days().is_some() || matches!(record, Record::Voice(_));
        if record.is_some_and(simulates) {
            return TimeUse::Simulating;
        }
        if self.is_paused {
            return TimeUse::Paused;
        }
        let is_opened_again = record.and_then(presence_event) == Some(PresenceEvent::Opened);
        match self.connection {
            ConnectionState::Unknown if long => TimeUse::Away,
            ConnectionState::Unknown => TimeUse::Active,
            ConnectionState::Closed => TimeUse::Away,
            // The program did not close the run, so the time at which the program stopped is unknown.
            ConnectionState::Open { .. } if is_opened_again => TimeUse::Away,
            ConnectionState::Open { .. } if self.is_suspended || self.has_lost_focus => TimeUse::Away,
            ConnectionState::Open { .. } if self.is_idle => TimeUse::Idle,
            ConnectionState::Open { watches_keys: false } if long => TimeUse::Idle,
            ConnectionState::Open { .. } if self.open_questions > 0 => TimeUse::Answering,
            ConnectionState::Open { .. } => TimeUse::Active,
        }
    }

    fn push_span(&mut self, passed: i64, time_use: TimeUse) {
        let from = self.end_ns;
        self.end_ns += passed;
        match self.spans.last_mut() {
            Some(last) if last.time_use == time_use && last.to == from => last.to = self.end_ns,
            _ if passed == 0 => {}
            _ => self.spans.push(TimeSpan { from, to: self.end_ns, time_use }),
        }
    }

    fn apply_presence(&mut self, presence: &Presence) {
        match presence.event {
            PresenceEvent::Opened => {
                let watches_keys = presence.interface.as_deref() == Some(KEY_WATCHING_INTERFACE);
                self.connection = ConnectionState::Open { watches_keys };
                // The program shows unanswered questions again after it has opened the run.
                self.open_questions = 0;
                (self.is_idle, self.is_suspended, self.has_lost_focus) = (false, false, false);
            }
            PresenceEvent::Closed => self.connection = ConnectionState::Closed,
            PresenceEvent::Idle => {
                self.is_idle = true;
                let since = presence.idle_ms.unwrap_or(0).min(i64::MAX as u64 / NS_PER_MS as u64);
                self.mark_idle_since(self.end_ns - since as i64 * NS_PER_MS);
            }
            PresenceEvent::Active => self.is_idle = false,
            PresenceEvent::FocusLost => self.has_lost_focus = true,
            PresenceEvent::FocusGained => self.has_lost_focus = false,
            PresenceEvent::Suspended => self.is_suspended = true,
            PresenceEvent::Resumed => self.is_suspended = false,
            PresenceEvent::Resized => {}
        }
    }

    /// Reclassifies active time since `since` as idle.
    fn mark_idle_since(&mut self, since: i64) {
        let first = self.spans.partition_point(|time| time.to <= since);
        let found = self.spans.split_off(first);
        for time in found {
            let cut = since.clamp(time.from, time.to);
            let later = match time.time_use {
                TimeUse::Active | TimeUse::Answering => TimeUse::Idle,
                other => other,
            };
            let parts = [(time.from, cut, time.time_use), (cut, time.to, later)];
            for (from, to, time_use) in parts.into_iter().filter(|(from, to, _)| from < to) {
                match self.spans.last_mut() {
                    Some(last) if last.time_use == time_use && last.to == from => last.to = to,
                    _ => self.spans.push(TimeSpan { from, to, time_use }),
                }
            }
        }
    }

    /// Returns the number of weeks whose decisions were implausibly fast.
    pub fn fast_week_count(&self) -> u32 {
        let is_fast =
            |week: &&AttendedWeek| week.is_implausibly_fast(&self.spent_between(week.from, week.to));
        self.weeks().iter().filter(is_fast).count() as u32
    }
}

fn presence_event(record: &Record) -> Option<PresenceEvent> {
    match record {
        Record::Activity(Activity::Session(presence)) => Some(presence.event),
        _ => None,
    }
}

/// Returns whether only a present user can cause this event. Weeks do not count, because a time limit can submit a
/// week.
fn is_user_action(record: &Record) -> bool {
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

/// Active time in seconds below which the decisions of a week were implausibly fast.
pub const FAST_WEEK_SECONDS: f64 = 10.0;

/// The period in which the decisions for a week, or for single days, were made and the days were simulated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct AttendedWeek {
    /// End of the previous week, nanoseconds since the first line.
    pub from: i64,
    /// End of the week, nanoseconds since the first line.
    pub to: i64,
    /// Whether the week was copied from the parent run.
    pub is_inherited: bool,
}

impl AttendedWeek {
    /// Returns whether the decisions for the week were made in this run and took less than [`FAST_WEEK_SECONDS`] of
    /// active time.
    pub fn is_implausibly_fast(&self, time: &TimeSpent) -> bool {
        !self.is_inherited && time.active_seconds() < FAST_WEEK_SECONDS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use novamind_record::trajectory::record::{
        Branch, Clock, ClosedDays, DetachCause, HelpRequest, PresenceEvent, ScreenView,
    };

    fn attendance_from_records(lines: &[(i64, Record)]) -> Attendance {
        let mut attendance = Attendance::default();
        lines.iter().for_each(|(seconds, record)| attendance.add_line(seconds * NS_PER_SECOND, record));
        attendance
    }

    fn session_record(event: PresenceEvent, interface: Option<&str>, idle_ms: Option<u64>) -> Record {
        Record::Activity(Activity::Session(Box::new(Presence {
            event,
            cause: (event == PresenceEvent::Closed).then_some(DetachCause::Quit),
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

    fn presence_record(event: PresenceEvent) -> Record {
        session_record(event, None, None)
    }

    fn opened_record(interface: &str) -> Record {
        session_record(PresenceEvent::Opened, Some(interface), None)
    }

    fn clock_record(event: ClockEvent) -> Record {
        Record::Activity(Activity::Clock(Clock { event, reason: None, stood_ms: None }))
    }

    fn help_record() -> Record {
        Record::Activity(Activity::Help(HelpRequest { term: String::new(), place: String::new() }))
    }

    fn view_record() -> Record {
        Record::Activity(Activity::View(ScreenView { screen: String::new(), from: String::new(), for_ms: 0 }))
    }

    fn week_record() -> Record {
        let (figures, state_hash, parts) = Default::default();
        Record::Week(ClosedDays { days_run: 7, figures, cash: 0.0, state_hash, parts })
    }

    /// Returns active, idle, away and paused seconds.
    fn seconds_by_kind(attendance: &Attendance) -> [f64; 4] {
        let spent = attendance.spent_between(0, attendance.end_ns());
        [spent.active_seconds(), spent.idle_seconds(), spent.away_seconds(), spent.paused_seconds()]
    }

    #[test]
    fn long_gap_without_presence_is_a_break() {
        let run = attendance_from_records(&[
            (0, help_record()),
            (600, help_record()),
            (1201, help_record()),
            (1200, help_record()),
            (1230, help_record()),
        ]);
        assert_eq!(seconds_by_kind(&run), [630.0, 0.0, 601.0, 0.0]);
        assert_eq!(run.clock_set_back_count(), 1);
    }

    #[test]
    fn idle_time_starts_at_the_last_key_press() {
        let run = attendance_from_records(&[
            (0, opened_record("console")),
            (660, view_record()),
            (760, session_record(PresenceEvent::Idle, None, Some(120_000))),
            (1000, presence_record(PresenceEvent::Active)),
            (1010, help_record()),
        ]);
        assert_eq!(seconds_by_kind(&run), [650.0, 360.0, 0.0, 0.0]);
        let plain = attendance_from_records(&[
            (0, opened_record("plain")),
            (660, help_record()),
            (700, help_record()),
        ]);
        assert_eq!(seconds_by_kind(&plain), [40.0, 660.0, 0.0, 0.0], "plain mode does not watch keys");
    }

    #[test]
    fn closed_stopped_or_unfocused_program_counts_as_away() {
        let run = attendance_from_records(&[
            (0, opened_record("console")),
            (10, presence_record(PresenceEvent::FocusLost)),
            (20, presence_record(PresenceEvent::FocusGained)),
            (25, presence_record(PresenceEvent::Suspended)),
            (125, presence_record(PresenceEvent::Resumed)),
            (130, clock_record(ClockEvent::Stopped)),
            (330, clock_record(ClockEvent::Started)),
            (335, presence_record(PresenceEvent::Closed)),
            (1335, opened_record("console")),
            (1340, view_record()),
            // The program was killed before this line, so there is no `closed` line.
            (1400, opened_record("console")),
            (1401, presence_record(PresenceEvent::FocusLost)),
            (1403, help_record()),
            (1405, help_record()),
        ]);
        assert_eq!(seconds_by_kind(&run), [10.0 + 5.0 + 5.0 + 5.0 + 5.0 + 1.0 + 2.0, 0.0, 1372.0, 200.0]);
        assert_eq!(run.spent_between(0, run.end_ns()).elapsed_seconds(), 1405.0);
    }

    #[test]
    fn clock_stopped_while_detached_counts_as_paused() {
        let run = attendance_from_records(&[
            (0, opened_record("console")),
            (5, clock_record(ClockEvent::Stopped)),
            (9, presence_record(PresenceEvent::Closed)),
            (100, opened_record("console")),
            (101, clock_record(ClockEvent::Forgotten)),
            (105, view_record()),
        ]);
        assert_eq!(seconds_by_kind(&run), [9.0, 0.0, 96.0, 96.0]);
    }

    #[test]
    fn simulated_and_inherited_days_take_no_time() {
        let run = attendance_from_records(&[
            (0, help_record()),
            (60, week_record()),
            (70, Record::Branch(Branch { from: None })),
            (75, opened_record("console")),
            (80, view_record()),
            (100, week_record()),
            (103, view_record()),
        ]);
        assert_eq!(seconds_by_kind(&run), [13.0, 0.0, 0.0, 0.0]);
        let at = |scope| run.spent_until(scope, 110 * NS_PER_SECOND).active_ms();
        let scopes = [LimitScope::Week, LimitScope::Session, LimitScope::Study].map(at);
        assert_eq!(scopes, [10_000, 15_000, 20_000]);
    }

    /// Returns the seconds that count for the limits of week, session and study at a time.
    fn limit_seconds(attendance: &Attendance, at: i64) -> [u64; 3] {
        [LimitScope::Week, LimitScope::Session, LimitScope::Study]
            .map(|scope| attendance.limit_ms_until(scope, at * NS_PER_SECOND) / 1000)
    }

    #[test]
    fn idle_time_and_time_in_other_windows_count_for_limits() {
        for interface in ["console", "plain"] {
            let run = attendance_from_records(&[
                (0, opened_record(interface)),
                (100, session_record(PresenceEvent::Idle, None, Some(60_000))),
                (400, presence_record(PresenceEvent::Active)),
                (410, presence_record(PresenceEvent::FocusLost)),
                (500, presence_record(PresenceEvent::FocusGained)),
            ]);
            assert_eq!(limit_seconds(&run, 520), [520; 3], "{interface}");
        }
    }

    #[test]
    fn killing_or_closing_the_program_does_not_stop_or_reset_limits() {
        let closed = presence_record(PresenceEvent::Closed);
        // With and without a `closed` line: the program was closed, or killed while the user was reading.
        let leavings = [vec![(50, closed)], vec![]];
        for (leaving, interface) in
            leavings.into_iter().flat_map(|one| ["console", "plain"].map(|name| (one.clone(), name)))
        {
            let mut lines = vec![(0, opened_record(interface)), (50, view_record())];
            lines.extend(leaving);
            lines.push((1000, opened_record(interface)));
            lines.push((1010, view_record()));
            let run = attendance_from_records(&lines);
            assert_eq!(limit_seconds(&run, 1010), [1010; 3]);
            let spent = run.spent_between(0, run.end_ns());
            assert_eq!(spent.away_seconds(), 950.0, "the tables show the time as away");
        }
    }

    #[test]
    fn absence_of_half_an_hour_is_a_break_between_sessions() {
        let run = attendance_from_records(&[
            (0, opened_record("console")),
            (100, presence_record(PresenceEvent::Closed)),
            (100 + 1800, opened_record("console")),
        ]);
        assert_eq!(limit_seconds(&run, 1910), [110, 10, 110]);
        let killed = attendance_from_records(&[
            (0, opened_record("console")),
            (100, view_record()),
            (100 + 1800, opened_record("console")),
        ]);
        assert_eq!(limit_seconds(&killed, 1910), [170, 10, 170], "a minute may have passed before the kill");
        let shorter = attendance_from_records(&[
            (0, opened_record("console")),
            (100, presence_record(PresenceEvent::Closed)),
            (100 + 1799, opened_record("console")),
        ]);
        assert_eq!(limit_seconds(&shorter, 1909), [1909; 3]);
    }

    #[test]
    fn only_stopped_clock_questions_and_simulation_stop_limits() {
        let question =
            Record::Activity(Activity::Question(novamind_record::trajectory::record::QuestionShown {
                questionnaire: String::new(),
                occasion: String::new(),
                id: String::new(),
                text: String::new(),
                form: String::new(),
                options: Vec::new(),
            }));
        let answer =
            Record::Activity(Activity::Answer(novamind_record::trajectory::record::QuestionAnswer {
                questionnaire: String::new(),
                occasion: String::new(),
                id: String::new(),
                value: serde_json::Value::Null,
                for_ms: 0,
                changes: 0,
                as_expected: None,
            }));
        let run = attendance_from_records(&[
            (0, opened_record("console")),
            (10, clock_record(ClockEvent::Stopped)),
            // The participant closes the program while the clock is stopped.
            (20, presence_record(PresenceEvent::Closed)),
            (500, opened_record("console")),
            (500, clock_record(ClockEvent::Forgotten)),
            (510, question),
            (600, session_record(PresenceEvent::Idle, None, Some(60_000))),
            (700, answer),
            (705, view_record()),
        ]);
        assert_eq!(limit_seconds(&run, 705), [25; 3]);
        let next = attendance_from_records(&[
            (0, opened_record("console")),
            (60, view_record()),
            (90, week_record()),
        ]);
        assert_eq!(limit_seconds(&next, 95), [5, 65, 65]);
    }

    #[test]
    fn seconds_are_rounded_once() {
        assert_eq!([499_999, 500_000, 1_499_999].map(to_seconds), [0.0, 0.001, 0.001]);
    }
}
