//! Speed of interactive queries on the database of a large company.

use std::time::Instant;

use serde_json::json;

use super::measured_company::{MeasuredCompany, RunStorage};
use super::{BenchContext, BenchError, BenchFigure, BenchUnit, Samples};
use novamind_base::statistics::median;
use novamind_record::folder::query_library::QueryLibrary;
use novamind_record::trajectory::record::Via;
use novamind_session::Session;
use novamind_tools::ToolId;

/// Approximate number of subscribers of the company at its peak.
const SUBSCRIBER_COUNT: u32 = 190_000;

/// Prefix of the names of figures that measure a query of the library.
const FIGURE_NAME_PREFIX: &str = "query ";

const USAGE_30_DAYS_SQL: &str = "SELECT COUNT(*) AS days, SUM(usage_units) AS units FROM daily_usage
    WHERE day > (SELECT MAX(day) FROM service_day) - 30";

/// Figures for the slowest query of the library, a count over millions of rows, and ten common queries.
pub const FIGURES: &[BenchFigure] = &[
    BenchFigure::with_target(
        "slowest query of the library at 190,000 subscribers",
        BenchUnit::Milliseconds,
        300.0,
        None,
    ),
    BenchFigure::with_target(
        "usage of 30 days at 190,000 subscribers, counted and summed",
        BenchUnit::Milliseconds,
        1_000.0,
        None,
    ),
    BenchFigure::without_target("query cash-by-week", BenchUnit::Milliseconds),
    BenchFigure::without_target("query costs-by-week", BenchUnit::Milliseconds),
    BenchFigure::without_target("query growth-by-week", BenchUnit::Milliseconds),
    BenchFigure::without_target("query revenue-by-plan", BenchUnit::Milliseconds),
    BenchFigure::without_target("query leavers-by-group", BenchUnit::Milliseconds),
    BenchFigure::without_target("query retention-by-plan", BenchUnit::Milliseconds),
    BenchFigure::without_target("query acquisition-by-source", BenchUnit::Milliseconds),
    BenchFigure::without_target("query usage-by-group", BenchUnit::Milliseconds),
    BenchFigure::without_target("query support-wait", BenchUnit::Milliseconds),
    BenchFigure::without_target("query prices-paid", BenchUnit::Milliseconds),
];

/// Returns the queried company at its peak size, after five weeks of in-app ads. At this time, every table has its
/// maximum number of rows.
///
/// # Errors
/// Fails if the run cannot be played or saved.
pub fn create_company_for_queries(bench: &BenchContext) -> Result<Session, BenchError> {
    let mut company = MeasuredCompany::with_subscribers(SUBSCRIBER_COUNT, RunStorage::Disk, bench)?;
    company.session.call(ToolId::SetAdsStrength, &json!({"global_strength": 0.1}), Via::Script)?;
    for _ in 0..5 {
        company.measure_week()?;
    }
    company.session.wait_for_database()?;
    Ok(company.session)
}

/// Measures every library query several times. The slowest query is the one with the largest median time.
pub fn measure_queries(bench: &BenchContext) -> Result<Samples, BenchError> {
    let mut session = MeasuredCompany::with_subscribers(SUBSCRIBER_COUNT, RunStorage::Disk, bench)?.session;
    session.wait_for_database()?;
    let mut ask = |sql: &str| query_milliseconds(&mut session, sql, bench.repetitions);
    let usage = ask(USAGE_30_DAYS_SQL)?;
    let library = QueryLibrary::bundled();
    let mut asked: Vec<(&str, Vec<f64>)> = Vec::new();
    for query in library.queries() {
        asked.push((&query.name, ask(query.body())?));
    }
    let typical = FIGURES.iter().filter_map(|figure| figure.name.strip_prefix(FIGURE_NAME_PREFIX));
    let typical = typical.map(|name| {
        let entry = asked.iter().find(|(known, _)| *known == name);
        entry.map(|(_, times)| times.clone()).ok_or_else(|| BenchError(format!("unknown query {name}")))
    });
    let typical: Vec<Vec<f64>> = typical.collect::<Result<_, _>>()?;
    let slowest = asked.into_iter().map(|(_, times)| times).max_by(|one, other| {
        let middle = |times: &[f64]| median(times).unwrap_or(0.0);
        middle(one).total_cmp(&middle(other))
    });
    Ok([slowest.unwrap_or_default(), usage].into_iter().chain(typical).collect())
}

/// Returns one time per repetition, in milliseconds, until the query result is available.
fn query_milliseconds(session: &mut Session, sql: &str, repetitions: usize) -> Result<Vec<f64>, BenchError> {
    let once = |_| {
        let started = Instant::now();
        session.query(sql)?;
        Ok(started.elapsed().as_secs_f64() * 1e3)
    };
    (0..repetitions).map(once).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measured_queries_are_in_the_library() {
        let library = QueryLibrary::bundled();
        let names: Vec<&str> =
            FIGURES.iter().filter_map(|figure| figure.name.strip_prefix(FIGURE_NAME_PREFIX)).collect();
        assert_eq!(names.len(), 10);
        assert!(names.iter().all(|name| library.find(name).is_some()), "{names:?}");
    }
}
