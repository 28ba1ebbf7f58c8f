//! Prices, model tiers, quotas, discounts.

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

use super::arguments::{Amount, Arguments, number, plan};
use super::refusal::Refusal;
use super::spec::Range;
use novamind_world::identifiers::Plan;

/// Sent values and values in force, for tools that set one number per plan.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlanUpdate<T: Serialize> {
    /// Sent values, in the order of the call.
    pub updated: IndexMap<Plan, T>,
    /// Values in force, by plan.
    pub current: IndexMap<Plan, T>,
}

/// Rule for discounts of a scope.
pub(super) const DISCOUNT: Amount = Amount {
    code: "promotion_negative",
    words: "must be a number of at least zero, in dollars a month",
    range: Range::AT_LEAST_ZERO,
};

/// Parses the global discount of a promotion.
pub(super) fn global_discount(value: &Value, field: &str) -> Result<f64, Refusal> {
    number(value).filter(|number| Range::AT_LEAST_ZERO.holds(*number)).ok_or_else(|| {
        let message = "the global discount must be a number of at least zero, in dollars a month";
        Refusal::at(field, "global_promotion_negative", message)
    })
}

/// Parses the values of the plans in a call. Rejects a call without values or with an unknown plan.
fn per_named_plan<T>(
    arguments: &Arguments,
    read: impl Fn(Plan, &Value) -> Result<T, Refusal>,
) -> Result<IndexMap<Plan, T>, Refusal> {
    if arguments.is_empty() {
        return Err(Refusal::new("nothing_given", "no value was given; give at least one of A, B, C"));
    }
    let named = arguments.as_map().iter().map(|(key, value)| Ok((plan(key, key)?, value)));
    let named: Vec<(Plan, &Value)> = named.collect::<Result<_, Refusal>>()?;
    named.into_iter().map(|(plan, value)| Ok((plan, read(plan, value)?))).collect()
}

fn by_plan<T>(value: impl Fn(Plan) -> T) -> IndexMap<Plan, T> {
    Plan::ALL.into_iter().map(|plan| (plan, value(plan))).collect()
}

fn plan_map(value: impl Fn(Plan) -> Value) -> Map<String, Value> {
    Plan::ALL.into_iter().map(|plan| (plan.id().to_owned(), value(plan))).collect()
}
