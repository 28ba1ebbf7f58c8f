//! X-ray views as data.

use serde::Serialize;
use serde_json::{Value, json};

use novamind_insight::{
    EnterpriseThreadDay, EnterpriseView, IndividualDay, IndividualView, LeadEquation, LeadFactor,
};
use novamind_session::identifiers::{ByPlan, Plan};

/// Values of a plan, with its name.
#[derive(Serialize)]
struct PlanEntry<'a, T> {
    plan: Plan,
    #[serde(flatten)]
    own: &'a T,
}

fn by_plan<T>(plans: &ByPlan<T>) -> [PlanEntry<'_, T>; 3] {
    Plan::ALL.map(|plan| PlanEntry { plan, own: &plans[plan] })
}

pub(super) fn leads_to_json(own: &LeadEquation, held: &[(LeadFactor, f64)]) -> Value {
    let factors = LeadFactor::ALL.map(|factor| (factor.letter().to_owned(), json!(own.factor(factor))));
    let channels = own.channels().map(|(channel, leads)| (channel.id().to_owned(), json!(leads)));
    let word_of_mouth = own.word_of_mouth.iter().map(|(group, leads)| (group.id().to_owned(), json!(leads)));
    json!({
        "group": own.group.id(),
        "day": own.day,
        "known": own.is_known,
        "factors": Value::Object(factors.into_iter().collect()),
        "channels": Value::Object(channels.collect()),
        "word_of_mouth": Value::Object(word_of_mouth.collect()),
        "expected": own.expected_leads(),
        "came": own.actual_leads,
        "p": own.p_value(),
        "held": (!held.is_empty()).then(|| own.expected_with(held)),
    })
}

pub(super) fn customer_to_json(lens: &IndividualView, headline: &str) -> Value {
    let day = |own: &IndividualDay| {
        json!({
            "day": own.day,
            "plan": own.plan.id(),
            "price": own.price,
            "billing_day": own.is_due,
            "satisfaction": own.satisfaction,
            "relationship": own.relationship,
            "open_issue_days": own.open_issue_days,
            "choice": own.weighed_decision.choice.map(Plan::id),
            "plans": by_plan(&own.weighed_decision.plans),
        })
    };
    json!({
        "customer_id": lens.customer,
        "group": lens.group.id(),
        "headline": headline,
        "came": lens.signup.day,
        "signed_up": lens.signup.signed_up,
        "shown": lens.day_shown().map(day),
        "last_bill": lens.last_bill().map(day),
    })
}

pub(super) fn enterprise_to_json(lens: &EnterpriseView) -> Value {
    let thread = |own: &EnterpriseThreadDay| {
        json!({
            "thread": own.thread,
            "kind": own.kind.id(),
            "budget": own.budget,
            "turns_left": own.remaining_turns,
            "relationship": own.relationship,
            "late_penalty": own.late_penalty,
            "reply_day": own.reply_day,
            "plans": by_plan(&own.plans),
        })
    };
    json!({
        "customer_id": lens.customer,
        "group": lens.group.id(),
        "day": lens.day,
        "threads": lens.threads_of_day().map(thread).collect::<Vec<Value>>(),
    })
}
