//! Parameters of the market: `configs/world/market.toml`.

use super::check::parameters;

parameters! {
    /// Calendar factors.
    pub struct Calendar {
        /// Factor of leads and usage by day mod 7.
        pub weekly: [f64; 7] where 0.0..=1e6,
        /// Factor of leads by day mod 30.
        pub monthly: [f64; 30] where 0.0..=1e6,
    }

    /// Demand surges (docs/mechanics/market/surges.md).
    pub struct DemandSurge {
        /// Daily probability of a surge.
        pub probability: f64 where 0.0..=1.0,
        /// Shortest surge, in days.
        pub duration_days_low: u32 where 1.0..=10_000.0,
        /// One above the longest surge, in days.
        pub duration_days_high_exclusive: u32 where 1.0..=10_001.0,
        /// Minimum factor on leads.
        pub multiplier_base: f64 where 0.0..=1e6,
        /// Width of the uniform part of the factor.
        pub multiplier_range: f64 where 0.0..=1e6,
    }

    /// Leads and channel yields (docs/mechanics/market/leads.md).
    pub struct Leads {
        /// Dollars per lead, whether or not it signs up.
        pub lead_acquisition_cost: f64 where 0.0..=1e9,
        /// Channel yields are leads per this many dollars.
        pub ad_spend_unit: f64 where POSITIVE..=1e12,
        /// Factor of an empty market.
        pub saturation_base: f64,
        /// Exponent of the share of the market that is taken.
        pub saturation_exponent: f64,
        /// Minimum saturation factor.
        pub saturation_floor: f64,
        /// Days of a year of market growth.
        pub days_per_year: f64 where POSITIVE..=1e6,
        /// Standard deviation of the monthly change of a yield, as a share of it.
        pub monthly_channel_noise_fraction: f64 where 0.0..=100.0,
        /// Minimum yield.
        pub monthly_channel_value_min: f64,
        /// Days between two changes.
        pub monthly_channel_noise_interval_days: u32 where 1.0..=100_000.0,
    }

    /// Reputation (docs/mechanics/market/reputation.md).
    pub struct Reputation {
        /// Reputation a day per customer and point of satisfaction.
        pub base_rep_per_customer: f64,
        /// Weight of negative satisfaction.
        pub negative_satisfaction_multiplier: f64,
        /// Minimum group size in the calculation.
        pub min_group_size: u32,
        /// Smaller changes are dropped.
        pub daily_delta_min_abs: f64,
        /// Lower clamp.
        pub reputation_clamp_min: f64 where 0.0..=1.0,
        /// Upper clamp.
        pub reputation_clamp_max: f64 where 0.0..=1.0,
        /// Minimum reputation after a write.
        pub reputation_floor: f64 where 0.0..=1.0,
        /// Share of a change that reaches other groups, times their weight.
        pub cross_group_spillover_factor: f64,
        /// Smaller spill-overs are dropped.
        pub cross_delta_min_abs: f64,
        /// Base damage of a cancellation.
        pub reputation_quality_cancel_damage: f64,
        /// The damage varies by (this + U).
        pub cancel_damage_noise_offset: f64,
        /// Growth of the damage with squared negative satisfaction.
        pub cancel_negative_satisfaction_coef: f64,
        /// Minimum group size in the calculation of event damage.
        pub event_scale_min_group_size: u32,
    }

    /// Competitor events and their press coverage (docs/mechanics/market/competitors.md).
    pub struct Competitor {
        /// Whether competitor events are disabled.
        pub competitor_events_disabled: bool,
        /// Mean days between events in the second half of a run.
        pub competitor_event_mean_interval: f64 where POSITIVE..=1e9,
        /// Minimum days between events.
        pub competitor_event_min_interval: f64 where 0.0..=1e9,
        /// Factor on the mean interval in the first half.
        pub first_half_interval_multiplier: f64,
        /// Factor on the minimum interval in the first half.
        pub first_half_min_interval_multiplier: f64,
        /// The first half ends at total days divided by this.
        pub first_half_divisor: u32 where 1.0..=1e9,
        /// Mean of the logarithm of the size.
        pub competitor_event_boost_mu: f64,
        /// Standard deviation of the logarithm of the size.
        pub competitor_event_boost_sigma: f64 where 0.0..=100.0,
        /// Minimum size before scaling.
        pub competitor_event_boost_min: f64 where 0.0..=1e6,
        /// Maximum size before scaling.
        pub competitor_event_boost_max: f64 where 0.0..=1e6,
        /// Scale of sizes at the start of a run.
        pub competitor_event_magnitude_scale_min: f64 where 0.0..=1e6,
        /// Scale of sizes at the end of the ramp.
        pub competitor_event_magnitude_scale_max: f64 where 0.0..=1e6,
        /// Day on which the ramp starts.
        pub magnitude_ramp_start_day: u32,
        /// Earliest day on which it may end.
        pub magnitude_ramp_end_day_min: u32,
        /// No events in the last days of a run.
        pub competitor_event_late_cutoff_days: u32 where 0.0..=1e9,
        /// Minimum share of the shared bank that a competitor copies.
        pub competitor_feedback_u_min: f64 where 0.0..=1.0,
        /// Maximum share.
        pub competitor_feedback_u_max: f64 where 0.0..=1.0,
        /// Minimum share copied of a group's targeted development.
        pub competitor_segment_drain_u_min: f64 where 0.0..=1.0,
        /// Maximum share.
        pub competitor_segment_drain_u_max: f64 where 0.0..=1.0,
        /// Minimum of both banks.
        pub bank_min: f64,
        /// Days after an event on which the press writes about it.
        pub competitor_event_post_days: u32 where 0.0..=10_000.0,
        /// Press posts a day.
        pub competitor_event_posts_per_day: u32 where 0.0..=1_000.0,
        /// Minimum error of the press about the size, as a factor.
        pub competitor_post_boost_noise_min: f64,
        /// Maximum error.
        pub competitor_post_boost_noise_max: f64,
        /// Upper edge of minor events.
        pub competitor_severity_minor_max: f64,
        /// Upper edge of moderate events.
        pub competitor_severity_moderate_max: f64,
        /// Upper edge of major events.
        pub competitor_severity_major_max: f64,
        /// Base views of a press post on a minor event.
        pub competitor_post_base_views_minor: u32 where 0.0..=1e9,
        /// On a moderate one.
        pub competitor_post_base_views_moderate: u32 where 0.0..=1e9,
        /// On a major one.
        pub competitor_post_base_views_major: u32 where 0.0..=1e9,
        /// On a transformative one.
        pub competitor_post_base_views_transformative: u32 where 0.0..=1e9,
        /// Likes per view.
        pub competitor_post_likes_ratio: f64,
        /// Shares per view.
        pub competitor_post_shares_ratio: f64,
        /// Number of points of view for such posts.
        pub post_perspective_count: u32 where 1.0..=255.0,
        /// Names of the competitors.
        pub competitor_names: Vec<String>,
    }

    /// Preference drift (docs/mechanics/market/drift.md).
    pub struct Drift {
        /// Neither drift nor competitors before this day.
        pub drift_grace_period_days: u32 where 0.0..=1e9,
        /// Rise of everyone's expectations a day.
        pub global_q_bias_drift: f64,
        /// Days between two applications of drift.
        pub interval_days: u32 where 1.0..=100_000.0,
        /// Days of drift per application.
        pub days_per_application: u32 where 0.0..=100_000.0,
        /// Lower bound of a drifting budget, dollars a month.
        pub individual_c_max_min: f64,
        /// Upper bound.
        pub individual_c_max_max: f64,
        /// Lower bound of a drifting steepness.
        pub individual_steepness_left_min: f64,
        /// Upper bound.
        pub individual_steepness_left_max: f64,
        /// Lower bound of drifting seats.
        pub individual_seat_count_min: f64,
    }

    /// The hidden index of the economy (docs/mechanics/market/economy.md).
    pub struct MacroEconomy {
        /// Index on day 0.
        pub macro_pmi_initial: f64 where 0.0..=100_000.0,
        /// Center of the cycle.
        pub macro_pmi_long_run_mean: f64 where 0.0..=100_000.0,
        /// Amplitude of the cycle.
        pub macro_pmi_cycle_amplitude: f64 where 0.0..=100_000.0,
        /// Length of the cycle, in days.
        pub macro_pmi_cycle_period_days: u32 where 0.0..=100_000.0,
        /// Share of the gap to the cycle closed a day.
        pub macro_pmi_mean_reversion_rate: f64 where 0.0..=100_000.0,
        /// Standard deviation of the daily step.
        pub macro_pmi_daily_volatility: f64 where 0.0..=100_000.0,
        /// Lower clamp of the index.
        pub macro_pmi_floor: f64 where 0.0..=100_000.0,
        /// Upper clamp of the index.
        pub macro_pmi_ceiling: f64 where 0.0..=100_000.0,
        /// Whether the phase is drawn once per run.
        pub macro_pmi_random_phase: bool,
        /// Phase otherwise, in radians.
        pub macro_pmi_fixed_phase: f64 where 0.0..=100_000.0,
        /// Days that one reading averages.
        pub macro_pmi_update_interval_days: u32 where 1.0..=100_000.0,
        /// Days until a reading is published.
        pub macro_pmi_publication_delay_days: u32 where 0.0..=100_000.0,
        /// Decimals of a published reading.
        pub published_pmi_decimals: u32 where 0.0..=12.0,
        /// Neutral index.
        pub neutral_pmi: f64,
        /// Points of the index per unit of sensitivity.
        pub pmi_scale: f64 where POSITIVE..=1e6,
        /// Factor at the neutral index.
        pub multiplier_neutral: f64,
        /// Minimum factor.
        pub multiplier_min: f64,
        /// Minimum reading of strong expansion.
        pub trend_strong_expansion_min: f64,
        /// Minimum reading of expansion.
        pub trend_expansion_min: f64,
        /// Minimum reading of a neutral economy.
        pub trend_neutral_min: f64,
        /// Minimum reading of contraction.
        pub trend_contraction_min: f64,
        /// Minimum reading of a peak, if it no longer rises.
        pub phase_peak_min_pmi: f64,
        /// Readings below it are a trough unless they fall.
        pub phase_trough_below_pmi: f64,
        /// Minimum days between two rounds of posts about the economy.
        pub macro_social_post_interval_min: u32 where 1.0..=100_000.0,
        /// Maximum days.
        pub macro_social_post_interval_max: u32 where 1.0..=100_000.0,
        /// Minimum posts of a round.
        pub macro_social_post_count_min: u32 where 0.0..=1_000.0,
        /// Maximum posts of a round.
        pub macro_social_post_count_max: u32 where 0.0..=1_000.0,
        /// Number of points of view for such posts.
        pub post_perspective_count: u32 where 1.0..=255.0,
        /// Minimum views of such a post.
        pub macro_post_views_base: f64,
        /// Likes per view.
        pub macro_post_likes_ratio: f64,
        /// Shares per view.
        pub macro_post_shares_ratio: f64,
    }
}

impl Calendar {
    /// Returns the factor of the leads of a day.
    pub fn lead_factor(&self, day: u32) -> f64 {
        self.weekly[(day % 7) as usize] * self.monthly[(day % 30) as usize]
    }
}
