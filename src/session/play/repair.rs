//! Repair of the database of an open run after a failed write, for example because the disk was full.

use std::sync::Arc;

use super::Session;
use super::open::{Access, open_projector};
use crate::snapshot::integrity::Integrity;
use novamind_database::{DatabaseLocation, is_consistent};
use novamind_record::error::RunError;
use novamind_record::trajectory::Trajectory;

impl Session {
    /// Repairs the database from the trajectory if an earlier write failed. After a repair, earlier connections are
    /// stale.
    ///
    /// # Errors
    /// The database still cannot be written. In this case, nothing has changed.
    pub fn repair_database(&mut self) -> Result<(), RunError> {
        let Some(problem) = self.database.failure() else { return Ok(()) };
        let Some(folder) = self.folder.clone().filter(|_| self.log.is_written()) else {
            return Err(problem.into());
        };
        // Include lines that are not on the disk yet.
        self.log.sync()?;
        let path = folder.join("trajectory.jsonl");
        let read = Trajectory::read(&path)?;
        let sound = is_consistent(&DatabaseLocation::File(folder.join("world.db")));
        // The replay starts with the parameters that were in force on day 0.
        let params = Arc::new(self.manifest.load_params()?);
        let database = open_projector(&folder, Access::Write, (&self.manifest, &params), &read, sound)?;
        let integrity = Integrity::read(&folder, &self.manifest, &self.seal_key);
        let rows = database.1.as_ref().map_or(0, |position| position.seq);
        let snapshot = integrity.usable_snapshot(&self.manifest, &read, Some(rows));
        let manifest = self.manifest.clone();
        let (mut other, seen) = Session::prepare_replay(manifest, &folder, params, &read.lines, snapshot);
        other.replay(&path, &read, seen, Some(database), &mut |_| {})?;
        other.database.wait_until_written()?;
        self.database.replace(other.database);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::company::reports::WeekResult;
    use crate::create::{NewRun, Storage};
    use novamind_database::Cell;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::Via;

    /// Returns rows that show how far the database has progressed.
    fn database_progress(session: &mut Session) -> Vec<Vec<Cell>> {
        let sql = "SELECT (SELECT count(*) FROM ledger), (SELECT max(day) FROM ledger), \
                   (SELECT count(*) FROM config_history), (SELECT sum(usage_units) FROM daily_usage)";
        session.query(sql).expect("rows").rows
    }

    fn advance_week(session: &mut Session) -> WeekResult {
        let forecasts = session.company().naive_forecasts();
        session.advance("on", &forecasts, Via::Form, &mut |_| {}).expect("a week")
    }

    fn play_weeks(session: &mut Session, weeks: usize) {
        let ads = json!({ "targeted_spend": { "content_marketing": { "S1": 750 } } });
        for (tool, arguments) in
            [("set_prices", json!({ "A": 12, "B": 25, "C": 55 })), ("set_targeted_ad_spend", ads)]
        {
            session.call(tool, &arguments, Via::Form).expect("done");
        }
        (0..weeks).for_each(|_| drop(advance_week(session)));
    }

    fn new_run(runs: &std::path::Path) -> Session {
        let storage = Storage::Runs(runs.to_owned());
        let new = NewRun { seed: Some(5), days: Some(60), storage, ..NewRun::default() };
        Session::create(new, &Configuration::bundled()).expect("a run")
    }

    #[test]
    fn last_week_reports_a_database_write_failure() {
        let runs = tempfile::tempdir().expect("a folder");
        let mut session = new_run(runs.path());
        while session.company().next_decision_day() < 60 {
            assert_eq!(advance_week(&mut session).remark, None);
        }
        session.wait_for_database().expect("written");
        session.database.limit_pages(Some(0));
        let last = advance_week(&mut session);
        assert!(last.ended.is_some());
        let remark = last.remark.expect("the disk is full");
        assert!(remark.contains("could not be written") && remark.contains("The run is safe"), "{remark}");
    }

    #[test]
    fn query_repairs_the_database_after_disk_space_is_available() {
        let (first, second) =
            (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
        let mut straight = new_run(first.path());
        play_weeks(&mut straight, 3);
        let mut session = new_run(second.path());
        session.database.limit_pages(Some(1));
        play_weeks(&mut session, 2);
        let problem = session.wait_for_database().expect_err("the disk is full").message;
        assert_eq!(
            session.database().failure().map(|projection_error| projection_error.to_string()),
            Some(problem.clone())
        );
        assert!(problem.contains("full") && problem.contains("the run is safe"), "{problem}");
        // After disk space is available, a query repairs the database and the run continues.
        let remark = advance_week(&mut session).remark.expect("the week has a remark");
        assert!(remark.contains("could not be written") && remark.contains("next query"), "{remark}");
        assert_eq!(database_progress(&mut session), database_progress(&mut straight));
        assert!(session.database().failure().is_none());
        assert_eq!(advance_week(&mut session).remark, None);
        advance_week(&mut straight);
        assert_eq!(database_progress(&mut session), database_progress(&mut straight));
        let folder = session.folder().expect("a folder").to_owned();
        drop(session);
        let mut again = Session::open(&folder, Access::Write, true).expect("it opens");
        assert!(again.remarks().is_empty(), "{:?}", again.remarks());
        assert_eq!(database_progress(&mut again), database_progress(&mut straight));
    }
}
