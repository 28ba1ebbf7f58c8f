//! The curves of a class, and a decision against a figure.

use std::collections::BTreeMap;

use super::{ClassView, RankedStudent};

/// A line or a point of a student in a drawing.
pub(super) struct StudentPoints<'a> {
    /// Label; none for the good play.
    pub label: Option<&'a str>,
    /// Where it lies.
    pub points: Vec<(f64, f64)>,
}

/// Cash by day in a part, of the good play and of every student in the ranking.
pub(super) fn curves<'a>(
    view: &'a ClassView<'a>,
    ranking: &[RankedStudent<'a>],
    part: u32,
) -> Vec<StudentPoints<'a>> {
    let points = |cash: &[(u32, f64)]| cash.iter().map(|(day, cash)| (f64::from(*day), *cash)).collect();
    let of_part =
        |student: &RankedStudent<'a>| student.runs.iter().find(|run| run.evidence.part == part).copied();
    let own: Vec<_> = ranking.iter().filter_map(|student| Some((student.label, of_part(student)?))).collect();
    let good = own.first().and_then(|(_, run)| view.good(run));
    let good = good.map(|good| StudentPoints { label: None, points: points(&good.cash) });
    let students = own
        .iter()
        .map(|(label, run)| StudentPoints { label: Some(label), points: points(&run.evidence.cash) });
    good.into_iter().chain(students).collect()
}

/// A decision against a figure.
pub(super) struct Scatter<'a> {
    /// The decision: its mean over the weeks in which the student decided.
    pub decision: String,
    /// The figure of the last week.
    pub figure: String,
    /// A point for each student.
    pub points: Vec<StudentPoints<'a>>,
}

/// The scatter of a part; none where students do not differ in any decision.
pub(super) fn scatter<'a>(
    view: &ClassView<'a>,
    ranking: &[RankedStudent<'a>],
    part: u32,
) -> Option<Scatter<'a>> {
    let runs: Vec<_> = ranking
        .iter()
        .filter_map(|student| {
            Some((student.label, student.runs.iter().find(|run| run.evidence.part == part)?))
        })
        .collect();
    let decision = view.shown.decision.clone().or_else(|| {
        let all: Vec<&BTreeMap<String, f64>> = runs.iter().map(|(_, run)| &run.evidence.decisions).collect();
        most_different(&all)
    })?;
    let figure = view.shown.figure.clone().unwrap_or_else(|| "cash".to_owned());
    let point = |(label, run): &(&'a str, &&'a crate::session::ClassRun)| {
        let across = run.evidence.decisions.get(&decision).copied().unwrap_or(0.0);
        Some(StudentPoints {
            label: Some(*label),
            points: vec![(across, *run.evidence.figures.get(&figure)?)],
        })
    };
    let points: Vec<StudentPoints<'a>> = runs.iter().filter_map(point).collect();
    Some(Scatter { decision, figure, points })
}

/// The decision whose values lie furthest apart, as a share of the largest.
fn most_different(all: &[&BTreeMap<String, f64>]) -> Option<String> {
    let names = all.iter().flat_map(|own| own.keys());
    let spread = |name: &String| {
        let values = || all.iter().map(|own| own.get(name).copied().unwrap_or(0.0));
        let (least, most) = values()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), own| (least.min(own), most.max(own)));
        let distinct: std::collections::BTreeSet<u64> = values().map(f64::to_bits).collect();
        // Of two that reach equally far, the one with more different values tells more.
        ((most - least) / most.abs().max(least.abs()).max(1e-9), distinct.len())
    };
    let sorted: std::collections::BTreeSet<&String> = names.collect();
    let best =
        sorted.into_iter().rev().map(|name| (spread(name), name)).filter(|((spread, _), _)| *spread > 1e-9);
    best.max_by(|(one, _), (other, _)| one.1.cmp(&other.1).then(one.0.total_cmp(&other.0)))
        .map(|(_, name)| name.clone())
}
