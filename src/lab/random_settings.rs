//! Policies with randomly drawn settings, for measurements that should not depend only on well-chosen
//! decisions.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde_json::{Map, Value, json};

use super::enterprise_answers::{EnterpriseRule, OfferRule, PriceFactor, ThreadTypes};
use super::policy::{
    CapacityRule, PerPlan, Policy, PolicyStart, PriceBook, RuleBased, ScheduledCall, TargetGroups,
};
use novamind_world::identifiers::{Channel, Group, Plan};

/// Last day on which settings change.
const LAST_CHANGE_DAY: u32 = 420;
/// Largest number of changes after day 0.
const MAX_CHANGES: u32 = 8;

/// Returns a policy whose prices, model tiers, quotas, budgets, answers to enterprises and later changes are drawn from
/// the seed. Capacity follows usage as in the baseline.
pub fn random_policy(seed: u64) -> Policy {
    let mut draw = Draws(ChaCha8Rng::seed_from_u64(seed));
    let book = price_book(&mut draw);
    let (prices, _, _) = book.prices_tiers_and_quotas();
    let mut calls = vec![budgets(&mut draw, 0, 1.0)];
    let starts = 7 * draw.below(7);
    calls.push(ads(&mut draw, starts, 1.0));
    for _ in 0..draw.below(MAX_CHANGES + 1) {
        let day = 7 * (1 + draw.below(LAST_CHANGE_DAY / 7));
        calls.push(match draw.below(5) {
            0 => set_prices(&mut draw, day, &prices),
            1 | 2 => {
                let scale = draw.log_uniform(0.3, 10.0);
                ads(&mut draw, day, scale)
            }
            3 => {
                let scale = draw.log_uniform(0.3, 10.0);
                budgets(&mut draw, day, scale)
            }
            _ => purchase(&mut draw, day),
        });
    }
    // Calls of the same tool replace each other in the order of their days.
    calls.sort_by_key(|call| call.day);
    let enterprise = draw.chance(0.7).then(|| enterprise_rule(&mut draw));
    let rule_based = RuleBased {
        price_book: book,
        target: TargetGroups::None,
        cash_floor: if draw.chance(0.5) { 100_000.0 } else { -1.0 },
        global_development: if draw.chance(0.5) { draw.log_uniform(50.0, 3_000.0).round() } else { 0.0 },
        capacity: CapacityRule::Utilisation,
        ..RuleBased::default()
    };
    Policy {
        name: format!("random-{seed}"),
        description: "Randomly drawn settings.".to_owned(),
        start: PolicyStart::default(),
        rule_based: Some(rule_based),
        calls,
        enterprise,
    }
}

struct Draws(ChaCha8Rng);

impl Draws {
    /// Returns a number from 0 to 1.
    fn unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn chance(&mut self, share: f64) -> bool {
        self.unit() < share
    }

    fn below(&mut self, count: u32) -> u32 {
        ((self.unit() * f64::from(count)) as u32).min(count.saturating_sub(1))
    }

    fn log_uniform(&mut self, least: f64, most: f64) -> f64 {
        least * libm::pow(most / least, self.unit())
    }

    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len() as u32) as usize]
    }
}

fn price_book(draw: &mut Draws) -> PriceBook {
    let a = draw.log_uniform(5.0, 60.0).round();
    let b = (a * (1.0 + 1.5 * draw.unit())).round();
    let c = (b * (1.0 + 3.0 * draw.unit())).round();
    let tier = 1 + draw.below(3) as u8;
    let (middle, top) = ((tier + draw.below(2) as u8).min(5), (tier + draw.below(3) as u8).min(5));
    let quota = draw.log_uniform(20.0, 2_000.0).round();
    PriceBook::Own {
        prices: PerPlan { a, b, c },
        tiers: PerPlan { a: tier, b: middle, c: top },
        quotas: PerPlan { a: quota as u64, b: (4.0 * quota) as u64, c: (100.0 * quota) as u64 },
    }
}

fn call(day: u32, tool: &str, arguments: Value) -> ScheduledCall {
    ScheduledCall {
        day,
        tool: tool.to_owned(),
        arguments,
        repeat: 1,
        every_weeks: None,
        until_day: None,
        may_fail: true,
    }
}

/// Returns a call that multiplies all prices by one factor. The routine sets its own prices every week, so the call is repeated.
fn set_prices(draw: &mut Draws, day: u32, prices: &PerPlan<f64>) -> ScheduledCall {
    let factor = draw.log_uniform(0.6, 1.6);
    let changed: Map<String, Value> = Plan::ALL
        .into_iter()
        .map(|plan| (plan.id().to_owned(), json!((prices.get(plan) * factor).round().max(1.0))))
        .collect();
    ScheduledCall { every_weeks: Some(1), ..call(day, "set_prices", Value::Object(changed)) }
}

fn amounts(draw: &mut Draws, scale: f64) -> Map<String, Value> {
    let known: Vec<Group> = Group::all().filter(|group| group.is_initially_known()).collect();
    let mut amounts = Map::new();
    for _ in 0..1 + draw.below(3) {
        let dollars = (draw.log_uniform(100.0, 5_000.0) * scale).round();
        amounts.insert(draw.pick(&known).id().to_owned(), json!(dollars));
    }
    amounts
}

fn budgets(draw: &mut Draws, day: u32, scale: f64) -> ScheduledCall {
    let spend = amounts(draw, scale);
    call(day, "set_targeted_dev_spend", json!({ "targeted_spend": spend }))
}

fn ads(draw: &mut Draws, day: u32, scale: f64) -> ScheduledCall {
    let channel = draw.pick(&Channel::ALL).id();
    let spend = amounts(draw, scale);
    call(day, "set_targeted_ad_spend", json!({ "targeted_spend": { channel: spend } }))
}

fn purchase(draw: &mut Draws, day: u32) -> ScheduledCall {
    match draw.below(3) {
        0 => call(day, "research_market", json!({})),
        1 => call(day, "research_group", json!({ "group_id": "S1", "target_level": 2 + draw.below(2) })),
        _ => call(day, "start_research_project", json!({ "tier": 1 + draw.below(3) })),
    }
}

fn enterprise_rule(draw: &mut Draws) -> EnterpriseRule {
    EnterpriseRule {
        offerings: vec![OfferRule {
            plan: draw.pick(&Plan::ALL),
            price: draw.log_uniform(15.0, 120.0).round(),
        }],
        factor: PriceFactor { start: 1.0, step: -0.1, floor: 0.5 },
        give_up_after: Some(2 + draw.below(5)),
        types: ThreadTypes::All,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seed_determines_the_policy() {
        assert_eq!(random_policy(3), random_policy(3));
        let different = (0..20).filter(|seed| random_policy(*seed).calls != random_policy(seed + 20).calls);
        assert_eq!(different.count(), 20);
    }
}
