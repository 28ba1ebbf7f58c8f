//! Acquisition costs: advertising and the cost of leads.

use super::assumptions::BoundAssumptions;
use novamind_session::best_starting_channel;
use novamind_world::identifiers::Group;
use novamind_world::market::leads::market_cap;
use novamind_world::params::Params;

/// Number of steps of the numerical integration over market saturation.
const INTEGRATION_STEPS: u32 = 20_000;

/// Returns the cost, in dollars, of filling the group's market by the first renewal with ads in the group's best
/// channel.
pub fn advertising_cost(group: Group, premises: &BoundAssumptions, params: &Params) -> f64 {
    let group_params = params.group(group);
    let first = premises.renewals.first().copied().unwrap_or(premises.days);
    let market =
        market_cap(group_params.base_market_cap, group_params.annual_cap_growth_rate, first, &params.leads);
    let channel = best_starting_channel(group, params);
    let each = params.starting_yields()[channel][group] / params.leads.ad_spend_unit;
    let leads = each * params.initial.initial_reputation * mean_calendar_factor(first, params);
    group_params.base_market_cap * saturation_factor(group_params.base_market_cap / market, params) / leads
}

/// Returns the mean cost per customer until a share `taken` of the market is reached, relative to the cost of
/// the first customer. The cost increases as the market fills.
fn saturation_factor(taken: f64, params: &Params) -> f64 {
    let leads = &params.leads;
    let cost = |step: u32| {
        let share = taken * (f64::from(step) + 0.5) / f64::from(INTEGRATION_STEPS);
        let left = leads.saturation_base - libm::pow(share, leads.saturation_exponent);
        1.0 / left.max(leads.saturation_floor)
    };
    (0..INTEGRATION_STEPS).map(cost).sum::<f64>() / f64::from(INTEGRATION_STEPS)
}

/// Returns the mean calendar factor of leads over days 1 to `last`.
fn mean_calendar_factor(last: u32, params: &Params) -> f64 {
    (1..=last).map(|day| params.calendar.lead_factor(day)).sum::<f64>() / f64::from(last.max(1))
}

/// Returns the number of customers (individuals and enterprises) to acquire.
pub fn acquired_customer_count(params: &Params) -> f64 {
    Group::all().map(|group| params.group(group).base_market_cap).sum()
}

/// Returns the total cost of leads, dollars.
pub fn lead_costs(params: &Params) -> f64 {
    acquired_customer_count(params) * params.leads.lead_acquisition_cost
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advertising_cost_includes_yield_reputation_and_saturation() {
        let (premises, params) = (BoundAssumptions::from_paper(3.0), Params::bundled());
        let s1 = Group::parse("S1").expect("a group");
        let taken = 1.0 / (1.0 + 0.2 * 30.0 / 365.0);
        // The integral of 1 / (1 - x^2) from 0 to a share is the inverse hyperbolic tangent of the share.
        let expected =
            272_000.0 / 0.3203613 / 0.5 / mean_calendar_factor(30, &params) * libm::atanh(taken) / taken;
        let value = advertising_cost(s1, &premises, &params);
        assert!((value / expected - 1.0).abs() < 1e-6, "{value} {expected}");
        assert_eq!(acquired_customer_count(&params), 1_208_492.0);
        assert_eq!(lead_costs(&params), 604_246.0);
    }
}
