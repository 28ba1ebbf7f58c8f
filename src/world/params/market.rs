//! Parameters of the market: `configs/world/market.toml`.

use super::check::parameters;

parameters! {
    /// Calendar factors of leads and usage.
    pub struct Calendar {
        /// Factors of leads and usage, indexed by day modulo 7.
        pub weekly: [f64; 7] where 0.0..=1e6,
        /// Factors of leads, indexed by day modulo 30.
        pub monthly: [f64; 30] where 0.0..=1e6,
    }

    /// Parameters of demand surges (docs/mechanics/market/surges.md).
    pub struct DemandSurge {
        /// Daily probability of a surge.
        pub probability: f64 where 0.0..=1.0,
        /// Shortest duration of a surge, in days.
        pub duration_days_low: u32 where 1.0..=10_000.0,
        /// One more than the longest duration of a surge, in days.
        pub duration_days_high_exclusive: u32 where 1.0..=10_001.0,
        /// Minimum factor by which a surge multiplies leads.
        pub multiplier_base: f64 where 0.0..=1e6,
        /// Upper limit of the uniform draw from 0 that is added to the minimum factor.
        pub multiplier_range: f64 where 0.0..=1e6,
    }

    /// Parameters of leads and channel yields (docs/mechanics/market/leads.md).
    pub struct Leads {
        /// Acquisition cost per lead in dollars, whether or not the lead signs up.
        pub lead_acquisition_cost: f64 where 0.0..=1e9,
        /// Amount in dollars to which channel yields refer: a yield is the number of leads that this amount brings.
        pub ad_spend_unit: f64 where POSITIVE..=1e12,
        /// Saturation factor of a market without subscribers.
        pub saturation_base: f64,
        /// Exponent of the subscribers' share of the market in the saturation factor.
        pub saturation_exponent: f64,
        /// Minimum saturation factor.
        pub saturation_floor: f64,
        /// Days per year, for the annual market growth.
        pub days_per_year: f64 where POSITIVE..=1e6,
        /// Standard deviation of a yield's monthly change, as a share of the yield.
        pub monthly_channel_noise_fraction: f64 where 0.0..=100.0,
        /// Minimum channel yield.
        pub monthly_channel_value_min: f64,
        /// Days between two changes in the channel yields.
        pub monthly_channel_noise_interval_days: u32 where 1.0..=100_000.0,
    }

    /// Parameters of reputation (docs/mechanics/market/reputation.md).
    pub struct Reputation {
        /// Reputation that each customer adds per day for each point of satisfaction.
        pub base_rep_per_customer: f64,
        /// Weight of negative satisfaction relative to positive satisfaction.
        pub negative_satisfaction_multiplier: f64,
        /// Minimum number of contributing subscribers that the formula of the daily change uses.
        pub min_group_size: u32,
        /// Minimum absolute daily change that is applied.
        pub daily_delta_min_abs: f64,
        /// Lower bound of reputation before the minimum is applied.
        pub reputation_clamp_min: f64 where 0.0..=1.0,
        /// Upper bound of reputation.
        pub reputation_clamp_max: f64 where 0.0..=1.0,
        /// Minimum reputation after a change.
        pub reputation_floor: f64 where 0.0..=1.0,
        /// Factor that applies to every spillover. The spillover to a group is the reputation change of the source
        /// group times this factor and the weight of the source group for the affected group.
        pub cross_group_spillover_factor: f64,
        /// Absolute change that spillover must exceed to be applied.
        pub cross_delta_min_abs: f64,
        /// Base reputation damage of a cancellation.
        pub reputation_quality_cancel_damage: f64,
        /// Offset that is added to a uniform draw to obtain the random factor of the damage.
        pub cancel_damage_noise_offset: f64,
        /// Coefficient of squared negative satisfaction in the factor of the reputation damage.
        pub cancel_negative_satisfaction_coef: f64,
        /// Minimum number of subscribers that the formula of the event damage uses.
        pub event_scale_min_group_size: u32,
    }

    /// Parameters of competitor events and their press coverage (docs/mechanics/market/competitors.md).
    pub struct Competitor {
        /// Whether competitor events are disabled.
        pub competitor_events_disabled: bool,
        /// Mean days between events in the second half of a run.
        pub competitor_event_mean_interval: f64 where POSITIVE..=1e9,
        /// Minimum days between competitor events.
        pub competitor_event_min_interval: f64 where 0.0..=1e9,
        /// Factor of the mean interval in the first half of a run.
        pub first_half_interval_multiplier: f64,
        /// Factor of the minimum interval in the first half of a run.
        pub first_half_min_interval_multiplier: f64,
        /// Number by which the total days are divided to obtain the end of the first half of a run.
        pub first_half_divisor: u32 where 1.0..=1e9,
        /// Mean of the logarithm of an event's gain in quality.
        pub competitor_event_boost_mu: f64,
        /// Standard deviation of the logarithm of an event's gain in quality.
        pub competitor_event_boost_sigma: f64 where 0.0..=100.0,
        /// Minimum gain in quality of an event before scaling.
        pub competitor_event_boost_min: f64 where 0.0..=1e6,
        /// Maximum gain in quality of an event before scaling.
        pub competitor_event_boost_max: f64 where 0.0..=1e6,
        /// Scale of events at the start of a run.
        pub competitor_event_magnitude_scale_min: f64 where 0.0..=1e6,
        /// Scale of events at the end of the ramp.
        pub competitor_event_magnitude_scale_max: f64 where 0.0..=1e6,
        /// Day on which the scale of events starts to rise.
        pub magnitude_ramp_start_day: u32,
        /// Earliest day on which the ramp can end.
        pub magnitude_ramp_end_day_min: u32,
        /// Number of days at the end of a run in which no events occur.
        pub competitor_event_late_cutoff_days: u32 where 0.0..=1e9,
        /// Minimum share of the shared quality bank that a competitor copies.
        pub competitor_feedback_u_min: f64 where 0.0..=1.0,
        /// Maximum share of the shared quality bank that a competitor copies.
        pub competitor_feedback_u_max: f64 where 0.0..=1.0,
        /// Minimum share of a group's targeted quality bank that a competitor copies.
        pub competitor_segment_drain_u_min: f64 where 0.0..=1.0,
        /// Maximum share of a group's targeted quality bank that a competitor copies.
        pub competitor_segment_drain_u_max: f64 where 0.0..=1.0,
        /// Lower bound of the shared quality bank and of each targeted quality bank.
        pub bank_min: f64,
        /// Number of days after an event during which the press writes about the event.
        pub competitor_event_post_days: u32 where 0.0..=10_000.0,
        /// Number of press posts per day about an event.
        pub competitor_event_posts_per_day: u32 where 0.0..=1_000.0,
        /// Minimum error factor of the gain that the press estimates.
        pub competitor_post_boost_noise_min: f64,
        /// Maximum error factor of the gain that the press estimates.
        pub competitor_post_boost_noise_max: f64,
        /// Upper bound of the gain of minor events.
        pub competitor_severity_minor_max: f64,
        /// Upper bound of the gain of moderate events.
        pub competitor_severity_moderate_max: f64,
        /// Upper bound of the gain of major events.
        pub competitor_severity_major_max: f64,
        /// Base views of a press post about a minor event.
        pub competitor_post_base_views_minor: u32 where 0.0..=1e9,
        /// Base views of a press post about a moderate event.
        pub competitor_post_base_views_moderate: u32 where 0.0..=1e9,
        /// Base views of a press post about a major event.
        pub competitor_post_base_views_major: u32 where 0.0..=1e9,
        /// Base views of a press post about a transformative event.
        pub competitor_post_base_views_transformative: u32 where 0.0..=1e9,
        /// Likes per view of a press post about a competitor.
        pub competitor_post_likes_ratio: f64,
        /// Shares per view of a press post about a competitor.
        pub competitor_post_shares_ratio: f64,
        /// Number of points of view for press posts about competitors.
        pub post_perspective_count: u32 where 1.0..=255.0,
        /// Names of competitors, one of which is drawn for each press post.
        pub competitor_names: Vec<String>,
    }

    /// Parameters of preference drift (docs/mechanics/market/drift.md).
    pub struct Drift {
        /// Day before which neither drift nor competitor events occur.
        pub drift_grace_period_days: u32 where 0.0..=1e9,
        /// Daily rise of the expectations of all groups.
        pub global_q_bias_drift: f64,
        /// Days between two applications of drift.
        pub interval_days: u32 where 1.0..=100_000.0,
        /// Days of drift that one application includes.
        pub days_per_application: u32 where 0.0..=100_000.0,
        /// Lower bound of a drifting budget, dollars per month.
        pub individual_c_max_min: f64,
        /// Upper bound of a drifting budget, dollars per month.
        pub individual_c_max_max: f64,
        /// Lower bound of the drifting lower steepness.
        pub individual_steepness_left_min: f64,
        /// Upper bound of the drifting lower steepness.
        pub individual_steepness_left_max: f64,
        /// Lower bound of the drifting number of seats.
        pub individual_seat_count_min: f64,
    }

    /// Parameters of the hidden PMI (docs/mechanics/market/economy.md).
    pub struct MacroEconomy {
        /// PMI on day 0.
        pub macro_pmi_initial: f64 where 0.0..=100_000.0,
        /// Mean of the PMI over the economic cycle.
        pub macro_pmi_long_run_mean: f64 where 0.0..=100_000.0,
        /// Amplitude of the economic cycle.
        pub macro_pmi_cycle_amplitude: f64 where 0.0..=100_000.0,
        /// Length of the economic cycle, in days.
        pub macro_pmi_cycle_period_days: u32 where 0.0..=100_000.0,
        /// Share of the gap between PMI and cycle that is closed per day.
        pub macro_pmi_mean_reversion_rate: f64 where 0.0..=100_000.0,
        /// Standard deviation of the PMI's daily step.
        pub macro_pmi_daily_volatility: f64 where 0.0..=100_000.0,
        /// Lower bound of the PMI.
        pub macro_pmi_floor: f64 where 0.0..=100_000.0,
        /// Upper bound of the PMI.
        pub macro_pmi_ceiling: f64 where 0.0..=100_000.0,
        /// Whether the phase of the cycle is drawn once per run.
        pub macro_pmi_random_phase: bool,
        /// Phase of the economic cycle in radians, if the phase is not drawn.
        pub macro_pmi_fixed_phase: f64 where 0.0..=100_000.0,
        /// Number of days whose PMI one reading averages.
        pub macro_pmi_update_interval_days: u32 where 1.0..=100_000.0,
        /// Publication lag of a reading, in days.
        pub macro_pmi_publication_delay_days: u32 where 0.0..=100_000.0,
        /// Decimals of a published reading.
        pub published_pmi_decimals: u32 where 0.0..=12.0,
        /// Neutral PMI, at which the economy has no effect.
        pub neutral_pmi: f64,
        /// PMI points per unit of sensitivity.
        pub pmi_scale: f64 where POSITIVE..=1e6,
        /// Macroeconomic multiplier at the neutral PMI.
        pub multiplier_neutral: f64,
        /// Minimum macroeconomic multiplier.
        pub multiplier_min: f64,
        /// Minimum reading of strong expansion.
        pub trend_strong_expansion_min: f64,
        /// Minimum reading of expansion.
        pub trend_expansion_min: f64,
        /// Minimum reading of a neutral economy.
        pub trend_neutral_min: f64,
        /// Minimum reading of contraction.
        pub trend_contraction_min: f64,
        /// Minimum reading of a peak. A peak is a reading that no longer rises.
        pub phase_peak_min_pmi: f64,
        /// Upper bound of a trough. A trough is a reading that does not fall.
        pub phase_trough_below_pmi: f64,
        /// Minimum days between two rounds of posts about the economy.
        pub macro_social_post_interval_min: u32 where 1.0..=100_000.0,
        /// Maximum days between two rounds of posts about the economy.
        pub macro_social_post_interval_max: u32 where 1.0..=100_000.0,
        /// Minimum number of posts per round.
        pub macro_social_post_count_min: u32 where 0.0..=1_000.0,
        /// Maximum number of posts per round.
        pub macro_social_post_count_max: u32 where 0.0..=1_000.0,
        /// Number of points of view for posts about the economy.
        pub post_perspective_count: u32 where 1.0..=255.0,
        /// Minimum number of views of a post about the economy.
        pub macro_post_views_base: f64,
        /// Likes per view of a post about the economy.
        pub macro_post_likes_ratio: f64,
        /// Shares per view of a post about the economy.
        pub macro_post_shares_ratio: f64,
    }
}

impl Calendar {
    /// Returns the calendar factor of the leads on a day.
    pub fn lead_factor(&self, day: u32) -> f64 {
        self.weekly[(day % 7) as usize] * self.monthly[(day % 30) as usize]
    }
}
