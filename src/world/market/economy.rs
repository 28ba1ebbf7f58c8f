//! The economy: the hidden daily PMI, its delayed publication, and its effects on groups
//! (docs/mechanics/market/economy.md).

use crate::canonical::canonical;
use crate::events::{Facts, Notice, Phase, Reading, Trend};
use crate::fault::Fault;
use crate::identifiers::Group;
use crate::params::{MacroEconomy, Params};
use crate::random::{Part, Streams};
use novamind_base::formatting::round_to;

/// The state of the economy.
#[derive(Debug, Clone, PartialEq)]
pub struct Economy {
    /// Today's PMI, hidden from the player.
    pub pmi: f64,
    /// Whether the first day has been simulated. Before the first day, every multiplier is 1.
    pub started: bool,
    /// Daily PMI values since the last measurement.
    history: Vec<f64>,
    /// Day of the last measurement.
    last_measurement: Option<u32>,
    /// Readings that are measured but not yet published.
    waiting: Vec<Reading>,
    /// The newest published reading.
    pub published: Option<Reading>,
}

canonical! { Economy { pmi, started, history, last_measurement, waiting, published } }

/// Returns the value towards which the economic cycle pulls the PMI: mean + amplitude sin(2 pi day / period + phase).
pub fn cycle_target(day: u32, phase: f64, economy: &MacroEconomy) -> f64 {
    let turn = 2.0 * std::f64::consts::PI * f64::from(day) / f64::from(economy.macro_pmi_cycle_period_days);
    economy.macro_pmi_long_run_mean + economy.macro_pmi_cycle_amplitude * libm::sin(turn + phase)
}

/// Returns the PMI of the next day. `z` is a standard normal draw.
pub fn next_pmi(pmi: f64, target: f64, z: f64, economy: &MacroEconomy) -> f64 {
    let moved =
        pmi + economy.macro_pmi_mean_reversion_rate * (target - pmi) + economy.macro_pmi_daily_volatility * z;
    moved.clamp(economy.macro_pmi_floor, economy.macro_pmi_ceiling)
}

/// Returns the multiplier for a sensitivity `beta` at a PMI: max(0.5, 1 + beta (PMI - 50) / 50).
pub fn macro_multiplier(beta: f64, pmi: f64, economy: &MacroEconomy) -> f64 {
    (economy.multiplier_neutral + beta * (pmi - economy.neutral_pmi) / economy.pmi_scale)
        .max(economy.multiplier_min)
}

/// A figure that the economy affects.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Number of leads of a group.
    LeadGeneration,
    /// Budget of a customer at a billing decision.
    WillingnessToPay,
    /// Reply speed of a new enterprise.
    DealVelocity,
    /// Drift of the number of seats.
    SeatCount,
}

impl Economy {
    /// Returns the economy on day 0.
    pub fn initial(params: &Params) -> Economy {
        Economy {
            pmi: params.economy.macro_pmi_initial,
            started: false,
            history: Vec::new(),
            last_measurement: None,
            waiting: Vec::new(),
            published: None,
        }
    }

    /// Returns the newest reading, even if it is not published yet.
    pub fn latest_measurement(&self) -> Option<&Reading> {
        self.waiting.last().or(self.published.as_ref())
    }

    /// Returns the multiplier of a group in a dimension at the current PMI. The multiplier is 1 before the first day,
    /// or if the group does not react.
    pub fn multiplier(&self, group: Group, dimension: Dimension, params: &Params) -> f64 {
        let beta = &params.group(group).macro_beta;
        let beta = match dimension {
            Dimension::LeadGeneration if params.has_fault(Fault::EconomyReversed) => {
                beta.lead_generation.map(|beta| -beta)
            }
            Dimension::LeadGeneration => beta.lead_generation,
            Dimension::WillingnessToPay => beta.willingness_to_pay,
            Dimension::DealVelocity => beta.deal_velocity,
            Dimension::SeatCount => beta.seat_count,
        };
        match beta {
            Some(beta) if self.started => macro_multiplier(beta, self.pmi, &params.economy),
            _ => params.economy.multiplier_neutral,
        }
    }
}

fn cycle_phase(economy: &MacroEconomy, streams: &Streams) -> f64 {
    if economy.macro_pmi_random_phase {
        streams.open_for_day(0, Part::Macro, [0]).between(0.0, 2.0 * std::f64::consts::PI)
    } else {
        economy.macro_pmi_fixed_phase
    }
}

/// Returns the PMI of a day, computed from the PMI of the day before.
pub fn index_on_day(day: u32, yesterday: f64, params: &Params, streams: &Streams) -> f64 {
    let economy = &params.economy;
    let drawn = || {
        let target = cycle_target(day, cycle_phase(economy, streams), economy);
        let z = streams.open(Part::Macro, [u64::from(day)]).standard_normal();
        next_pmi(yesterday, target, z, economy)
    };
    params.replayed_series().and_then(|series| series.pmi(day)).unwrap_or_else(drawn)
}

/// Simulates the economy on one day. Updates the PMI unless it is fixed, measures a reading when a month is complete,
/// and publishes readings after the publication lag.
pub fn step(
    day: u32,
    economy: &mut Economy,
    is_fixed: bool,
    params: &Params,
    streams: &Streams,
    facts: &mut Facts,
) {
    let macro_economy = &params.economy;
    if !is_fixed {
        economy.pmi = index_on_day(day, economy.pmi, params, streams);
    }
    economy.started = true;
    economy.history.push(economy.pmi);
    let interval = macro_economy.macro_pmi_update_interval_days;
    if economy.last_measurement.is_none_or(|last| day - last >= interval) {
        measure(day, economy, macro_economy);
    }
    publish(day, economy, macro_economy, facts);
}

fn measure(day: u32, economy: &mut Economy, macro_economy: &MacroEconomy) {
    let mean = economy.history.iter().sum::<f64>() / economy.history.len() as f64;
    let value = round_to(mean, macro_economy.published_pmi_decimals);
    let before =
        economy.latest_measurement().map_or(macro_economy.macro_pmi_initial, |reading| reading.value);
    let change = round_to(value - before, macro_economy.published_pmi_decimals);
    let (trend, phase) =
        (Trend::from_index(value, macro_economy), Phase::from_reading(value, change, macro_economy));
    economy.waiting.push(Reading { measured_day: day, value, change, trend, phase });
    economy.history.clear();
    economy.last_measurement = Some(day);
}

fn publish(day: u32, economy: &mut Economy, macro_economy: &MacroEconomy, facts: &mut Facts) {
    let delay = macro_economy.macro_pmi_publication_delay_days;
    let due = economy.waiting.partition_point(|reading| reading.measured_day + delay <= day);
    for reading in economy.waiting.drain(..due) {
        economy.published = Some(reading);
        facts.readings.push(reading);
        facts.notices.push(Notice::EconomyUpdate(reading));
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Returns an economy that has started and has the given PMI.
    pub(crate) fn economy_at(pmi: f64) -> Economy {
        Economy { pmi, started: true, ..Economy::initial(&Params::bundled()) }
    }

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 5e-10, "got {actual}, expected {expected}");
    }

    fn multiplier(id: &str, dimension: Dimension, pmi: f64) -> f64 {
        let params = Params::bundled();
        economy_at(pmi).multiplier(Group::parse(id).expect("a group"), dimension, &params)
    }

    #[test]
    fn index_without_noise_follows_the_cycle() {
        let mut params = Params::bundled();
        params.economy.macro_pmi_daily_volatility = 0.0;
        let (mut economy, streams) = (Economy::initial(&params), Streams::new(1));
        let mut readings = Vec::new();
        for day in 1..=61 {
            let mut facts = Facts::default();
            step(day, &mut economy, false, &params, &streams, &mut facts);
            readings.extend(facts.readings.iter().map(|reading| (day, *reading)));
            match day {
                1 => assert_near(economy.pmi, 49.250007889),
                2 => assert_near(economy.pmi, 49.131839323),
                10 => assert_near(economy.pmi, 48.250782805),
                30 => assert_near(economy.pmi, 46.520458736),
                31 => assert_near(economy.pmi, 46.450702501),
                _ => {}
            }
        }
        let expected = [
            (31, 1, 49.3, -0.1, Trend::Neutral, Phase::Declining),
            (61, 31, 47.7, -1.6, Trend::Contraction, Phase::Declining),
        ];
        assert_eq!(readings.len(), 2);
        for ((published, reading), (day, measured_day, value, change, trend, phase)) in
            readings.iter().zip(expected)
        {
            assert_eq!((*published, *reading), (day, Reading { measured_day, value, change, trend, phase }));
        }
        let macro_economy = Params::bundled().economy;
        assert_eq!(
            next_pmi(
                30.1,
                cycle_target(200, macro_economy.macro_pmi_fixed_phase, &macro_economy),
                -3.0,
                &macro_economy
            ),
            30.0
        );
    }

    #[test]
    fn multiplier_follows_group_sensitivities() {
        use Dimension::*;
        for (id, dimension, pmi, expected) in [
            ("S1", LeadGeneration, 42.5, 0.775),
            ("S1", WillingnessToPay, 42.5, 0.73),
            ("E1", SeatCount, 42.5, 0.8425),
            ("D_E01", LeadGeneration, 42.5, 1.0675),
            ("D_E06", WillingnessToPay, 42.5, 0.7525),
            ("S1", LeadGeneration, 30.0, 0.5),
            ("E1", SeatCount, 30.0, 0.58),
            ("D_S01", WillingnessToPay, 70.0, 1.78),
            ("S1", LeadGeneration, 60.0, 1.3),
            ("S1", WillingnessToPay, 60.0, 1.36),
            ("E1", SeatCount, 60.0, 1.21),
            ("D_E01", SeatCount, 60.0, 0.88),
            ("S1", WillingnessToPay, 41.37, 0.68932),
            ("D_E06", LeadGeneration, 41.37, 0.66343),
            ("D_E01", LeadGeneration, 41.37, 1.07767),
            ("E1", WillingnessToPay, 30.0, 0.52),
            ("D_E06", LeadGeneration, 70.0, 1.78),
            ("S2", SeatCount, 70.0, 1.0),
        ] {
            assert_near(multiplier(id, dimension, pmi), expected);
        }
    }

    #[test]
    fn readings_are_labeled_by_value_and_change() {
        let economy = Params::bundled().economy;
        for (pmi, trend) in [
            (58.0, "strong_expansion"),
            (57.9, "expansion"),
            (51.9, "neutral"),
            (47.9, "contraction"),
            (41.9, "severe_contraction"),
        ] {
            assert_eq!(Trend::from_index(pmi, &economy).id(), trend);
        }
        for (value, change, phase) in [
            (53.0, 0.0, "peak"),
            (53.0, 0.1, "recovering"),
            (50.0, -0.1, "declining"),
            (50.0, 0.0, "recovering"),
            (47.0, 0.0, "trough"),
            (47.0, -1.0, "declining"),
        ] {
            assert_eq!(Phase::from_reading(value, change, &economy).id(), phase);
        }
    }

    #[test]
    fn index_matches_measured_distribution() {
        let params = Params::bundled();
        let (mut means, mut lows, mut highs, mut below) = (vec![], vec![], vec![], vec![]);
        for seed in 0..60 {
            let (mut economy, streams) = (Economy::initial(&params), Streams::new(seed));
            let path: Vec<f64> = (1..=500)
                .map(|day| {
                    step(day, &mut economy, false, &params, &streams, &mut Facts::default());
                    economy.pmi
                })
                .collect();
            means.push(path.iter().sum::<f64>() / 500.0);
            lows.push(path.iter().copied().fold(f64::INFINITY, f64::min));
            highs.push(path.iter().copied().fold(0.0, f64::max));
            below.push(path.iter().filter(|pmi| **pmi < 50.0).count() as f64 / 500.0);
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        assert!((mean(&means) - 50.5).abs() < 0.5, "{}", mean(&means));
        assert!((mean(&lows) - 42.8).abs() < 0.8, "{}", mean(&lows));
        assert!((mean(&highs) - 58.3).abs() < 0.8, "{}", mean(&highs));
        assert!((mean(&below) - 0.477).abs() < 0.04, "{}", mean(&below));
    }
}
