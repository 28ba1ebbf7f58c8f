//! Prices, model tiers, quotas, discounts.

mod set_model_tiers;
mod set_prices;
mod set_promotion;
mod set_usage_quotas;

pub use set_model_tiers::SetModelTiers;
pub use set_prices::SetPrices;
pub use set_promotion::SetPromotion;
pub use set_usage_quotas::SetUsageQuotas;

use serde_json::{Map, Value};

use super::arguments::{Amount, Arguments};
use super::refusal::Refusal;
use super::spec::Range;
use crate::world::command::ResolvedCommand;
use crate::world::identifiers::{ByPlan, Plan};
use crate::world::settings::CoreSettings;
use crate::world::settings::SettingsChange;

/// A discount of a scope.
pub(super) const DISCOUNT: Amount = Amount {
    code: "promotion_negative",
    words: "must be a number of at least zero, in dollars a month",
    range: Range::AT_LEAST_ZERO,
};

/// The global discount of a promotion.
pub(super) fn global_discount(arguments: &Arguments, now: f64) -> Result<f64, Refusal> {
    let Some(value) = arguments.get("global_promotion") else { return Ok(now) };
    super::arguments::number(value).filter(|number| Range::AT_LEAST_ZERO.holds(*number)).ok_or_else(|| {
        let message = "the global discount must be a number of at least zero, in dollars a month";
        Refusal::at("global_promotion", "global_promotion_negative", message)
    })
}

/// Refuses a call that gives nothing, or names a plan that does not exist.
fn some_plans(arguments: &Arguments) -> Result<(), Refusal> {
    if arguments.is_empty() {
        return Err(Refusal::new("nothing_given", "no value was given; give at least one of A, B, C"));
    }
    match arguments.as_map().keys().find(|key| Plan::parse(key).is_none()) {
        Some(key) => Err(super::arguments::plan(key, key).expect_err("no such plan")),
        None => Ok(()),
    }
}

/// One JSON value per plan.
fn by_plan(value: impl Fn(Plan) -> Value) -> Map<String, Value> {
    Plan::ALL.into_iter().map(|plan| (plan.id().to_owned(), value(plan))).collect()
}

/// What was sent and what holds now, for tools that set one number per plan.
fn updated_and_current(arguments: &Arguments, current: &ByPlan<Value>) -> Value {
    serde_json::json!({
        "updated": crate::notation::plain_numbers(Value::Object(arguments.as_map().clone())),
        "current": by_plan(|plan| current[plan].clone()),
    })
}

/// The core settings a resolved leaves.
pub(super) fn core_of<'a>(resolved: &'a ResolvedCommand, now: &'a CoreSettings) -> &'a CoreSettings {
    match resolved {
        ResolvedCommand::Set(SettingsChange::Core(core)) => core,
        _ => now,
    }
}
