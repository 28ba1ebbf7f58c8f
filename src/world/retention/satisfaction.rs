//! Daily satisfaction of every active subscriber (`docs/mechanics/retention/satisfaction.md`).

use std::ops::Range;

use crate::context::DayContext;
use crate::customers::columns::Block;
use crate::fault::Fault;
use crate::identifiers::{ByGroup, ByPlan, Group};
use crate::params::{Params, Quality};
use crate::quality::{
    QualityTerms, perceived_quality, quota_demand, quota_factor, relationship_as_read, relationship_bonus,
    service_penalty,
};
use crate::reputation::{ReputationContribution, contribution};

/// Returns the moving average of satisfaction: (1 - alpha) old + alpha instant.
#[inline]
pub fn smoothed_satisfaction(old: f64, instant: f64, alpha: f64) -> f64 {
    (1.0 - alpha) * old + alpha * instant
}

/// Adds up the contributions of each group's blocks, in block order.
pub fn sum_by_group(by_block: Vec<(Group, ReputationContribution)>) -> ByGroup<ReputationContribution> {
    let mut contributions = ByGroup::<ReputationContribution>::default();
    for (group, contribution) in by_block {
        contributions[group] += contribution;
    }
    contributions
}

/// The terms of the daily satisfaction update of one subscriber.
#[derive(Debug, Clone, Copy)]
pub struct SatisfactionTerms {
    /// Terms of the subscriber's perceived quality.
    pub experience: QualityTerms,
    /// Quality loss from today's service, which the delivered quality already includes.
    pub service_penalty: f64,
    /// Quality that the subscriber perceives today, computed from `experience`.
    pub perceived: f64,
    /// Required quality at the subscriber's price, without the market's expectations.
    pub required: f64,
    /// Quality that the market's expectations add to the required quality.
    pub expectation: f64,
    /// Today's satisfaction: perceived quality less required quality and expectations.
    pub instant: f64,
    /// Satisfaction before the update.
    pub before: f64,
    /// Satisfaction after the update.
    pub after: f64,
}

/// Computes the satisfaction update of one subscriber without applying it. Must be called before [`update_block`].
pub fn satisfaction_terms(group: Group, block: &Block, at: usize, day: &DayContext<'_>) -> SatisfactionTerms {
    let &DayContext { morning, service, ads, tenure, params, .. } = day;
    let quality = &params.quality;
    let penalty = service_penalty(service.overload, service.outage, quality);
    let plan = block.plan[at];
    let subscriber_inputs = SubscriberInputs {
        usage_rate: block.usage_rate[at],
        relationship: block.relationship[at],
        open_issue_days: block.open_issue_days[at],
        ads_sensitivity: block.ads_quality_sensitivity[at],
    };
    let day_inputs = DayInputs {
        delivered: morning.delivered(group, plan) - penalty,
        quota: match params.has_fault(Fault::QuotaInverted) {
            true => inverted_quota(morning.quotas[plan], subscriber_inputs.usage_rate * morning.weekday),
            false => morning.quotas[plan],
        },
        tenure: tenure.bonus(morning.day - block.start_day[at]),
        ads: ads.for_customer(group, block.customer[at]),
    };
    let experience = build_experience(subscriber_inputs, day_inputs, morning.weekday, quality, params);
    let perceived = perceived_quality(experience, params.fidelity.perceived_quality);
    let (required, expectation) = (block.required[at], morning.expectations[group].quality);
    let (before, instant) = (block.satisfaction[at], perceived - (required + expectation));
    let after = smoothed_satisfaction(before, instant, params.satisfaction.satisfaction_ema_alpha);
    SatisfactionTerms {
        experience,
        service_penalty: penalty,
        perceived,
        required,
        expectation,
        instant,
        before,
        after,
    }
}

struct SubscriberInputs {
    usage_rate: f64,
    relationship: f64,
    open_issue_days: u32,
    ads_sensitivity: f64,
}

struct DayInputs {
    delivered: f64,
    quota: f64,
    tenure: f64,
    ads: f64,
}

// Always inlined, because the compiler vectorizes the loop over rows only if this function is part of the loop.
#[inline(always)]
fn build_experience(
    subscriber_inputs: SubscriberInputs,
    day_inputs: DayInputs,
    weekday: f64,
    quality: &Quality,
    params: &Params,
) -> QualityTerms {
    let demand = quota_demand(subscriber_inputs.usage_rate * weekday, subscriber_inputs.usage_rate, params);
    QualityTerms {
        delivered: day_inputs.delivered,
        relationship: relationship_bonus(
            relationship_as_read(subscriber_inputs.relationship, quality),
            quality,
        ),
        tenure: day_inputs.tenure,
        quota: quota_factor(day_inputs.quota, demand, quality),
        issues: quality.issue_penalty_per_open_day * f64::from(subscriber_inputs.open_issue_days),
        ads: subscriber_inputs.ads_sensitivity * day_inputs.ads,
    }
}

/// Returns a quota q for which q / demand equals demand / `quota`.
fn inverted_quota(quota: f64, daily_demand: f64) -> f64 {
    daily_demand * daily_demand / quota
}

/// Number of rows per batch, small enough for the looked-up values to stay in cache.
const ROWS_PER_BATCH: usize = 64;

/// Values that have to be looked up for each row.
struct RowInputs {
    delivered: [f64; ROWS_PER_BATCH],
    quota: [f64; ROWS_PER_BATCH],
    tenure: [f64; ROWS_PER_BATCH],
    ads: [f64; ROWS_PER_BATCH],
}

impl RowInputs {
    fn zeroed() -> RowInputs {
        RowInputs {
            delivered: [0.0; ROWS_PER_BATCH],
            quota: [0.0; ROWS_PER_BATCH],
            tenure: [0.0; ROWS_PER_BATCH],
            ads: [0.0; ROWS_PER_BATCH],
        }
    }

    #[inline]
    fn load_block(
        &mut self,
        group: Group,
        block: &Block,
        rows: Range<usize>,
        delivered: &ByPlan<f64>,
        day: &DayContext<'_>,
    ) {
        let &DayContext { morning, ads, tenure, .. } = day;
        let (plan, start_day) = (&block.plan[rows.clone()], &block.start_day[rows.clone()]);
        let customer = &block.customer[rows.clone()];
        for at in 0..plan.len().min(ROWS_PER_BATCH) {
            self.delivered[at] = delivered[plan[at]];
            self.quota[at] = morning.quotas[plan[at]];
            self.tenure[at] = tenure.bonus(morning.day - start_day[at]);
            self.ads[at] = ads.for_customer(group, customer[at]);
        }
        if day.params.has_fault(Fault::QuotaInverted) {
            let demands = block.usage_rate[rows].iter().map(|rate| rate * morning.weekday);
            self.quota
                .iter_mut()
                .zip(demands)
                .for_each(|(quota, demand)| *quota = inverted_quota(*quota, demand));
        }
    }
}

/// Updates the satisfaction of all rows of a block and returns their contributions to the reputation in the group.
///
/// Rows are processed in batches. Lookups, calculation and summation are separate loops over local copies, so
/// that the compiler can vectorize the calculation.
pub fn update_block(group: Group, block: &mut Block, day: &DayContext<'_>) -> ReputationContribution {
    let &DayContext { morning, service, params, .. } = day;
    let (quality, reputation) = (&params.quality.clone(), &params.reputation.clone());
    let penalty = service_penalty(service.overload, service.outage, quality);
    let delivered = ByPlan::from_fn(|plan| morning.delivered(group, plan) - penalty);
    let (weekday, expectation) = (morning.weekday, morning.expectations[group].quality);
    let form = params.fidelity.perceived_quality;
    let alpha = params.satisfaction.satisfaction_ema_alpha;
    let (mut found, mut moved) = (RowInputs::zeroed(), [0.0; ROWS_PER_BATCH]);
    let (mut sum, count) = (0.0, block.len());
    for first in (0..count).step_by(ROWS_PER_BATCH) {
        let rows = (count - first).min(ROWS_PER_BATCH);
        let range = first..first + rows;
        found.load_block(group, block, range.clone(), &delivered, day);
        let rate = &block.usage_rate[range.clone()];
        let (relationship, required) = (&block.relationship[range.clone()], &block.required[range.clone()]);
        let open_days = &block.open_issue_days[range.clone()];
        let sensitivity = &block.ads_quality_sensitivity[range.clone()];
        let satisfaction = &mut block.satisfaction[range];
        for at in 0..rows {
            let subscriber_inputs = SubscriberInputs {
                usage_rate: rate[at],
                relationship: relationship[at],
                open_issue_days: open_days[at],
                ads_sensitivity: sensitivity[at],
            };
            let day_inputs = DayInputs {
                delivered: found.delivered[at],
                quota: found.quota[at],
                tenure: found.tenure[at],
                ads: found.ads[at],
            };
            let perceived = perceived_quality(
                build_experience(subscriber_inputs, day_inputs, weekday, quality, params),
                form,
            );
            let instant = perceived - (required[at] + expectation);
            moved[at] = smoothed_satisfaction(satisfaction[at], instant, alpha);
        }
        satisfaction.copy_from_slice(&moved[..rows]);
        for satisfaction in &moved[..rows] {
            sum += contribution(*satisfaction, reputation);
        }
    }
    ReputationContribution { sum, count: count as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::context::tests::with_day_context;
    use crate::customers::columns::Subscriber;
    use crate::events::ServiceDay;
    use crate::identifiers::Plan;
    use crate::morning::Morning;
    use crate::morning::tests::morning;
    use crate::params::DriftCounted;
    use crate::random::Streams;
    use crate::retention::{refresh_required, remembered_budget};
    use crate::settings::Settings;
    use crate::settings::{AdsStrength, PerCustomer, PerGroup};
    use crate::test_kit::subscriber;

    fn group() -> Group {
        Group::at(0).expect("S1")
    }

    fn next_satisfaction(row: Subscriber, day: &Morning, service: ServiceDay, setting: &AdsStrength) -> f64 {
        let params = Params::bundled();
        let mut block = Block::default();
        block.push(row);
        refresh_required(&mut block, 0, day.expectations[group()].c_max, &params);
        let settings = Settings { ads_strength: setting.clone(), ..Settings::initial(&params) };
        with_day_context(day, &settings, &service, (&params, &Streams::new(1)), |day| {
            update_block(group(), &mut block, day)
        });
        block.satisfaction[0]
    }

    #[test]
    fn each_service_problem_lowers_satisfaction() {
        let mut day = morning(31);
        day.product[group()] = 0.2 + 0.15 + 0.05;
        day.multipliers[Plan::B] = 0.9;
        day.quotas[Plan::B] = 70.0;
        let row = Subscriber {
            plan: Plan::B,
            effective_price: 18.0,
            effective_c_max: 48.0,
            relationship: 0.7,
            open_issue_days: 3,
            satisfaction: 0.2,
            customer: 9,
            ..subscriber(1)
        };
        let service = ServiceDay { overload: 0.5, outage: true, ..ServiceDay::without_load() };
        let setting = AdsStrength {
            global: 0.2,
            by_group: PerGroup::from([(group(), 0.1)]),
            by_customer: PerCustomer::from([(9, 0.4)]),
        };
        let moved = next_satisfaction(row, &day, service, &setting);
        assert!((moved - 0.158865172).abs() < 1e-9, "{moved}");
    }

    #[test]
    fn satisfaction_does_not_depend_on_other_rows() {
        let (params, day, service) = (Params::bundled(), morning(190), ServiceDay::without_load());
        let setting = AdsStrength { by_customer: PerCustomer::from([(70, 0.4)]), ..AdsStrength::default() };
        let settings = Settings { ads_strength: setting, ..Settings::initial(&params) };
        let streams = Streams::new(1);
        let update = |block: &mut Block| {
            with_day_context(&day, &settings, &service, (&params, &streams), |day| {
                update_block(group(), block, day)
            })
        };
        let row = |n: u32| Subscriber {
            plan: Plan::ALL[n as usize % 3],
            usage_rate: f64::from(n % 5) * 30.0,
            start_day: n,
            relationship: f64::from(n % 4) / 3.0,
            open_issue_days: n % 7,
            satisfaction: f64::from(n % 9) / 4.0 - 1.0,
            required: 0.001 * f64::from(n),
            ..subscriber(n)
        };
        for count in [1, 63, 64, 65, 150] {
            let mut together = Block::default();
            (1..=count).for_each(|n| together.push(row(n)));
            let before = together.clone();
            let contribution = update(&mut together);
            let mut contributions = ReputationContribution::default();
            for n in 1..=count {
                let mut alone = Block::default();
                alone.push(row(n));
                contributions += update(&mut alone);
                assert_eq!(together.row(n as usize - 1), alone.row(0), "row {n} of {count}");
            }
            assert_eq!(contribution, contributions, "{count} rows");
            with_day_context(&day, &settings, &service, (&params, &streams), |day| {
                for (at, after) in together.satisfaction.iter().enumerate() {
                    assert_eq!(
                        satisfaction_terms(group(), &before, at, day).after.to_bits(),
                        after.to_bits()
                    );
                }
            });
        }
    }

    #[test]
    fn drift_is_counted_twice_after_billing() {
        let params = Params::bundled();
        let mut day = morning(100);
        day.multipliers[Plan::A] = 1.0;
        day.quotas[Plan::A] = 1000.0;
        day.product[group()] = 0.2;
        day.expectations[group()].quality = 0.08;
        day.expectations[group()].c_max = 2.0;
        let mut row = Subscriber {
            effective_price: 20.0,
            effective_c_max: 50.0,
            start_day: 70,
            satisfaction: 0.0,
            ..subscriber(1)
        };
        let service = ServiceDay::without_load();
        let moved = next_satisfaction(row, &day, service, &AdsStrength::default());
        assert!((moved - -0.0133028107).abs() < 1e-9, "{moved}");
        row.effective_c_max = remembered_budget(row.c_max, 2.0, &params);
        assert_eq!(row.effective_c_max, 52.0);
        let instant = next_satisfaction(row, &day, service, &AdsStrength::default()) / 0.1;
        assert!((instant - -0.127399581).abs() < 1e-8, "{instant}");
        // If drift is counted once, a bill stores the customer's budget without drift, so satisfaction does not change.
        let mut once = params;
        once.fidelity.drift_counted = DriftCounted::Once;
        row.effective_c_max = remembered_budget(row.c_max, 2.0, &once);
        assert_eq!(row.effective_c_max, 50.0);
        let unchanged = next_satisfaction(row, &day, service, &AdsStrength::default());
        assert_eq!(unchanged.to_bits(), moved.to_bits());
        // Release 2 has no minimum budget, so the budget of a poor customer is stored unchanged.
        assert_eq!(remembered_budget(12.0, 2.0, &once), 15.0);
        once.billing.billing_c_max_min = 0.0;
        assert_eq!(remembered_budget(12.0, 2.0, &once), 12.0);
    }
}
