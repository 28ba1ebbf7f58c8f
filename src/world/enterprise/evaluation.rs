//! How an enterprise responds to offerings: it accepts the best offering, makes a counter-offer, or ends the thread
//! without a reply.

use crate::customers::curve::{Curve, required_quality};
use crate::events::Offering;
use crate::identifiers::ByPlan;
use crate::params::Params;
use novamind_base::formatting::round_to;

/// The response of an enterprise to offerings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OfferResponse {
    /// The enterprise accepts the offering at this position.
    Accept(usize),
    /// The enterprise asks for this price, in dollars per seat per month, for the plan of the offering at this
    /// position.
    Counter(usize, f64),
    /// The enterprise never replies again.
    Silence,
}

/// Values that an enterprise uses to evaluate offerings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OfferEvaluator {
    /// Curve of the enterprise, including all market drift.
    pub curve: Curve,
    /// Perceived quality of each plan.
    pub quality: ByPlan<f64>,
    /// First asked price as a share of the highest acceptable price.
    pub initial_offer_factor: f64,
    /// Maximum number of turns that the enterprise accepts.
    pub max_turns: u32,
}

/// Returns the quality less the quality that is required at the price.
pub fn surplus(quality: f64, price: f64, curve: &Curve, params: &Params) -> f64 {
    quality - required_quality(price, curve, params)
}

/// Returns the highest price at which the quality is sufficient, by bisection of 0..=c_max. Returns 0 if the quality
/// is not sufficient at any price.
pub fn highest_price(quality: f64, curve: &Curve, params: &Params) -> f64 {
    if quality < required_quality(0.0, curve, params) {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, curve.c_max);
    for _ in 0..params.enterprise.max_price_search_iterations {
        let middle = (low + high) / 2.0;
        if required_quality(middle, curve, params) <= quality {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Returns the price of a counter-offer after this many turns, rounded to cents. The price starts at the first asked
/// price and closes a share of the gap to the highest price with each turn.
pub fn counter_price(highest: f64, initial_offer_factor: f64, turns: u32, params: &Params) -> f64 {
    let sales = &params.enterprise;
    let mut bid = initial_offer_factor * highest;
    for _ in 0..turns {
        bid += sales.enterprise_negotiation_alpha * (highest - bid);
    }
    round_to(bid, sales.counter_offer_decimals)
}

impl OfferEvaluator {
    /// Returns the response of the enterprise to offerings. `turn` is the number of the thread's last turn.
    pub fn respond(&self, offerings: &[Offering], turn: u32, params: &Params) -> OfferResponse {
        if turn >= self.max_turns {
            return OfferResponse::Silence;
        }
        let affordable =
            |offering: &Offering| !params.fidelity.deal_price_ceiling || offering.price <= self.curve.c_max;
        let best = self.best_offering(offerings, affordable, params);
        if let Some((at, surplus)) = best
            && surplus > params.enterprise.accept_min_satisfaction_exclusive
        {
            return OfferResponse::Accept(at);
        }
        let Some((at, _)) = best.or_else(|| self.best_offering(offerings, |_| true, params)) else {
            return OfferResponse::Silence;
        };
        let highest = highest_price(self.quality[offerings[at].plan], &self.curve, params);
        let price = counter_price(highest, self.initial_offer_factor, turn, params);
        if price > 0.0 { OfferResponse::Counter(at, price) } else { OfferResponse::Silence }
    }

    /// Returns the position and the surplus of the best suitable offering, or of the first best offering on a tie.
    fn best_offering(
        &self,
        offerings: &[Offering],
        fits: impl Fn(&Offering) -> bool,
        params: &Params,
    ) -> Option<(usize, f64)> {
        let mut best: Option<(usize, f64)> = None;
        for (at, offering) in offerings.iter().enumerate().filter(|(_, offering)| fits(offering)) {
            let surplus = surplus(self.quality[offering.plan], offering.price, &self.curve, params);
            if best.is_none_or(|(_, most)| surplus > most) {
                best = Some((at, surplus));
            }
        }
        best
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::identifiers::Plan;

    /// Participation curve of the reference enterprise K of `docs/mechanics/enterprise/evaluation.md#check-values`.
    pub(in crate::enterprise) const K: Curve =
        Curve { steepness_left: 1.0, steepness_right: 2.0, c_max: 60.0, q_min: 0.5, q_max: 0.95 };

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 1e-9, "got {actual}, expected {expected}");
    }

    fn offerings(list: &[(Plan, f64)]) -> Vec<Offering> {
        list.iter().map(|&(plan, price)| Offering { plan, price }).collect()
    }

    fn evaluator(a: f64, b: f64, c: f64) -> OfferEvaluator {
        OfferEvaluator { curve: K, quality: ByPlan([a, b, c]), initial_offer_factor: 0.75, max_turns: 6 }
    }

    #[test]
    fn required_quality_matches_the_reference_enterprise() {
        let params = Params::bundled();
        for (price, required) in [
            (0.0, 0.5170680905),
            (15.0, 0.6125),
            (29.999999, 0.7079319069),
            (30.0, 0.7265058915),
            (45.0, 0.8375),
            (60.0, 0.9484941085),
            (60.01, 0.95),
            (1e6, 0.95),
            (-10.0, 0.5034351096),
        ] {
            assert!((required_quality(price, &K, &params) - required).abs() < 1e-10, "price {price}");
        }
    }

    #[test]
    fn highest_price_matches_the_required_quality() {
        let params = Params::bundled();
        for (quality, highest) in [
            (0.517, 0.0),
            (0.52, 1.0363337665),
            (0.6, 13.6611386921),
            (0.7, 27.4766492501),
            (0.75, 38.7616753750),
            (0.8, 42.9205584583),
            (0.94, 54.2041588054),
            (1.0, 60.0),
        ] {
            assert_near(highest_price(quality, &K, &params), highest);
        }
        let below_the_jump = highest_price(0.725, &K, &params);
        assert!(below_the_jump < 30.0 && below_the_jump > 29.9999);
    }

    #[test]
    fn counter_price_approaches_the_highest_price() {
        let params = Params::bundled();
        let highest = highest_price(0.8, &K, &params);
        let bids: Vec<f64> = (0..8).map(|turns| counter_price(highest, 0.75, turns, &params)).collect();
        assert_eq!(bids, [32.19, 35.41, 37.66, 39.24, 40.34, 41.12, 41.66, 42.04]);
        let highest = highest_price(0.7, &K, &params);
        let bids = [1, 2, 3, 5].map(|turns| counter_price(highest, 0.6, turns, &params));
        assert_eq!(bids, [19.78, 22.09, 23.71, 25.63]);
    }

    #[test]
    fn best_offering_is_accepted_before_the_last_turn() {
        let params = Params::bundled();
        let offer_evaluator = evaluator(0.72, 0.80, 0.88);
        let three = offerings(&[(Plan::A, 30.0), (Plan::B, 35.0), (Plan::C, 50.0)]);
        assert_eq!(offer_evaluator.respond(&three, 1, &params), OfferResponse::Accept(1));
        assert_near(surplus(0.80, 35.0, &K, &params), 0.067249831);
        for (price, missing) in [(44.0, -0.018921704), (50.0, -0.114254451)] {
            assert_eq!(
                offer_evaluator.respond(&offerings(&[(Plan::B, price)]), 1, &params),
                OfferResponse::Counter(0, 35.41)
            );
            assert_near(surplus(0.80, price, &K, &params), missing);
        }
        let gift = offerings(&[(Plan::B, 1.0)]);
        assert_eq!(offer_evaluator.respond(&gift, 6, &params), OfferResponse::Silence);
        assert_near(surplus(0.80, 1.0, &K, &params), 0.280110073);
        assert_eq!(offer_evaluator.respond(&gift, 5, &params), OfferResponse::Accept(0));
        assert_eq!(
            offer_evaluator.respond(&offerings(&[(Plan::B, 35.0), (Plan::B, 35.0)]), 1, &params),
            OfferResponse::Accept(0)
        );
        assert_eq!(
            offer_evaluator.respond(&offerings(&[(Plan::B, -5.0)]), 1, &params),
            OfferResponse::Accept(0)
        );
        assert_eq!(offer_evaluator.respond(&[], 1, &params), OfferResponse::Silence);
    }

    #[test]
    fn quality_beyond_all_requirements_accepts_any_price() {
        let params = Params::bundled();
        let expensive = offerings(&[(Plan::B, 100_000.0)]);
        assert_eq!(evaluator(0.9, 0.96, 1.0).respond(&expensive, 1, &params), OfferResponse::Accept(0));
        assert_near(surplus(0.96, 100_000.0, &K, &params), 0.01);
        assert_eq!(
            evaluator(0.9, 0.95, 1.0).respond(&expensive, 1, &params),
            OfferResponse::Counter(0, 49.50)
        );
        let weak = evaluator(0.5, 0.6, 0.7);
        assert_eq!(weak.respond(&offerings(&[(Plan::A, 1.0)]), 1, &params), OfferResponse::Silence);
        assert_near(surplus(0.5, 1.0, &K, &params), -0.019889927);
    }

    #[test]
    fn first_impression_changes_the_counter_price() {
        let params = Params::bundled();
        for (noise, price) in [(0.8, 14.85), (0.9, 24.75), (1.0, 35.41), (1.1, 39.09)] {
            let offer_evaluator = evaluator(0.0, 0.8 * noise, 0.0);
            assert_eq!(
                offer_evaluator.respond(&offerings(&[(Plan::B, 59.0)]), 1, &params),
                OfferResponse::Counter(0, price)
            );
        }
    }

    #[test]
    fn price_ceiling_rejects_prices_above_the_budget() {
        let mut params = Params::bundled();
        params.fidelity.deal_price_ceiling = true;
        let offer_evaluator = evaluator(0.9, 0.96, 1.1);
        // The expensive offering has the largest surplus, but the enterprise accepts the affordable offering.
        let mixed = offerings(&[(Plan::C, 61.0), (Plan::B, 58.0)]);
        assert_eq!(offer_evaluator.respond(&mixed, 1, &params), OfferResponse::Accept(1));
        // If no offering is affordable, the offering with the largest surplus determines the plan of the counter-offer.
        let expensive = offerings(&[(Plan::B, 61.0), (Plan::C, 70.0)]);
        let OfferResponse::Counter(1, price) = offer_evaluator.respond(&expensive, 1, &params) else {
            panic!("a counter-offer")
        };
        assert_near(price, counter_price(60.0, 0.75, 1, &params));
        params.fidelity.deal_price_ceiling = false;
        assert_eq!(offer_evaluator.respond(&expensive, 1, &params), OfferResponse::Accept(1));
    }
}
