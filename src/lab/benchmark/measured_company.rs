//! The measured company: policy P1a, played up to a number of subscribers.

use std::time::Instant;

use super::{BenchContext, BenchError};
use crate::policy::Policy;
use crate::runner::{RunSpec, decide, new_run};
use novamind_record::trajectory::record::Via;
use novamind_session::{NewRun, Session, Storage};

/// Policy of all figures.
pub const POLICY: &str = "P1a";
/// Seed of all figures.
pub const SEED: u64 = 42;
/// Weeks after which every subscriber was billed: a billing period and a few days.
const SETTLING_WEEKS: u32 = 5;

/// Storage of the run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RunStorage {
    /// In memory, without a database.
    Memory,
    /// On disk, with the database updated in the background, as in interactive play.
    Disk,
}

/// Market of the company.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MarketSize {
    /// The default market.
    Standard,
    /// A larger market with room for a million subscribers.
    Large,
}

/// A company with many subscribers.
pub struct MeasuredCompany {
    policy: Policy,
    /// Its run.
    pub session: Session,
}

/// Measurement of one week.
#[derive(Debug, Clone, Copy)]
pub struct WeekMeasurement {
    /// Seconds from the key to the dashboard.
    pub seconds: f64,
    /// Active subscribers in the middle of the week.
    pub subscribers: f64,
}

impl WeekMeasurement {
    /// Returns the seconds per subscriber and day.
    pub fn per_subscriber_day(&self) -> f64 {
        self.seconds / 7.0 / self.subscribers
    }
}

impl MeasuredCompany {
    /// Creates a company on day 0.
    pub fn new(
        market: MarketSize,
        keep: RunStorage,
        bench: &BenchContext,
    ) -> Result<MeasuredCompany, BenchError> {
        let policy = Policy::find(POLICY, &bench.configuration)?;
        let mut spec = RunSpec::for_seed(SEED);
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

    /// Returns a company in the default market once it has this many subscribers.
    pub fn with_subscribers(
        subscribers: u32,
        keep: RunStorage,
        bench: &BenchContext,
    ) -> Result<MeasuredCompany, BenchError> {
        let mut company = MeasuredCompany::new(MarketSize::Standard, keep, bench)?;
        company.grow_to(subscribers)?;
        Ok(company)
    }

    /// Returns the active subscribers.
    pub fn subscribers(&self) -> u32 {
        self.session.weeks().last().map_or(0, |week| week.individual_subscribers)
    }

    /// Makes the decisions of a week and simulates it; only the simulation is measured.
    pub fn measure_week(&mut self) -> Result<WeekMeasurement, BenchError> {
        decide(&self.policy, SEED, &mut self.session)?;
        self.session.wait_for_database()?;
        let before = self.subscribers();
        let forecasts = self.session.company().naive_forecasts();
        let started = Instant::now();
        self.session.advance("bench", &forecasts, Via::Policy, &mut |_| {})?;
        let seconds = started.elapsed().as_secs_f64();
        Ok(WeekMeasurement { seconds, subscribers: f64::from(before + self.subscribers()) / 2.0 })
    }

    /// Plays until the company has this many subscribers.
    pub fn grow_to(&mut self, subscribers: u32) -> Result<(), BenchError> {
        while self.subscribers() < subscribers {
            if self.session.ended().is_some() {
                return Err(BenchError(format!("the company never reached {subscribers} subscribers")));
            }
            self.measure_week()?;
        }
        Ok(())
    }

    /// Plays until every subscriber was billed once.
    pub fn play_billing_period(&mut self) -> Result<(), BenchError> {
        for _ in 0..SETTLING_WEEKS {
            self.measure_week()?;
        }
        Ok(())
    }
}
