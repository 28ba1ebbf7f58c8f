//! The weekly routine of the paper's rule-based baseline (docs/interfaces/policies.md#weekly-routine).

use serde_json::{Map, Value, json};

use super::policy::{CapacityRule, OperationsRule, RuleBased, TargetGroups};
use novamind_session::{Observation, Session, best_starting_channel};
use novamind_tools::ToolId;
use novamind_world::identifiers::{Group, Plan};
use novamind_world::params::Params;

/// First day on which the routine advertises.
const ADS_START_DAY: u32 = 20;
/// First day on which the second target group receives development and ads.
const SECOND_GROUP_START_DAY: u32 = 30;
/// Returns the calls of the routine on the current decision day, in order.
pub fn routine_calls(rules: &RuleBased, session: &Session) -> Vec<(ToolId, Value)> {
    let seen = session.company().observe();
    let on = seen.cash > rules.cash_floor;
    let (prices, tiers, quotas) = rules.price_book.prices_tiers_and_quotas();
    let mut calls = vec![
        (ToolId::SetPrices, per_plan(|plan| json!(prices.get(plan)))),
        (ToolId::SetModelTiers, per_plan(|plan| json!(tiers.get(plan)))),
        (ToolId::SetUsageQuotas, per_plan(|plan| json!(quotas.get(plan)))),
        (ToolId::SetDailySpend, daily_spend_arguments(rules, &seen, on)),
    ];
    if rules.target != TargetGroups::None {
        calls.extend(targeted_calls(rules, &seen, on, session.params()));
    }
    if rules.capacity == CapacityRule::Utilisation {
        calls.push((
            ToolId::SetCapacityTier,
            json!({ "tier": session.company().capacity_step_toward_usage() }),
        ));
    }
    calls
}

fn per_plan(value: impl Fn(Plan) -> Value) -> Value {
    Plan::ALL.into_iter().map(|plan| (plan.id().to_owned(), value(plan))).collect()
}

fn daily_spend_arguments(rules: &RuleBased, seen: &Observation, on: bool) -> Value {
    let operations = match rules.operations {
        OperationsRule::Named(_) => (0.05 * f64::from(seen.subscribers + seen.companies)).max(100.0),
        OperationsRule::Fixed(amount) => amount,
    };
    json!({ "operations": operations, "development": if on { rules.global_development } else { 0.0 } })
}

fn targeted_calls(rules: &RuleBased, seen: &Observation, on: bool, params: &Params) -> [(ToolId, Value); 2] {
    let (s1, s3) = rules.spend.budgets();
    let mut targets = vec![("S1", s1)];
    if rules.target == TargetGroups::S1ThenS3 && seen.day >= SECOND_GROUP_START_DAY {
        targets.push(("S3", s3));
    }
    let (mut development, mut ads) = (Map::new(), Map::new());
    for (id, budget) in targets {
        if on {
            development.insert(id.to_owned(), json!(budget.development));
        }
        if on && seen.day >= ADS_START_DAY {
            let channel = best_starting_channel(Group::parse(id).expect("S1 and S3 exist"), params);
            let groups = ads.entry(channel.id()).or_insert_with(|| Value::Object(Map::new()));
            if let Value::Object(groups) = groups {
                groups.insert(id.to_owned(), json!(budget.ads));
            }
        }
    }
    [
        (ToolId::SetTargetedDevSpend, json!({ "targeted_spend": development })),
        (ToolId::SetTargetedAdSpend, json!({ "targeted_spend": ads })),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn initial_best_channels_are_content_marketing_and_referrals() {
        let params = Params::bundled();
        let best = |id| best_starting_channel(Group::parse(id).expect("a group"), &params).id();
        assert_eq!((best("S1"), best("S3")), ("content_marketing", "referral_program"));
    }
}
