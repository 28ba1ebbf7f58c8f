//! What a referee would ask of a run that is no finding: how it was played, in numbers.

use serde::Serialize;

use novamind_record::folder::manifest::Manifest;
use novamind_record::trajectory::record::{Activity, Outcome};
use novamind_record::trajectory::{Record, Trajectory};
use novamind_session::{Attendance, SittingCount};

/// How a run of a study was played.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunFacts {
    /// Run.
    pub run: String,
    /// Label.
    pub participant: Option<String>,
    /// Condition.
    pub condition: Option<String>,
    /// It is the practice.
    pub practice: bool,
    /// When it was created, RFC 3339.
    pub created: String,
    /// When its last line was written, RFC 3339.
    pub last_at: String,
    /// Lines.
    pub lines: u64,
    /// Weeks that ran.
    pub weeks: u32,
    /// How it ended, where it did.
    pub ended: Option<String>,
    /// Sittings.
    pub sittings: u32,
    /// Sittings that no line closes: the program was killed, or still plays.
    pub unclosed_sittings: u32,
    /// Calls and weeks that were refused.
    pub refusals: u32,
    /// Weeks in which at least one forecast was filled by the naive projection.
    pub naive_weeks: u32,
    /// Weeks that were decided in less than ten active seconds.
    pub fast_weeks: u32,
    /// Characters that came from the clipboard; none of a run that was never open in the console, which sees them.
    pub pasted: Option<u64>,
    /// Attention checks that were not answered as expected.
    pub failed_checks: u32,
    /// Longest time between two lines that follow each other, seconds.
    pub longest_gap: f64,
}

impl RunFacts {
    pub(super) fn of(manifest: &Manifest, trajectory: &Trajectory) -> Option<RunFacts> {
        let stamp = manifest.study.as_ref()?;
        let sittings = SittingCount::of(&trajectory.lines);
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
            fast_weeks: Attendance::of(&trajectory.lines).fast_weeks(),
            pasted: (sittings.in_console > 0).then_some(0),
            failed_checks: 0,
            longest_gap: 0.0,
        };
        let mut before = None::<f64>;
        for line in &trajectory.lines {
            let moment = line.moment();
            facts.longest_gap = facts.longest_gap.max(before.map_or(0.0, |before| moment - before));
            before = Some(moment);
            match &line.record {
                Record::Call(call) if matches!(call.outcome, Outcome::Refused(_)) => facts.refusals += 1,
                Record::Advance(filed) => {
                    facts.naive_weeks += u32::from(filed.filled_naively() == Some(true));
                }
                Record::Week(_) => facts.weeks += 1,
                Record::End(end) => facts.ended = Some(end.reason.id().to_owned()),
                Record::Activity(activity) => facts.note(activity),
                _ => {}
            }
        }
        Some(facts)
    }

    fn note(&mut self, activity: &Activity) {
        match activity {
            Activity::Draft(draft) => self.pasted = self.pasted.map(|own| own + draft.pasted),
            Activity::Answer(answer) => self.failed_checks += u32::from(answer.as_expected == Some(false)),
            _ => {}
        }
    }
}
