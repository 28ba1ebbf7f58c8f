//! Service health of a day (`docs/mechanics/product/service.md`).

use crate::events::{Facts, ServiceDay};
use crate::morning::Morning;
use crate::params::{Operations, Params};
use crate::random::{Part, Stream, Streams};

/// Returns the usage above capacity as a share of capacity: max(0, usage / capacity - 1).
pub fn overload(usage: u64, capacity_units: f64, operations: &Operations) -> f64 {
    (usage as f64 / capacity_units - operations.overload_reference_utilization).max(0.0)
}

/// Returns today's probability of an outage: max(0.001, 0.03 exp(-ops / 500)) (1 + 4 o).
pub fn outage_probability(spend_operations: f64, overload: f64, operations: &Operations) -> f64 {
    let base =
        operations.base_outage_prob * libm::exp(-spend_operations / operations.ops_outage_reduction_scale);
    base.max(operations.ops_outage_min_prob) * (1.0 + operations.outage_overload_factor * overload)
}

/// Returns the 95th percentile of the latency in milliseconds. `z` is a standard normal draw.
pub fn p95_latency(overload: f64, z: f64, operations: &Operations) -> f64 {
    operations.p95_base_ms + operations.p95_overload_factor * overload + operations.p95_noise_std * z
}

/// Returns the share of failed requests. `z` is a standard normal draw.
pub fn error_rate(overload: f64, z: f64, operations: &Operations) -> f64 {
    let rate = operations.error_rate_base
        + operations.error_rate_overload_factor * overload
        + operations.error_rate_noise_std * z;
    rate.clamp(operations.error_rate_min, operations.error_rate_max)
}

/// Draws the duration of an outage in minutes.
pub fn draw_downtime_minutes(stream: &mut Stream, operations: &Operations) -> u32 {
    let (mut u, choices) = (stream.uniform(), operations.downtime_minutes_choices);
    for (minutes, probability) in choices.into_iter().zip(operations.downtime_minutes_probabilities) {
        if u < probability {
            return minutes;
        }
        u -= probability;
    }
    choices[2]
}

/// Fixed inputs of the service health on a day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedService {
    /// Share of the measured usage that counts as demand.
    pub load_factor: f64,
    /// Day whose random draws determine outages, latency and error rate.
    pub draw_day: u32,
}

/// Computes and records the service health of the day, with fixed inputs if `fixed_service` is `Some`.
pub fn compute_service(
    total_usage: u64,
    morning: &Morning,
    fixed_service: Option<FixedService>,
    params: &Params,
    streams: &Streams,
    facts: &mut Facts,
) -> ServiceDay {
    let operations = &params.operations;
    let capacity_units = params.capacity_tier(morning.core.capacity_tier).capacity_units;
    let load =
        fixed_service.map_or(total_usage, |fixed| (total_usage as f64 * fixed.load_factor).round() as u64);
    let overload = overload(load, f64::from(capacity_units), operations);
    let stream_day = fixed_service.map_or(morning.day, |fixed| fixed.draw_day);
    let mut stream = streams.open(Part::Service, [u64::from(stream_day)]);
    let outage = stream.bernoulli(outage_probability(morning.core.operations, overload, operations));
    let downtime_minutes = if outage { draw_downtime_minutes(&mut stream, operations) } else { 0 };
    let service = ServiceDay {
        total_usage,
        overload,
        outage,
        downtime_minutes,
        p95_ms: p95_latency(overload, stream.standard_normal(), operations),
        error_rate: error_rate(overload, stream.standard_normal(), operations),
        capacity_tier: morning.core.capacity_tier,
        capacity_units,
    };
    facts.service = Some(service);
    service
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 1e-10, "got {actual}, expected {expected}");
    }

    #[test]
    fn overload_multiplies_the_outage_probability() {
        let operations = Params::bundled().operations;
        for (usage, capacity, spend, o, probability) in [
            (75_000, 50_000.0, 0.0, 0.5, 0.09),
            (75_000, 50_000.0, 500.0, 0.5, 0.0331091497),
            (10_000, 50_000.0, 2_000.0, 0.0, 0.001),
            (240_000, 200_000.0, 1_000.0, 0.2, 0.00730810529),
        ] {
            assert_near(overload(usage, capacity, &operations), o);
            assert_near(
                outage_probability(spend, overload(usage, capacity, &operations), &operations),
                probability,
            );
        }
        assert_near(p95_latency(0.5, 1.0, &operations), 630.0);
        assert_near(error_rate(0.5, 1.0, &operations), 0.009);
    }

    #[test]
    fn operations_reduce_the_outage_probability_to_its_minimum() {
        let operations = Params::bundled().operations;
        for (usage, spend, probability) in [
            (0, 0.0, 0.03),
            (0, 500.0, 0.0110363832),
            (0, 3_000.0, 0.001),
            (100_000, 500.0, 0.0551819162),
            (50_000, 100.0, 0.0245619226),
        ] {
            assert_near(
                outage_probability(spend, overload(usage, 50_000.0, &operations), &operations),
                probability,
            );
        }
        assert_near(p95_latency(0.5, 0.0, &operations), 580.0);
        assert_near(error_rate(0.5, 0.0, &operations), 0.008);
    }

    #[test]
    fn outage_durations_match_their_probabilities() {
        let (operations, streams) = (Params::bundled().operations, Streams::new(9));
        let mut counts = std::collections::BTreeMap::new();
        for day in 0..20_000 {
            *counts
                .entry(draw_downtime_minutes(&mut streams.open(Part::Service, [day]), &operations))
                .or_insert(0) += 1;
        }
        let share = |minutes| f64::from(counts[&minutes]) / 20_000.0;
        assert!(
            (share(10) - 0.5).abs() < 0.015
                && (share(30) - 0.35).abs() < 0.015
                && (share(90) - 0.15).abs() < 0.015
        );
    }
}
