//! Tools for prices, model tiers, quotas and discounts.

mod set_model_tiers;
mod set_prices;
mod set_promotion;
mod set_usage_quotas;

pub use set_model_tiers::SetModelTiers;
pub use set_prices::SetPrices;
pub use set_promotion::SetPromotion;
pub use set_usage_quotas::SetUsageQuotas;

use indexmap::IndexMap;
use serde::Serialize;
use serde_json::{Map, Value};

use super::arguments::{AmountRule, Arguments, json_f64, parse_plan};
use super::rejection::Rejection;
use super::spec::NumberRange;
use novamind_world::identifiers::Plan;

/// The result of tools that set one number per plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanUpdate<T: Serialize> {
    /// Values that the call set, in the order of the call.
    pub updated: IndexMap<Plan, T>,
    /// Values in force after the call, by plan.
    pub current: IndexMap<Plan, T>,
}

/// Requirement for the discounts of a scope.
pub(super) const DISCOUNT_RULE: AmountRule = AmountRule {
    code: "promotion_negative",
    requirement: "must be a number of at least zero, in dollars a month",
    range: NumberRange::AT_LEAST_ZERO,
};

/// Parses the global discount of a call, which applies to all customers.
pub(super) fn parse_global_discount(value: &Value, field: &str) -> Result<f64, Rejection> {
    json_f64(value).filter(|number| NumberRange::AT_LEAST_ZERO.contains(*number)).ok_or_else(|| {
        let message = "the global discount must be a number of at least zero, in dollars a month";
        Rejection::for_field(field, "global_promotion_negative", message)
    })
}

/// Parses the arguments of a call that sets one value per plan. Rejects a call without values or with an unknown plan.
fn parse_per_plan_arguments<T>(
    arguments: &Arguments,
    read: impl Fn(Plan, &Value) -> Result<T, Rejection>,
) -> Result<IndexMap<Plan, T>, Rejection> {
    if arguments.is_empty() {
        return Err(Rejection::new("nothing_given", "no value was given; give at least one of A, B, C"));
    }
    let named = arguments.as_map().iter().map(|(key, value)| Ok((parse_plan(key, key)?, value)));
    let named: Vec<(Plan, &Value)> = named.collect::<Result<_, Rejection>>()?;
    named.into_iter().map(|(plan, value)| Ok((plan, read(plan, value)?))).collect()
}

fn map_plans<T>(value: impl Fn(Plan) -> T) -> IndexMap<Plan, T> {
    Plan::ALL.into_iter().map(|plan| (plan, value(plan))).collect()
}

fn plan_values_json(value: impl Fn(Plan) -> Value) -> Map<String, Value> {
    Plan::ALL.into_iter().map(|plan| (plan.id().to_owned(), value(plan))).collect()
}
