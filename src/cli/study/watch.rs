//! `novamind study watch`: shows all sessions in progress on a machine, or in shared folders of runs.

use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;

use super::read_study;
use crate::cli::{Context, Failure, print};
use crate::database::{Cell, QueryResult};
use crate::formatting::escape_control_characters;
use crate::plain::format_result;
use crate::record::clock::parse_nanoseconds;
use crate::record::folder::runs::participant_folder;
use crate::session::week_of_day;
use novamind_study::{
    REMARKS_FILE, Remark, SessionState, SessionStatus, Study, VisitSummary, has_visited, read_remarks,
    read_study_visits, session_statuses, write_remark,
};

#[derive(Debug, Args)]
pub struct Options {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Folders of runs [default: this machine's folder of runs]
    #[arg(value_name = "RUNS")]
    machines: Vec<PathBuf>,
    /// Print the sessions once and exit
    #[arg(long)]
    once: bool,
    /// Print one JSON object per session and exit
    #[arg(long)]
    json: bool,
    /// Record a note about a participant instead of showing sessions: a label and a text
    #[arg(long, num_args = 2, value_names = ["LABEL", "TEXT"])]
    note: Option<Vec<String>>,
}

/// Time between two refreshes of the display.
const REFRESH_INTERVAL: Duration = Duration::from_secs(2);

pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let study = read_study(&options.folder)?;
    let machines = context.machine_folders(&options.machines)?;
    if let Some([label, text]) = options.note.as_deref() {
        return write_note(&study, &machines, label, text);
    }
    let look = || -> Vec<SessionStatus> {
        machines.iter().flat_map(|runs| session_statuses(&study, runs)).collect()
    };
    if options.json {
        let lines: Vec<String> =
            look().iter().map(|sitting| serde_json::to_string(sitting).unwrap_or_default() + "\n").collect();
        return print(&lines.concat());
    }
    if options.once || !std::io::stdout().is_terminal() {
        return print(&escape_control_characters(&status_text(&study, &look(), &machines)));
    }
    loop {
        // The terminal remains in its normal mode, so that scrolling and ctrl-c work as usual.
        print(&format!(
            "\x1b[H\x1b[2J{}\npress ctrl-c to stop watching\n",
            escape_control_characters(&status_text(&study, &look(), &machines))
        ))?;
        std::thread::sleep(REFRESH_INTERVAL);
    }
}

/// Records a note in the folder that contains the runs of the participant.
fn write_note(study: &Study, machines: &[PathBuf], label: &str, text: &str) -> Result<(), Failure> {
    participant_folder(Path::new(""), label).map_err(Failure::usage)?;
    let last_played = machines.iter().filter_map(|runs| {
        let statuses = session_statuses(study, runs)
            .into_iter()
            .filter(|session_status| session_status.participant == label);
        statuses.map(|status| status.quiet_seconds).min_by(f64::total_cmp).map(|quiet| (quiet, runs))
    });
    let with_runs = last_played.min_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, runs)| runs);
    let visited = |runs: &&PathBuf| has_visited(study, runs, label);
    let is_assigned = study.assignment.as_ref().is_some_and(|assignment| assignment.row_for(label).is_some());
    let place = with_runs.or_else(|| machines.iter().find(visited));
    let place = place.or_else(|| machines.first().filter(|_| is_assigned)).ok_or_else(|| {
        Failure::usage(format!(
            "{label} is not a label of this study: the label is not in the assignment, and no run or visit in these folders has the label. Nothing was recorded"
        ))
    })?;
    write_remark(place, label, text)?;
    print(&format!("recorded a note for {label} in {}\n", place.join(REMARKS_FILE).display()))
}

fn status_text(study: &Study, all: &[SessionStatus], machines: &[PathBuf]) -> String {
    let running = all
        .iter()
        .filter(|session_status| !matches!(session_status.state, SessionState::Left | SessionState::Over))
        .count();
    let places = study
        .assignment
        .as_ref()
        .map_or(String::new(), |assignment| format!(" of {} assigned", assignment.rows.len()));
    let mut people: Vec<&str> = all.iter().map(|status| status.participant.as_str()).collect();
    people.dedup();
    let mut text =
        format!("{} · {running} running · {}{places} started\n\n", study.protocol.name, people.len());
    text += &format_result(&status_table(all));
    text += &format!("\n\n{}\n", visit_summary(study, all, machines));
    let mut noted: Vec<Remark> = machines.iter().flat_map(|runs| read_remarks(runs)).collect();
    noted.sort_by_key(|remark| parse_nanoseconds(&remark.at));
    for remark in noted {
        text += &format!("{} {}: {}\n", remark.at, remark.participant, remark.text);
    }
    text
}

/// Summarizes the visits, including visits in which no run started.
fn visit_summary(study: &Study, all: &[SessionStatus], machines: &[PathBuf]) -> VisitSummary {
    let with_runs = all.iter().map(|session_status| session_status.participant.as_str()).collect();
    VisitSummary::from_lines(&read_study_visits(study, machines), &with_runs)
}

fn status_table(all: &[SessionStatus]) -> QueryResult {
    let columns = ["participant", "run", "kind", "state", "week", "day", "of", "quiet", "problems"];
    let row = |session_status: &SessionStatus| {
        vec![
            Cell::Text(session_status.participant.clone()),
            Cell::Text(session_status.run.clone()),
            Cell::Text(if session_status.practice { "practice" } else { "session" }.to_owned()),
            Cell::Text(describe_state(session_status.state).to_owned()),
            Cell::Integer(i64::from(week_of_day(session_status.day))),
            Cell::Integer(i64::from(session_status.day)),
            Cell::Integer(i64::from(session_status.days)),
            Cell::Text(format_quiet_time(session_status.quiet_seconds)),
            Cell::Text(session_status.problems.join("; ")),
        ]
    };
    QueryResult {
        columns: columns.map(str::to_owned).to_vec(),
        rows: all.iter().map(row).collect(),
        ..QueryResult::default()
    }
}

fn describe_state(state: SessionState) -> &'static str {
    match state {
        SessionState::Plays => "plays",
        SessionState::Idle => "idle",
        SessionState::Paused => "clock stopped",
        SessionState::Left => "left",
        SessionState::Stopped => "ended without leaving",
        SessionState::Over => "over",
    }
}

/// Formats the time since a session wrote the last line of its record.
fn format_quiet_time(seconds: f64) -> String {
    match seconds as u64 {
        0..=59 => format!("{seconds:.0} s"),
        60..=3599 => format!("{:.0} min", seconds / 60.0),
        3600..=86_399 => format!("{:.1} h", seconds / 3600.0),
        _ => format!("{:.0} days", seconds / 86_400.0),
    }
}
