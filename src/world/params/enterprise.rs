//! Companies: `configs/world/enterprise.toml`.

use super::check::parameters;

parameters! {
    /// Negotiations (`docs/mechanics/enterprise/README.md`).
    pub struct EnterpriseParams {
        /// Mean first bid as a share of the most a company would pay.
        pub enterprise_initial_offer_factor_mean: f64,
        /// Its spread.
        pub enterprise_initial_offer_factor_std: f64,
        /// Days without an answer that lose a lead or a customer.
        pub agent_response_timeout_days: u32 where 1.0..=100_000.0,
        /// Offerings of a message that count.
        pub enterprise_max_offerings_per_turn: u32 where 1.0..=1_000.0,
        /// Days of the one month that every contract lasts.
        pub contract_month_days: u32 where 1.0..=100_000.0,
        /// Shortest reply delay, days.
        pub reply_delay_min_days: u32 where 1.0..=100_000.0,
        /// Surplus of quality above which an offer is taken.
        pub accept_min_satisfaction_exclusive: f64,
        /// Share of the gap to the highest price that each turn closes, 0..=1.
        pub enterprise_negotiation_alpha: f64 where 0.0..=1.0,
        /// Halvings in the search for the highest price.
        pub max_price_search_iterations: u32 where 1.0..=1_000.0,
        /// Decimals of a counter-offer.
        pub counter_offer_decimals: u32 where 0.0..=12.0,
        /// Days that an answer may take for nothing.
        pub late_reply_free_days: u32 where 0.0..=100_000.0,
        /// Relationship added per further day; negative.
        pub late_reply_relationship_delta_per_day: f64,
        /// Relationship added by a new deal.
        pub deal_relationship_delta: f64,
        /// Relationship added when a customer falls silent; negative.
        pub ghost_relationship_delta: f64,
        /// The same in a renegotiation.
        pub renegotiation_ghost_relationship_delta: f64,
        /// The same when a customer got no answer.
        pub timeout_relationship_delta: f64,
        /// Lower bound of a relationship.
        pub relationship_min: f64 where 0.0..=1.0,
        /// Upper bound of a relationship.
        pub relationship_max: f64 where 0.0..=1.0,
        /// Surplus at the price paid below which a customer threatens to leave.
        pub churn_trigger_satisfaction_below: f64,
        /// Relative gain in surplus above which a customer may ask for another plan.
        pub plan_change_min_relative_improvement: f64,
        /// Chance a day that it asks then.
        pub plan_change_probability: f64 where 0.0..=1.0,
        /// Least present surplus that the gain is compared with.
        pub plan_change_improvement_denominator_min: f64 where POSITIVE..=1e6,
        /// Age of an open issue that is to blame for a departure, days.
        pub extended_issue_days: u32 where 0.0..=100_000.0,
        /// Quality that a departing customer compares with.
        pub churn_reason_quality_reference: f64,
        /// Difference to it below which quality is to blame.
        pub churn_reason_quality_gap: f64,
        /// Shared quality of the plan below which it is to blame when nobody answered.
        pub timeout_quality_reason_threshold: f64,
    }
}
