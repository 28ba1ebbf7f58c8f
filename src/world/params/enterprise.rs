//! Parameters of enterprises: `configs/world/enterprise.toml`.

use super::check::parameters;

parameters! {
    /// Parameters of negotiations (`docs/mechanics/enterprise/README.md`).
    pub struct EnterpriseParams {
        /// Mean first asked price, as a share of the highest acceptable price.
        pub enterprise_initial_offer_factor_mean: f64,
        /// Standard deviation of the first asked price, as a share of the highest acceptable price.
        pub enterprise_initial_offer_factor_std: f64,
        /// Number of days after which an enterprise is lost if the player does not answer.
        pub agent_response_timeout_days: u32 where 1.0..=100_000.0,
        /// Maximum number of offerings per message.
        pub enterprise_max_offerings_per_turn: u32 where 1.0..=1_000.0,
        /// Length of a contract, days.
        pub contract_month_days: u32 where 1.0..=100_000.0,
        /// Shortest reply delay of an enterprise, days.
        pub reply_delay_min_days: u32 where 1.0..=100_000.0,
        /// Surplus that an offer must exceed to be accepted.
        pub accept_min_satisfaction_exclusive: f64,
        /// Share of the gap to the highest price that each turn closes, 0..=1.
        pub enterprise_negotiation_alpha: f64 where 0.0..=1.0,
        /// Maximum number of iterations in the search for the highest price.
        pub max_price_search_iterations: u32 where 1.0..=1_000.0,
        /// Decimals of the price in a counter-offer.
        pub counter_offer_decimals: u32 where 0.0..=12.0,
        /// Days within which the player can answer without a penalty.
        pub late_reply_free_days: u32 where 0.0..=100_000.0,
        /// Change in the relationship per additional day; negative.
        pub late_reply_relationship_delta_per_day: f64,
        /// Change in the relationship after a new deal.
        pub deal_relationship_delta: f64,
        /// Change in the relationship if an enterprise stops replying; negative.
        pub ghost_relationship_delta: f64,
        /// Change in the relationship if an enterprise stops replying in a renegotiation.
        pub renegotiation_ghost_relationship_delta: f64,
        /// Change in the relationship if the player did not answer before the deadline.
        pub timeout_relationship_delta: f64,
        /// Lower bound of a relationship.
        pub relationship_min: f64 where 0.0..=1.0,
        /// Upper bound of a relationship.
        pub relationship_max: f64 where 0.0..=1.0,
        /// Surplus at the agreed price below which an enterprise threatens to cancel.
        pub churn_trigger_satisfaction_below: f64,
        /// Relative gain in surplus above which an enterprise can request a different plan.
        pub plan_change_min_relative_improvement: f64,
        /// Daily probability that an enterprise requests a different plan.
        pub plan_change_probability: f64 where 0.0..=1.0,
        /// Minimum denominator of the relative gain in surplus.
        pub plan_change_improvement_denominator_min: f64 where POSITIVE..=1e6,
        /// Minimum issue age at which an open issue is the reason for a cancellation, days.
        pub extended_issue_days: u32 where 0.0..=100_000.0,
        /// Reference quality that decides whether quality is the reason for a cancellation.
        pub churn_reason_quality_reference: f64,
        /// Difference from the reference quality below which quality is the reason for a cancellation.
        pub churn_reason_quality_gap: f64,
        /// Shared quality of the plan below which quality is the reason for a cancellation after a timeout.
        pub timeout_quality_reason_threshold: f64,
    }
}
