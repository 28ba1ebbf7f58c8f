//! Inputs outside the player's control that a re-simulation can fix at the values of an earlier week. The normal
//! simulation fixes no inputs.

use super::identifiers::ByGroup;
use super::market::leads::LeadFactors;
use super::product::service::FixedService;

/// Inputs that are fixed from a day on, with their values. Other inputs change as usual.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FixedInputs {
    /// First day with fixed inputs. The first value of each list belongs to this day.
    pub from: u32,
    /// Whether competitors make no moves.
    pub competitors: bool,
    /// Whether expectations and budgets do not drift.
    pub drift: bool,
    /// Whether channel yields stay constant.
    pub yields: bool,
    /// Whether the PMI stays constant.
    pub economy: bool,
    /// Lead factor of demand surges for each day; empty if surges are not fixed.
    pub surges: Vec<f64>,
    /// Day-of-month factor for each day; empty if the calendar is not fixed.
    pub month_days: Vec<f64>,
    /// Usage and random draws of the service for each day; empty if the service is not fixed.
    pub service: Vec<FixedService>,
}

impl FixedInputs {
    /// Returns whether drift is suppressed on a day.
    pub fn fixes_drift(&self, day: u32) -> bool {
        self.drift && day >= self.from
    }

    /// Returns the fixed service inputs of a day, or `None` if the service is not fixed on that day.
    pub fn fixed_service_on(&self, day: u32) -> Option<FixedService> {
        self.value_on_day(day, &self.service)
    }

    /// Replaces the lead factors that are fixed on a day.
    pub fn apply_to_leads(&self, day: u32, weekday: f64, factors: &mut ByGroup<LeadFactors>) {
        let month_day = self.value_on_day(day, &self.month_days);
        for lead_factors in
            factors.0.iter_mut().filter(|lead_factors| **lead_factors != LeadFactors::default())
        {
            lead_factors.calendar = month_day.map_or(lead_factors.calendar, |factor| weekday * factor);
            lead_factors.surge = self.value_on_day(day, &self.surges).unwrap_or(lead_factors.surge);
        }
    }

    fn value_on_day<T: Copy>(&self, day: u32, list: &[T]) -> Option<T> {
        list.get(day.checked_sub(self.from)? as usize).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::day::observer::NoObserver;
    use crate::day::{step_day, step_day_observed};
    use std::collections::{BTreeMap, BTreeSet};

    use crate::events::{Arrival, DayFigures, Facts, SubscriptionStatus};
    use crate::identifiers::{Channel, Group};
    use crate::market::surges::Surge;
    use crate::params::Params;
    use crate::random::Streams;
    use crate::settings::PerGroup;
    use crate::state::World;
    use crate::test_kit::apply_policy_p;

    const LOAD_FACTOR: f64 = 1000.0;

    /// Returns the world of a company at the end of a day, with its parameters and streams.
    fn company_at_end_of_day(day_before: u32) -> (World, Params, Streams) {
        let (params, streams) = (Params::bundled(), Streams::new(9));
        let mut facts = Facts::default();
        let mut world = World::new(500, 1_000_000.0, &params, &mut facts);
        apply_policy_p(&mut world);
        world.settings.core.capacity_tier = 7;
        let ads = &mut world.settings.targeted_ads.targeted_spend;
        ads.insert(Channel::SearchAds, PerGroup::from([(Group::parse("S1").expect("a group"), 20_000.0)]));
        for _ in 0..day_before {
            step_day(&mut world, &params, &streams, &mut facts);
        }
        (world, params, streams)
    }

    fn next_day(day_before: &(World, Params, Streams), fixed_inputs: &FixedInputs) -> (World, DayFigures) {
        let (world, params, streams) = day_before;
        let mut world = world.clone();
        let figures =
            step_day_observed(&mut world, params, streams, fixed_inputs, &mut Facts::default(), &NoObserver)
                .0;
        (world, figures)
    }

    #[test]
    fn fixed_inputs_stay_constant_and_others_change() {
        let day_before = company_at_end_of_day(89);
        let fixed = |change: fn(&mut FixedInputs)| {
            let mut fixed_inputs = FixedInputs { from: 90, ..FixedInputs::default() };
            change(&mut fixed_inputs);
            next_day(&day_before, &fixed_inputs).0.market
        };
        let (before, free) = (&day_before.0.market, fixed(|_| {}));
        assert!(free.drift != before.drift && free.yields != before.yields);
        assert!(free.economy.pmi != before.economy.pmi);
        let drift = fixed(|inputs| inputs.drift = true);
        assert_eq!(drift.drift.c_max, before.drift.c_max);
        assert_eq!((&drift.yields, drift.economy.pmi), (&free.yields, free.economy.pmi));
        let yields = fixed(|fixed| fixed.yields = true);
        assert_eq!((&yields.yields, &yields.drift), (&before.yields, &free.drift));
        let economy = fixed(|fixed| fixed.economy = true);
        assert_eq!((economy.economy.pmi, &economy.yields), (before.economy.pmi, &free.yields));
    }

    #[test]
    fn fixed_competitors_cause_no_events() {
        let moves = |rivals: bool| {
            let mut day_before = company_at_end_of_day(89);
            let fixed_inputs = FixedInputs { from: 90, competitors: rivals, ..FixedInputs::default() };
            (0..60).for_each(|_| day_before.0 = next_day(&day_before, &fixed_inputs).0);
            day_before.0.market.competitors.len()
        };
        assert_eq!(
            (moves(true), moves(false) > 2),
            (company_at_end_of_day(89).0.market.competitors.len(), true)
        );
    }

    #[test]
    fn fixed_factors_replace_lead_factors() {
        let mut day_before = company_at_end_of_day(59);
        day_before.0.market.surges.push(Surge { day: 58, end_day: 70, multiplier: 4.0 });
        let leads = |fixed_inputs: FixedInputs| {
            next_day(&day_before, &FixedInputs { from: 60, ..fixed_inputs }).1.new_leads
        };
        let free = leads(FixedInputs::default());
        assert!(leads(FixedInputs { surges: vec![1.0], ..FixedInputs::default() }) * 2 < free);
        assert!(leads(FixedInputs { month_days: vec![0.25], ..FixedInputs::default() }) * 2 < free);
        // A list without a value for the day fixes nothing.
        assert_eq!(leads(FixedInputs { surges: Vec::new(), ..FixedInputs::default() }), free);
    }

    #[test]
    fn fixed_service_determines_overload_and_noise() {
        let day_before = company_at_end_of_day(59);
        let service = |load: f64, luck_of: u32| {
            let fixed_inputs = FixedInputs {
                from: 60,
                service: vec![FixedService { load_factor: load, draw_day: luck_of }],
                ..FixedInputs::default()
            };
            next_day(&day_before, &fixed_inputs).1
        };
        let free = next_day(&day_before, &FixedInputs::default()).1;
        assert_eq!(service(1.0, 60), free);
        assert!(service(LOAD_FACTOR, 60).overload > 0.0 && free.overload == 0.0);
        assert_ne!(service(1.0, 59).p95_ms, free.p95_ms);
        // The fixed service inputs do not change usage.
        assert_eq!(service(LOAD_FACTOR, 60).total_usage, free.total_usage);
    }

    /// The service does not affect a lead's decision, so a lead makes the same decision with and without overload.
    #[test]
    fn service_does_not_affect_lead_decisions() {
        let (world, params, streams) = company_at_end_of_day(59);
        let decisions = |load: f64| -> BTreeMap<(Group, u32), bool> {
            let fixed_inputs = FixedInputs {
                from: 60,
                service: vec![FixedService { load_factor: load, draw_day: 60 }],
                ..FixedInputs::default()
            };
            let mut facts = Facts::default();
            step_day_observed(&mut world.clone(), &params, &streams, &fixed_inputs, &mut facts, &NoObserver);
            let signed: BTreeSet<u32> = facts
                .openings
                .iter()
                .filter(|opening| opening.status == SubscriptionStatus::Subscribed)
                .map(|opening| opening.customer)
                .collect();
            let decided =
                |arrival: &Arrival| ((arrival.group, arrival.n), signed.contains(&arrival.customer));
            facts.arrivals.iter().map(decided).collect()
        };
        let (calm, strained) = (decisions(1.0), decisions(LOAD_FACTOR));
        let both: Vec<_> = calm.iter().filter(|(lead, _)| strained.contains_key(lead)).collect();
        assert!(both.len() > 20 && both.iter().any(|(_, signed)| **signed));
        assert!(both.into_iter().all(|(lead, signed)| strained[lead] == *signed));
    }
}
