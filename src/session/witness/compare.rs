//! A trajectory beside what a witness was told of it.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use serde::Serialize;

use super::record::Told;
use crate::session::trajectory::record::Activity;
use crate::session::trajectory::{Line, Record, Trajectory, clock_went_back, seconds};

/// What a comparison found.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What kind of thing it is.
    pub kind: FindingKind,
    /// Run.
    pub run: String,
    /// Line of the trajectory it begins at, from 1.
    pub line: u64,
    /// The moment it belongs to, RFC 3339: that of the line, as the witness was told it where it was.
    pub at: String,
    /// In words.
    pub words: String,
}

/// Kinds of findings.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FindingKind {
    /// Lines are not those that the witness was told of.
    Changed,
    /// The witness was told of lines after the last one.
    Cut,
    /// The run went on twice from the same line: a copy was put back, or both were played.
    TwoHistories,
    /// Decisions and weeks that no witness was told of.
    Unseen,
    /// The run went on on another machine.
    OtherMachine,
    /// A line is older than the one before it, by more than a correction of the clock takes.
    ClockBack,
}

/// Compares a trajectory, and the lines of what was done after its end, with what witnesses were told of its run, in the order of the lines. What follows from an honest
/// session on one machine is no finding, nor is a line that was told twice.
pub fn compare(trajectory: &Trajectory, afterwards: &[Line], told: &[Told]) -> Vec<Finding> {
    let Some(Record::Start(start)) = trajectory.lines.first().map(|line| &line.record) else {
        return Vec::new();
    };
    let lines = trajectory.lines.iter().chain(afterwards).collect();
    let comparison = Comparison { run: &start.run, lines, told: distinct(told, &start.run) };
    let mut findings = Vec::new();
    findings.extend(comparison.changed());
    findings.extend(comparison.cut());
    findings.extend(comparison.two_histories());
    findings.extend(comparison.unseen());
    findings.extend(comparison.other_machines());
    findings.extend(comparison.clock_back());
    findings.sort_by_key(|finding| (finding.line, finding.kind));
    findings
}

/// What was told of a run, each line once: after a crash some are told again.
fn distinct<'a>(told: &'a [Told], run: &str) -> Vec<&'a Told> {
    let mut known = HashSet::new();
    told.iter().filter(|told| told.run == run && !told.is_withdrawal() && known.insert(*told)).collect()
}

struct Comparison<'a> {
    run: &'a str,
    lines: Vec<&'a Line>,
    told: Vec<&'a Told>,
}

impl Comparison<'_> {
    fn finding(&self, kind: FindingKind, seq: u64, at: &str, words: String) -> Finding {
        Finding { kind, run: self.run.to_owned(), line: seq + 1, at: at.to_owned(), words }
    }

    fn line(&self, told: &Told) -> Option<&Line> {
        self.lines.get(usize::try_from(told.seq).ok()?).copied()
    }

    fn is_in_trajectory(&self, told: &Told) -> bool {
        self.line(told).is_some_and(|line| line.hash == told.hash)
    }

    /// Lines of the trajectory that the witness knows otherwise.
    fn changed(&self) -> Option<Finding> {
        let other = |told: &&&Told| self.line(told).is_some_and(|line| line.hash != told.hash);
        let others: BTreeSet<u64> = self.told.iter().filter(other).map(|told| told.seq).collect();
        let (&first, count) = (others.first()?, others.len());
        // A later line that is as it was told vouches for everything before it: then the other one was given up.
        let vouched = self.told.iter().filter(|told| self.is_in_trajectory(told)).map(|told| told.seq).max();
        let &last = others.last()?;
        if vouched.is_some_and(|seq| seq > last) {
            return None;
        }
        let told = self.told.iter().find(|told| told.seq == first)?;
        let words = format!(
            "line {} is not the one the witness was told of; {} that it was told of {} different in the trajectory, up \
             to line {}",
            first + 1,
            lines(count),
            if count == 1 { "is" } else { "are" },
            last + 1
        );
        Some(self.finding(FindingKind::Changed, first, &told.at, words))
    }

    /// Lines after the last one of the trajectory.
    fn cut(&self) -> Option<Finding> {
        let end = self.lines.len() as u64;
        let missing: Vec<&&Told> = self.told.iter().filter(|told| told.seq >= end).collect();
        let furthest = missing.iter().max_by_key(|told| told.seq)?;
        let words = format!(
            "the record ends with line {end}, but the witness was told of line {} at {}: {} missing",
            furthest.seq + 1,
            furthest.at,
            match furthest.seq + 1 - end {
                1 => "1 line is".to_owned(),
                count => format!("{count} lines are"),
            }
        );
        Some(self.finding(FindingKind::Cut, end, &furthest.at, words))
    }

    /// The first line from which the witness was told of two ways to go on.
    fn two_histories(&self) -> Option<Finding> {
        let mut by_seq: BTreeMap<u64, Vec<&Told>> = BTreeMap::new();
        for told in &self.told {
            let same = by_seq.entry(told.seq).or_default();
            if same.iter().all(|known| known.hash != told.hash) {
                same.push(told);
            }
        }
        let twice =
            by_seq.iter().find(|(_, told)| told.len() > 1).map(|(seq, told)| (*seq, told[0], told[1]));
        // Or a line that was given up, while a later one is as it was told.
        let vouched = self.told.iter().filter(|told| self.is_in_trajectory(told)).map(|told| told.seq).max();
        let given_up = |told: &&&Told| {
            let other = self.line(told).is_some_and(|line| line.hash != told.hash);
            other && vouched.is_some_and(|seq| seq > told.seq)
        };
        let given_up = self.told.iter().filter(given_up).min_by_key(|told| told.seq);
        let given_up = given_up.and_then(|told| Some((told, self.line(told)?)));
        let (seq, first, second) = match (twice, given_up) {
            (Some((seq, one, other)), None) => (seq, &one.at, &other.at),
            (Some((seq, one, other)), Some((told, _))) if seq <= told.seq => (seq, &one.at, &other.at),
            (_, Some((told, line))) => (told.seq, &told.at, &line.at),
            (None, None) => return None,
        };
        let (earlier, later) =
            if seconds(first) <= seconds(second) { (first, second) } else { (second, first) };
        let words = format!(
            "line {} was written twice, differently, at {earlier} and at {later}: the run was taken back to an earlier \
             state, or a copy of it was played",
            seq + 1
        );
        Some(self.finding(FindingKind::TwoHistories, seq, later, words))
    }

    /// Stretches of lines of which no witness was told, where something was decided or answered or a week ended in them.
    fn unseen(&self) -> Vec<Finding> {
        let seen: BTreeSet<u64> = self.told.iter().map(|told| told.seq).collect();
        let unseen: Vec<&Line> =
            self.lines.iter().copied().filter(|line| !seen.contains(&line.seq)).collect();
        let stretches = unseen.chunk_by(|one, next| one.seq + 1 == next.seq);
        stretches.filter_map(|stretch| self.unseen_stretch(stretch)).collect()
    }

    fn unseen_stretch(&self, stretch: &[&Line]) -> Option<Finding> {
        let weighs = |line: &&&Line| {
            let decides = matches!(
                line.record,
                Record::Call(_) | Record::Advance(_) | Record::End(_) | Record::Activity(Activity::Answer(_))
            );
            line.closes_days() || decides
        };
        stretch.iter().find(weighs)?;
        let (first, last) = (stretch.first()?, stretch.last()?);
        let weeks = stretch.iter().filter(|line| line.closes_days()).count();
        let which = match stretch.len() {
            1 => format!("line {}", first.seq + 1),
            _ => format!("lines {} to {}", first.seq + 1, last.seq + 1),
        };
        let words = match weeks {
            0 => format!("no witness was told of {which}"),
            1 => format!("no witness was told of {which}, in which 1 week ended"),
            weeks => format!("no witness was told of {which}, in which {weeks} weeks ended"),
        };
        Some(self.finding(FindingKind::Unseen, first.seq, &first.at, words))
    }

    /// Where the next line that was told came from another machine.
    fn other_machines(&self) -> Vec<Finding> {
        let mut order = self.told.clone();
        order.sort_by_key(|told| told.seq);
        let moves = order.windows(2).filter(|pair| pair[0].machine != pair[1].machine);
        moves
            .map(|pair| {
                let words = format!(
                    "line {} was written on machine {}, line {} on {}",
                    pair[0].seq + 1,
                    pair[0].machine,
                    pair[1].seq + 1,
                    pair[1].machine
                );
                self.finding(FindingKind::OtherMachine, pair[1].seq, &pair[1].at, words)
            })
            .collect()
    }

    fn clock_back(&self) -> Vec<Finding> {
        clock_went_back(self.lines.iter().copied())
            .map(|(before, line, back)| {
                let words = format!(
                    "the clock went back by {back:.0} seconds: line {} carries {}, line {} carries {}",
                    before.seq + 1,
                    before.at,
                    line.seq + 1,
                    line.at
                );
                self.finding(FindingKind::ClockBack, line.seq, &line.at, words)
            })
            .collect()
    }
}

fn lines(count: usize) -> String {
    match count {
        1 => "1 line".to_owned(),
        _ => format!("{count} lines"),
    }
}
