//! Current states of a study's runs on a machine, for `study watch`.

use std::path::Path;

use serde::Serialize;

use crate::definition::Study;
use novamind_record::clock::{now, parse_seconds};
use novamind_record::folder::lock::is_locked;
use novamind_record::folder::manifest::Manifest;
use novamind_record::folder::manifest_check::ManifestCheck;
use novamind_record::folder::runs::{all_run_folders, read_last_lines};
use novamind_record::trajectory::record::{Activity, ClockEvent, Outcome, PresenceEvent};
use novamind_record::trajectory::{Line, Record};

/// The current state of a run of a study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SessionStatus {
    /// Label of the participant.
    pub participant: String,
    /// ID of the run.
    pub run: String,
    /// Whether the run is the practice run.
    pub practice: bool,
    /// State of the participant.
    pub state: SessionState,
    /// Last simulated day.
    pub day: u32,
    /// Planned last day of the run.
    pub days: u32,
    /// Seconds since the last line of the trajectory.
    pub quiet_seconds: f64,
    /// Seconds since the run was created.
    #[serde(skip)]
    pub elapsed_seconds: f64,
    /// Problems with the record: damage, or the last failure to save.
    pub problems: Vec<String>,
}

/// The state of a participant in a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SessionState {
    /// The participant is playing the run.
    Plays,
    /// The run is open, and the participant is idle or has suspended the program.
    Idle,
    /// The participant has stopped the clock.
    Paused,
    /// The participant has closed the run.
    Left,
    /// The program ended without closing the run.
    Stopped,
    /// The run has ended.
    Over,
}

/// Returns the states of a study's runs in a machine's folder of runs, sorted by label and run.
pub fn session_statuses(study: &Study, runs: &Path) -> Vec<SessionStatus> {
    let folders = all_run_folders(runs);
    let entries = folders.iter().flat_map(|folder| std::fs::read_dir(folder).into_iter().flatten().flatten());
    let statuses = entries.filter_map(|entry| {
        let folder = entry.path();
        let manifest = ManifestCheck::read(&folder).ok()?.manifest;
        let is_own = manifest.study.as_ref().is_some_and(|stamp| stamp.digest == study.digest);
        is_own.then(|| session_status(&folder, &manifest))
    });
    let mut status: Vec<SessionStatus> = statuses.collect();
    status.sort_by(|one, other| (&one.participant, &one.run).cmp(&(&other.participant, &other.run)));
    status
}

fn session_status(folder: &Path, manifest: &Manifest) -> SessionStatus {
    let (lines, damaged) = match read_last_lines(&folder.join("trajectory.jsonl")) {
        Ok(lines) => (lines, None),
        Err(problem) => (Vec::new(), Some(problem)),
    };
    let quiet = lines.last().map_or(0.0, |line| (parse_seconds(&now()) - line.at_seconds()).max(0.0));
    let mut problems: Vec<String> = damaged.into_iter().collect();
    problems.extend(last_save_error(&lines));
    SessionStatus {
        participant: manifest.participant.clone().unwrap_or_default(),
        run: manifest.id.clone(),
        practice: manifest.study.as_ref().is_some_and(|stamp| stamp.practice),
        state: session_state(&lines, is_locked(folder)),
        day: lines.iter().rev().find(|line| line.closes_days()).map_or(0, |line| line.day),
        days: manifest.days,
        quiet_seconds: quiet,
        elapsed_seconds: (parse_seconds(&now()) - parse_seconds(&manifest.created)).max(0.0),
        problems,
    }
}

/// Returns the message of the last failure to save, or `None` if a later call or week was saved.
fn last_save_error(lines: &[Line]) -> Option<String> {
    lines.iter().rev().find_map(|line| match &line.record {
        Record::Call(call) => Some(match &call.outcome {
            Outcome::Rejected(rejection) if rejection.code == "not_saved" => Some(rejection.message.clone()),
            _ => None,
        }),
        Record::Week(_) => Some(None),
        _ => None,
    })?
}

fn session_state(lines: &[Line], locked: bool) -> SessionState {
    let state = lines.iter().rev().find_map(|line| match &line.record {
        Record::End(_) => Some(SessionState::Over),
        Record::Activity(Activity::Clock(clock)) if clock.event == ClockEvent::Stopped => {
            Some(SessionState::Paused)
        }
        Record::Activity(Activity::Session(presence)) => match presence.event {
            PresenceEvent::Closed => Some(SessionState::Left),
            PresenceEvent::Idle | PresenceEvent::Suspended => Some(SessionState::Idle),
            _ => Some(SessionState::Plays),
        },
        Record::Call(_) | Record::Advance(_) | Record::Week(_) | Record::Query(_) => {
            Some(SessionState::Plays)
        }
        _ => None,
    });
    match state.unwrap_or(SessionState::Plays) {
        // If the run is not locked and no line records that it was closed, the program was killed.
        SessionState::Plays | SessionState::Idle | SessionState::Paused if !locked => SessionState::Stopped,
        state => state,
    }
}
