//! Record of commands that read an unfinished baseline run. A read is recorded because the participant can learn from
//! the output.

use std::path::Path;

use crate::play::Session;
use crate::play::open::Access;
use novamind_record::error::RunError;
use novamind_record::folder::lock::lock_run;
use novamind_record::folder::manifest_check::read_manifest;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::{Activity, ExternalRead};
use novamind_record::trajectory::{Durability, Record, Trajectory, TrajectoryWriter};

/// Records that a command reads the baseline run in a folder. Does nothing for ended runs, for other modes, and for
/// folders that cannot be written.
///
/// # Errors
/// The run is in use or damaged, or the line cannot be written.
pub fn record_external_read(folder: &Path, command: &str, detail: &str) -> Result<(), RunError> {
    let manifest = read_manifest(folder)?;
    if manifest.mode != Mode::Baseline || !manifest.session_rules().records_activity("look") {
        return Ok(());
    }
    let path = folder.join("trajectory.jsonl");
    if Trajectory::read(&path)?.end_line().is_some() {
        return Ok(());
    }
    let lock = match lock_run(folder, &manifest.id) {
        Ok(lock) => lock,
        Err(RunError::NotWritable { .. }) => return Ok(()),
        Err(RunError::InUse { id, holder }) => {
            // Do not suggest watching a run of a study: only the experimenter can do that.
            let watch = if manifest.study.is_none() {
                format!(", or watch it with `novamind play --run {id} --watch`")
            } else {
                String::new()
            };
            return Err(RunError::InvalidRequest(format!(
                "baseline run {id} is being played ({holder}), and the output of {command} would not be recorded; try \
                 again when the run is closed{watch}"
            )));
        }
        Err(error) => return Err(error),
    };
    let activity =
        Activity::ExternalRead(ExternalRead { command: command.to_owned(), detail: detail.to_owned() });
    let trajectory = Trajectory::read(&path)?;
    if trajectory.unfinished_bytes > 0 || has_pending_week(&trajectory) {
        // First open the interrupted run for play, which removes an unfinished line and completes an interrupted week.
        drop(lock);
        let mut session = Session::open(folder, Access::Write, true)?;
        session.activity().record(activity);
        return session.save();
    }
    let day = trajectory.lines.last().map_or(0, |line| line.day);
    let mut writer = TrajectoryWriter::resume(&path, &trajectory)?;
    writer.append(day, &Record::Activity(activity), Durability::Synced)?;
    drop(lock);
    Ok(())
}

fn has_pending_week(trajectory: &Trajectory) -> bool {
    let open = trajectory.lines.iter().rev().find_map(|line| match line.record {
        Record::Advance(_) => Some(true),
        Record::Week(_) | Record::Step(_) => Some(false),
        _ => None,
    });
    open == Some(true)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::create::{NewRun, Storage};
    use crate::resume::verify::verify;
    use novamind_record::folder::configuration::Configuration;
    use novamind_record::trajectory::record::Via;
    use serde_json::json;

    fn baseline_run(runs: &Path, weeks: usize) -> (std::path::PathBuf, Session) {
        let new = NewRun {
            seed: Some(3),
            days: Some(28),
            mode: Mode::Baseline,
            participant: Some("P01".to_owned()),
            storage: Storage::Runs(runs.to_owned()),
            ..NewRun::default()
        };
        let mut session = Session::create(new, &Configuration::bundled()).expect("a run");
        for _ in 0..weeks {
            let forecasts = session.company().naive_forecasts();
            session.advance("wait", &forecasts, Via::Script, &mut |_| {}).expect("a week");
        }
        (session.folder().expect("a folder").to_owned(), session)
    }

    fn external_reads(folder: &Path) -> Vec<String> {
        let trajectory = Trajectory::read(&folder.join("trajectory.jsonl")).expect("lines");
        let external_read = |record: &Record| match record {
            Record::Activity(Activity::ExternalRead(external_read)) => {
                Some(format!("{} {}", external_read.command, external_read.detail))
            }
            _ => None,
        };
        trajectory.lines.iter().filter_map(|line| external_read(&line.record)).collect()
    }

    #[test]
    fn external_reads_are_recorded_and_the_run_continues() {
        let runs = tempfile::tempdir().expect("a folder");
        let (folder, mut session) = baseline_run(runs.path(), 1);
        let refused = record_external_read(&folder, "query", "SELECT 1").expect_err("the run is in use");
        assert!(refused.to_string().contains("being played"), "{refused}");
        session.save().expect("saved");
        drop(session);
        record_external_read(&folder, "query", "SELECT 1").expect("recorded");
        // The first line of the trajectory, not `run.toml`, defines the mode.
        let manifest = folder.join("run.toml");
        let text = std::fs::read_to_string(&manifest).expect("a manifest");
        std::fs::write(&manifest, text.replace("\"baseline\"", "\"sandbox\"")).expect("written");
        record_external_read(&folder, "report", "markdown").expect("recorded");
        std::fs::write(&manifest, text).expect("written");
        let mut session = Session::open(&folder, Access::Write, true).expect("it opens");
        assert_eq!(session.remarks(), [] as [&str; 0], "database and snapshot are unchanged");
        let rows = session.query("SELECT max(day) FROM ledger").expect("rows");
        assert_eq!(rows.rows.len(), 1);
        session.call(novamind_tools::ToolId::SetPrices, &json!({"A": 12}), Via::Script).expect("a call");
        let forecasts = session.company().naive_forecasts();
        session.advance("wait", &forecasts, Via::Script, &mut |_| {}).expect("a week");
        drop(session);
        assert_eq!(external_reads(&folder), ["query SELECT 1", "report markdown"]);
        assert_eq!(verify(&folder).expect("it verifies").states, 2);
    }

    #[test]
    fn external_read_finishes_an_interrupted_week_first() {
        let runs = tempfile::tempdir().expect("a folder");
        let (folder, session) = baseline_run(runs.path(), 1);
        drop(session);
        let path = folder.join("trajectory.jsonl");
        let text = std::fs::read_to_string(&path).expect("lines");
        let lines: Vec<&str> = text.lines().collect();
        let advance = lines.iter().position(|line| line.contains("\"kind\":\"advance\"")).expect("a week");
        // The program was killed after the `advance` line, while writing the `week` line.
        std::fs::write(&path, lines[..=advance].join("\n") + "\n{\"seq\"").expect("written");
        for name in ["world.db", "snapshot.bin"] {
            let _ = std::fs::remove_file(folder.join(name));
        }
        record_external_read(&folder, "query", "SELECT 1").expect("recorded");
        assert_eq!(external_reads(&folder), ["query SELECT 1"]);
        assert_eq!(verify(&folder).expect("it verifies").states, 1);
    }

    #[test]
    fn external_reads_of_other_modes_are_not_recorded() {
        let runs = tempfile::tempdir().expect("a folder");
        let storage = Storage::Runs(runs.path().to_owned());
        let new = NewRun { days: Some(28), storage, ..NewRun::default() };
        let session = Session::create(new, &Configuration::bundled()).expect("a run");
        let folder = session.folder().expect("a folder").to_owned();
        record_external_read(&folder, "query", "SELECT 1").expect("a sandbox may be read while it is played");
        drop(session);
        record_external_read(&folder, "query", "SELECT 1").expect("and later");
        assert_eq!(external_reads(&folder), [] as [&str; 0]);
    }
}
