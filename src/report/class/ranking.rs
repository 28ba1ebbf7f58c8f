//! The ranking of a class by the measure of the lesson, relative to the reference play on the same seed.

use super::ClassView;
use novamind_course::{ClassRun, RunVerdict};

/// A student in the ranking.
#[derive(Debug, Clone, PartialEq)]
pub struct RankedStudent<'a> {
    /// Label of the student.
    pub label: &'a str,
    /// Name for display: the label, or the rank if names are hidden.
    pub name: String,
    /// Score relative to the reference play, or cash in dollars if there is no lesson.
    pub score: f64,
    /// The best finished run of each part of the lesson. If there is no lesson, the student's only run.
    pub runs: Vec<&'a ClassRun>,
}

/// Returns the students who have a run that counts, highest score first.
pub fn rank_students<'a>(view: &'a ClassView<'a>) -> Vec<RankedStudent<'a>> {
    let day = common_day(view);
    let rank_student = |label: &'a str| {
        let (score, runs) = match view.lesson {
            Some(_) => score_by_parts(view, label)?,
            None => score_by_cash(view, label, day)?,
        };
        Some(RankedStudent { label, name: String::new(), score, runs })
    };
    let labels = view.class.students.iter().map(|student| student.label.as_str());
    let mut all: Vec<RankedStudent<'a>> = labels.filter_map(rank_student).collect();
    all.sort_by(|one, other| other.score.total_cmp(&one.score).then_with(|| one.label.cmp(other.label)));
    for (at, student) in all.iter_mut().enumerate() {
        student.name =
            if view.display.hides_names { format!("no. {}", at + 1) } else { student.label.to_owned() };
    }
    all
}

fn score_by_parts<'a>(view: &'a ClassView<'a>, label: &str) -> Option<(f64, Vec<&'a ClassRun>)> {
    let class_runs: Vec<&ClassRun> =
        view.valid_runs().filter(|run| run.label == label && run.verdict == RunVerdict::Finished).collect();
    let best = |part: u32| {
        let scored = class_runs
            .iter()
            .filter(|run| run.evidence.part == part)
            .map(|run| (view.score_share(run).unwrap_or(0.0), *run));
        scored.max_by(|(one, _), (other, _)| one.total_cmp(other))
    };
    let found: Vec<(f64, &ClassRun)> = (1..=view.part_count()).filter_map(best).collect();
    if found.is_empty() {
        return None;
    }
    let sum: f64 = found.iter().map(|(share, _)| share).sum();
    Some((sum / f64::from(view.part_count()), found.into_iter().map(|(_, run)| run).collect()))
}

fn score_by_cash<'a>(view: &'a ClassView<'a>, label: &str, day: u32) -> Option<(f64, Vec<&'a ClassRun>)> {
    let run = view.valid_runs().find(|run| run.label == label)?;
    let cash = run.evidence.cash.iter().rev().find(|(number, _)| *number <= day)?.1;
    Some((cash, vec![run]))
}

fn common_day(view: &ClassView<'_>) -> u32 {
    view.valid_runs().map(|run| run.evidence.day).min().unwrap_or(0)
}
