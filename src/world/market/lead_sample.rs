//! A sample of a group's leads and their choices, computed by the same functions as the simulation
//! (docs/mechanics/customers/curve-explorer.md).

use super::arrivals::{LeadEvaluation, curve_and_demand_with};
use crate::customers::choice::{PlanOffer, passes_quality_gate};
use crate::customers::curve::{Curve, required_quality};
use crate::customers::drift::Expectation;
use crate::customers::traits::draw_traits_from_stream;
use crate::identifiers::{ByPlan, Group};
use crate::params::Params;
use crate::random::{Part, Stream, Streams, Word};

/// A sampled lead: its curve, the demand that is compared with quotas, and its error in judging quality.
#[derive(Debug, Clone, Copy)]
struct SampledLead {
    curve: Curve,
    demand: f64,
    misjudgement: Word,
}

/// A sample of leads of one group, drawn like real leads.
#[derive(Debug, Clone)]
pub struct LeadSample {
    group: Group,
    leads: Vec<SampledLead>,
}

/// The choices that the leads of a sample make among offers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeadChoices {
    /// Number of leads in the sample, at least 1.
    pub leads: u32,
    /// Number of individuals who sign up, by plan. Enterprises that request an offer are counted under plan A.
    pub choices_by_plan: ByPlan<u32>,
    /// Sum of the first bills, in dollars. 0 for enterprises, which negotiate their price.
    pub first_bills: f64,
}

impl LeadChoices {
    /// Returns the share of leads that sign up, or of enterprises that request an offer, 0..=1.
    pub fn conversion(&self) -> f64 {
        f64::from(self.choices_by_plan.0.iter().sum::<u32>()) / f64::from(self.leads)
    }

    /// Returns the mean first bill per lead, in dollars.
    pub fn revenue_per_lead(&self) -> f64 {
        self.first_bills / f64::from(self.leads)
    }
}

impl LeadSample {
    /// Draws the first customers of a group from `streams`, with curves that include the market's drift.
    pub fn draw(
        group: Group,
        count: u32,
        expectation: Expectation,
        params: &Params,
        streams: &Streams,
    ) -> LeadSample {
        let keys: Vec<[u64; 2]> = (1..=count.max(1)).map(|n| [group.index() as u64, u64::from(n)]).collect();
        let traits = streams.keys(Part::Traits, &keys);
        let noises = streams.first_words(Part::LeadNoise, &keys);
        let lead = |(key, misjudgement)| {
            // The deal velocity (1.0) does not affect the traits that a lead's choice uses.
            let traits = draw_traits_from_stream(Stream::from_key(key), group, 1.0, params);
            let (curve, demand) = curve_and_demand_with(expectation, &traits, params);
            SampledLead { curve, demand, misjudgement }
        };
        LeadSample { group, leads: traits.into_iter().zip(noises).map(lead).collect() }
    }

    /// Returns the choices of the leads among `offers`. `promotion` is the discount for leads. `ongoing` is the
    /// discount for subscribers of each plan, which lowers the first bill but does not affect the choice. Both
    /// discounts are in dollars per month.
    pub fn choose(
        &self,
        offers: &ByPlan<PlanOffer>,
        promotion: f64,
        ongoing: &ByPlan<f64>,
        params: &Params,
    ) -> LeadChoices {
        let mut choices =
            LeadChoices { leads: self.leads.len() as u32, choices_by_plan: ByPlan([0; 3]), first_bills: 0.0 };
        for lead in &self.leads {
            if self.group.is_enterprise() {
                let asks = passes_quality_gate(offers, lead.demand, &lead.curve, params);
                choices.choices_by_plan.0[0] += u32::from(asks);
                continue;
            }
            let curve_and_demand = (lead.curve, lead.demand);
            let evaluation =
                LeadEvaluation::new(offers, promotion, curve_and_demand, lead.misjudgement, params);
            if evaluation.is_accepted(params) {
                let plan = evaluation.choice.plan;
                let bill = offers[plan].price - evaluation.discount - ongoing[plan];
                choices.choices_by_plan[plan] += 1;
                choices.first_bills += bill.max(params.billing.effective_price_min);
            }
        }
        choices
    }

    /// Returns for each share (0..=1) the quality that is sufficient for this share of the leads at a price. The
    /// required quality of leads whose budget is below the price is infinite.
    pub fn required_quality_quantiles(&self, price: f64, shares: &[f64], params: &Params) -> Vec<f64> {
        let required = |lead: &SampledLead| match price > lead.curve.c_max {
            true => f64::INFINITY,
            false => required_quality(price, &lead.curve, params),
        };
        let mut all: Vec<f64> = self.leads.iter().map(required).collect();
        all.sort_by(f64::total_cmp);
        let last = all.len() - 1;
        shares.iter().map(|share| all[((share * last as f64).round() as usize).min(last)]).collect()
    }

    /// Returns a quantile of the leads' budgets, dollars per month. `share` of the leads have at most this budget.
    pub fn budget_quantile(&self, share: f64) -> f64 {
        let mut budgets: Vec<f64> = self.leads.iter().map(|lead| lead.curve.c_max).collect();
        budgets.sort_by(f64::total_cmp);
        let last = budgets.len() - 1;
        budgets[((share * last as f64).round() as usize).min(last)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::customers::traits::draw_traits;

    const SAMPLE: u32 = 2000;

    fn group(id: &str) -> Group {
        Group::parse(id).expect("a group")
    }

    fn sample(id: &str) -> LeadSample {
        LeadSample::draw(group(id), SAMPLE, Expectation::default(), &Params::bundled(), &Streams::new(1))
    }

    fn same_offers(price: f64, quality: f64) -> ByPlan<PlanOffer> {
        ByPlan([PlanOffer { price, quality, quota: 1e6 }; 3])
    }

    /// The expected conversions are from the first week in the simulator, with the same price for all plans
    /// (configs/lessons/price-follows-quality.toml).
    #[test]
    fn conversions_match_the_simulator_within_two_points() {
        let (params, s1) = (Params::bundled(), sample("S1"));
        for (price, simulated) in [
            (12.0, [0.37, 0.83, 0.96]),
            (20.0, [0.18, 0.69, 0.80]),
            (30.0, [0.06, 0.51, 0.69]),
            (40.0, [0.02, 0.35, 0.56]),
        ] {
            for (quality, conversion) in [0.2, 0.4, 0.6].into_iter().zip(simulated) {
                let lead_choices = s1.choose(&same_offers(price, quality), 0.0, &ByPlan([0.0; 3]), &params);
                let off = lead_choices.conversion() - conversion;
                assert!(
                    off.abs() <= 0.02,
                    "${price} at {quality}: {} and {conversion}",
                    lead_choices.conversion()
                );
            }
        }
    }

    #[test]
    fn sample_matches_the_first_customers() {
        let (params, streams) = (Params::bundled(), Streams::new(1));
        let s1 = sample("S1");
        assert_eq!(s1.leads.len(), 2000);
        for n in [1, 9, 2000] {
            let traits = draw_traits(group("S1"), n, 0.3, &params, &streams);
            assert_eq!(s1.leads[n as usize - 1].curve, traits.curve);
        }
    }

    #[test]
    fn quantiles_split_the_sample_and_budgets_limit_prices() {
        let (params, s1) = (Params::bundled(), sample("S1"));
        let [low, median, high]: [f64; 3] =
            s1.required_quality_quantiles(14.0, &[0.1, 0.5, 0.9], &params).try_into().expect("three shares");
        assert!(low < median && median < high && high < 1.0, "{low} {median} {high}");
        let asked = s1
            .leads
            .iter()
            .filter(|sampled_lead| required_quality(14.0, &sampled_lead.curve, &params) <= median);
        assert_eq!(asked.count(), 1001);
        assert_eq!(
            s1.required_quality_quantiles(s1.budget_quantile(0.5) + 0.01, &[0.5], &params),
            [f64::INFINITY]
        );
    }

    #[test]
    fn lead_promotions_raise_conversion_but_ongoing_promotions_do_not() {
        let (params, s1, none) = (Params::bundled(), sample("S1"), ByPlan([0.0; 3]));
        let list = s1.choose(&same_offers(20.0, 0.4), 0.0, &none, &params);
        let promoted = s1.choose(&same_offers(20.0, 0.4), 8.0, &none, &params);
        let ongoing = s1.choose(&same_offers(20.0, 0.4), 0.0, &ByPlan([8.0; 3]), &params);
        assert!(promoted.choices_by_plan.0[0] > list.choices_by_plan.0[0]);
        assert_eq!(ongoing.choices_by_plan, list.choices_by_plan);
        assert!((ongoing.revenue_per_lead() / list.revenue_per_lead() - 0.6).abs() < 1e-12);
        let same = s1.choose(&same_offers(12.0, 0.4), 0.0, &none, &params);
        assert_eq!(promoted, same, "a list price of 20 minus 8 is a price of 12");
    }

    #[test]
    fn enterprises_request_an_offer_at_any_price() {
        let (params, e1, none) = (Params::bundled(), sample("E1"), ByPlan([0.0; 3]));
        let cheap = e1.choose(&same_offers(1.0, 0.55), 0.0, &none, &params);
        let dear = e1.choose(&same_offers(900.0, 0.55), 0.0, &none, &params);
        assert_eq!(cheap, dear);
        assert!(cheap.conversion() > 0.2 && cheap.conversion() < 0.9, "{}", cheap.conversion());
        assert_eq!(cheap.first_bills, 0.0);
    }
}
