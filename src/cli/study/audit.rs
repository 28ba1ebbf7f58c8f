//! `novamind study audit`: finds contradictions within and between the records of a study.

use std::path::PathBuf;

use clap::Args;

use super::read_study;
use crate::cli::{Context, Failure, print};
use crate::database::{Cell, QueryResult};
use crate::formatting::escape_control_characters;
use crate::plain::format_result;
use novamind_study::{AuditFinding, AuditReport, RunFacts, Study, audit_study};

#[derive(Debug, Args)]
pub struct Options {
    /// Folder of the study
    #[arg(value_name = "DIR")]
    folder: PathBuf,
    /// Folders of runs of the study's machines, or copies of these folders [default: this machine's folder of runs]
    #[arg(value_name = "RUNS")]
    machines: Vec<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Prints the audit of a study. Fails with exit code 1 if the audit has findings.
pub fn run(options: &Options, context: &Context) -> Result<(), Failure> {
    let study = read_study(&options.folder)?;
    let machines = context.machine_folders(&options.machines)?;
    let audit = audit_study(&study, &machines)?;
    if options.json {
        print(&(serde_json::to_string_pretty(&audit).unwrap_or_default() + "\n"))?;
    } else {
        // Labels and records from other machines may contain control characters.
        print(&escape_control_characters(&describe_audit(&study, &audit)))?;
    }
    match audit.findings.len() {
        0 => Ok(()),
        1 => Err(Failure::failed("1 finding")),
        count => Err(Failure::failed(format!("{count} findings"))),
    }
}

fn describe_audit(study: &Study, audit: &AuditReport) -> String {
    let mut text = format!("{} · protocol {}\n\n", study.protocol.name, &study.digest[..16]);
    text += &format_result(&facts_table(&audit.runs));
    text += &format!("\n\n{}\n\n", audit.visits);
    if audit.runs_of_other_studies > 0 {
        text += &format!("Runs of other studies, not examined: {}.\n\n", audit.runs_of_other_studies);
    }
    for finding in &audit.findings {
        text += &finding_line(finding);
    }
    if audit.findings.is_empty() {
        text += "No findings.\n";
    }
    text
}

fn finding_line(finding: &AuditFinding) -> String {
    let who = finding.participant.as_deref().unwrap_or("?");
    let line = finding.line.map_or(String::new(), |line| format!(", line {line}"));
    let at = if finding.at.is_empty() { String::new() } else { format!(", {}", finding.at) };
    let place = match finding.run.as_str() {
        "" => String::new(),
        run => format!("{who}, run {run}{line}{at}: "),
    };
    format!("{place}{}\n  {}\n", finding.kind.title(), finding.words)
}

/// Returns a table with one row of facts per run.
fn facts_table(runs: &[RunFacts]) -> QueryResult {
    let columns = [
        "participant",
        "run",
        "kind",
        "condition",
        "weeks",
        "ended",
        "sittings",
        "unclosed",
        "refusals",
        "naive",
        "fast",
        "pasted",
        "failed checks",
        "longest time between two lines, s",
    ];
    let row = |run_facts: &RunFacts| {
        let text = |text: &Option<String>| text.clone().map_or(Cell::Text(String::new()), Cell::Text);
        let number = |number: u32| Cell::Integer(i64::from(number));
        vec![
            text(&run_facts.participant),
            Cell::Text(run_facts.run.clone()),
            Cell::Text(if run_facts.practice { "practice" } else { "session" }.to_owned()),
            text(&run_facts.condition),
            number(run_facts.weeks),
            text(&run_facts.ended),
            number(run_facts.sittings),
            number(run_facts.unclosed_sittings),
            number(run_facts.refusals),
            number(run_facts.naive_weeks),
            number(run_facts.fast_weeks),
            run_facts.pasted.map_or(Cell::Null, |pasted| Cell::Integer(pasted as i64)),
            number(run_facts.failed_checks),
            Cell::Integer(run_facts.longest_gap.round() as i64),
        ]
    };
    QueryResult {
        columns: columns.map(str::to_owned).to_vec(),
        rows: runs.iter().map(row).collect(),
        ..QueryResult::default()
    }
}
