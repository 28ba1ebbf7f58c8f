//! Comparison of runs with each other and with published figures, by result, weekly cash, decisions and behavior.

mod compared_runs;
mod figures;
mod run_rows;
mod table;

pub use compared_runs::{ComparedDecisions, Comparison, measure_for_unit};
pub use figures::{ComparedFigure, FIGURES, find_figure};
pub use table::{comparison_to_rows, comparison_to_text};

use novamind_report::Logbook;
use novamind_report::ranking::{compare_results, published_results};
use novamind_report::ranking_eligibility::{RankingCriteria, describe_unranked_runs};

/// Compares runs by result, weekly cash, decisions and behavior.
pub fn compare_runs(runs: &[Logbook]) -> Comparison {
    let mut figures: Vec<_> = FIGURES.iter().map(|figure| figure.row(runs)).collect();
    figures.extend(figures::group_rows(runs));
    let paper = published_results().paper().generation;
    if !runs.iter().any(|run| paper == run.generation.into()) {
        // The published ranges come from runs of another generation.
        figures.iter_mut().for_each(|row| row.published = None);
    }
    let is_ranked = runs.iter().all(|run| run.generation == runs[0].generation);
    Comparison {
        runs: runs.iter().map(|run| run.run.clone()).collect(),
        participants: runs.iter().map(Logbook::player_name).collect(),
        scenarios: runs.iter().map(|run| run.scenario.clone()).collect(),
        generations: runs.iter().map(|run| run.generation).collect(),
        horizons: runs.iter().map(|run| (run.days, run.horizon_rule)).collect(),
        is_ranked,
        order: if is_ranked { order_by_result(runs) } else { (0..runs.len()).collect() },
        ends: runs.iter().map(|run| (run.day, run.ended)).collect(),
        figures,
        cash: figures::cash_rows(runs),
        decisions: decisions_by_day(runs),
        caveats: caveats(runs),
    }
}

/// Returns the indices of the runs, best result first. The result of an unfinished run is its current cash.
fn order_by_result(runs: &[Logbook]) -> Vec<usize> {
    let result = |run: &Logbook| (run.score.unwrap_or(run.cash), run.measures.survival_days);
    let mut order: Vec<usize> = (0..runs.len()).collect();
    order.sort_by(|one, other| compare_results(result(&runs[*other]), result(&runs[*one])));
    order
}

fn decisions_by_day(runs: &[Logbook]) -> Vec<ComparedDecisions> {
    let mut days: Vec<u32> =
        runs.iter().flat_map(|run| run.weeks.iter().map(|week| week.decision_day)).collect();
    days.sort_unstable();
    days.dedup();
    let of = |run: &Logbook, day: u32| {
        let weeks = run.weeks.iter().filter(|week| week.decision_day == day);
        weeks.flat_map(|week| week.decisions.iter().cloned()).collect::<Vec<_>>()
    };
    let decided = days
        .iter()
        .map(|day| ComparedDecisions { day: *day, by_run: runs.iter().map(|run| of(run, *day)).collect() });
    decided.filter(|decided| decided.by_run.iter().any(|texts| !texts.is_empty())).collect()
}

/// Returns the reasons why the figures of the runs are not comparable with each other or with published figures.
fn caveats(runs: &[Logbook]) -> Vec<String> {
    let Some(first) = runs.first() else { return Vec::new() };
    let mut caveats = Vec::new();
    if runs.iter().any(|run| run.generation != first.generation) {
        caveats.push(
            "The runs are of release 1 and of release 2: they are shown side by side and are not ranked."
                .to_owned(),
        );
    }
    let mut note = |differ: bool, what: &str| {
        if differ {
            caveats.push(format!("The runs differ in their {what}."));
        }
    };
    let any = |differs: &dyn Fn(&Logbook, &Logbook) -> bool| runs.iter().any(|run| differs(run, first));
    note(any(&|logbook, first| logbook.seed != first.seed), "seed");
    note(any(&|logbook, first| logbook.days != first.days), "days");
    note(any(&|logbook, first| logbook.horizon_rule != first.horizon_rule), "horizon rule");
    note(any(&|logbook, first| logbook.start_cash != first.start_cash), "cash at the start");
    note(any(&|logbook, first| logbook.parameters_digest != first.parameters_digest), "parameters");
    note(any(&|logbook, first| logbook.mode != first.mode), "mode");
    let obstacles: Vec<_> = runs.iter().map(|run| RankingCriteria::from_logbook(run).obstacles()).collect();
    caveats.extend(describe_unranked_runs(&obstacles).map(|(count, why)| match count {
        1 => format!("One run is not comparable with published runs: {why}."),
        count => format!("{count} runs are not comparable with published runs: {why}."),
    }));
    caveats
}
