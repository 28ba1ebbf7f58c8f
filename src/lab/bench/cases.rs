//! The rows of the speed table and their measurements.

use std::time::Instant;

use super::company::{Company, Keep, Lap, Market, POLICY, SEED};
use super::machine::{folder_size, peak_memory};
use super::{Bench, BenchError, BenchFigure, Case, Samples, Unit, queries, resimulation};
use crate::{Collector, Policy, RunSpec, play};
use novamind_base::statistics::median;
use novamind_record::folder::runs::find_run;
use novamind_session::{Access, Session};

/// Cases of the simulator.
pub const CASES: &[Case] = &[
    Case {
        name: "day",
        figures: &[
            BenchFigure::aimed(
                "a day at 165,000, database in the background",
                Unit::Milliseconds,
                10.0,
                Some(4.0),
            ),
            BenchFigure::shown("a day at 165,000, in memory", Unit::Milliseconds),
        ],
        fresh: false,
        long: false,
        measure: day,
    },
    Case {
        name: "million",
        figures: &[
            BenchFigure::aimed(
                "a day at 1,000,000, database in the background",
                Unit::Milliseconds,
                60.0,
                Some(25.0),
            ),
            BenchFigure::shown("a day at 1,000,000, in memory", Unit::Milliseconds),
            BenchFigure::aimed("peak memory at 1,000,000", Unit::Megabytes, 1.2 * 1_073.741_824, None),
        ],
        fresh: false,
        long: true,
        measure: million,
    },
    Case {
        name: "run",
        figures: &[BenchFigure::aimed("500 days, trajectory recorded", Unit::Seconds, 3.0, Some(1.7))],
        fresh: false,
        long: false,
        measure: run,
    },
    Case {
        name: "save",
        figures: &[
            BenchFigure::aimed("500 days with --save, world.db complete", Unit::Seconds, 9.0, Some(5.0)),
            BenchFigure::aimed("its run directory", Unit::Megabytes, 300.0, Some(150.0)),
            BenchFigure::aimed("its peak memory", Unit::Megabytes, 400.0, None),
        ],
        fresh: true,
        long: false,
        measure: save,
    },
    Case {
        name: "resume",
        figures: &[BenchFigure::aimed("resume of a 500-day run", Unit::Seconds, 1.0, None)],
        fresh: false,
        long: false,
        measure: resume,
    },
    Case {
        name: "week",
        figures: &[
            BenchFigure::aimed("a week at 165,000: key to dashboard", Unit::Milliseconds, 150.0, None),
            BenchFigure::aimed(
                "a week at 165,000: key to first query answered",
                Unit::Milliseconds,
                800.0,
                None,
            ),
        ],
        fresh: false,
        long: false,
        measure: week,
    },
    Case {
        name: "resimulation",
        figures: resimulation::FIGURES,
        fresh: false,
        long: true,
        measure: resimulation::resimulation,
    },
    Case { name: "queries", figures: queries::FIGURES, fresh: false, long: true, measure: queries::queries },
    Case {
        name: "scaling",
        figures: &[
            BenchFigure::aimed("cost per subscriber, 10,000 to 1,000,000: spread", Unit::Percent, 30.0, None),
            BenchFigure::shown(
                "one thread, per subscriber and day at 10,000",
                Unit::NanosecondsPerSubscriberDay,
            ),
            BenchFigure::shown(
                "one thread, per subscriber and day at 40,000",
                Unit::NanosecondsPerSubscriberDay,
            ),
            BenchFigure::shown(
                "one thread, per subscriber and day at 165,000",
                Unit::NanosecondsPerSubscriberDay,
            ),
            BenchFigure::shown(
                "one thread, per subscriber and day at 1,000,000",
                Unit::NanosecondsPerSubscriberDay,
            ),
        ],
        fresh: false,
        long: true,
        measure: scaling,
    },
];

/// Returns the milliseconds per day, scaled to this many subscribers.
fn day_at(subscribers: f64, laps: &[Lap]) -> Vec<f64> {
    laps.iter().map(|lap| lap.per_subscriber_day() * subscribers * 1e3).collect()
}

fn laps(company: &mut Company, count: usize) -> Result<Vec<Lap>, BenchError> {
    (0..count).map(|_| company.week()).collect()
}

/// Returns a company with about 165,000 subscribers. It grows during the measurement.
fn at_165_000(keep: Keep, bench: &Bench) -> Result<Company, BenchError> {
    Company::grown(150_000, keep, bench)
}

/// Saves a run with about 165,000 subscribers in the scratch folder and returns its ID.
///
/// # Errors
/// Fails if the run cannot be played or saved.
pub fn keep_a_large_company(bench: &Bench) -> Result<String, BenchError> {
    let mut company = at_165_000(Keep::Disk, bench)?;
    company.session.save()?;
    Ok(company.session.manifest().id.clone())
}

/// Returns a company with about a million subscribers in the large market.
fn at_a_million(keep: Keep, bench: &Bench) -> Result<Company, BenchError> {
    let mut company = Company::found(Market::Large, keep, bench)?;
    company.grow_to(1_000_000)?;
    company.settle()?;
    Ok(company)
}

fn day(bench: &Bench) -> Result<Samples, BenchError> {
    let on_disk = laps(&mut at_165_000(Keep::Disk, bench)?, bench.repetitions)?;
    let in_memory = laps(&mut at_165_000(Keep::Memory, bench)?, bench.repetitions)?;
    Ok(vec![day_at(165_000.0, &on_disk), day_at(165_000.0, &in_memory)])
}

fn million(bench: &Bench) -> Result<Samples, BenchError> {
    let mut company = at_a_million(Keep::Disk, bench)?;
    let on_disk = laps(&mut company, bench.repetitions)?;
    company.session.save()?;
    // Read the peak before the second company allocates memory.
    let memory = peak_memory().into_iter().collect();
    drop(company);
    let in_memory = laps(&mut at_a_million(Keep::Memory, bench)?, bench.repetitions)?;
    Ok(vec![day_at(1e6, &on_disk), day_at(1e6, &in_memory), memory])
}

/// Plays the 500 days; returns the seconds and the name of the run.
fn play_all(projection: bool, bench: &Bench) -> Result<(f64, String), BenchError> {
    let policy = Policy::find(POLICY, &bench.configuration)?;
    let spec = RunSpec { save: Some(bench.scratch.clone()), projection, ..RunSpec::of_seed(SEED) };
    let outcome = play(&policy, &spec, &bench.configuration, &mut Collector::idle())?;
    let run = outcome.run.ok_or_else(|| BenchError("the run was not saved".to_owned()))?;
    Ok((outcome.seconds, run))
}

fn run(bench: &Bench) -> Result<Samples, BenchError> {
    let seconds = (0..bench.repetitions).map(|_| Ok(play_all(false, bench)?.0));
    Ok(vec![seconds.collect::<Result<_, BenchError>>()?])
}

fn save(bench: &Bench) -> Result<Samples, BenchError> {
    let (mut seconds, mut sizes) = (Vec::new(), Vec::new());
    for _ in 0..bench.repetitions {
        let (took, run) = play_all(true, bench)?;
        let folder = find_run(&bench.scratch, &run)?;
        seconds.push(took);
        sizes.push(folder_size(&folder)?);
        std::fs::remove_dir_all(&folder)?;
    }
    Ok(vec![seconds, sizes, peak_memory().into_iter().collect()])
}

fn resume(bench: &Bench) -> Result<Samples, BenchError> {
    let (_, run) = play_all(true, bench)?;
    let folder = find_run(&bench.scratch, &run)?;
    let mut seconds = Vec::new();
    for _ in 0..bench.repetitions {
        let started = Instant::now();
        let session = Session::open(&folder, Access::Write, true)?;
        seconds.push(started.elapsed().as_secs_f64());
        drop(session);
    }
    Ok(vec![seconds])
}

fn week(bench: &Bench) -> Result<Samples, BenchError> {
    let mut company = at_165_000(Keep::Disk, bench)?;
    let (mut dashboard, mut query) = (Vec::new(), Vec::new());
    for _ in 0..bench.repetitions {
        let lap = company.week()?;
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

/// Subscriber counts at which costs are compared, in the default market.
const SIZES: [u32; 3] = [10_000, 40_000, 165_000];
/// Maximum weeks measured per company: after more it has outgrown its size.
const WEEKS_OF_A_SIZE: usize = 5;

/// Uses one thread: the gain of a second one depends on wake-up latency, which is the same for a company
/// of any size.
fn scaling(bench: &Bench) -> Result<Samples, BenchError> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| costs_by_size(bench))
}

/// Companies take turns, so that a slow period of the machine affects all of them equally.
fn costs_by_size(bench: &Bench) -> Result<Samples, BenchError> {
    // Companies grow during the measurement, so they start slightly smaller.
    let own = SIZES.iter().map(|size| Company::grown(size / 10 * 9, Keep::Memory, bench));
    let mut companies = own.collect::<Result<Vec<Company>, BenchError>>()?;
    companies.push(at_a_million(Keep::Memory, bench)?);
    let mut costs = vec![Vec::new(); companies.len()];
    for _ in 0..bench.repetitions.min(WEEKS_OF_A_SIZE) {
        for (company, own) in companies.iter_mut().zip(&mut costs) {
            own.push(company.week()?.per_subscriber_day() * 1e9);
        }
    }
    let medians: Vec<f64> = costs.iter().filter_map(|samples| median(samples)).collect();
    let least = medians.iter().copied().fold(f64::INFINITY, f64::min);
    let most = medians.iter().copied().fold(0.0, f64::max);
    costs.insert(0, vec![(most / least - 1.0) * 100.0]);
    Ok(costs)
}
