//! Cash curves of a class, and scatter plots of a figure against a decision.

use std::collections::{BTreeMap, BTreeSet};

use super::{ClassView, DEFAULT_FIGURE, RankedStudent};
use novamind_course::ClassRun;

/// The line or the points of one student in a drawing.
pub struct StudentPoints<'a> {
    /// Label of the student; `None` for the reference play.
    pub label: Option<&'a str>,
    /// Points as horizontal and vertical values.
    pub points: Vec<(f64, f64)>,
}

/// Returns the cash by day in a part of the lesson, first for the reference play, then for every ranked student.
pub fn student_curves<'a>(
    view: &'a ClassView<'a>,
    ranking: &[RankedStudent<'a>],
    part: u32,
) -> Vec<StudentPoints<'a>> {
    let points = |cash: &[(u32, f64)]| cash.iter().map(|(day, cash)| (f64::from(*day), *cash)).collect();
    let part_runs = runs_in_part(ranking, part);
    let good = part_runs.first().and_then(|(_, run)| view.reference_play(run));
    let good = good.map(|good| StudentPoints { label: None, points: points(&good.cash) });
    let students = part_runs
        .iter()
        .map(|(label, run)| StudentPoints { label: Some(label), points: points(&run.evidence.cash) });
    good.into_iter().chain(students).collect()
}

/// A scatter plot of a figure against a decision.
pub struct Scatter<'a> {
    /// Decision on the horizontal axis. The axis shows its mean over the weeks in which the student decided.
    pub decision: String,
    /// Figure on the vertical axis. The axis shows its value in the last week.
    pub figure: String,
    /// One point per student, at the values of the decision and the figure.
    pub points: Vec<StudentPoints<'a>>,
}

fn runs_in_part<'a>(ranking: &[RankedStudent<'a>], part: u32) -> Vec<(&'a str, &'a ClassRun)> {
    let run_in_part = |student: &RankedStudent<'a>| {
        let run = student.runs.iter().find(|run| run.evidence.part == part).copied()?;
        Some((student.label, run))
    };
    ranking.iter().filter_map(run_in_part).collect()
}

/// Returns the decisions of a part in which students differ, largest difference first. Parts are numbered from 1.
pub fn differing_decisions(ranking: &[RankedStudent<'_>], part: u32) -> Vec<String> {
    let runs = runs_in_part(ranking, part);
    names_by_difference(&runs.iter().map(|(_, run)| &run.evidence.decisions).collect::<Vec<_>>())
}

/// Returns the figures of a part in which students differ: cash first, then by decreasing difference.
pub fn differing_figures(ranking: &[RankedStudent<'_>], part: u32) -> Vec<String> {
    let runs = runs_in_part(ranking, part);
    let all = names_by_difference(&runs.iter().map(|(_, run)| &run.evidence.figures).collect::<Vec<_>>());
    let others = all.into_iter().filter(|name| name != DEFAULT_FIGURE);
    std::iter::once(DEFAULT_FIGURE.to_owned()).chain(others).collect()
}

/// Returns the scatter plot of a part; `None` if students do not differ in any decision.
pub fn scatter<'a>(view: &ClassView<'a>, ranking: &[RankedStudent<'a>], part: u32) -> Option<Scatter<'a>> {
    let decision =
        view.display.decision.clone().or_else(|| differing_decisions(ranking, part).into_iter().next())?;
    let figure = view.display.figure.clone().unwrap_or_else(|| DEFAULT_FIGURE.to_owned());
    let point = |(label, run): (&'a str, &'a ClassRun)| {
        let across = run.evidence.decisions.get(&decision).copied().unwrap_or(0.0);
        Some(StudentPoints {
            label: Some(label),
            points: vec![(across, *run.evidence.figures.get(&figure)?)],
        })
    };
    let points: Vec<StudentPoints<'a>> = runs_in_part(ranking, part).into_iter().filter_map(point).collect();
    Some(Scatter { decision, figure, points })
}

/// Returns the names of the values in which students differ, sorted by the number of distinct values, then by the range
/// relative to the maximum.
fn names_by_difference(all: &[&BTreeMap<String, f64>]) -> Vec<String> {
    let spread = |name: &String| {
        let values = || all.iter().map(|by_name| by_name.get(name).copied().unwrap_or(0.0));
        let (least, most) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), value| {
            (least.min(value), most.max(value))
        });
        let distinct: BTreeSet<u64> = values().map(f64::to_bits).collect();
        (distinct.len(), (most - least) / most.abs().max(least.abs()).max(1e-9))
    };
    let names: BTreeSet<&String> = all.iter().flat_map(|by_name| by_name.keys()).collect();
    let mut varying_names: Vec<((usize, f64), &String)> = names
        .into_iter()
        .map(|name| (spread(name), name))
        .filter(|((_, spread), _)| *spread > 1e-9)
        .collect();
    varying_names.sort_by(|(one, _), (other, _)| other.0.cmp(&one.0).then(other.1.total_cmp(&one.1)));
    varying_names.into_iter().map(|(_, name)| name.clone()).collect()
}
