//! `hidden.*`: what is hidden as tables, beside those of the company (docs/formats/hidden-tables.md).

use super::hidden_tables::{CUSTOMERS, HiddenTables, ShownCustomers, THREADS};
use crate::ask::query_refusal;
use crate::state::Session;
use novamind_database::{Interrupt, Rows, Scope, Table, Ticket};
use novamind_tools::Refusal;

impl Session {
    /// Answers a statement that may read the hidden tables. `hidden.customers` shows a day, the last one if none is named;
    /// all others have every day. The look is recorded.
    ///
    /// # Errors
    /// `not_in_this_mode`, `day_unknown`, `not_possible`, `not_readable`, `not_saved`, the `sql_` codes.
    pub fn xray_query(&mut self, sql: &str, day: Option<u32>) -> Result<Rows, Refusal> {
        let ticket = self.xray_interrupt()?.ticket();
        self.xray_query_as(ticket, sql, day)
    }

    /// The same under a ticket of [`Session::xray_interrupt`] that was drawn when the statement was asked for.
    ///
    /// # Errors
    /// As [`Session::xray_query`].
    pub fn xray_query_as(&mut self, ticket: Ticket, sql: &str, day: Option<u32>) -> Result<Rows, Refusal> {
        let day = self.begin_look("sql", sql, day)?;
        // Tables that went wrong are not kept: the next look begins anew.
        let mut tables = self.take_hidden_tables()?;
        let named = tables.connection().hidden_tables_in(sql);
        // One diary serves all tables: the days are simulated once.
        let keeps_threads = self.diary.keeps_threads() || named.iter().any(|table| table.name == THREADS);
        for table in named {
            match table.name.as_str() {
                CUSTOMERS => self.show_customers(&mut tables, ticket, table, day)?,
                _ => self.add_days(&mut tables, ticket, table, keeps_threads)?,
            }
        }
        let limits = self.query_limits();
        let answer = tables.connection().ask_as(ticket, sql, limits);
        self.hidden_tables = Some(tables);
        answer.map_err(query_refusal)
    }

    /// A handle that stops the running statement on hidden tables.
    ///
    /// # Errors
    /// `not_in_this_mode`; the run has no database.
    pub fn xray_interrupt(&mut self) -> Result<Interrupt, Refusal> {
        self.refuse_to_look_inside()?;
        let tables = self.take_hidden_tables()?;
        Ok(self.hidden_tables.insert(tables).connection().interrupt())
    }

    fn take_hidden_tables(&mut self) -> Result<HiddenTables, Refusal> {
        // The tables of the company are to hold everything up to now, as they do for any other statement.
        self.complete_database()?;
        match self.hidden_tables.take() {
            Some(tables) => Ok(tables),
            None => {
                let tables = HiddenTables::behind(self.projection.open_connection(Scope::Hidden)?);
                if self.diary.keeps_threads() {
                    // Those of its days were handed over to tables that are gone.
                    self.shadow = None;
                }
                Ok(tables)
            }
        }
    }

    fn show_customers(
        &self,
        tables: &mut HiddenTables,
        ticket: Ticket,
        table: &Table,
        day: u32,
    ) -> Result<(), Refusal> {
        let now = &self.simulation.world;
        let is_now = day == now.day;
        let wanted = if is_now { ShownCustomers::now(now) } else { ShownCustomers::Evening(day) };
        if tables.shows(wanted) {
            return Ok(());
        }
        let shown = match is_now {
            true => tables.show(ticket, table, wanted, now),
            false => tables.show(ticket, table, wanted, &self.world_on(day)?),
        };
        shown.map_err(query_refusal)
    }

    fn add_days(
        &mut self,
        tables: &mut HiddenTables,
        ticket: Ticket,
        table: &'static Table,
        keeps_threads: bool,
    ) -> Result<(), Refusal> {
        let day = self.day();
        if !tables.lacks(table, day) {
            return Ok(());
        }
        let diary = self.diary_of_all_days(keeps_threads)?;
        tables.continue_to(day, ticket, table, &diary).map_err(query_refusal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{NewRun, Storage};
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::folder::mode::Mode;
    use novamind_record::rules::{ResultsShown, SessionRules};
    use novamind_record::stamp::StudyStamp;

    #[test]
    fn a_run_of_which_its_study_shows_no_results_stays_closed_once_it_is_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let storage = Storage::Runs(folder.path().to_owned());
        let new = NewRun { mode: Mode::Baseline, days: Some(28), storage, ..NewRun::default() };
        let mut session = Session::create(new, &Configuration::shipped()).expect("a run");
        let forecasts = session.naive_forecasts();
        session.advance("wait", &forecasts, crate::Via::Script, &mut |_| {}).expect("a week");
        session.end().expect("it ends");
        let sql = "SELECT count(*) FROM hidden.groups";
        for (practice, results, is_shown) in [
            (false, ResultsShown::Own, true),
            (true, ResultsShown::Own, false),
            (false, ResultsShown::None, false),
        ] {
            session.manifest.study = Some(StudyStamp::pilot(practice));
            session.manifest.rules = Some(SessionRules { results, ..SessionRules::of_mode(Mode::Baseline) });
            let asked = session.xray_query(sql, None).map_err(|refusal| refusal.code);
            assert_eq!(asked.is_ok(), is_shown, "{practice} {results:?}");
            assert!(is_shown || asked == Err("not_in_this_mode"));
        }
    }
}
