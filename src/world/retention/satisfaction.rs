//! Daily satisfaction of every active subscriber (chapter 20 §15, step 13).

use std::ops::Range;

use multiversion::multiversion;

use crate::world::customers::Customers;
use crate::world::customers::columns::Block;
use crate::world::day::Morning;
use crate::world::events::ServiceDay;
use crate::world::identifiers::{ByGroup, ByPlan, Group};
use crate::world::market::reputation::contribution;
use crate::world::params::{Params, PerceivedQuality, Quality, Reputation};
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

/// What a group's subscribers contribute to its reputation today.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mood {
    /// Sum of the contributions of chapter 30 §2.2.
    pub sum: f64,
    /// How many contributed.
    pub count: u32,
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

/// Moves everybody's satisfaction and returns what each group contributes to its reputation.
pub fn update(customers: &mut Customers, conditions: &Conditions<'_>) -> ByGroup<Mood> {
    let by_block = customers.sweep(|group, _, block| (group, update_block(group, block, conditions)));
    let mut moods = ByGroup::<Mood>::default();
    for (group, mood) in by_block {
        moods[group].sum += mood.sum;
        moods[group].count += mood.count;
    }
    moods
}

/// Rows whose satisfaction is worked out together.
const STRIP: usize = 128;

/// What has to be looked up for them, an array for each value: the same steps for every row, side by side.
struct Strip {
    delivered: [f64; STRIP],
    quota: [f64; STRIP],
    tenure: [f64; STRIP],
    ads: [f64; STRIP],
    demand: [f64; STRIP],
    open_issue_days: [f64; STRIP],
    contribution: [f64; STRIP],
}

/// What all rows of a strip share, copied out of the parameters: the compiler cannot know that no column overlaps
/// them, and would read them again for every row.
struct Shared {
    quality: Quality,
    reputation: Reputation,
    form: PerceivedQuality,
    expectation: f64,
    alpha: f64,
}

impl Shared {
    fn of(group: Group, conditions: &Conditions<'_>) -> Shared {
        let &Conditions { morning, params, .. } = conditions;
        Shared {
            quality: params.quality.clone(),
            reputation: params.reputation.clone(),
            form: params.fidelity.perceived_quality,
            expectation: morning.expectations[group].quality,
            alpha: params.satisfaction.satisfaction_ema_alpha,
        }
    }
}

fn update_block(group: Group, block: &mut Block, conditions: &Conditions<'_>) -> Mood {
    let shared = Shared::of(group, conditions);
    let mut strip = Strip::empty();
    let mut sum = 0.0;
    for from in (0..block.len()).step_by(STRIP) {
        let rows = from..(from + STRIP).min(block.len());
        strip.look_up(group, block, rows.clone(), conditions);
        let count = rows.len();
        let (relationship, required) = (&block.relationship[rows.clone()], &block.required[rows.clone()]);
        feel(&mut strip, relationship, required, &mut block.satisfaction[rows], &shared);
        // One after the other, so that the sum does not depend on how many go side by side.
        sum = strip.contribution[..count].iter().fold(sum, |sum, own| sum + own);
    }
    Mood { sum, count: block.len() as u32 }
}

impl Strip {
    fn empty() -> Strip {
        let nothing = [0.0; STRIP];
        Strip {
            delivered: nothing,
            quota: nothing,
            tenure: nothing,
            ads: nothing,
            demand: nothing,
            open_issue_days: nothing,
            contribution: nothing,
        }
    }

    /// Takes over what the columns hold of these rows, and looks up what belongs to their plans, days and ads.
    fn look_up(&mut self, group: Group, block: &Block, rows: Range<usize>, conditions: &Conditions<'_>) {
        let &Conditions { morning, service, ads, tenure, params } = conditions;
        let penalty = service_penalty(service.overload, service.outage, &params.quality);
        let offers = ByPlan::from_fn(|plan| (morning.delivered(group, plan) - penalty, morning.quotas[plan]));
        for (at, &plan) in block.plan[rows.clone()].iter().enumerate() {
            (self.delivered[at], self.quota[at]) = offers[plan];
        }
        for (bonus, &start_day) in self.tenure.iter_mut().zip(&block.start_day[rows.clone()]) {
            *bonus = tenure.bonus(morning.day - start_day);
        }
        if ads.is_used() {
            let people =
                block.customer[rows.clone()].iter().zip(&block.ads_quality_sensitivity[rows.clone()]);
            for (lost, (&customer, sensitivity)) in self.ads.iter_mut().zip(people) {
                *lost = sensitivity * ads.for_customer(group, customer);
            }
        }
        for (demand, &rate) in self.demand.iter_mut().zip(&block.usage_rate[rows.clone()]) {
            *demand = quota_demand(rate * morning.weekday, rate, params);
        }
        for (days, &open) in self.open_issue_days.iter_mut().zip(&block.open_issue_days[rows.clone()]) {
            *days = f64::from(open);
        }
    }
}

/// Moves the satisfaction of a strip. Compiled for the widest registers the processor may have too: no step is fused
/// with another there, so the bits are the same.
#[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl", "x86_64+avx2"))]
fn feel(
    strip: &mut Strip,
    relationship: &[f64],
    required: &[f64],
    satisfaction: &mut [f64],
    shared: &Shared,
) {
    let Shared { quality, reputation, .. } = shared;
    let rows = satisfaction.len().min(STRIP);
    let (relationship, required) = (&relationship[..rows], &required[..rows]);
    let satisfaction = &mut satisfaction[..rows];
    for at in 0..rows {
        let perceived = perceived_quality(
            Experience {
                delivered: strip.delivered[at],
                relationship: relationship_bonus(relationship_as_read(relationship[at], quality), quality),
                tenure: strip.tenure[at],
                quota: quota_factor(strip.quota[at], strip.demand[at], quality),
                issues: quality.issue_penalty_per_open_day * strip.open_issue_days[at],
                ads: strip.ads[at],
            },
            shared.form,
        );
        let instant = perceived - (required[at] + shared.expectation);
        let moved = moved_satisfaction(satisfaction[at], instant, shared.alpha);
        satisfaction[at] = moved;
        strip.contribution[at] = contribution(moved, reputation);
    }
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
        update_block(group(), &mut block, &conditions);
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
