//! Companies for measurements. Policy P1a is played until a company has a given number of subscribers.

use std::time::Instant;

use super::{BenchContext, BenchError};
use crate::policy::Policy;
use crate::runner::{RunSpec, make_decisions, new_run};
use novamind_record::trajectory::record::Via;
use novamind_session::{NewRun, Session, Storage};

/// Name of the policy that all measured companies play.
pub const POLICY: &str = "P1a";
/// Seed of all measured companies.
pub const SEED: u64 = 42;
/// Number of weeks after which every subscriber has been billed at least once.
const FULL_BILLING_WEEKS: u32 = 5;

/// The storage of a measured company's run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunStorage {
    /// Memory only, without a database.
    Memory,
    /// On disk, with the database updated in the background, as in interactive play.
    Disk,
}

/// The market of a measured company.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarketSize {
    /// The default market.
    Standard,
    /// A larger market, in which a company can reach 1,000,000 subscribers.
    Large,
}

/// A company with many subscribers, for measurements.
pub struct MeasuredCompany {
    policy: Policy,
    /// Session of the company's run.
    pub session: Session,
}

/// The measurement of one simulated week.
#[derive(Debug, Clone, Copy)]
pub struct WeekMeasurement {
    /// Seconds from the key press to the updated dashboard.
    pub seconds: f64,
    /// Number of active subscribers in the middle of the week.
    pub subscribers: f64,
}

impl WeekMeasurement {
    /// Returns the simulation time in seconds per subscriber per simulated day.
    pub fn per_subscriber_day(&self) -> f64 {
        self.seconds / 7.0 / self.subscribers
    }
}

impl MeasuredCompany {
    /// Creates a measured company on day 0.
    pub fn new(
        market: MarketSize,
        keep: RunStorage,
        bench: &BenchContext,
    ) -> Result<MeasuredCompany, BenchError> {
        let policy = Policy::find(POLICY, &bench.configuration)?;
        let mut spec = RunSpec { scenario: bench.scenario.clone(), ..RunSpec::for_seed(SEED) };
        if market == MarketSize::Large {
            spec.cash = Some(1e9);
            spec.overrides = vec![("leads.saturation_base".to_owned(), "14.5".to_owned())];
        }
        let on_disk = keep == RunStorage::Disk;
        let new = NewRun {
            storage: if on_disk { Storage::Runs(bench.scratch_folder.clone()) } else { Storage::Memory },
            projection: on_disk,
            sync_calls: on_disk,
            ..new_run(&policy, &spec)
        };
        Ok(MeasuredCompany { session: Session::create(new, &bench.configuration)?, policy })
    }

    /// Creates a company in the default market and plays weeks until it has at least `subscribers` subscribers.
    pub fn with_subscribers(
        subscribers: u32,
        keep: RunStorage,
        bench: &BenchContext,
    ) -> Result<MeasuredCompany, BenchError> {
        let mut company = MeasuredCompany::new(MarketSize::Standard, keep, bench)?;
        company.grow_to_subscribers(subscribers)?;
        Ok(company)
    }

    /// Returns the number of active subscribers.
    pub fn subscribers(&self) -> u32 {
        self.session.weeks().last().map_or(0, |week| week.individual_subscribers)
    }

    /// Makes the decisions of a week and simulates the week. Only the simulation is measured.
    pub fn measure_week(&mut self) -> Result<WeekMeasurement, BenchError> {
        make_decisions(&self.policy, SEED, &mut self.session)?;
        self.session.wait_for_database()?;
        let before = self.subscribers();
        let forecasts = self.session.company().naive_forecasts();
        let started = Instant::now();
        self.session.advance("bench", &forecasts, Via::Policy, &mut |_| {})?;
        let seconds = started.elapsed().as_secs_f64();
        Ok(WeekMeasurement { seconds, subscribers: f64::from(before + self.subscribers()) / 2.0 })
    }

    /// Plays weeks until the company has at least `subscribers` subscribers.
    pub fn grow_to_subscribers(&mut self, subscribers: u32) -> Result<(), BenchError> {
        while self.subscribers() < subscribers {
            if self.session.ended().is_some() {
                return Err(BenchError(format!("the company never reached {subscribers} subscribers")));
            }
            self.measure_week()?;
        }
        Ok(())
    }

    /// Plays weeks until every subscriber has been billed once.
    pub fn play_billing_period(&mut self) -> Result<(), BenchError> {
        for _ in 0..FULL_BILLING_WEEKS {
            self.measure_week()?;
        }
        Ok(())
    }
}
