//! Inspections: hidden state is shown only after an inspection was permitted and recorded.

use std::sync::{Arc, Mutex, PoisonError};

use super::shadow::Shadow;
use crate::company::reports::{DayReport, Week};
use crate::company::xray::Xray;
use crate::play::Session;
use novamind_database::{QueryConnection, Scope};
use novamind_record::trajectory::record::{Activity, XrayLook};
use novamind_record::trajectory::{Durability, Record};
use novamind_tools::Refusal;
use novamind_world::customers::FIRST_CUSTOMER;
use novamind_world::day::watch::{DayWatch, Unwatched};
use novamind_world::events::Facts;
use novamind_world::identifiers::Group;
use novamind_world::params::Params;
use novamind_world::state::World;

/// A permitted and recorded inspection of the hidden state of a run.
#[derive(Debug)]
pub struct Look {
    run: String,
    day: u32,
}

impl Look {
    /// Starts an inspection of a day, by default the last one. It is recorded before anything is shown.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `read_only`, `not_saved`.
    pub fn begin(run: &mut Session, what: &str, which: &str, day: Option<u32>) -> Result<Look, Refusal> {
        run.refuse_to_look_inside()?;
        let day = Look::day_to_show(run, day)?;
        Look::record(run, what, which, day)
    }

    /// Starts an inspection of the current state of the run. `shown_day` is the day in the record.
    ///
    /// # Errors
    /// `not_in_this_mode`, `read_only`, `not_saved`.
    pub fn begin_at(run: &mut Session, what: &str, which: &str, shown_day: u32) -> Result<Look, Refusal> {
        run.refuse_to_look_inside()?;
        Look::record(run, what, which, shown_day)
    }

    /// Starts an inspection of a customer on a day, by default the last one. Also returns the customer's group, its
    /// number in the group and its arrival day.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown` (also if the customer arrived later), `customer_not_found`, `read_only`,
    /// `not_saved`.
    pub fn begin_at_customer(
        run: &mut Session,
        customer: u32,
        day: Option<u32>,
    ) -> Result<(Look, (Group, u32), u32), Refusal> {
        run.refuse_to_look_inside()?;
        let day = Look::day_to_show(run, day)?;
        let customers = &run.simulation().world.customers;
        let Some(found) = customers.find(customer) else {
            let message = match customers.next_customer {
                FIRST_CUSTOMER => "there are no customers yet".to_owned(),
                next => format!(
                    "there is no customer {customer}; choose one from {FIRST_CUSTOMER} to {}",
                    next - 1
                ),
            };
            return Err(Refusal::at("customer_id", "customer_not_found", message));
        };
        let arrival = customers.numbers.arrival_day(customer).unwrap_or(0);
        if arrival > day {
            let message = format!("customer {customer} arrived on day {arrival}, after day {day}");
            return Err(Refusal::at("day", "day_unknown", message));
        }
        Ok((Look::record(run, "customer", &customer.to_string(), day)?, found, arrival))
    }

    /// Returns the day to show, by default the last one.
    ///
    /// # Errors
    /// `day_unknown`: it has not been simulated.
    pub fn day_to_show(run: &Session, day: Option<u32>) -> Result<u32, Refusal> {
        let last = run.day();
        let refused = |message: String| Err(Refusal::at("day", "day_unknown", message));
        match day.unwrap_or(last) {
            _ if last == 0 => refused("no day has run yet".to_owned()),
            day if (1..=last).contains(&day) => Ok(day),
            day => refused(format!("there is no day {day}; choose a day from 1 to {last}")),
        }
    }

    /// Opens a connection to the database on which the hidden tables exist and are empty.
    ///
    /// # Errors
    /// `not_in_this_mode`; the run has no database.
    pub fn hidden_tables(run: &mut Session) -> Result<QueryConnection, Refusal> {
        run.refuse_to_look_inside()?;
        run.complete_database()?.open_connection_to(Scope::Hidden)
    }

    /// Records an inspection before anything is shown.
    ///
    /// # Errors
    /// `read_only` if the run is open read-only, `not_saved`.
    fn record(run: &mut Session, what: &str, which: &str, shown_day: u32) -> Result<Look, Refusal> {
        if !run.log().is_written() {
            let message =
                "an inspection must be recorded, but this run is open read-only; open it to play it";
            return Err(Refusal::new("read_only", message));
        }
        let look = XrayLook { what: what.to_owned(), which: which.to_owned(), shown_day };
        let line = Record::Activity(Activity::Xray(look));
        let appended = run.append(&line, Durability::Synced);
        appended.map_err(|error| Refusal::new("not_saved", error.to_string()))?;
        Ok(Look { run: run.manifest().id.clone(), day: shown_day })
    }

    /// Returns the day that it shows.
    pub fn day(&self) -> u32 {
        self.day
    }

    /// Returns the current hidden state of the run.
    pub fn inside<'a>(&self, run: &'a Session) -> Xray<'a> {
        self.assert_is_of(run);
        run.hidden_state()
    }

    /// Returns a copy of the run before its first line. It passes its days to `watch`.
    ///
    /// # Errors
    /// `not_possible`: the run has no folder; `not_readable`.
    pub fn shadow(&self, run: &Session, watch: Arc<dyn DayWatch>) -> Result<Shadow, Refusal> {
        self.assert_is_of(run);
        Shadow::of(run, watch)
    }

    fn assert_is_of(&self, run: &Session) {
        debug_assert_eq!(
            self.run,
            run.manifest().id,
            "an inspection is valid only for the run that recorded it"
        );
    }

    /// Simulates the days of the run again up to `day`, at most to the end of its week, and passes them to `watch`.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub fn watch_up_to(&self, run: &Session, day: u32, watch: Arc<dyn DayWatch>) -> Result<(), Refusal> {
        self.assert_is_of(run);
        watch_up_to(run, day, watch)
    }

    /// Returns the world at the end of a past day.
    ///
    /// # Errors
    /// `not_possible`, `not_readable`.
    pub fn world_on(&self, run: &Session, day: u32) -> Result<World, Refusal> {
        let evening = Arc::new(Evening { day, world: Mutex::default() });
        self.watch_up_to(run, day, evening.clone())?;
        let world = evening.world.lock().unwrap_or_else(PoisonError::into_inner).take();
        world.ok_or_else(|| Refusal::new("not_readable", format!("the record does not lead to day {day}")))
    }
}

fn watch_up_to(run: &Session, day: u32, watch: Arc<dyn DayWatch>) -> Result<(), Refusal> {
    Shadow::of(run, watch)?.lead(run, |reached| reached < day, &mut |_| {})
}

/// Days to simulate, with the watch that receives them.
pub struct WatchedDays<'a> {
    /// Number of days.
    pub days: u32,
    /// Receives the days.
    pub watch: Arc<dyn DayWatch>,
    /// Whether the watch receives the past days first.
    pub shows_past: bool,
    /// Returns whether to continue after a day.
    pub goes_on: &'a dyn Fn(u32) -> bool,
    /// Inspections to record afterward: their kind, and the subject of each.
    pub looks: (&'a str, Vec<String>),
}

impl WatchedDays<'_> {
    /// Simulates at least one day of a debug run and passes the days to the watch. Both continuing and stopping
    /// reveal hidden state, so each inspection is recorded on the last day. Without inspections, the watch receives
    /// nothing.
    ///
    /// # Errors
    /// `not_in_this_mode`, `run_over`, `not_possible`, `not_readable`; `not_saved`: days may have run.
    pub fn step(self, run: &mut Session, progress: &mut dyn FnMut(&DayReport<'_>)) -> Result<Week, Refusal> {
        run.refuse_to_look_inside()?;
        run.refuse_to_step()?;
        let WatchedDays { days, watch, shows_past, goes_on, looks: (what, which) } = self;
        let until = run.day().saturating_add(days.max(1));
        if which.is_empty() {
            return step_on(run, until, &|_| true, progress);
        }
        if shows_past {
            watch_up_to(run, run.day(), watch.clone())?;
        }
        run.set_watch(watch);
        let week = step_on(run, until, goes_on, progress);
        run.set_watch(Arc::new(Unwatched));
        let week = week?;
        for which in which {
            Look::record(run, what, &which, run.day())?;
        }
        Ok(week)
    }
}

/// Simulates days across weeks up to `until`, as long as `goes_on` returns true.
fn step_on(
    run: &mut Session,
    until: u32,
    goes_on: &dyn Fn(u32) -> bool,
    progress: &mut dyn FnMut(&DayReport<'_>),
) -> Result<Week, Refusal> {
    let mut notices = Vec::new();
    loop {
        let mut week = run.step_while(goes_on, until - run.day(), progress)?;
        notices.append(&mut week.notices);
        if run.day() >= until || week.ended.is_some() || week.remark.is_some() || !goes_on(run.day()) {
            return Ok(Week { notices, ..week });
        }
    }
}

struct Evening {
    day: u32,
    world: Mutex<Option<World>>,
}

impl DayWatch for Evening {
    fn day_over(&self, world: &World, _: &Params, _: &Facts) {
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
    use novamind_record::rules::{ResultsShown, SessionRules};
    use novamind_record::stamp::StudyStamp;

    #[test]
    fn a_run_of_which_its_study_shows_no_results_stays_closed_once_it_is_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let storage = Storage::Runs(folder.path().to_owned());
        let new = NewRun { mode: Mode::Baseline, days: Some(28), storage, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
        let forecasts = session.company().naive_forecasts();
        session
            .advance("wait", &forecasts, novamind_record::trajectory::record::Via::Script, &mut |_| {})
            .expect("a week");
        session.end().expect("it ends");
        let sql = "SELECT count(*) FROM hidden.groups";
        for (practice, results, is_shown) in [
            (false, ResultsShown::Own, true),
            (true, ResultsShown::Own, false),
            (false, ResultsShown::None, false),
        ] {
            session.manifest_mut().study = Some(StudyStamp::pilot(practice));
            session.manifest_mut().rules =
                Some(SessionRules { results, ..SessionRules::of_mode(Mode::Baseline) });
            let look = Look::begin(&mut session, "sql", sql, None).map_err(|refusal| refusal.code);
            let asked = Look::hidden_tables(&mut session).map(drop).map_err(|refusal| refusal.code);
            assert_eq!(asked, look.map(drop), "{practice} {results:?}");
            assert_eq!(asked.is_ok(), is_shown, "{practice} {results:?}");
            assert!(is_shown || asked == Err("not_in_this_mode"));
        }
    }
}
