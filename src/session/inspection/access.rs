//! Inspections: hidden state is shown only after an inspection was permitted and recorded.

use std::sync::{Arc, Mutex, PoisonError};

use super::run_replay::RunReplay;
use crate::company::hidden_state::HiddenState;
use crate::company::reports::{DayReport, WeekResult};
use crate::play::Session;
use novamind_database::{QueryConnection, Scope};
use novamind_record::trajectory::record::{Activity, Inspection};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::Rejection;
use novamind_world::customers::FIRST_CUSTOMER;
use novamind_world::day::observer::{DayObserver, NoObserver};
use novamind_world::events::Facts;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::state::World;

/// A permitted and recorded inspection of the hidden state of a run.
#[derive(Debug)]
pub struct InspectionPermit {
    run: String,
    day: u32,
}

impl InspectionPermit {
    /// Starts an inspection of a day, by default the last day. The inspection is recorded before hidden state is shown.
    ///
    /// # Errors
    /// One of the rejections `not_in_this_mode`, `day_unknown`, `read_only`, `not_saved`.
    pub fn start(
        run: &mut Session,
        what: &str,
        which: &str,
        day: Option<u32>,
    ) -> Result<InspectionPermit, Rejection> {
        run.check_inspection()?;
        let day = InspectionPermit::resolve_day(run, day)?;
        InspectionPermit::record(run, what, which, day)
    }

    /// Starts an inspection of the current state of the run. `shown_day` is recorded as the inspected day.
    ///
    /// # Errors
    /// One of the rejections `not_in_this_mode`, `read_only`, `not_saved`.
    pub fn start_at_current_state(
        run: &mut Session,
        what: &str,
        which: &str,
        shown_day: u32,
    ) -> Result<InspectionPermit, Rejection> {
        run.check_inspection()?;
        InspectionPermit::record(run, what, which, shown_day)
    }

    /// Starts an inspection of a customer on a day, by default the last day. Also returns the customer's group, number
    /// in the group and arrival day.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown` (also if the customer arrived later), `customer_not_found`, `read_only`,
    /// `not_saved`.
    pub fn start_for_customer(
        run: &mut Session,
        customer: u32,
        day: Option<u32>,
    ) -> Result<(InspectionPermit, (Group, u32), u32), Rejection> {
        run.check_inspection()?;
        let day = InspectionPermit::resolve_day(run, day)?;
        let customers = &run.simulation().world.customers;
        let Some(found) = customers.find(customer) else {
            let message = match customers.next_customer {
                FIRST_CUSTOMER => "there are no customers yet".to_owned(),
                next => format!(
                    "there is no customer {customer}; choose one from {FIRST_CUSTOMER} to {}",
                    next - 1
                ),
            };
            return Err(Rejection::for_field("customer_id", "customer_not_found", message));
        };
        let arrival = customers.numbers.arrival_day(customer).unwrap_or(0);
        if arrival > day {
            let message = format!("customer {customer} arrived on day {arrival}, after day {day}");
            return Err(Rejection::for_field("day", "day_unknown", message));
        }
        Ok((InspectionPermit::record(run, "customer", &customer.to_string(), day)?, found, arrival))
    }

    /// Checks the day of an inspection and returns it. Defaults to the last day.
    ///
    /// # Errors
    /// `day_unknown`: the day has not been simulated.
    pub fn resolve_day(run: &Session, day: Option<u32>) -> Result<u32, Rejection> {
        let last = run.day();
        let refused = |message: String| Err(Rejection::for_field("day", "day_unknown", message));
        match day.unwrap_or(last) {
            _ if last == 0 => refused("no day has been simulated yet".to_owned()),
            day if (1..=last).contains(&day) => Ok(day),
            day => refused(format!("there is no day {day}; choose a day from 1 to {last}")),
        }
    }

    /// Opens a database connection that has empty hidden tables.
    ///
    /// # Errors
    /// `not_in_this_mode`; `sql_error` if the run has no database or the database cannot be read.
    pub fn open_hidden_tables(run: &mut Session) -> Result<QueryConnection, Rejection> {
        run.check_inspection()?;
        run.up_to_date_database()?.open_scoped_connection(Scope::Hidden)
    }

    /// Records an inspection before hidden state is shown.
    ///
    /// # Errors
    /// `read_only` if the run is open read-only, `not_saved`.
    fn record(
        run: &mut Session,
        what: &str,
        which: &str,
        shown_day: u32,
    ) -> Result<InspectionPermit, Rejection> {
        if !run.log().is_written() {
            let message =
                "an inspection must be recorded, but this run is open read-only; open the run for play";
            return Err(Rejection::new("read_only", message));
        }
        let inspection = Inspection { what: what.to_owned(), which: which.to_owned(), shown_day };
        let line = Record::Activity(Activity::Inspection(inspection));
        let appended = run.append(&line, Durability::Synced);
        appended.map_err(|error| Rejection::new("not_saved", error.to_string()))?;
        Ok(InspectionPermit { run: run.manifest().id.clone(), day: shown_day })
    }

    /// Returns the day of the inspection.
    pub fn day(&self) -> u32 {
        self.day
    }

    /// Returns the current hidden state of the run.
    pub fn hidden_state<'a>(&self, run: &'a Session) -> HiddenState<'a> {
        self.assert_belongs_to(run);
        run.hidden_state()
    }

    /// Returns a replay of the run that starts before the first line and passes its days to `watch`.
    ///
    /// # Errors
    /// `not_possible` if the run has no folder; `not_readable` if its record cannot be read.
    pub fn replay(&self, run: &Session, watch: Arc<dyn DayObserver>) -> Result<RunReplay, Rejection> {
        self.assert_belongs_to(run);
        RunReplay::new(run, watch)
    }

    fn assert_belongs_to(&self, run: &Session) {
        debug_assert_eq!(
            self.run,
            run.manifest().id,
            "an inspection is valid only for the run that recorded it"
        );
    }

    /// Simulates the days of the run again up to the end of the week of `day`, and passes the days to `watch`.
    ///
    /// # Errors
    /// One of the rejections `not_possible`, `not_readable`.
    pub fn replay_until(
        &self,
        run: &Session,
        day: u32,
        watch: Arc<dyn DayObserver>,
    ) -> Result<(), Rejection> {
        self.assert_belongs_to(run);
        replay_until(run, day, watch)
    }

    /// Returns the world state at the end of a past day.
    ///
    /// # Errors
    /// One of the rejections `not_possible`, `not_readable`.
    pub fn world_at_day_end(&self, run: &Session, day: u32) -> Result<World, Rejection> {
        let capture = Arc::new(WorldCapture { day, world: Mutex::default() });
        self.replay_until(run, day, capture.clone())?;
        let world = capture.world.lock().unwrap_or_else(PoisonError::into_inner).take();
        world.ok_or_else(|| Rejection::new("not_readable", format!("the record does not contain day {day}")))
    }
}

fn replay_until(run: &Session, day: u32, watch: Arc<dyn DayObserver>) -> Result<(), Rejection> {
    RunReplay::new(run, watch)?.advance(run, |reached| reached < day, &mut |_| {})
}

/// Days to simulate, and the observer that receives these days.
pub struct ObservedDays<'a> {
    /// Number of days to simulate.
    pub days: u32,
    /// Observer that receives the simulated days.
    pub watch: Arc<dyn DayObserver>,
    /// Whether the observer receives the past days first.
    pub replays_past_days: bool,
    /// Function that returns whether to continue after a day.
    pub should_continue: &'a dyn Fn(u32) -> bool,
    /// Inspections to record after the simulation: their kind, and the subject of each inspection.
    pub inspections: (&'a str, Vec<String>),
}

impl ObservedDays<'_> {
    /// Simulates at least one day of a debug run and passes the days to the observer. Each inspection is recorded on
    /// the last day, because even the decision to continue or stop reveals hidden state. If there are no inspections,
    /// the observer does not receive any days.
    ///
    /// # Errors
    /// `not_in_this_mode`, `run_over`, `not_possible`, `not_readable`; `not_saved`: days may have been simulated.
    pub fn simulate(
        self,
        run: &mut Session,
        progress: &mut dyn FnMut(&DayReport<'_>),
    ) -> Result<WeekResult, Rejection> {
        run.check_inspection()?;
        run.check_can_step()?;
        let ObservedDays {
            days,
            watch,
            replays_past_days: shows_past,
            should_continue: goes_on,
            inspections: (what, which),
        } = self;
        let until = run.day().saturating_add(days.max(1));
        if which.is_empty() {
            return step_until(run, until, &|_| true, progress);
        }
        if shows_past {
            replay_until(run, run.day(), watch.clone())?;
        }
        run.set_observer(watch);
        let week = step_until(run, until, goes_on, progress);
        run.set_observer(Arc::new(NoObserver));
        let week = week?;
        for which in which {
            InspectionPermit::record(run, what, &which, run.day())?;
        }
        Ok(week)
    }
}

/// Simulates days across weeks up to `until`, as long as `goes_on` returns true.
fn step_until(
    run: &mut Session,
    until: u32,
    goes_on: &dyn Fn(u32) -> bool,
    progress: &mut dyn FnMut(&DayReport<'_>),
) -> Result<WeekResult, Rejection> {
    let mut notices = Vec::new();
    loop {
        let mut week = run.step_while(goes_on, until - run.day(), progress)?;
        notices.append(&mut week.notices);
        if run.day() >= until || week.ended.is_some() || week.remark.is_some() || !goes_on(run.day()) {
            return Ok(WeekResult { notices, ..week });
        }
    }
}

struct WorldCapture {
    day: u32,
    world: Mutex<Option<World>>,
}

impl DayObserver for WorldCapture {
    fn on_day_end(&self, world: &World, _: &Params, _: &Facts) {
        if world.day == self.day {
            *self.world.lock().unwrap_or_else(PoisonError::into_inner) = Some(world.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{NewRun, Storage};
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::mode::Mode;
    use novamind_record::rules::{ResultsDisclosure, SessionRules};
    use novamind_record::stamp::StudyStamp;

    #[test]
    fn inspection_follows_result_rules_of_the_study() {
        let folder = tempfile::tempdir().expect("a folder");
        let storage = Storage::Runs(folder.path().to_owned());
        let new = NewRun { mode: Mode::Baseline, days: Some(28), storage, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        let forecasts = session.company().naive_forecasts();
        session
            .advance("wait", &forecasts, novamind_record::trajectory::record::Via::Script, &mut |_| {})
            .expect("a week");
        session.abandon().expect("it ends");
        let sql = "SELECT count(*) FROM hidden.groups";
        for (practice, results, is_shown) in [
            (false, ResultsDisclosure::Own, true),
            (true, ResultsDisclosure::Own, false),
            (false, ResultsDisclosure::None, false),
        ] {
            session.manifest_mut().study = Some(StudyStamp::pilot_study(practice));
            session.manifest_mut().rules =
                Some(SessionRules { results, ..SessionRules::for_mode(Mode::Baseline) });
            let inspection =
                InspectionPermit::start(&mut session, "sql", sql, None).map_err(|rejection| rejection.code);
            let asked = InspectionPermit::open_hidden_tables(&mut session)
                .map(drop)
                .map_err(|rejection| rejection.code);
            assert_eq!(asked, inspection.map(drop), "{practice} {results:?}");
            assert_eq!(asked.is_ok(), is_shown, "{practice} {results:?}");
            assert!(is_shown || asked == Err("not_in_this_mode"));
        }
    }
}
