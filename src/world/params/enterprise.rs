//! Parameters of enterprises: `configs/world/enterprise.toml`.

use super::check::parameters;

parameters! {
    /// Negotiations (`docs/mechanics/enterprise/README.md`).
    pub struct EnterpriseParams {
        /// Mean first bid as a share of the highest acceptable price.
        pub enterprise_initial_offer_factor_mean: f64,
        /// Its standard deviation.
        pub enterprise_initial_offer_factor_std: f64,
        /// Days without an answer after which a lead or customer is lost.
        pub agent_response_timeout_days: u32 where 1.0..=100_000.0,
        /// Maximum offerings per message.
        pub enterprise_max_offerings_per_turn: u32 where 1.0..=1_000.0,
        /// Length of a contract, days.
        pub contract_month_days: u32 where 1.0..=100_000.0,
        /// Shortest reply delay, days.
        pub reply_delay_min_days: u32 where 1.0..=100_000.0,
        /// Surplus of quality above which an offer is accepted.
        pub accept_min_satisfaction_exclusive: f64,
        /// Share of the gap to the highest price that each turn closes, 0..=1.
        pub enterprise_negotiation_alpha: f64 where 0.0..=1.0,
        /// Iterations of the search for the highest price.
        pub max_price_search_iterations: u32 where 1.0..=1_000.0,
        /// Decimals of a counter-offer.
        pub counter_offer_decimals: u32 where 0.0..=12.0,
        /// Days that an answer may take without penalty.
        pub late_reply_free_days: u32 where 0.0..=100_000.0,
        /// Change of the relationship per further day; negative.
        pub late_reply_relationship_delta_per_day: f64,
        /// Change of the relationship by a new deal.
        pub deal_relationship_delta: f64,
        /// Change of the relationship if a customer falls silent; negative.
        pub ghost_relationship_delta: f64,
        /// The same in a renegotiation.
        pub renegotiation_ghost_relationship_delta: f64,
        /// The same if the player did not answer.
        pub timeout_relationship_delta: f64,
        /// Lower bound of a relationship.
        pub relationship_min: f64 where 0.0..=1.0,
        /// Upper bound of a relationship.
        pub relationship_max: f64 where 0.0..=1.0,
        /// Surplus at the agreed price below which a customer threatens to leave.
        pub churn_trigger_satisfaction_below: f64,
        /// Relative gain in surplus above which a customer may request another plan.
        pub plan_change_min_relative_improvement: f64,
        /// Daily probability of that request.
        pub plan_change_probability: f64 where 0.0..=1.0,
        /// Minimum of the current surplus as the denominator of the gain.
        pub plan_change_improvement_denominator_min: f64 where POSITIVE..=1e6,
        /// Age from which an open issue is the reason for a departure, days.
        pub extended_issue_days: u32 where 0.0..=100_000.0,
        /// Reference quality for the reason of a departure.
        pub churn_reason_quality_reference: f64,
        /// Difference from it below which quality is the reason.
        pub churn_reason_quality_gap: f64,
        /// Shared quality of the plan below which quality is the reason after a timeout.
        pub timeout_quality_reason_threshold: f64,
    }
}
