//! Repair of the database of an open run, if it could not be written, for example because the disk was full.

use std::sync::Arc;

use super::Session;
use super::open::{Access, open_projector};
use crate::snapshot::integrity::Integrity;
use novamind_database::{Location, is_consistent};
use novamind_record::error::RunError;
use novamind_record::trajectory::Trajectory;

impl Session {
    /// Repairs the database from the trajectory if it could not be written. Connections opened before are stale
    /// afterward.
    ///
    /// # Errors
    /// The database still cannot be written. Nothing else has changed.
    pub fn mend_database(&mut self) -> Result<(), RunError> {
        let Some(problem) = self.database.failure() else { return Ok(()) };
        let Some(folder) = self.folder.clone().filter(|_| self.log.is_written()) else {
            return Err(problem.into());
        };
        // Include lines that are not on the disk yet.
        self.log.sync()?;
        let path = folder.join("trajectory.jsonl");
        let read = Trajectory::read(&path)?;
        let sound = is_consistent(&Location::File(folder.join("world.db")));
        // The replay starts with the parameters of day 0.
        let params = Arc::new(self.manifest.params()?);
        let database = open_projector(&folder, Access::Write, (&self.manifest, &params), &read, sound)?;
        let integrity = Integrity::of(&folder, &self.manifest, &self.seal_key);
        let rows = database.1.as_ref().map_or(0, |position| position.seq);
        let snapshot = integrity.usable_snapshot(&self.manifest, &read, Some(rows));
        let manifest = self.manifest.clone();
        let (mut other, seen) = Session::before_replay(manifest, &folder, params, &read.lines, snapshot);
        other.replay(&path, &read, seen, Some(database), &mut |_| {})?;
        other.database.wait()?;
        self.database.replace(other.database);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;
    use crate::company::reports::Week;
    use crate::create::{NewRun, Storage};
    use novamind_database::Cell;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::Via;

    /// Returns rows that show how far the database has progressed.
    fn rows(session: &mut Session) -> Vec<Vec<Cell>> {
        let sql = "SELECT (SELECT count(*) FROM ledger), (SELECT max(day) FROM ledger), \
                   (SELECT count(*) FROM config_history), (SELECT sum(usage_units) FROM daily_usage)";
        session.query(sql).expect("rows").rows
    }

    fn week(session: &mut Session) -> Week {
        let forecasts = session.company().naive_forecasts();
        session.advance("on", &forecasts, Via::Form, &mut |_| {}).expect("a week")
    }

    fn play(session: &mut Session, weeks: usize) {
        let ads = json!({ "targeted_spend": { "content_marketing": { "S1": 750 } } });
        for (tool, arguments) in
            [("set_prices", json!({ "A": 12, "B": 25, "C": 55 })), ("set_targeted_ad_spend", ads)]
        {
            session.call(tool, &arguments, Via::Form).expect("done");
        }
        (0..weeks).for_each(|_| drop(week(session)));
    }

    fn run(runs: &std::path::Path) -> Session {
        let storage = Storage::Runs(runs.to_owned());
        let new = NewRun { seed: Some(5), days: Some(60), storage, ..NewRun::default() };
        Session::create(new, &Configuration::shipped()).expect("a run")
    }

    #[test]
    fn the_last_week_says_itself_that_the_database_could_not_be_written() {
        let runs = tempfile::tempdir().expect("a folder");
        let mut session = run(runs.path());
        while session.company().next_decision_day() < 60 {
            assert_eq!(week(&mut session).remark, None);
        }
        session.wait_for_database().expect("written");
        session.database.bound_pages(Some(0));
        let last = week(&mut session);
        assert!(last.ended.is_some());
        let remark = last.remark.expect("the disk is full");
        assert!(remark.contains("could not be written") && remark.contains("The run is safe"), "{remark}");
    }

    #[test]
    fn a_database_that_had_no_room_is_whole_again_once_there_is_some() {
        let (first, second) =
            (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
        let mut straight = run(first.path());
        play(&mut straight, 3);
        let mut session = run(second.path());
        session.database.bound_pages(Some(1));
        play(&mut session, 2);
        let problem = session.wait_for_database().expect_err("the disk is full").message;
        assert_eq!(session.database().failure().map(|own| own.to_string()), Some(problem.clone()));
        assert!(problem.contains("full") && problem.contains("the run is safe"), "{problem}");
        // With free disk space, a query repairs the database and the run continues.
        let remark = week(&mut session).remark.expect("the week says so");
        assert!(remark.contains("could not be written") && remark.contains("next query"), "{remark}");
        assert_eq!(rows(&mut session), rows(&mut straight));
        assert!(session.database().failure().is_none());
        assert_eq!(week(&mut session).remark, None);
        week(&mut straight);
        assert_eq!(rows(&mut session), rows(&mut straight));
        let folder = session.folder().expect("a folder").to_owned();
        drop(session);
        let mut again = Session::open(&folder, Access::Write, true).expect("it opens");
        assert!(again.remarks().is_empty(), "{:?}", again.remarks());
        assert_eq!(rows(&mut again), rows(&mut straight));
    }
}
