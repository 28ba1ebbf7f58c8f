//! Detects recorded views of hidden state that took place before all sessions with the same seed had ended.

use super::run_record::RunRecord;
use super::{AuditFinding, FindingKind};
use crate::definition::Study;
use novamind_record::clock::parse_seconds;
use novamind_record::folder::manifest::Manifest;
use novamind_record::mode::Mode;
use novamind_record::trajectory::record::Activity;
use novamind_record::trajectory::{Line, Record};
use novamind_session::read_afterwards;

/// The first recorded view of hidden state in a run.
struct HiddenView {
    seconds: f64,
    at: String,
    /// Number of the line, from 1; `None` for a debug run, which shows hidden state from its creation.
    line: Option<u64>,
    words: String,
}

/// Returns a finding for each run in which the hidden state of a session's seed was viewed before the session ended.
/// The record does not identify the viewer.
pub(super) fn hidden_view_findings(study: &Study, runs: &[&RunRecord]) -> Vec<AuditFinding> {
    let sessions: Vec<(&RunRecord, &Manifest, Option<f64>)> =
        runs.iter().filter_map(|run| study_session(study, run)).collect();
    let finding = |run: &&RunRecord| {
        let manifest = run.manifest.as_ref()?;
        let view = first_view(run, manifest)?;
        let is_affected = |(run_record, session, end): &&(&RunRecord, &Manifest, Option<f64>)| {
            run_record.id != run.id
                && session.seed == manifest.seed
                && end.is_none_or(|end| view.seconds < end)
        };
        let mut labels: Vec<&str> = sessions
            .iter()
            .filter(is_affected)
            .filter_map(|(_, session, _)| session.participant.as_deref())
            .collect();
        labels.sort_unstable();
        labels.dedup();
        if labels.is_empty() {
            return None;
        }
        let words = format!(
            "{} of seed {}; sessions of that seed that had not ended: {}",
            view.words,
            manifest.seed,
            labels.join(", ")
        );
        Some(AuditFinding {
            kind: FindingKind::HiddenState,
            run: run.id.clone(),
            participant: manifest.participant.clone(),
            line: view.line,
            at: view.at,
            words,
        })
    };
    runs.iter().filter_map(finding).collect()
}

/// Returns the run with its manifest and the time of its end, or `None` if the run is not a session of the study.
fn study_session<'a>(
    study: &Study,
    run: &'a RunRecord,
) -> Option<(&'a RunRecord, &'a Manifest, Option<f64>)> {
    run.stamp().filter(|stamp| stamp.digest == study.digest && !stamp.practice)?;
    let end = run.trajectory.as_ref().ok().and_then(|trajectory| trajectory.end_line());
    Some((run, run.manifest.as_ref()?, end.map(Line::at_seconds)))
}

fn first_view(run: &RunRecord, manifest: &Manifest) -> Option<HiddenView> {
    if manifest.mode == Mode::Debug {
        let (seconds, at) = (parse_seconds(&manifest.created), manifest.created.clone());
        let words = "this debug run shows the hidden state".to_owned();
        return Some(HiddenView { seconds, at, line: None, words });
    }
    let trajectory = run.trajectory.as_ref().ok()?;
    let afterwards = read_afterwards(&run.folder, trajectory).map_or(Vec::new(), |after| after.lines);
    let mut views = trajectory.lines.iter().chain(&afterwards).filter(|line| is_view(line));
    let first = views.next()?;
    let words = match views.count() {
        0 => "the record has 1 view of the hidden state".to_owned(),
        more => format!("the record has {} views of the hidden state", more + 1),
    };
    Some(HiddenView { seconds: first.at_seconds(), at: first.at.clone(), line: Some(first.seq + 1), words })
}

fn is_view(line: &Line) -> bool {
    matches!(line.record, Record::Activity(Activity::Inspection(_)))
}
