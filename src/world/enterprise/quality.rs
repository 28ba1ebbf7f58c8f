//! Quality that enterprises perceive, in negotiations and in the daily evaluation
//! (`docs/mechanics/enterprise/quality.md`).

use super::NegotiationContext;
use crate::customers::columns::Subscriber;
use crate::customers::curve::Curve;
use crate::identifiers::{ByPlan, Group};
use crate::params::{EnterpriseQualityCap, ServicePenalty};
use crate::quality::{
    QualityTerms, delivered_quality, perceived_quality, quota_demand, quota_factor, relationship_as_read,
    relationship_bonus,
};

impl NegotiationContext<'_> {
    /// Returns the quality of each plan in a negotiation, before the first-impression factor of a lead. Uses today's
    /// product, and ignores tenure and weekday. Quotas count only if `active` is true: the enterprise is a subscriber.
    pub(super) fn negotiation_quality(&self, group: Group, row: &Subscriber, active: bool) -> ByPlan<f64> {
        let product = self.product.quality(group, self.day.params);
        let quality = &self.day.params.quality;
        let maximum = match self.day.params.fidelity.enterprise_quality_cap {
            EnterpriseQualityCap::One => quality.negotiation_quality_max,
            EnterpriseQualityCap::None => f64::INFINITY,
        };
        ByPlan::from_fn(|plan| {
            let demand = quota_demand(row.usage_rate, row.usage_rate, self.day.params);
            let quota =
                if active { quota_factor(self.day.morning.quotas[plan], demand, quality) } else { 1.0 };
            let delivered = delivered_quality(product, 0.0, 0.0, self.day.morning.multipliers[plan]);
            self.perceived_plan_quality(group, row, delivered, 0.0, quota)
                .clamp(quality.negotiation_quality_min, maximum)
        })
    }

    /// Returns the quality of each plan in the daily evaluation of a subscriber. Uses the product of this morning,
    /// tenure and weekday; the result is not bounded.
    pub(super) fn subscriber_quality(&self, group: Group, row: &Subscriber) -> ByPlan<f64> {
        let demand = quota_demand(row.usage_rate * self.day.morning.weekday, row.usage_rate, self.day.params);
        let tenure = self.day.tenure.bonus(self.day.day().saturating_sub(row.start_day));
        ByPlan::from_fn(|plan| {
            let quota = quota_factor(self.day.morning.quotas[plan], demand, &self.day.params.quality);
            self.perceived_plan_quality(group, row, self.day.morning.delivered(group, plan), tenure, quota)
        })
    }

    fn perceived_plan_quality(
        &self,
        group: Group,
        row: &Subscriber,
        delivered: f64,
        tenure: f64,
        quota: f64,
    ) -> f64 {
        let quality = &self.day.params.quality;
        let penalty = match self.day.params.fidelity.service_penalty {
            ServicePenalty::Satisfaction => 0.0,
            ServicePenalty::Everywhere => self.day.service_penalty,
        };
        let experience = QualityTerms {
            delivered: delivered - penalty,
            relationship: relationship_bonus(relationship_as_read(row.relationship, quality), quality),
            tenure,
            quota,
            issues: quality.issue_penalty_per_open_day * f64::from(row.open_issue_days),
            ads: row.ads_quality_sensitivity * self.day.ads.for_group(group),
        };
        perceived_quality(experience, self.day.params.fidelity.perceived_quality)
    }

    /// Returns the curve of an enterprise in a negotiation, including all market drift.
    pub(super) fn negotiation_curve(&self, group: Group, row: &Subscriber) -> Curve {
        let expectation = self.drift.expectation(group);
        let floor = self.day.params.quality.read_time_c_max_min;
        row_curve(row).with_drift(expectation.quality, expectation.c_max, floor)
    }

    /// Returns the curve of an enterprise in the daily evaluation, including the market drift up to this morning.
    pub(super) fn subscriber_curve(&self, group: Group, row: &Subscriber) -> Curve {
        let expectation = self.day.morning.expectations[group];
        let floor = self.day.params.quality.read_time_c_max_min;
        row_curve(row).with_drift(expectation.quality, expectation.c_max, floor)
    }
}

fn row_curve(row: &Subscriber) -> Curve {
    Curve {
        steepness_left: row.steepness_left,
        steepness_right: row.steepness_right,
        c_max: row.c_max,
        q_min: row.q_min,
        q_max: row.q_max,
    }
}

#[cfg(test)]
mod tests {
    use super::super::test_kit::NegotiationKit;
    use super::*;

    fn assert_near(actual: ByPlan<f64>, expected: [f64; 3]) {
        for (value, expected) in actual.iter().zip(expected) {
            assert!((value - expected).abs() < 1e-10, "got {actual:?}, expected {expected:?}");
        }
    }

    #[test]
    fn negotiation_quality_includes_relationship_issues_ads_and_quota() {
        let mut kit = NegotiationKit::new(91);
        kit.product.shared_bonus = 0.6;
        kit.product.group_bonus[kit.group] = 0.05;
        let quality = |kit: &NegotiationKit, change: &dyn Fn(&mut Subscriber), active: bool| {
            let mut row = kit.reference_row();
            change(&mut row);
            kit.with_negotiation(|day| day.negotiation_quality(kit.group, &row, active))
        };
        let waiting = |row: &mut Subscriber| (row.relationship, row.open_issue_days) = (0.4, 2);
        assert_near(quality(&kit, &waiting, false), [0.615, 0.700, 0.785]);
        assert_near(quality(&kit, &|_| {}, false), [0.765, 0.850, 0.935]);
        let worst = |row: &mut Subscriber| (row.relationship, row.open_issue_days) = (0.0, 2);
        assert_near(quality(&kit, &worst, false), [0.705, 0.790, 0.875]);
        assert_near(quality(&kit, &|row| row.relationship = 1.0, false), [1.0; 3]);
        kit.params.fidelity.enterprise_quality_cap = EnterpriseQualityCap::None;
        assert_near(quality(&kit, &|row| row.relationship = 1.0, false), [1.215, 1.3, 1.385]);
        let hopeless = |row: &mut Subscriber| (row.relationship, row.open_issue_days) = (0.4, 90);
        assert_near(quality(&kit, &hopeless, false), [-1.0; 3]);
        kit.params.fidelity.enterprise_quality_cap = EnterpriseQualityCap::One;
        kit.settings.ads_strength.global = 0.5;
        assert_near(quality(&kit, &|_| {}, false), [0.7057709848, 0.7907709848, 0.8757709848]);
        kit.settings.ads_strength.global = 0.0;
        kit.morning.quotas = ByPlan([3000.0, 4000.0, 10_000.0]);
        let using = |row: &mut Subscriber| (row.usage_rate, row.start_day) = (5000.0, 1);
        assert_near(quality(&kit, &using, true), [0.459, 0.680, 0.935]);
    }

    #[test]
    fn negotiation_quality_with_all_terms() {
        let mut kit = NegotiationKit::new(31);
        kit.product.shared_bonus = 0.15;
        kit.product.group_bonus[kit.group] = 0.05;
        kit.morning.multipliers = ByPlan([0.6, 0.9, 1.1]);
        kit.morning.quotas = ByPlan([60.0, 70.0, 1200.0]);
        kit.settings.ads_strength.global = 0.2;
        kit.settings.ads_strength.by_group.insert(kit.group, 0.1);
        let row = Subscriber {
            relationship: 0.7,
            open_issue_days: 3,
            usage_rate: 80.0,
            ads_quality_sensitivity: 0.12,
            ..kit.reference_row()
        };
        let qualities = kit.with_negotiation(|day| day.negotiation_quality(kit.group, &row, true));
        for (quality, expected) in qualities.iter().zip([0.156815793, 0.314315793, 0.461815793]) {
            assert!((quality - expected).abs() < 1e-9, "got {quality}, expected {expected}");
        }
    }
}
