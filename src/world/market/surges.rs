//! Demand surges: unannounced, temporary increases of leads (docs/mechanics/market/surges.md).

use crate::canonical::canonical;
use crate::params::{DemandSurge, Params, SurgeStart};
use crate::random::{Part, Streams};

/// A demand surge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Surge {
    /// Day for which the surge was drawn.
    pub day: u32,
    /// First day after the surge.
    pub end_day: u32,
    /// Factor by which the surge multiplies leads.
    pub multiplier: f64,
}

canonical! { Surge { day, end_day, multiplier } }

/// Returns the last day of the week that contains `day`. Weeks end on days divisible by 7, and the last week ends with
/// the run.
pub fn week_end(day: u32, days_per_week: u32, last_day: u32) -> u32 {
    day.next_multiple_of(days_per_week).min(last_day.max(day))
}

/// Draws the surge of a day, or returns `None` if the day has no surge.
pub fn draw_surge(day: u32, surge: &DemandSurge, streams: &Streams) -> Option<Surge> {
    let mut stream = streams.open(Part::Surge, [u64::from(day)]);
    if !stream.bernoulli(surge.probability) {
        return None;
    }
    let duration = stream.integer(surge.duration_days_low, surge.duration_days_high_exclusive - 1);
    let multiplier = surge.multiplier_base + surge.multiplier_range * stream.uniform();
    Some(Surge { day, end_day: day + duration, multiplier })
}

/// Returns the surge of a day. The surge is drawn, or read from the recorded series if the parameters replay one.
pub fn surge_on_day(day: u32, params: &Params, streams: &Streams) -> Option<Surge> {
    let demand_surge = &params.demand_surge;
    match params.replayed_series().and_then(|series| series.demand_surge(day)) {
        None => draw_surge(day, demand_surge, streams),
        Some(recorded_surge) => recorded_surge
            .filter(|_| demand_surge.probability > 0.0)
            .map(|surge| Surge { day, end_day: day + surge.days, multiplier: surge.multiplier }),
    }
}

/// Draws the surges of all days of a week on the first day of the week.
pub fn draw_week_surges(
    day: u32,
    last_day: u32,
    surges: &mut Vec<Surge>,
    params: &Params,
    streams: &Streams,
) {
    let length = params.run.days_per_week;
    if day % length == 1 {
        let days = day..=week_end(day, length, last_day);
        surges.extend(days.filter_map(|day| surge_on_day(day, params, streams)));
    }
}

/// Returns the product of the factors of all surges on a day, or 1 if there is no surge. In the released simulator, a
/// surge starts on the first day of the week in which it was drawn ([`SurgeStart::Week`]).
pub fn surge_factor(day: u32, surges: &[Surge], start: SurgeStart) -> f64 {
    let has_started = |surge: &Surge| start == SurgeStart::Week || surge.day <= day;
    surges
        .iter()
        .filter(|surge| day < surge.end_day && has_started(surge))
        .map(|surge| surge.multiplier)
        .product()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surges_multiply_from_the_first_day_of_their_week() {
        let surge = |day, end_day, multiplier| Surge { day, end_day, multiplier };
        let week = |day, surges: &[Surge]| surge_factor(day, surges, SurgeStart::Week);
        let stored = [surge(5, 10, 3.0), surge(6, 9, 2.0)];
        for (day, factor) in [(1, 6.0), (4, 6.0), (8, 6.0), (9, 3.0), (10, 1.0)] {
            assert_eq!(week(day, &stored), factor, "day {day}");
        }
        let stored = [surge(12, 16, 2.5), surge(13, 17, 2.0)];
        for (day, factor) in [(8, 5.0), (11, 5.0), (15, 5.0), (16, 2.0), (17, 1.0)] {
            assert_eq!(week(day, &stored), factor, "day {day}");
        }
        assert_eq!(surge_factor(11, &stored, SurgeStart::Day), 1.0);
        assert_eq!(surge_factor(12, &stored, SurgeStart::Day), 2.5);
    }

    #[test]
    fn week_end_is_divisible_by_seven_or_the_last_day() {
        assert_eq!(week_end(1, 7, 500), 7);
        assert_eq!(week_end(7, 7, 500), 7);
        assert_eq!(week_end(498, 7, 500), 500);
    }

    #[test]
    fn surges_match_measured_distribution() {
        let params = Params::bundled();
        let (mut count, mut multipliers, mut durations) = (0.0, 0.0, 0.0);
        for seed in 0..300 {
            let (streams, mut surges) = (Streams::new(seed), Vec::new());
            (1..=500).for_each(|day| draw_week_surges(day, 500, &mut surges, &params, &streams));
            count += surges.len() as f64;
            multipliers += surges.iter().map(|surge| surge.multiplier).sum::<f64>();
            durations += surges.iter().map(|surge| f64::from(surge.end_day - surge.day)).sum::<f64>();
        }
        assert!((count / 300.0 - 2.5).abs() < 0.35, "{}", count / 300.0);
        assert!((multipliers / count - 5.0).abs() < 0.3 && (durations / count - 6.5).abs() < 0.4);
    }
}
