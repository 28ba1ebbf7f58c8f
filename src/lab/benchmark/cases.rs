//! The cases of the speed table, with their measurements.

use std::time::Instant;

use super::machine::{folder_megabytes, peak_memory_megabytes};
use super::measured_company::{MarketSize, MeasuredCompany, POLICY, RunStorage, SEED, WeekMeasurement};
use super::{BenchCase, BenchContext, BenchError, BenchFigure, BenchUnit, Samples, queries, resimulation};
use crate::{MetricsCollector, Policy, RunSpec, play_policy};
use novamind_base::statistics::median;
use novamind_record::folder::runs::find_run;
use novamind_session::{Access, Session};

/// Measured cases of the simulator.
pub const CASES: &[BenchCase] = &[
    BenchCase {
        name: "day",
        figures: &[
            BenchFigure::with_target(
                "a day at 165,000 subscribers, database in the background",
                BenchUnit::Milliseconds,
                10.0,
                Some(4.0),
            ),
            BenchFigure::without_target("a day at 165,000 subscribers, in memory", BenchUnit::Milliseconds),
        ],
        needs_new_process: false,
        is_slow: false,
        measure: measure_day,
    },
    BenchCase {
        name: "million",
        figures: &[
            BenchFigure::with_target(
                "a day at 1,000,000 subscribers, database in the background",
                BenchUnit::Milliseconds,
                60.0,
                Some(25.0),
            ),
            BenchFigure::without_target("a day at 1,000,000 subscribers, in memory", BenchUnit::Milliseconds),
            BenchFigure::with_target(
                "peak memory at 1,000,000 subscribers",
                BenchUnit::Megabytes,
                1.2 * 1_073.741_824,
                None,
            ),
        ],
        needs_new_process: false,
        is_slow: true,
        measure: measure_day_with_a_million,
    },
    BenchCase {
        name: "run",
        figures: &[BenchFigure::with_target(
            "500 days, trajectory recorded",
            BenchUnit::Seconds,
            3.0,
            Some(1.7),
        )],
        needs_new_process: false,
        is_slow: false,
        measure: measure_run,
    },
    BenchCase {
        name: "save",
        figures: &[
            BenchFigure::with_target(
                "500 days with --save, world.db complete",
                BenchUnit::Seconds,
                9.0,
                Some(5.0),
            ),
            BenchFigure::with_target("run directory with --save", BenchUnit::Megabytes, 300.0, Some(150.0)),
            BenchFigure::with_target("peak memory with --save", BenchUnit::Megabytes, 400.0, None),
        ],
        needs_new_process: true,
        is_slow: false,
        measure: measure_save,
    },
    BenchCase {
        name: "resume",
        figures: &[BenchFigure::with_target("resume of a 500-day run", BenchUnit::Seconds, 1.0, None)],
        needs_new_process: false,
        is_slow: false,
        measure: measure_resume,
    },
    BenchCase {
        name: "week",
        figures: &[
            BenchFigure::with_target(
                "a week at 165,000 subscribers: key press to dashboard",
                BenchUnit::Milliseconds,
                150.0,
                None,
            ),
            BenchFigure::with_target(
                "a week at 165,000 subscribers: key press to first query result",
                BenchUnit::Milliseconds,
                800.0,
                None,
            ),
        ],
        needs_new_process: false,
        is_slow: false,
        measure: measure_week,
    },
    BenchCase {
        name: "resimulation",
        figures: resimulation::FIGURES,
        needs_new_process: false,
        is_slow: true,
        measure: resimulation::measure_resimulation,
    },
    BenchCase {
        name: "queries",
        figures: queries::FIGURES,
        needs_new_process: false,
        is_slow: true,
        measure: queries::measure_queries,
    },
    BenchCase {
        name: "scaling",
        figures: &[
            BenchFigure::with_target(
                "cost per subscriber, 10,000 to 1,000,000 subscribers: spread",
                BenchUnit::Percent,
                30.0,
                None,
            ),
            BenchFigure::without_target(
                "one thread, per subscriber per day at 10,000 subscribers",
                BenchUnit::NanosecondsPerSubscriberDay,
            ),
            BenchFigure::without_target(
                "one thread, per subscriber per day at 40,000 subscribers",
                BenchUnit::NanosecondsPerSubscriberDay,
            ),
            BenchFigure::without_target(
                "one thread, per subscriber per day at 165,000 subscribers",
                BenchUnit::NanosecondsPerSubscriberDay,
            ),
            BenchFigure::without_target(
                "one thread, per subscriber per day at 1,000,000 subscribers",
                BenchUnit::NanosecondsPerSubscriberDay,
            ),
        ],
        needs_new_process: false,
        is_slow: true,
        measure: measure_scaling,
    },
];

/// Returns the milliseconds per simulated day, scaled to `subscribers`.
fn estimate_day_milliseconds(subscribers: f64, laps: &[WeekMeasurement]) -> Vec<f64> {
    laps.iter().map(|lap| lap.per_subscriber_day() * subscribers * 1e3).collect()
}

fn measure_weeks(company: &mut MeasuredCompany, count: usize) -> Result<Vec<WeekMeasurement>, BenchError> {
    (0..count).map(|_| company.measure_week()).collect()
}

/// Returns a company with about 165,000 subscribers, which grows during the measurement.
fn create_company_with_165_000_subscribers(
    keep: RunStorage,
    bench: &BenchContext,
) -> Result<MeasuredCompany, BenchError> {
    MeasuredCompany::with_subscribers(150_000, keep, bench)
}

/// Saves a run with about 165,000 subscribers in the scratch folder and returns its ID.
///
/// # Errors
/// Fails if the run cannot be played or saved.
pub fn save_large_company(bench: &BenchContext) -> Result<String, BenchError> {
    let mut company = create_company_with_165_000_subscribers(RunStorage::Disk, bench)?;
    company.session.save()?;
    Ok(company.session.manifest().id.clone())
}

/// Returns a company with about 1,000,000 subscribers in the large market.
fn create_company_with_a_million_subscribers(
    keep: RunStorage,
    bench: &BenchContext,
) -> Result<MeasuredCompany, BenchError> {
    let mut company = MeasuredCompany::new(MarketSize::Large, keep, bench)?;
    company.grow_to_subscribers(1_000_000)?;
    company.play_billing_period()?;
    Ok(company)
}

fn measure_day(bench: &BenchContext) -> Result<Samples, BenchError> {
    let on_disk = measure_weeks(
        &mut create_company_with_165_000_subscribers(RunStorage::Disk, bench)?,
        bench.repetitions,
    )?;
    let in_memory = measure_weeks(
        &mut create_company_with_165_000_subscribers(RunStorage::Memory, bench)?,
        bench.repetitions,
    )?;
    Ok(vec![estimate_day_milliseconds(165_000.0, &on_disk), estimate_day_milliseconds(165_000.0, &in_memory)])
}

fn measure_day_with_a_million(bench: &BenchContext) -> Result<Samples, BenchError> {
    let mut company = create_company_with_a_million_subscribers(RunStorage::Disk, bench)?;
    let on_disk = measure_weeks(&mut company, bench.repetitions)?;
    company.session.save()?;
    // Read the peak memory before a second company allocates memory.
    let memory = peak_memory_megabytes().into_iter().collect();
    drop(company);
    let in_memory = measure_weeks(
        &mut create_company_with_a_million_subscribers(RunStorage::Memory, bench)?,
        bench.repetitions,
    )?;
    Ok(vec![estimate_day_milliseconds(1e6, &on_disk), estimate_day_milliseconds(1e6, &in_memory), memory])
}

/// Plays 500 days. Returns the duration in seconds and the ID of the run.
fn play_500_days(projection: bool, bench: &BenchContext) -> Result<(f64, String), BenchError> {
    let policy = Policy::find(POLICY, &bench.configuration)?;
    let spec = RunSpec {
        save_folder: Some(bench.scratch_folder.clone()),
        saves_database: projection,
        scenario: bench.scenario.clone(),
        ..RunSpec::for_seed(SEED)
    };
    let outcome = play_policy(&policy, &spec, &bench.configuration, &mut MetricsCollector::disabled())?;
    let run = outcome.run.ok_or_else(|| BenchError("the run was not saved".to_owned()))?;
    Ok((outcome.seconds, run))
}

fn measure_run(bench: &BenchContext) -> Result<Samples, BenchError> {
    let seconds = (0..bench.repetitions).map(|_| Ok(play_500_days(false, bench)?.0));
    Ok(vec![seconds.collect::<Result<_, BenchError>>()?])
}

fn measure_save(bench: &BenchContext) -> Result<Samples, BenchError> {
    let (mut seconds, mut sizes) = (Vec::new(), Vec::new());
    for _ in 0..bench.repetitions {
        let (took, run) = play_500_days(true, bench)?;
        let folder = find_run(&bench.scratch_folder, &run)?;
        seconds.push(took);
        sizes.push(folder_megabytes(&folder)?);
        std::fs::remove_dir_all(&folder)?;
    }
    Ok(vec![seconds, sizes, peak_memory_megabytes().into_iter().collect()])
}

fn measure_resume(bench: &BenchContext) -> Result<Samples, BenchError> {
    let (_, run) = play_500_days(true, bench)?;
    let folder = find_run(&bench.scratch_folder, &run)?;
    let mut seconds = Vec::new();
    for _ in 0..bench.repetitions {
        let started = Instant::now();
        let session = Session::open(&folder, Access::Write, true)?;
        seconds.push(started.elapsed().as_secs_f64());
        drop(session);
    }
    Ok(vec![seconds])
}

fn measure_week(bench: &BenchContext) -> Result<Samples, BenchError> {
    let mut company = create_company_with_165_000_subscribers(RunStorage::Disk, bench)?;
    let (mut dashboard, mut query) = (Vec::new(), Vec::new());
    for _ in 0..bench.repetitions {
        let lap = company.measure_week()?;
        let since = company.session.day() - 7;
        let question = format!(
            "SELECT category, COUNT(*) AS entries, SUM(amount) AS total FROM ledger WHERE day > {since} GROUP BY category"
        );
        let started = Instant::now();
        company.session.query(&question)?;
        dashboard.push(lap.seconds * 1e3);
        query.push((lap.seconds + started.elapsed().as_secs_f64()) * 1e3);
    }
    Ok(vec![dashboard, query])
}

/// Numbers of subscribers for which the cost per subscriber is compared, in the default market.
const SUBSCRIBER_COUNTS: [u32; 3] = [10_000, 40_000, 165_000];
/// Maximum number of weeks measured per company. After more weeks, the company has grown too far beyond its nominal
/// size.
const MAX_WEEKS_PER_SIZE: usize = 5;

/// Measures the cost per subscriber on one thread. The gain from a second thread depends on its wake-up latency,
/// which is the same for a company of any size.
fn measure_scaling(bench: &BenchContext) -> Result<Samples, BenchError> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| measure_costs_by_size(bench))
}

/// Measures one week of each company in turn. A slow period of the machine then affects all companies equally.
fn measure_costs_by_size(bench: &BenchContext) -> Result<Samples, BenchError> {
    // The companies start slightly smaller, because they grow during the measurement.
    let sized_companies = SUBSCRIBER_COUNTS
        .iter()
        .map(|size| MeasuredCompany::with_subscribers(size / 10 * 9, RunStorage::Memory, bench));
    let mut companies = sized_companies.collect::<Result<Vec<MeasuredCompany>, BenchError>>()?;
    companies.push(create_company_with_a_million_subscribers(RunStorage::Memory, bench)?);
    let mut costs = vec![Vec::new(); companies.len()];
    for _ in 0..bench.repetitions.min(MAX_WEEKS_PER_SIZE) {
        for (company, values) in companies.iter_mut().zip(&mut costs) {
            values.push(company.measure_week()?.per_subscriber_day() * 1e9);
        }
    }
    let medians: Vec<f64> = costs.iter().filter_map(|samples| median(samples)).collect();
    let min = medians.iter().copied().fold(f64::INFINITY, f64::min);
    let max = medians.iter().copied().fold(0.0, f64::max);
    costs.insert(0, vec![(max / min - 1.0) * 100.0]);
    Ok(costs)
}
