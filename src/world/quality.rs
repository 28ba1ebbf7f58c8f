//! Delivered and perceived quality, one function per term (`docs/mechanics/product/quality.md`).

use serde::Serialize;

use crate::fault::Fault;
use crate::params::{Ads, Params, PerceivedQuality, Quality, UsageQuota};

/// Returns the delivered quality of a plan for a group: (base + shared + group bonus) times the model's multiplier.
#[inline]
pub fn delivered_quality(base: f64, shared_bonus: f64, group_bonus: f64, multiplier: f64) -> f64 {
    (base + shared_bonus + group_bonus) * multiplier
}

/// Returns the share of a demand that a quota covers, 0..=1, or 1 if there is no demand.
#[inline]
pub fn quota_factor(quota: f64, demand: f64, quality: &Quality) -> f64 {
    // The division is unconditional, because the compiler can vectorize only code without branches.
    let covered = (quota.max(0.0) / demand).clamp(quality.quota_factor_min, quality.quota_factor_max);
    if demand <= 0.0 { 1.0 } else { covered }
}

/// Returns today's quality loss from overload and outages: 0.08 o + 0.20 outage (0 or 1).
#[inline]
pub fn service_penalty(overload: f64, outage: bool, quality: &Quality) -> f64 {
    quality.service_overload_weight * overload + if outage { quality.service_outage_weight } else { 0.0 }
}

/// Returns the quality bonus of a relationship. A relationship below the neutral point has a negative bonus.
#[inline]
pub fn relationship_bonus(relationship: f64, quality: &Quality) -> f64 {
    quality.relationship_quality_bonus_max
        * (relationship - quality.relationship_neutral_point)
        * quality.relationship_scale
}

/// Returns the relationship that most mechanisms use: exactly 0 counts as neutral
/// (`docs/mechanics/product/quality.md#relationship-0`).
#[inline]
pub fn relationship_as_read(relationship: f64, quality: &Quality) -> f64 {
    if relationship == 0.0 { quality.fallback_relationship } else { relationship }
}

/// Returns the tenure bonus: 0.05 ln(1 + days / 30), which is 0 on the first day.
pub fn tenure_bonus(days_subscribed: u32, params: &Params) -> f64 {
    let Quality { stickiness_log_scale, stickiness_days_scale, .. } = params.quality;
    let scale = if params.has_fault(Fault::TenureInDays) { 1.0 } else { stickiness_days_scale };
    stickiness_log_scale * libm::log(1.0 + f64::from(days_subscribed) / scale)
}

/// Precomputed tenure bonuses by days since the start of the subscription. Computing the logarithm for every
/// subscriber would dominate the time that a simulated day takes.
#[derive(Debug, Clone, Default)]
pub struct TenureTable(Vec<f64>);

impl TenureTable {
    /// Computes the bonuses for 0..=days days.
    pub fn up_to(days: u32, params: &Params) -> TenureTable {
        TenureTable((0..=days).map(|day| tenure_bonus(day, params)).collect())
    }

    /// Returns the tenure bonus after `days_subscribed` days.
    #[inline]
    pub fn bonus(&self, days_subscribed: u32) -> f64 {
        self.0[days_subscribed as usize]
    }
}

/// Returns the effective strength of in-app advertising, 0..=1: ln(1 + 9 a) / ln 10, where a is the summed strength
/// clamped to 0..=1.
pub fn ads_effect(summed_strength: f64, ads: &Ads) -> f64 {
    let strength = summed_strength.clamp(ads.strength_min, ads.strength_max);
    libm::log(1.0 + ads.log_curve_k * strength) / libm::log(1.0 + ads.log_curve_k)
}

/// The terms from which a customer's perceived quality is computed.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct QualityTerms {
    /// Delivered quality, less the service penalty if it applies.
    pub delivered: f64,
    /// Quality bonus from the relationship, negative below the neutral point.
    pub relationship: f64,
    /// Quality bonus that grows with the number of days as a subscriber.
    pub tenure: f64,
    /// Quota factor, 0..=1, by which quality terms are multiplied.
    pub quota: f64,
    /// Quality loss from the open issue: issue age times penalty per day.
    pub issues: f64,
    /// Quality loss from ads: sensitivity times effective strength.
    pub ads: f64,
}

/// Returns the perceived quality. The released simulator computes (delivered + relationship + tenure) quota - issues -
/// ads. In the paper, all terms are multiplied by the quota factor.
#[inline]
pub fn perceived_quality(experience: QualityTerms, form: PerceivedQuality) -> f64 {
    let QualityTerms { delivered, relationship, tenure, quota, issues, ads } = experience;
    match form {
        PerceivedQuality::Release => (delivered + relationship + tenure) * quota - issues - ads,
        PerceivedQuality::Paper => (delivered + relationship + tenure - issues - ads) * quota,
    }
}

/// Returns the demand that is compared with a quota, in units per day or per billing period.
#[inline]
pub fn quota_demand(daily_demand_today: f64, daily_rate: f64, params: &Params) -> f64 {
    let period_demand = daily_rate * f64::from(params.billing.billing_period_days);
    match params.fidelity.usage_quota {
        UsageQuota::Daily => daily_demand_today,
        UsageQuota::Period => period_demand,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_near(actual: f64, expected: f64) {
        assert!((actual - expected).abs() < 1e-9, "got {actual}, expected {expected}");
    }

    #[test]
    fn quota_factor_and_ads_effect_match_check_values() {
        let params = Params::bundled();
        for (quota, demand, factor) in [
            (0.0, 0.0, 1.0),
            (0.0, 10.0, 0.0),
            (50.0, 80.0, 0.625),
            (60.0, 92.0, 0.652173913),
            (100.0, 80.0, 1.0),
        ] {
            assert_near(quota_factor(quota, demand, &params.quality), factor);
        }
        assert_near(quota_factor(-3.0, 5.0, &params.quality), 0.0);
        for (strength, effect) in [
            (0.05, 0.161368002),
            (0.1, 0.278753601),
            (0.2, 0.447158031),
            (0.25, 0.511883361),
            (0.5, 0.740362689),
            (0.75, 0.889301703),
            (0.3 + 0.2 + 0.4, 0.9590413923),
            (1.0, 1.0),
            (1.7, 1.0),
        ] {
            assert_near(ads_effect(strength, &params.ads), effect);
        }
    }

    #[test]
    fn relationship_of_zero_is_read_as_neutral() {
        let quality = Params::bundled().quality;
        assert_near(relationship_bonus(relationship_as_read(0.0, &quality), &quality), 0.0);
        assert_near(relationship_bonus(0.0, &quality), -0.45);
        assert_near(relationship_bonus(1.0, &quality), 0.45);
    }

    #[test]
    fn tenure_bonus_starts_on_the_second_day() {
        let params = Params::bundled();
        let table = TenureTable::up_to(60, &params);
        assert_near(table.bonus(0), 0.0);
        assert_near(table.bonus(30), 0.05 * std::f64::consts::LN_2);
        assert_near(table.bonus(60), tenure_bonus(60, &params));
    }

    #[test]
    fn paper_form_multiplies_all_terms_by_the_quota_factor() {
        let experience = QualityTerms {
            delivered: 0.5,
            relationship: 0.1,
            tenure: 0.05,
            quota: 0.5,
            issues: 0.06,
            ads: 0.04,
        };
        assert_near(perceived_quality(experience, PerceivedQuality::Release), 0.325 - 0.1);
        assert_near(perceived_quality(experience, PerceivedQuality::Paper), 0.275);
    }
}
