//! Facts about how a run was played, which are reported in addition to findings.

use serde::Serialize;

use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::{Activity, Outcome, has_naive_forecasts};
use novamind_record::trajectory::{Record, Trajectory};
use novamind_session::{Attendance, SessionCount};

/// Facts about how a run of a study was played.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunFacts {
    /// ID of the run.
    pub run: String,
    /// Label of the participant.
    pub participant: Option<String>,
    /// Condition of the participant.
    pub condition: Option<String>,
    /// Whether the run is the practice run.
    pub practice: bool,
    /// Time at which the run was created, RFC 3339.
    pub created: String,
    /// Time of the last line of the trajectory, RFC 3339.
    pub last_at: String,
    /// Number of lines of the trajectory.
    pub lines: u64,
    /// Number of simulated weeks.
    pub weeks: u32,
    /// Reason why the run ended; `None` if the run has not ended.
    pub ended: Option<String>,
    /// Number of times that the run was opened.
    pub sittings: u32,
    /// Number of times that the run was opened and not closed: the program was killed or is still running.
    pub unclosed_sittings: u32,
    /// Number of rejected tool calls and rejected weeks.
    pub refusals: u32,
    /// Number of weeks with at least one naive forecast.
    pub naive_weeks: u32,
    /// Number of weeks that were decided in less than ten active seconds.
    pub fast_weeks: u32,
    /// Number of pasted characters; `None` if the run was never open in the console, because only the console detects
    /// pasted characters.
    pub pasted: Option<u64>,
    /// Number of attention checks that were not answered as expected.
    pub failed_checks: u32,
    /// Longest time between two successive lines, seconds.
    pub longest_gap: f64,
}

impl RunFacts {
    pub(super) fn from_trajectory(manifest: &Manifest, trajectory: &Trajectory) -> Option<RunFacts> {
        let stamp = manifest.study.as_ref()?;
        let sittings = SessionCount::from_lines(&trajectory.lines);
        let mut facts = RunFacts {
            run: manifest.id.clone(),
            participant: manifest.participant.clone(),
            condition: stamp.condition.clone(),
            practice: stamp.practice,
            created: manifest.created.clone(),
            last_at: trajectory.lines.last().map(|line| line.at.clone()).unwrap_or_default(),
            lines: trajectory.lines.len() as u64,
            weeks: 0,
            ended: None,
            sittings: sittings.opened,
            unclosed_sittings: sittings.not_closed,
            refusals: 0,
            naive_weeks: 0,
            fast_weeks: Attendance::from_lines(&trajectory.lines).fast_week_count(),
            pasted: (sittings.in_console > 0).then_some(0),
            failed_checks: 0,
            longest_gap: 0.0,
        };
        let mut before = None::<f64>;
        for line in &trajectory.lines {
            let moment = line.at_seconds();
            facts.longest_gap = facts.longest_gap.max(before.map_or(0.0, |before| moment - before));
            before = Some(moment);
            match &line.record {
                Record::Call(call) if matches!(call.outcome, Outcome::Rejected(_)) => facts.refusals += 1,
                Record::Advance(filed) => {
                    let days_left = manifest.days.saturating_sub(line.day);
                    let is_naive = has_naive_forecasts(&filed.forecasts, days_left) == Some(true);
                    facts.naive_weeks += u32::from(is_naive);
                }
                Record::Week(_) => facts.weeks += 1,
                Record::End(end) => facts.ended = Some(end.reason.id().to_owned()),
                Record::Activity(activity) => facts.count_activity(activity),
                _ => {}
            }
        }
        Some(facts)
    }

    fn count_activity(&mut self, activity: &Activity) {
        match activity {
            Activity::Draft(draft) => self.pasted = self.pasted.map(|number| number + draft.pasted),
            Activity::Answer(answer) => self.failed_checks += u32::from(answer.as_expected == Some(false)),
            _ => {}
        }
    }
}
