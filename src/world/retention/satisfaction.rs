//! Daily satisfaction of every active subscriber (chapter 20 §15, step 13).

use std::ops::AddAssign;

use crate::world::customers::columns::Block;
use crate::world::day::Morning;
use crate::world::events::ServiceDay;
use crate::world::identifiers::{ByGroup, ByPlan, Group};
use crate::world::market::reputation::contribution;
use crate::world::params::Params;
use crate::world::product::ads::AdLoad;
use crate::world::product::quality::{
    Experience, TenureTable, perceived_quality, quota_demand, quota_factor, relationship_as_read,
    relationship_bonus, service_penalty,
};

/// Moving average: (1 - alpha) old + alpha instant.
#[inline]
pub fn moved_satisfaction(old: f64, instant: f64, alpha: f64) -> f64 {
    (1.0 - alpha) * old + alpha * instant
}

/// What some subscribers contribute to the reputation of their group today.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mood {
    /// Sum of the contributions of chapter 30 §2.2.
    pub sum: f64,
    /// How many contributed.
    pub count: u32,
}

impl AddAssign for Mood {
    fn add_assign(&mut self, other: Mood) {
        self.sum += other.sum;
        self.count += other.count;
    }
}

/// Adds up what the blocks of each group contribute, in their order.
pub fn by_group(by_block: Vec<(Group, Mood)>) -> ByGroup<Mood> {
    let mut moods = ByGroup::<Mood>::default();
    for (group, mood) in by_block {
        moods[group] += mood;
    }
    moods
}

/// What the whole sweep shares.
pub struct Conditions<'a> {
    /// Values frozen this morning.
    pub morning: &'a Morning,
    /// Service of today.
    pub service: &'a ServiceDay,
    /// In-app ads.
    pub ads: &'a AdLoad<'a>,
    /// Tenure bonuses by days.
    pub tenure: &'a TenureTable,
    /// Parameters.
    pub params: &'a Params,
}

/// Moves the satisfaction of everybody in a block and returns what they contribute to their group's reputation.
///
/// One linear pass over the columns it needs. What all rows share is copied out first: the compiler cannot know that
/// no column overlaps the parameters, and would read them again for every row.
pub fn update(group: Group, block: &mut Block, conditions: &Conditions<'_>) -> Mood {
    let &Conditions { morning, service, ads, tenure, params } = conditions;
    let (quality, reputation) = (params.quality.clone(), params.reputation.clone());
    let penalty = service_penalty(service.overload, service.outage, &quality);
    let delivered = ByPlan::from_fn(|plan| morning.delivered(group, plan) - penalty);
    let (day, weekday, quotas) = (morning.day, morning.weekday, morning.quotas);
    let expectation = morning.expectations[group].quality;
    let form = params.fidelity.perceived_quality;
    let alpha = params.satisfaction.satisfaction_ema_alpha;
    let rows = block.len();
    let (plan, rate, start_day) = (&block.plan[..rows], &block.usage_rate[..rows], &block.start_day[..rows]);
    let (relationship, open_days) = (&block.relationship[..rows], &block.open_issue_days[..rows]);
    let (customer, sensitivity) = (&block.customer[..rows], &block.ads_quality_sensitivity[..rows]);
    let (required, satisfaction) = (&block.required[..rows], &mut block.satisfaction[..rows]);
    let mut sum = 0.0;
    for at in 0..rows {
        let demand = quota_demand(rate[at] * weekday, rate[at], params);
        let perceived = perceived_quality(
            Experience {
                delivered: delivered[plan[at]],
                relationship: relationship_bonus(relationship_as_read(relationship[at], &quality), &quality),
                tenure: tenure.bonus(day - start_day[at]),
                quota: quota_factor(quotas[plan[at]], demand, &quality),
                issues: quality.issue_penalty_per_open_day * f64::from(open_days[at]),
                ads: sensitivity[at] * ads.for_customer(group, customer[at]),
            },
            form,
        );
        let instant = perceived - (required[at] + expectation);
        satisfaction[at] = moved_satisfaction(satisfaction[at], instant, alpha);
        sum += contribution(satisfaction[at], &reputation);
    }
    Mood { sum, count: rows as u32 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::customers::columns::Subscriber;
    use crate::world::customers::columns::tests::subscriber;
    use crate::world::day::tests::morning;
    use crate::world::identifiers::Plan;
    use crate::world::retention::{refresh_required, remembered_budget};
    use crate::world::settings::{AdsStrength, PerCustomer, PerGroup};

    fn group() -> Group {
        Group::at(0).expect("S1")
    }

    fn next_satisfaction(row: Subscriber, day: &Morning, service: ServiceDay, setting: &AdsStrength) -> f64 {
        let params = Params::shipped();
        let mut block = Block::default();
        block.push(row);
        refresh_required(&mut block, 0, day.expectations[group()].c_max, &params);
        let ads = AdLoad::of(setting, &params);
        let tenure = TenureTable::up_to(200, &params.quality);
        let conditions =
            Conditions { morning: day, service: &service, ads: &ads, tenure: &tenure, params: &params };
        update(group(), &mut block, &conditions);
        block.satisfaction[0]
    }

    #[test]
    fn check_6_of_chapter_20() {
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
        let service = ServiceDay { overload: 0.5, outage: true, ..ServiceDay::quiet() };
        let setting = AdsStrength {
            global: 0.2,
            by_group: PerGroup::from([(group(), 0.1)]),
            by_customer: PerCustomer::from([(9, 0.4)]),
        };
        let moved = next_satisfaction(row, &day, service, &setting);
        assert!((moved - 0.158865172).abs() < 1e-9, "{moved}");
    }

    #[test]
    fn check_18_of_chapter_20_counts_drift_twice() {
        let params = Params::shipped();
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
        let service = ServiceDay::quiet();
        let moved = next_satisfaction(row, &day, service, &AdsStrength::default());
        assert!((moved - -0.0133028107).abs() < 1e-9, "{moved}");
        row.effective_c_max = remembered_budget(row.c_max, 2.0, &params);
        assert_eq!(row.effective_c_max, 52.0);
        let instant = next_satisfaction(row, &day, service, &AdsStrength::default()) / 0.1;
        assert!((instant - -0.127399581).abs() < 1e-8, "{instant}");
    }
}
