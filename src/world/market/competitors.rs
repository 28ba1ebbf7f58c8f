//! Competitor events: competitors raise all groups' expectations and copy the player's improvements
//! (docs/mechanics/market/competitors.md).

use crate::canonical::canonical;
use crate::customers::drift::DriftTotals;
use crate::events::Severity;
use crate::fault::Fault;
use crate::identifiers::{ByGroup, Group};
use crate::params::{Competitor, Params};
use crate::product::Product;
use crate::random::{Part, Stream, Streams};
use crate::series::RecordedEvent;

/// A competitor's gain in quality, which raised the expectations of customers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CompetitorEvent {
    /// Day on which the gain was applied.
    pub day: u32,
    /// Gain in quality that was applied.
    pub boost: f64,
    /// Drawn gain in quality, scaled by the growth over the run.
    pub sampled: f64,
    /// Share of the player's shared quality bank that competitors could copy.
    pub u: f64,
    /// Whether the copied gain was larger than the drawn gain and was applied.
    pub by_feedback: bool,
}

canonical! { CompetitorEvent { day, boost, sampled, u, by_feedback } }

/// Returns the severity of a gain in quality.
pub fn severity(boost: f64, competitor: &Competitor) -> Severity {
    match boost {
        _ if boost < competitor.competitor_severity_minor_max => Severity::Minor,
        _ if boost < competitor.competitor_severity_moderate_max => Severity::Moderate,
        _ if boost < competitor.competitor_severity_major_max => Severity::Major,
        _ => Severity::Transformative,
    }
}

fn can_occur(day: u32, total_days: u32, params: &Params) -> bool {
    let competitor = &params.competitor;
    let too_early = day < params.drift.drift_grace_period_days;
    let too_late =
        i64::from(day) > i64::from(total_days) - i64::from(competitor.competitor_event_late_cutoff_days);
    !competitor.competitor_events_disabled && !too_early && !too_late
}

/// Returns the probability of an event on a day, or 0 if no event is possible.
pub fn event_probability(day: u32, total_days: u32, last_event: Option<u32>, params: &Params) -> f64 {
    let competitor = &params.competitor;
    if !can_occur(day, total_days, params) {
        return 0.0;
    }
    let (mut mean, mut least) =
        (competitor.competitor_event_mean_interval, competitor.competitor_event_min_interval);
    let gap = f64::from(day) - last_event.map_or(-competitor.competitor_event_mean_interval, f64::from);
    if day < (total_days / competitor.first_half_divisor).max(1) {
        mean *= competitor.first_half_interval_multiplier;
        least *= competitor.first_half_min_interval_multiplier;
    }
    if gap < least { 0.0 } else { 1.0 / mean }
}

/// Returns the factor by which events grow over the run. The factor rises from 1 to 4 until 30 days before the last
/// day.
pub fn magnitude_scale(day: u32, total_days: u32, competitor: &Competitor) -> f64 {
    let start = f64::from(competitor.magnitude_ramp_start_day);
    let end = (f64::from(total_days) - f64::from(competitor.competitor_event_late_cutoff_days))
        .max(f64::from(competitor.magnitude_ramp_end_day_min));
    let ramp = ((f64::from(day) - start) / (end - start).max(1.0)).clamp(0.0, 1.0);
    let (least, most) =
        (competitor.competitor_event_magnitude_scale_min, competitor.competitor_event_magnitude_scale_max);
    least + (most - least) * ramp
}

/// Returns the gain in quality of an event: a log-normal draw that is clamped, then scaled by the growth over the run.
pub fn sampled_boost(log_normal: f64, day: u32, total_days: u32, competitor: &Competitor) -> f64 {
    log_normal.clamp(competitor.competitor_event_boost_min, competitor.competitor_event_boost_max)
        * magnitude_scale(day, total_days, competitor)
}

/// Resolves an event. The larger of the sampled gain and the share `u` of the quality bank applies. Copied quality is
/// removed from the bank.
pub fn resolve_event(day: u32, sampled: f64, u: f64, bank: &mut f64, params: &Params) -> CompetitorEvent {
    let feedback = u * *bank;
    let by_feedback = (feedback > sampled) != params.has_fault(Fault::SmallerRivalMove);
    if by_feedback {
        *bank = (*bank - feedback).max(params.competitor.bank_min);
    }
    CompetitorEvent { day, boost: if by_feedback { feedback } else { sampled }, sampled, u, by_feedback }
}

/// A competitor's move on a day, before the move is applied.
#[derive(Debug, Clone)]
pub struct CompetitorMove {
    /// Day on which the move takes effect.
    pub day: u32,
    /// Drawn gain in quality, scaled by the growth over the run.
    pub sampled: f64,
    /// Share of the player's shared quality bank that competitors can copy.
    pub u: f64,
    /// The rest of the random stream, from which the copied shares of the targeted quality banks are drawn.
    remaining_stream: Stream,
}

impl CompetitorMove {
    /// Returns the copied share of each non-empty targeted quality bank, in alphabetical order of group.
    pub fn copied_group_shares(
        &self,
        group_bank: &ByGroup<f64>,
        competitor: &Competitor,
    ) -> Vec<(Group, f64)> {
        let mut stream = self.remaining_stream.clone();
        let mut funded: Vec<Group> = Group::all().filter(|group| group_bank[*group] > 0.0).collect();
        funded.sort_by_key(|group| group.id());
        let mut share = || {
            stream
                .between(competitor.competitor_segment_drain_u_min, competitor.competitor_segment_drain_u_max)
        };
        funded.into_iter().map(|group| (group, share())).collect()
    }
}

/// Returns the competitor move on a day, or `None` if there is no move. The result depends on the day of the last
/// event.
pub fn move_on_day(
    day: u32,
    total_days: u32,
    last_event: Option<u32>,
    params: &Params,
    streams: &Streams,
) -> Option<CompetitorMove> {
    let competitor = &params.competitor;
    let chance = event_probability(day, total_days, last_event, params);
    let mut stream = streams.open(Part::CompetitorEvent, [u64::from(day)]);
    let drawn = match params.replayed_series().and_then(|series| series.competitor_event(day)) {
        Some(recorded_event) => recorded_event.filter(|_| can_occur(day, total_days, params)),
        None => draw_event(chance, competitor, &mut stream),
    };
    let RecordedEvent { size, u } = drawn?;
    Some(CompetitorMove {
        day,
        sampled: sampled_boost(size, day, total_days, competitor),
        u,
        remaining_stream: stream,
    })
}

/// Returns the next move after a day. The next move is already determined, because draws depend only on the day, and
/// possible days depend only on the last event.
pub fn next_move(
    after: u32,
    total_days: u32,
    last_event: Option<u32>,
    params: &Params,
    streams: &Streams,
) -> Option<CompetitorMove> {
    (after + 1..=total_days).find_map(|day| move_on_day(day, total_days, last_event, params, streams))
}

/// Applies the competitor move of the day, if any.
pub fn apply_move(
    day: u32,
    total_days: u32,
    events: &mut Vec<CompetitorEvent>,
    product: &mut Product,
    drift: &mut DriftTotals,
    params: &Params,
    streams: &Streams,
) {
    let competitor = &params.competitor;
    let last_event = events.last().map(|event| event.day);
    let Some(made) = move_on_day(day, total_days, last_event, params, streams) else { return };
    let event = resolve_event(day, made.sampled, made.u, &mut product.shared_bank, params);
    raise_expectations(event.boost, drift, params);
    for (group, v) in made.copied_group_shares(&product.group_bank, competitor) {
        copy_group_bank(group, v, product, drift, competitor);
    }
    events.push(event);
}

/// Draws today's event, if any: its gain in quality before the growth over the run, and the share of the quality bank
/// that competitors can copy.
pub fn draw_event(chance: f64, competitor: &Competitor, stream: &mut Stream) -> Option<RecordedEvent> {
    if chance <= 0.0 || !stream.bernoulli(chance) {
        return None;
    }
    let size =
        stream.log_normal(competitor.competitor_event_boost_mu, competitor.competitor_event_boost_sigma);
    let u = stream.between(competitor.competitor_feedback_u_min, competitor.competitor_feedback_u_max);
    Some(RecordedEvent { size, u })
}

/// Raises the expectations of all groups, and additionally the expectations of reactive groups.
pub fn raise_expectations(boost: f64, drift: &mut DriftTotals, params: &Params) {
    drift.global_quality += boost;
    for group in Group::all() {
        drift.quality[group] += params.group(group).competitor_reactivity_q_bias * boost;
    }
}

/// Copies a share `v` of a group's targeted quality bank, which raises the group's expectations.
pub fn copy_group_bank(
    group: Group,
    v: f64,
    product: &mut Product,
    drift: &mut DriftTotals,
    competitor: &Competitor,
) {
    let drained = v * product.group_bank[group];
    drift.quality[group] += drained;
    product.group_bank[group] = (product.group_bank[group] - drained).max(competitor.bank_min);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 1e-12, "got {actual}, expected {expected}");
    }

    fn group(id: &str) -> Group {
        Group::parse(id).expect("a group")
    }

    /// Resolves an event with given draws: the log-normal gain and the fraction of the range of `u`.
    fn event(day: u32, size: f64, bank: f64, fraction: f64) -> (CompetitorEvent, f64, Severity) {
        let params = Params::bundled();
        let competitor = &params.competitor;
        let u = competitor.competitor_feedback_u_min
            + fraction * (competitor.competitor_feedback_u_max - competitor.competitor_feedback_u_min);
        let mut bank = bank;
        let event = resolve_event(day, sampled_boost(size, day, 500, competitor), u, &mut bank, &params);
        (event, bank, severity(event.boost, competitor))
    }

    #[test]
    fn events_occur_between_grace_period_and_last_month() {
        let params = Params::bundled();
        let chance = |day, total, last| event_probability(day, total, last, &params);
        assert_eq!(chance(59, 500, None), 0.0);
        assert_eq!(chance(471, 500, None), 0.0);
        let early = chance(60, 500, None);
        assert!(0.0971 < early && early < 0.0973);
        let late = chance(260, 500, None);
        assert!(0.1458 < late && late < 0.1459);
        assert_eq!(chance(100, 500, Some(99)), 0.0);
        assert!(chance(100, 500, Some(98)) > 0.0);
        assert!(chance(260, 500, Some(259)) > 0.0);
        assert_eq!((chance(35, 50, None), chance(60, 50, None)), (0.0, 0.0));
        let mut quiet = params.clone();
        quiet.competitor.competitor_events_disabled = true;
        assert_eq!(event_probability(200, 500, None, &quiet), 0.0);
    }

    #[test]
    fn event_sizes_grow_and_copying_reduces_the_bank() {
        let (small, _, class) = event(60, 0.02, 0.0, 0.5);
        assert_near(small.boost, 0.027547974413646);
        assert_eq!(class, Severity::Minor);
        let mut drift = DriftTotals::default();
        raise_expectations(small.boost, &mut drift, &Params::bundled());
        assert_near(drift.quality[group("S1")], 0.004132196162047);
        assert_near(drift.quality[group("S2")], 0.001652878464819);
        assert_near(drift.quality[group("D_S08")], 0.009641791044776);
        let (moderate, bank, class) = event(300, 0.02, 0.1, 0.5);
        assert_near(moderate.boost, 0.058251599147122);
        assert!(!moderate.by_feedback && bank == 0.1 && class == Severity::Moderate);
        let (copied, bank, class) = event(300, 0.02, 0.5, 0.5);
        assert_near(copied.boost, 0.175);
        assert_near(bank, 0.325);
        assert!(copied.by_feedback && class == Severity::Major);
        let (huge, _, class) = event(300, 5.0, 0.0, 0.0);
        assert_near(huge.boost, 0.503170942164179);
        assert_eq!(class, Severity::Transformative);
        assert_near(event(300, 0.0001, 0.0, 0.0).0.boost, 0.005750525053305);
        assert_near(event(470, 0.02, 0.0, 0.0).0.boost, 0.08);
    }

    #[test]
    fn targeted_banks_are_copied_separately() {
        let params = Params::bundled();
        let (event, bank, _) = event(200, 0.03, 1.0, 0.25);
        assert_near(event.boost, 0.275);
        assert_near(bank, 0.725);
        let (mut product, mut drift) = (Product::initial(&params), DriftTotals::default());
        product.group_bank[group("D_E03")] = 0.1;
        product.group_bank[group("S1")] = 0.4;
        raise_expectations(event.boost, &mut drift, &params);
        copy_group_bank(group("D_E03"), 0.05, &mut product, &mut drift, &params.competitor);
        copy_group_bank(group("S1"), 0.08, &mut product, &mut drift, &params.competitor);
        assert_near(drift.quality[group("S1")], 0.07325);
        assert_near(product.group_bank[group("D_E03")], 0.095);
        assert_near(product.group_bank[group("S1")], 0.368);
    }

    #[test]
    fn event_sizes_are_clamped_before_scaling() {
        let params = Params::bundled();
        let competitor = &params.competitor;
        assert_near(sampled_boost(0.01, 250, 500, competitor), 0.02592750533049);
        assert_near(sampled_boost(0.01, 470, 500, competitor), 0.04);
        assert_near(sampled_boost(5.0, 470, 500, competitor), 0.69103125);
        assert_near(sampled_boost(1e-9, 470, 500, competitor), 0.0078975);
        assert_near(sampled_boost(0.01, 467, 497, competitor), 0.04);
        let mut bank = 1.0;
        let event = resolve_event(60, sampled_boost(0.01, 60, 500, competitor), 0.35, &mut bank, &params);
        assert!(event.by_feedback);
        assert_near(event.boost, 0.35);
        assert_near(bank, 0.65);
    }

    #[test]
    fn events_without_development_match_measured_distribution() {
        let params = Params::bundled();
        let (mut counts, mut sums, mut first_half) = (0.0, 0.0, 0.0);
        let seeds = 200;
        for seed in 0..seeds {
            let (mut events, mut product) = (Vec::new(), Product::initial(&params));
            let (mut drift, streams) = (DriftTotals::default(), Streams::new(seed));
            for day in 1..=500 {
                apply_move(day, 500, &mut events, &mut product, &mut drift, &params, &streams);
            }
            counts += events.len() as f64;
            sums += events.iter().map(|event| event.boost).sum::<f64>();
            first_half += events.iter().filter(|event| event.day < 250).count() as f64;
        }
        let seeds = seeds as f64;
        assert!((counts / seeds - 48.2).abs() < 4.0 * 6.0 / seeds.sqrt(), "{}", counts / seeds);
        assert!((first_half / seeds - 16.6).abs() < 4.0 * 3.5 / seeds.sqrt(), "{}", first_half / seeds);
        assert!((sums / seeds - 2.82).abs() < 4.0 * 0.66 / seeds.sqrt(), "{}", sums / seeds);
    }
}
