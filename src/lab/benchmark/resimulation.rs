//! Speed of re-simulation: what-if branches and causes of a change.

use std::ops::ControlFlow;
use std::time::Instant;

use super::measured_company::{MeasuredCompany, RunStorage};
use super::{BenchContext, BenchError, BenchFigure, BenchUnit, Samples};
use novamind_insight::{
    CauseAnalysis, ConditionParseError, DecisionEdit, RecordAnalysis, WhatIf, cause_analysis_folder,
};
use novamind_session::Session;

const SMALL_SUBSCRIBERS: u32 = 20_000;
const LARGE_SUBSCRIBERS: u32 = 165_000;
const BRANCH_WEEKS: u32 = 12;
/// Edits of the alternative branches. One additional branch keeps the decisions of the run.
const ALTERNATIVES: [&str; 3] = ["set_prices * 0.9", "set_prices * 1.1", "set_daily_spend * 1.1"];

/// Figures for what-ifs and causes. A small company grows fast, so the what-if covers weeks in which the company has
/// 20,000 subscribers on average. For the first answer about a run, the program reads the record and simulates the run
/// from day 0. Later answers reuse this simulation.
pub const FIGURES: &[BenchFigure] = &[
    BenchFigure::with_target(
        "what if, 4 branches of 12 weeks, 20,000 subscribers: next answer",
        BenchUnit::Seconds,
        0.5,
        None,
    ),
    BenchFigure::without_target(
        "what if, 4 branches of 12 weeks, 20,000 subscribers: first answer",
        BenchUnit::Seconds,
    ),
    BenchFigure::with_target(
        "why of a week at 20,000 subscribers: first answer",
        BenchUnit::Seconds,
        1.0,
        None,
    ),
    BenchFigure::with_target(
        "why of a week at 165,000 subscribers: first answer",
        BenchUnit::Seconds,
        8.0,
        None,
    ),
];

/// Measures companies with the numbers of subscribers that the names of the figures state.
pub fn measure_resimulation(bench: &BenchContext) -> Result<Samples, BenchError> {
    let mut company = MeasuredCompany::with_subscribers(SMALL_SUBSCRIBERS, RunStorage::Disk, bench)?;
    let small = measure_cause_analysis(&company.session, bench.repetitions)?;
    while mean_subscribers(&company.session) < f64::from(SMALL_SUBSCRIBERS) {
        company.measure_week()?;
    }
    let branch_week = company.session.weeks().len() as u32 + 1 - BRANCH_WEEKS;
    let (mut first, mut next) = (Vec::new(), Vec::new());
    for _ in 0..bench.repetitions {
        let started = Instant::now();
        let mut what_if = WhatIf::open(&cause_analysis_folder(&company.session)?)?;
        run_what_if(&mut what_if, branch_week)?;
        first.push(started.elapsed().as_secs_f64());
        let again = Instant::now();
        run_what_if(&mut what_if, branch_week)?;
        next.push(again.elapsed().as_secs_f64());
    }
    company.grow_to_subscribers(LARGE_SUBSCRIBERS)?;
    let large = measure_cause_analysis(&company.session, bench.repetitions)?;
    Ok(vec![next, first, small, large])
}

/// Returns the mean number of subscribers over the last [`BRANCH_WEEKS`] weeks.
fn mean_subscribers(session: &Session) -> f64 {
    let last = session.weeks().iter().rev().take(BRANCH_WEEKS as usize);
    last.map(|week| f64::from(week.individual_subscribers)).sum::<f64>() / f64::from(BRANCH_WEEKS)
}

/// Simulates the four branches of a what-if from the start of a week.
fn run_what_if(what_if: &mut WhatIf, week: u32) -> Result<(), BenchError> {
    let read = |edit: &str| edit.parse::<DecisionEdit>().map_err(BenchError);
    let alternatives = ALTERNATIVES.into_iter().map(|edit| Ok(vec![read(edit)?]));
    let alternatives = alternatives.collect::<Result<Vec<_>, BenchError>>()?;
    what_if.compare(week, Some(week + BRANCH_WEEKS - 1), &alternatives, &|_, _| ControlFlow::Continue(()))?;
    Ok(())
}

/// Returns the time until the causes of last week's change in cancellations are computed, in seconds per repetition.
fn measure_cause_analysis(session: &Session, repetitions: usize) -> Result<Vec<f64>, BenchError> {
    let folder = cause_analysis_folder(session)?;
    let once = |_| {
        let started = Instant::now();
        let week_question = "cancellations"
            .parse()
            .map_err(|problem: ConditionParseError| BenchError::new(problem.message))?;
        CauseAnalysis::open(&folder)?.explain(week_question, &|_| ControlFlow::Continue(()))?;
        Ok(started.elapsed().as_secs_f64())
    };
    (0..repetitions).map(once).collect()
}
